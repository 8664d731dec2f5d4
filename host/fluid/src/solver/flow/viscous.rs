//! Implicit viscosity, for liquid too thick for explicit steps.
//!
//! ```text
//! (1 + theta a D) u' = (1 - (1 - theta) a D) u,   a = nu dt / h^2,
//! D u = weight u - sum over neighbours,   theta = max(1/2, 1 - 4 / (12 a))
//! ```
//! Crank-Nicolson while that damps the finest ripples well, towards backward Euler beyond: the
//! right side never weighs D by more than 1/3. The matrix is symmetric and positive definite
//! for any walls, so conjugate gradients (Hestenes, Stiefel 1952) solve it, for the three
//! components at once.

use crate::solver::flow::{
    engine::Engine,
    field::{FaceRuns, Lanes, Layout, Run, Star, Vector, components, cut, cut_mut},
    ghosts::{Fill, Ghosts},
};

/// The residual falls to this part of the right side.
const TOLERANCE: f64 = 1e-5;

/// Iterations at most; a grid of 64 cells needs some 150 in the limit of infinite viscosity.
const MAX_ITERATIONS: u32 = 200;

/// Work space: residual, direction, and the matrix times it.
pub struct Work<'a> {
    /// Right side, then residual.
    pub residual: &'a mut Vector,
    /// Search direction.
    pub direction: &'a mut Vector,
    /// Matrix times direction.
    pub product: &'a mut Vector,
}

/// Replaces `velocity` by its solution for `a` = nu dt / h^2. Returns the iterations taken.
pub fn solve(
    on: Engine<'_>,
    layout: &Layout,
    ghosts: &Ghosts,
    velocity: &mut Vector,
    work: Work<'_>,
    a: f32,
) -> u32 {
    let theta = (1.0 - 4.0 / (12.0 * a)).max(0.5);
    let Work { residual, direction, product } = work;
    // From the velocity itself, so that its ghosts say what the sides do and all that is added
    // are differences: A u' = (1 - (1 - theta) a D) u, residual = that - A u = -a D u.
    apply(on, layout, components(velocity), residual, [0.0, -a]);
    for c in 0..3 {
        direction[c].copy_from_slice(&residual[c]);
    }
    ghosts.fill(direction, Fill::Difference);
    let mut square = norm(on, layout, components(residual));
    let small = norm(on, layout, components(velocity)).max(square) * TOLERANCE * TOLERANCE;
    for iteration in 0..MAX_ITERATIONS {
        if square <= small {
            ghosts.fill(velocity, Fill::Unprojected);
            return iteration;
        }
        let curvature = apply(on, layout, components(direction), product, [1.0, theta * a]);
        if curvature <= 0.0 || !curvature.is_finite() {
            ghosts.fill(velocity, Fill::Unprojected);
            return iteration;
        }
        let alpha = (square / curvature) as f32;
        combine(on, layout, 1.0, velocity, alpha, components(direction));
        combine(on, layout, 1.0, residual, -alpha, components(product));
        let square_next = norm(on, layout, components(residual));
        let beta = (square_next / square) as f32;
        combine(on, layout, beta, direction, 1.0, components(residual));
        ghosts.fill(direction, Fill::Difference);
        square = square_next;
    }
    MAX_ITERATIONS
}

/// out = own u + share D u; returns u . out.
fn apply(
    on: Engine<'_>,
    layout: &Layout,
    u: [&[f32]; 3],
    out: &mut Vector,
    shares: [f32; 2],
) -> f64 {
    let outs = out.each_mut().map(|out| layout.planes(out));
    on.pool.planes_sum(outs, [layout.plane; 3], |k, [x, y, z]| {
        on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, [sum, _]| {
                apply_row::<0>(on, layout, u[0], at, cut_mut(x, to, len), shares, sum);
                apply_row::<1>(on, layout, u[1], at, cut_mut(y, to, len), shares, sum);
                apply_row::<2>(on, layout, u[2], at, cut_mut(z, to, len), shares, sum);
            },
        )[0]
    })
}

#[inline(always)]
fn apply_row<const C: usize>(
    on: Engine<'_>,
    layout: &Layout,
    u: &[f32],
    at: usize,
    out: &mut [f32],
    [own, share]: [f32; 2],
    sum: &mut Lanes,
) {
    let u = Star::new(layout, u, at, out.len());
    let open = cut(&on.faces.open[C], at, out.len());
    let weight = cut(&on.faces.weight[C], at, out.len());
    for i in 0..out.len() {
        let here = u.here[i];
        out[i] = open[i] * (own * here + share * (weight[i] * here - u.around(i)));
    }
    sum.add_product(u.here, out);
}

fn norm(on: Engine<'_>, layout: &Layout, u: [&[f32]; 3]) -> f64 {
    on.pool.sum(layout.cells[2], |k| {
        on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, len, .. }, [sum, _]| FaceRuns::new(layout, u, at, len).add_squares(sum),
        )[0]
    })
}

/// out = share out + alpha u.
fn combine(
    on: Engine<'_>,
    layout: &Layout,
    share: f32,
    out: &mut Vector,
    alpha: f32,
    u: [&[f32]; 3],
) {
    let outs = out.each_mut().map(|out| layout.planes(out));
    on.pool.planes(outs, [layout.plane; 3], |k, [x, y, z]| {
        on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, _| {
                combine_row(share, cut_mut(x, to, len), alpha, cut(u[0], at, len));
                combine_row(share, cut_mut(y, to, len), alpha, cut(u[1], at, len));
                combine_row(share, cut_mut(z, to, len), alpha, cut(u[2], at, len));
            },
        );
    });
}

#[inline(always)]
fn combine_row(share: f32, out: &mut [f32], alpha: f32, u: &[f32]) {
    out.iter_mut().zip(u).for_each(|(out, u)| *out = share * *out + alpha * u);
}
