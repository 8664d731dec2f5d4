//! The friction of liquid whose viscosity differs from place to place.
//!
//! ```text
//! friction of u_c = V u = -(1/h^2) div mu (grad u + grad u^T)_c
//! ```
//! per density of the flow. With the stresses along an axis in the cells and those across at their
//! edges, V is the gradient of a sum of squares,
//! ```text
//! u V u = sum over cells of 2 mu (d_c u_c)^2 + sum over edges of mu_e (d_d u_c + d_c u_d)^2
//! ```
//! so that it is symmetric and takes energy, whatever the viscosities. At an edge, mu_e is the
//! harmonic mean of the cells around: stress passes layers as current does resistors in series.
//! Sides and walls that the liquid sticks to are met as by uniform liquid (see [`super::ghosts`]
//! and [`super::walls`]): squares are weighed by the areas between faces, those of two components
//! together by the lesser.

mod set;

use crate::solver::flow::{
    engine::Engine,
    faces::VesselFaces,
    field::{Field, Layout, Run, Star, Vector, cut, cut_mut},
};

/// Weights of the friction, per second, and the inertia it works against.
pub struct Stress {
    layout: Layout,
    /// 2 mu of cells.
    pub(super) cell: Field,
    /// 1 / mu of liquid cells, 0 elsewhere.
    pub(super) resistance: Field,
    /// mu of the edges along each axis, at the lower corner of the cell.
    pub(super) edge: Vector,
    /// Where walls cut faces; `None` in a box.
    pub(super) cut: Option<CutWeights>,
    /// Inertia of each face, per density of the flow; 0 where nothing moves by itself.
    pub inertia: Vector,
    /// No mode decays faster.
    pub stiffness_per_s: f64,
}

/// The same where walls leave less than whole areas.
pub(super) struct CutWeights {
    pub(super) cell: [Field; 3],
    /// By the axis of the edge: of the component along the next axis, and along the one after.
    pub(super) along: [[Field; 2]; 3],
    pub(super) drag: Vector,
}

/// The three axes from one on.
const fn from_axis(axis: usize) -> [usize; 3] {
    [axis, (axis + 1) % 3, (axis + 2) % 3]
}

impl Stress {
    /// No friction, for the liquid in these faces.
    pub fn new(layout: &Layout, vessel: Option<&VesselFaces>) -> Self {
        let zeros = || layout.zeros();
        let vector = || [zeros(), zeros(), zeros()];
        let cut = vessel.map(|_| CutWeights {
            cell: vector(),
            along: [(); 3].map(|()| [zeros(), zeros()]),
            drag: vector(),
        });
        Self {
            layout: *layout,
            cell: zeros(),
            resistance: zeros(),
            edge: vector(),
            cut,
            inertia: vector(),
            stiffness_per_s: 0.0,
        }
    }

    /// The drag of walls that cut a face.
    pub fn drag(&self, c: usize, at: usize) -> f32 {
        self.cut.as_ref().map_or(0.0, |weights| weights.drag[c][at])
    }

    /// The largest sum of magnitudes in a row of V, over its inertia (Gershgorin 1931).
    fn stiffest(&self, on: Engine<'_>) -> f64 {
        let layout = &self.layout;
        on.pool.max(layout.cells[2], |k| {
            let rows = |c| self.rows(c, (k + 1) * layout.plane, layout.plane - layout.row);
            let mut most = 0f64;
            for c in 0..3 {
                let inertia = cut(&self.inertia[c], (k + 1) * layout.plane, layout.plane);
                let rows = rows(c);
                for (i, inertia) in inertia.iter().enumerate().take(layout.plane - layout.row) {
                    if *inertia > 0.0 {
                        most = most.max(f64::from(rows.magnitudes(i) / inertia));
                    }
                }
            }
            most
        })
    }

    /// out = own inertia u + share V u; returns u . out. Faces that nothing moves get 0.
    pub fn apply(
        &self,
        on: Engine<'_>,
        u: [&[f32]; 3],
        out: &mut Vector,
        [own, share]: [f32; 2],
    ) -> f64 {
        let layout = &self.layout;
        let outs = out.each_mut().map(|out| layout.planes(out));
        on.pool.planes_sum(outs, [layout.plane; 3], |k, [x, y, z]| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, [sum, _]| {
                    macro_rules! component {
                        ($c:literal, $out:ident) => {{
                            let out = cut_mut($out, to, len);
                            let inertia = cut(&self.inertia[$c], at, len);
                            let here = cut(u[$c], at, len);
                            let rows = self.rows($c, at, len);
                            rows.friction::<$c>(
                                layout,
                                u,
                                at,
                                len,
                                #[inline(always)]
                                |i, friction| {
                                    let all = own * inertia[i] * here[i] + share * friction;
                                    out[i] = if inertia[i] > 0.0 { all } else { 0.0 };
                                },
                            );
                            sum.add_product(here, out);
                        }};
                    }
                    component!(0, x);
                    component!(1, y);
                    component!(2, z);
                },
            )[0]
        })
    }

    /// Sets `inverse` to that of the diagonal of inertia + share V; 0 where nothing moves.
    pub fn invert_diagonal(&self, on: Engine<'_>, share: f32, inverse: &mut Vector) {
        let layout = &self.layout;
        let outs = inverse.each_mut().map(|out| layout.planes(out));
        on.pool.planes(outs, [layout.plane; 3], |k, outs| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    for (c, out) in outs.into_iter().enumerate() {
                        let (out, rows) = (cut_mut(out, to, len), self.rows(c, at, len));
                        let inertia = cut(&self.inertia[c], at, len);
                        for i in 0..len {
                            let diagonal = inertia[i] + share * rows.diagonal(i);
                            out[i] = if inertia[i] > 0.0 { 1.0 / diagonal } else { 0.0 };
                        }
                    }
                },
            );
        });
    }

    /// The weights of the edges below and above faces of component `c` along `d`.
    #[inline(always)]
    fn across(&self, c: usize, d: usize, at: usize, len: usize) -> Across<'_> {
        let axis = 3 - c - d;
        let is_next = usize::from(from_axis(axis)[1] != c);
        let along = match &self.cut {
            Some(weights) => &weights.along[axis][is_next],
            None => &self.edge[axis],
        };
        let high = at + self.layout.strides()[d];
        Across {
            along: (cut(along, at, len), cut(along, high, len)),
            both: (cut(&self.edge[axis], at, len), cut(&self.edge[axis], high, len)),
        }
    }

    #[inline(always)]
    fn rows(&self, c: usize, at: usize, len: usize) -> Rows<'_> {
        let strides = self.layout.strides();
        let cell = self.cut.as_ref().map_or(&self.cell, |weights| &weights.cell[c]);
        let [_, next, after] = from_axis(c);
        Rows {
            cell: (cut(cell, at - strides[c], len), cut(cell, at, len)),
            across: [self.across(c, next, at, len), self.across(c, after, at, len)],
            drag: self.cut.as_ref().map(|weights| cut(&weights.drag[c], at, len)),
        }
    }
}

