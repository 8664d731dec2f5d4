//! Projection: the pressure that leaves no divergence.
//!
//! ```text
//! A psi = -delta,   u_face -= psi_i - psi_(i-1),   pressure += psi / dt
//! ```
//! delta is the sum of a cell's face velocities, outwards; A is the seven-point operator on
//! open faces. In a box it is inverted directly. In a pot conjugate gradients (Hestenes,
//! Stiefel 1952) use the box's direct solver as their preconditioner: residual extended by 0 to
//! the whole box, solution restricted to the liquid. The energy of the extension is bounded by
//! that of the liquid's own field, so the number of iterations does not grow with the grid.

use crate::pool::Pool;
use crate::solver::flow::{
    engine::Engine,
    faces::Faces,
    field::{FaceRuns, Field, Lanes, Layout, Run, Star, Vector, components, cut, cut_mut},
    poisson::{Poisson, basis::Ends},
};

/// The residual may fall to this part of what it was ...
const RELATIVE_TOLERANCE: f64 = 1e-5;

/// ... or, as nothing smaller can be told from the rounding of the velocities, to this part of
/// the largest speed.
const SPEED_TOLERANCE: f64 = 3e-6;

/// Iterations at most.
const MAX_ITERATIONS: usize = 40;

/// Below this a velocity component is 0: at rest means at rest.
const REST_M_S: f32 = 1e-6;

/// The pressure of the next step, per density and spacing, extrapolated from the last two.
pub struct Prediction {
    /// The pressure that is expected.
    pub next: Field,
    /// How much it grew from step to step.
    pub trend: Field,
    /// Share of the trend that is extrapolated.
    pub share: f32,
}

/// Solves for the pressure on one grid.
pub struct Projection {
    layout: Layout,
    poisson: Poisson,
    /// Solution of the last solve.
    pub psi: Field,
    /// Residual, preconditioned residual, search direction, and A times it; only in a pot.
    krylov: Option<[Field; 4]>,
}

impl Projection {
    /// For the liquid that `faces` describe.
    pub fn new(layout: &Layout, faces: &Faces, pool: &Pool) -> Self {
        let poisson = Poisson::new(layout, [Ends::CLOSED; 3], pool.threads());
        let zeros = || layout.zeros();
        let krylov = (!faces.is_box).then(|| [zeros(), zeros(), zeros(), zeros()]);
        Self { layout: *layout, poisson, psi: zeros(), krylov }
    }

    /// Takes the divergence out of `velocity`; what that took, times `rate_per_s`, is what the
    /// pressure was mispredicted by: 1/dt in a step, 0 outside of one.
    /// Returns the number of iterations, 0 where the solution is direct or nothing moves.
    pub fn project(
        &mut self,
        on: Engine<'_>,
        velocity: &mut Vector,
        pressure: &mut Prediction,
        rate_per_s: f32,
    ) -> u32 {
        let Self { layout, poisson, psi, krylov } = self;
        let residual = krylov.as_mut().map_or(&mut *psi, |[residual, ..]| residual);
        let squares = on.set_residual(layout, components(velocity), residual);
        if squares[0] == 0.0 {
            return 0;
        }
        let iterations = match krylov {
            Some(krylov) => on.iterate(layout, poisson, psi, krylov, squares),
            None => {
                poisson.solve_in_place(on.pool, on.simd, psi);
                0
            }
        };
        self.correct(on, velocity, pressure, rate_per_s);
        iterations
    }

    /// Subtracts the gradient of psi, snaps what is nearly at rest, and keeps the pressure.
    fn correct(
        &mut self,
        on: Engine<'_>,
        velocity: &mut Vector,
        pressure: &mut Prediction,
        rate: f32,
    ) {
        let (layout, psi) = (self.layout, &*self.psi);
        let [x, y, z] = velocity.each_mut().map(|field| layout.planes(field));
        let Prediction { next, trend, share } = pressure;
        let share = *share;
        let outs = [x, y, z, layout.planes(next), layout.planes(trend)];
        on.pool.planes(outs, [layout.plane; 5], |k, [x, y, z, next, trend]| {
            on.run(
                &layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    let psi = Star::new(&layout, psi, at, len);
                    let open = on.faces.open.each_ref();
                    let [open_x, open_y, open_z] = [open[0], open[1], open[2]];
                    correct_row(cut_mut(x, to, len), cut(open_x, at, len), psi.here, psi.x.0);
                    correct_row(cut_mut(y, to, len), cut(open_y, at, len), psi.here, psi.y.0);
                    correct_row(cut_mut(z, to, len), cut(open_z, at, len), psi.here, psi.z.0);
                    predict(cut_mut(next, to, len), cut_mut(trend, to, len), rate, share, psi.here);
                },
            );
        });
    }
}

