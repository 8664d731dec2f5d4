//! The pressure in a vessel that is not a box: preconditioned conjugate gradients (Hestenes,
//! Stiefel 1952).
//!
//! The preconditioner is the direct solver of the whole box: residual extended by 0, solution
//! restricted to the liquid. The energy of the extension is bounded by that of the liquid's own
//! field, so the number of iterations does not grow with the grid. A cell that walls leave little
//! open area is worth more than the box knows: what its own inverse has beyond that of a whole
//! cell is added (Jacobi).

use crate::solver::flow::{
    density::Density,
    engine::Engine,
    faces::{Faces, VesselFaces},
    field::{FaceRuns, Field, Lanes, Layout, Run, Star, components, cut, cut_mut},
    ghosts::Ghosts,
    poisson::{Poisson, Stored},
};

/// The residual may fall to this part of what it was, of liquid of one density and of more: that
/// falls from rest in every step ...
const RELATIVE_TOLERANCE: [f64; 2] = [1e-5, 1e-6];

/// ... or, as nothing smaller can be told from the rounding of the velocities, to this part of
/// the largest speed.
const SPEED_TOLERANCE: [f64; 2] = [3e-6, 1e-6];

/// Iterations at most, of liquid of one density and of more.
const MAX_ITERATIONS: [usize; 2] = [40, 120];

/// The operator, and what its preconditioner needs to know of it.
#[derive(Clone, Copy)]
pub struct Operator<'a> {
    /// What passes each face for a difference of pressure.
    pub through: [&'a [f32]; 3],
    /// Sum of that over the faces of each liquid cell.
    pub through_cell: &'a [f32],
    /// What the inverse of a cell has more than in the box, if walls cut any.
    pub lift: Option<&'a [f32]>,
    /// Square root of the density, if that differs.
    pub root: Option<&'a [f32]>,
}

impl<'a> Operator<'a> {
    /// Of the liquid in `faces`; `None` where the direct solver is all that it takes.
    pub fn new(faces: &'a Faces, density: Option<&'a Density>) -> Option<Self> {
        let lift = faces.vessel.as_ref().map(|vessel| &*vessel.lift);
        match (density, &faces.vessel) {
            (None, None) => None,
            (None, Some(VesselFaces { area, open_area, .. })) => {
                let through = components(area);
                Some(Self { through, through_cell: open_area, lift, root: None })
            }
            (Some(density), _) => {
                let (through, root) = (components(density.through()), Some(&*density.root));
                Some(Self { through, through_cell: &density.through_cell, lift, root })
            }
        }
    }
}

/// out += share x.
#[inline(always)]
fn add_row(out: &mut [f32], share: f32, x: &[f32]) {
    for (out, x) in out.iter_mut().zip(x) {
        *out += share * x;
    }
}