/// The weights of a run of faces.
struct Rows<'a> {
    /// Of the cells before and behind.
    cell: (&'a [f32], &'a [f32]),
    /// Of the edges on both other axes.
    across: [Across<'a>; 2],
    drag: Option<&'a [f32]>,
}

/// The weights of the edges below and above.
struct Across<'a> {
    along: (&'a [f32], &'a [f32]),
    both: (&'a [f32], &'a [f32]),
}

impl Across<'_> {
    /// What one component loses across both edges, of which it is at `ends`, the other `v` on both
    /// sides of each.
    #[inline(always)]
    fn shear(&self, i: usize, here: f32, ends: (&[f32], &[f32]), v: &[&[f32]; 4]) -> f32 {
        let below = self.along.0[i] * (here - ends.0[i]) + self.both.0[i] * (v[0][i] - v[1][i]);
        let above = self.along.1[i] * (ends.1[i] - here) + self.both.1[i] * (v[2][i] - v[3][i]);
        below - above
    }
}

impl Rows<'_> {
    #[inline(always)]
    fn diagonal(&self, i: usize) -> f32 {
        let [a, b] = &self.across;
        let edges = (a.along.0[i] + a.along.1[i]) + (b.along.0[i] + b.along.1[i]);
        self.cell.0[i] + self.cell.1[i] + edges + self.drag.map_or(0.0, |drag| drag[i])
    }

    #[inline(always)]
    fn magnitudes(&self, i: usize) -> f32 {
        let [a, b] = &self.across;
        let both = (a.both.0[i] + a.both.1[i]) + (b.both.0[i] + b.both.1[i]);
        2.0 * (self.diagonal(i) + both)
    }

    /// Calls `visit(i, V u)` for the faces of component `C`.
    #[inline(always)]
    fn friction<const C: usize>(
        &self,
        layout: &Layout,
        u: [&[f32]; 3],
        at: usize,
        len: usize,
        visit: impl FnMut(usize, f32),
    ) {
        match self.drag {
            Some(drag) => self.friction_of::<C, true>(layout, u, at, len, drag, visit),
            None => self.friction_of::<C, false>(layout, u, at, len, self.cell.0, visit),
        }
    }

    #[inline(always)]
    fn friction_of<const C: usize, const CUT: bool>(
        &self,
        layout: &Layout,
        u: [&[f32]; 3],
        at: usize,
        len: usize,
        drag: &[f32],
        mut visit: impl FnMut(usize, f32),
    ) {
        let own = Star::new(layout, u[C], at, len);
        let [_, d, e] = from_axis(C);
        let ends = [own.x, own.y, own.z];
        let (d_ends, e_ends, c_ends) = (ends[d], ends[e], ends[C]);
        let (d_other, e_other) =
            (both_sides(layout, C, d, u[d], at, len), both_sides(layout, C, e, u[e], at, len));
        let [d_weights, e_weights] = &self.across;
        for (i, here) in own.here.iter().copied().enumerate() {
            let normal =
                self.cell.0[i] * (here - c_ends.0[i]) - self.cell.1[i] * (c_ends.1[i] - here);
            let mut sum = normal
                + d_weights.shear(i, here, d_ends, &d_other)
                + e_weights.shear(i, here, e_ends, &e_other);
            if CUT {
                sum += drag[i] * here;
            }
            visit(i, sum);
        }
    }
}

/// Component `d` of a velocity, before and behind the edges below and above faces of component `c`.
#[inline(always)]
fn both_sides<'a>(
    layout: &Layout,
    c: usize,
    d: usize,
    v: &'a [f32],
    at: usize,
    len: usize,
) -> [&'a [f32]; 4] {
    let (high, back) = (at + layout.strides()[d], layout.strides()[c]);
    [cut(v, at, len), cut(v, at - back, len), cut(v, high, len), cut(v, high - back, len)]
}

#[cfg(test)]
mod tests;