#[inline(always)]
fn correct_row(u: &mut [f32], open: &[f32], above: &[f32], below: &[f32]) {
    for i in 0..u.len() {
        let next = u[i] - open[i] * (above[i] - below[i]);
        u[i] = if next.abs() < REST_M_S { 0.0 } else { next };
    }
}

#[inline(always)]
fn predict(next: &mut [f32], trend: &mut [f32], rate: f32, share: f32, psi: &[f32]) {
    for i in 0..next.len() {
        let miss = rate * psi[i];
        trend[i] = share * trend[i] + miss;
        next[i] += miss + share * trend[i];
    }
}

/// out += share x.
#[inline(always)]
fn add_row(out: &mut [f32], share: f32, x: &[f32]) {
    out.iter_mut().zip(x).for_each(|(out, x)| *out += share * x);
}

impl Engine<'_> {
    /// residual = -delta; returns its squared norm and the squared norm of the velocity.
    fn set_residual(
        &self,
        layout: &Layout,
        velocity: [&[f32]; 3],
        residual: &mut Field,
    ) -> [f64; 2] {
        let body = |k, [out]: [&mut [f32]; 1]| {
            self.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, sums| {
                    let out = cut_mut(out, to, len);
                    let faces = FaceRuns::new(layout, velocity, at, len);
                    let liquid = cut(&self.faces.liquid, at, len);
                    for i in 0..out.len() {
                        out[i] = -liquid[i] * faces.outflow(i);
                    }
                    sums[0].add_product(out, out);
                    faces.add_squares(&mut sums[1]);
                },
            )
        };
        let outs = [layout.planes(residual)];
        let combine = |a: [f64; 4], b: [f64; 4]| [a[0] + b[0], a[1] + b[1], 0.0, 0.0];
        let [square, speed_square, ..] = self.pool.fold(None, outs, [layout.plane], body, combine);
        [square, speed_square]
    }

    /// Preconditioned conjugate gradients from psi = 0.
    fn iterate(
        &self,
        layout: &Layout,
        poisson: &mut Poisson,
        psi: &mut Field,
        [residual, z, p, q]: &mut [Field; 4],
        [square, speed_square]: [f64; 2],
    ) -> u32 {
        let small = (square * RELATIVE_TOLERANCE * RELATIVE_TOLERANCE)
            .max(speed_square * SPEED_TOLERANCE * SPEED_TOLERANCE);
        psi.fill(0.0);
        if square <= small {
            return 0;
        }
        let mut rz = self.precondition(layout, poisson, residual, z);
        p.copy_from_slice(z);
        for iteration in 1..=MAX_ITERATIONS {
            let curvature = self.apply(layout, p, q);
            if !(curvature > 0.0 && rz > 0.0) {
                return iteration as u32;
            }
            let square = self.descend(layout, (rz / curvature) as f32, [p, q], psi, residual);
            if square <= small || iteration == MAX_ITERATIONS {
                return iteration as u32;
            }
            let rz_next = self.precondition(layout, poisson, residual, z);
            self.turn(layout, (rz_next / rz) as f32, z, p);
            rz = rz_next;
        }
        MAX_ITERATIONS as u32
    }

    /// z = the box's solution for r, in the liquid; returns r . z.
    fn precondition(
        &self,
        layout: &Layout,
        poisson: &mut Poisson,
        r: &[f32],
        z: &mut Field,
    ) -> f64 {
        poisson.solve(self.pool, self.simd, r, z);
        self.pool.planes_sum([layout.planes(z)], [layout.plane], |k, [z]| {
            let (at, len) = ((k + 1) * layout.plane, layout.plane);
            let (z, liquid, r) =
                (cut_mut(z, 0, len), cut(&self.faces.liquid, at, len), cut(r, at, len));
            self.simd.vectorize(
                #[inline(always)]
                || {
                    for (z, liquid) in z.iter_mut().zip(liquid) {
                        *z *= liquid;
                    }
                    let mut sum = Lanes::default();
                    sum.add_product(z, r);
                    sum.sum()
                },
            )
        })
    }

    /// q = A p; returns p . q. p is 0 outside the liquid.
    fn apply(&self, layout: &Layout, p: &[f32], q: &mut Field) -> f64 {
        self.pool.planes_sum([layout.planes(q)], [layout.plane], |k, [q]| {
            self.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, sums| {
                    let (q, p) = (cut_mut(q, to, len), Star::new(layout, p, at, len));
                    let liquid = cut(&self.faces.liquid, at, len);
                    let count = cut(&self.faces.open_count, at, len);
                    for i in 0..q.len() {
                        q[i] = liquid[i] * (count[i] * p.here[i] - p.around(i));
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