impl Engine<'_> {
    /// Preconditioned conjugate gradients from psi = 0.
    ///
    /// `residual` comes in as the right-hand side with its squared norm; the velocity's says what
    /// can be told from rounding. Returns the iterations taken.
    pub fn iterate(
        &self,
        (layout, ghosts): (&Layout, &Ghosts),
        poisson: &mut Poisson,
        operator: Operator<'_>,
        psi: &mut Field,
        [residual, z, p, q]: &mut [Field; 4],
        [square, speed_square]: [f64; 2],
    ) -> u32 {
        let differs = usize::from(operator.root.is_some());
        let small = (square * RELATIVE_TOLERANCE[differs].powi(2))
            .max(speed_square * SPEED_TOLERANCE[differs].powi(2));
        psi.fill(0.0);
        if square <= small {
            return 0;
        }
        let most = MAX_ITERATIONS[differs];
        let mut rz = self.precondition(layout, operator, poisson, residual, [z, q]);
        p.copy_from_slice(z);
        ghosts.wrap_cells(p);
        for iteration in 1..=most {
            let curvature = self.apply(layout, operator, p, q);
            if !(curvature > 0.0 && rz > 0.0) {
                return iteration as u32;
            }
            let square = self.descend(layout, (rz / curvature) as f32, [p, q], psi, residual);
            if square <= small || iteration == most {
                return iteration as u32;
            }
            let rz_next = self.precondition(layout, operator, poisson, residual, [z, q]);
            self.turn(layout, (rz_next / rz) as f32, z, p);
            ghosts.wrap_cells(p);
            rz = rz_next;
        }
        most as u32
    }

    /// z = the box's solution for r, in the liquid; returns r . z. `work` is overwritten.
    fn precondition(
        &self,
        layout: &Layout,
        Operator { lift, root, .. }: Operator<'_>,
        poisson: &mut Poisson,
        r: &[f32],
        [z, work]: [&mut Field; 2],
    ) -> f64 {
        match root {
            None => poisson.solve(self.pool, self.simd, Stored(layout, r), z),
            Some(root) => {
                self.scale(layout, root, r, work);
                poisson.solve(self.pool, self.simd, Stored(layout, work), z);
            }
        }
        self.pool.planes_sum([layout.planes(z)], [layout.plane], |k, [z]| {
            let (at, len) = ((k + 1) * layout.plane, layout.plane);
            let (z, r) = (cut_mut(z, 0, len), cut(r, at, len));
            let share = cut(root.unwrap_or(&self.faces.liquid), at, len);
            let lift = lift.map(|lift| cut(lift, at, len));
            self.simd.vectorize(
                #[inline(always)]
                || {
                    for i in 0..len {
                        z[i] *= share[i];
                    }
                    if let Some(lift) = lift {
                        // As much more, the denser the cell is; where all are alike share is 1.
                        for i in 0..len {
                            z[i] += (share[i] * share[i]) * (lift[i] * r[i]);
                        }
                    }
                    let mut sum = Lanes::default();
                    sum.add_product(z, r);
                    sum.sum()
                },
            )
        })
    }

    /// out = share x.
    fn scale(&self, layout: &Layout, share: &[f32], x: &[f32], out: &mut Field) {
        self.pool.planes([layout.planes(out)], [layout.plane], |k, [out]| {
            let (at, len) = ((k + 1) * layout.plane, layout.plane);
            let (share, x) = (cut(share, at, len), cut(x, at, len));
            self.simd.vectorize(
                #[inline(always)]
                || out.iter_mut().zip(share.iter().zip(x)).for_each(|(out, (s, x))| *out = s * x),
            );
        });
    }

    /// q = A p; returns p . q. p is 0 outside the liquid.
    fn apply(&self, layout: &Layout, operator: Operator<'_>, p: &[f32], q: &mut Field) -> f64 {
        self.pool.planes_sum([layout.planes(q)], [layout.plane], |k, [q]| {
            self.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, sums| {
                    let (q, p) = (cut_mut(q, to, len), Star::new(layout, p, at, len));
                    let liquid = cut(&self.faces.liquid, at, len);
                    let area = FaceRuns::new(layout, operator.through, at, len);
                    let open = cut(operator.through_cell, at, len);
                    for i in 0..q.len() {
                        let x = area.x.0[i] * p.x.0[i] + area.x.1[i] * p.x.1[i];
                        let y = area.y.0[i] * p.y.0[i] + area.y.1[i] * p.y.1[i];
                        let z = area.z.0[i] * p.z.0[i] + area.z.1[i] * p.z.1[i];
                        q[i] = liquid[i] * (open[i] * p.here[i] - (x + y + z));
                    }
                    sums[0].add_product(p.here, q);
                },
            )[0]
        })
    }

    /// psi += alpha p, r -= alpha q; returns r . r.
    fn descend(
        &self,
        layout: &Layout,
        alpha: f32,
        [p, q]: [&[f32]; 2],
        psi: &mut Field,
        r: &mut Field,
    ) -> f64 {
        let outs = [layout.planes(psi), layout.planes(r)];
        self.pool.planes_sum(outs, [layout.plane; 2], |k, [psi, r]| {
            self.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, sums| {
                    let (psi, r) = (cut_mut(psi, to, len), cut_mut(r, to, len));
                    add_row(psi, alpha, cut(p, at, len));
                    add_row(r, -alpha, cut(q, at, len));
                    sums[0].add_product(r, r);
                },
            )[0]
        })
    }

    /// p = z + beta p.
    fn turn(&self, layout: &Layout, beta: f32, z: &[f32], p: &mut Field) {
        self.pool.planes([layout.planes(p)], [layout.plane], |k, [p]| {
            self.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    let (p, z) = (cut_mut(p, to, len), cut(z, at, len));
                    for (p, z) in p.iter_mut().zip(z) {
                        *p = z + beta * *p;
                    }
                },
            );
        });
    }
}
