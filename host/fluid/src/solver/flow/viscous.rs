//! Implicit viscosity, for liquid too thick for explicit steps.
//!
//! ```text
//! (m + s D) change = m rhs,   s = theta nu dt / h^2,   D u = 6 u - sum over neighbours
//! ```
//! with m = 1 and this D wherever no wall is near (else see [`super::walls`]).
//! The right side is a whole step's change as the old velocity would have it: what is at rest
//! or steady stays so, whatever the step. theta is 1/2 (Crank, Nicolson 1947) while that damps
//! the finest ripples well, and goes to 1 (backward Euler) beyond: see [`implicit_share`].
//!
//! In a box each component is solved for directly, by the transforms of [`super::poisson`]. The
//! matrix is symmetric and positive definite for any walls, so elsewhere conjugate gradients
//! (Hestenes, Stiefel 1952) solve it, for the three components at once.

use crate::solver::flow::{
    engine::Engine,
    faces::{Faces, VesselFaces},
    field::{FaceRuns, Lanes, Layout, Run, Star, Vector, components, cut, cut_mut, vector_bytes},
    ghosts::{Fill, Ghosts},
    openings::{apply_on_sides, visit_above, visit_unreached, weigh_above},
    poisson::{Modal, Room},
};

/// The residual falls to this part of the right side, which is a change ...
const TOLERANCE: f64 = 1e-4;

/// ... or to this part of the velocity, where f32 can tell no more.
const SPEED_TOLERANCE: f64 = 1e-8;

/// Iterations at most; a grid of 64 cells needs some 150 in the limit of infinite viscosity.
const MAX_ITERATIONS: u32 = 200;

/// The share theta of a step's viscosity that acts on its end, for a = nu dt / h^2: the old
/// velocity is never weighed by more than 1/3 against the sum of its neighbours.
pub fn implicit_share(a: f64) -> f64 {
    (1.0 - 4.0 / (12.0 * a)).max(0.5)
}

/// Solves for the change of velocity on one grid.
pub struct Viscous {
    layout: Layout,
    method: Method,
}

enum Method {
    /// One system for each component that has room to change.
    Direct(Vec<(usize, Modal)>),
    /// Search direction, and the matrix times it.
    Gradients(Box<[Vector; 2]>),
}

impl Viscous {
    /// For the liquid that `faces` describe, between the sides of `ghosts`; it is to be solved for
    /// in `room`.
    pub fn new(layout: &Layout, faces: &Faces, ghosts: &Ghosts, room: &mut Room) -> Self {
        let vector = || [layout.zeros(), layout.zeros(), layout.zeros()];
        let method = if !faces.is_box || ghosts.is_any_free() {
            Method::Gradients(Box::new([vector(), vector()]))
        } else {
            let component = |c| {
                let (unknowns, ends) = ghosts.unknown_changes(c)?;
                let modal = Modal::new(layout, unknowns, ends);
                room.make_for(&modal);
                Some((c, modal))
            };
            Method::Direct((0..3).filter_map(component).collect())
        };
        Self { layout: *layout, method }
    }

    /// True if no iterations are needed.
    pub fn is_direct(&self) -> bool {
        matches!(self.method, Method::Direct(_))
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        match &self.method {
            Method::Direct(modals) => modals.iter().map(|(_, modal)| modal.bytes()).sum(),
            Method::Gradients(krylov) => krylov.iter().map(vector_bytes).sum(),
        }
    }

    /// rhs = -a D u, the change that viscosity alone would make of `velocity`, a = nu dt / h^2.
    pub fn set_rhs(&self, on: Engine<'_>, velocity: &Vector, rhs: &mut Vector, a: f32) {
        apply(on, &self.layout, components(velocity), rhs, [0.0, -a]);
        if let Some(vessel) = &on.faces.vessel {
            vessel.walls.weigh(rhs, true);
            weigh_above(&self.layout, on.faces, rhs, true);
            if let Some(solids) = &vessel.solids {
                solids.pull(rhs, a);
            }
        }
    }

    /// Adds the solution of (m + s D) change = m rhs to `velocity`, and fills its ghosts; `rhs` is
    /// used up. Returns the number of iterations: 0 where the solution is direct.
    pub fn solve(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        room: &mut Room,
        s: f32,
        rhs: &mut Vector,
        velocity: &mut Vector,
    ) -> u32 {
        let layout = &self.layout;
        let iterations = match &mut self.method {
            Method::Gradients(krylov) => iterate(on, layout, ghosts, s, krylov, rhs, velocity),
            Method::Direct(modals) => {
                // As (1/s + D) (s change) = rhs.
                for (c, modal) in modals.iter_mut().filter(|_| s > 0.0) {
                    modal.set_shift(1.0 / f64::from(s));
                    modal.solve_in_place(on.pool, on.simd, room, &mut rhs[*c]);
                }
                let per_s = if s > 0.0 { 1.0 / s } else { 1.0 };
                combine(on, layout, 1.0, velocity, per_s, components(rhs));
                0
            }
        };
        ghosts.fill(velocity, Fill::Unprojected);
        iterations
    }
}

/// Conjugate gradients, as [`Viscous::solve`].
fn iterate(
    on: Engine<'_>,
    layout: &Layout,
    ghosts: &Ghosts,
    s: f32,
    [direction, product]: &mut [Vector; 2],
    residual: &mut Vector,
    velocity: &mut Vector,
) -> u32 {
    if let Some(vessel) = &on.faces.vessel {
        vessel.walls.weigh(residual, false);
        weigh_above(layout, on.faces, residual, false);
    }
    let mut square = norm(on, layout, components(residual));
    let speed_square = norm(on, layout, components(velocity));
    let small =
        (square * TOLERANCE * TOLERANCE).max(speed_square * SPEED_TOLERANCE * SPEED_TOLERANCE);
    for c in 0..3 {
        direction[c].copy_from_slice(&residual[c]);
    }
    let mut iterations = 0;
    while square > small && iterations < MAX_ITERATIONS {
        ghosts.fill(direction, Fill::Difference);
        let curvature = apply(on, layout, components(direction), product, [1.0, s]);
        if curvature <= 0.0 || !curvature.is_finite() {
            break;
        }
        let alpha = (square / curvature) as f32;
        combine(on, layout, 1.0, velocity, alpha, components(direction));
        combine(on, layout, 1.0, residual, -alpha, components(product));
        let square_next = norm(on, layout, components(residual));
        let beta = (square_next / square) as f32;
        combine(on, layout, beta, direction, 1.0, components(residual));
        square = square_next;
        iterations += 1;
    }
    iterations
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
    let within = on.pool.planes_sum(outs, [layout.plane; 3], |k, [x, y, z]| {
        let sum = on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, [sum, _]| {
                apply_row::<0>(on, layout, u[0], at, cut_mut(x, to, len), shares, sum);
                apply_row::<1>(on, layout, u[1], at, cut_mut(y, to, len), shares, sum);
                apply_row::<2>(on, layout, u[2], at, cut_mut(z, to, len), shares, sum);
            },
        )[0];
        let beside_walls = |vessel: &VesselFaces| {
            let out = [x, y, z];
            vessel.walls.apply(layout, u, k, shares, out)
        };
        sum + on.faces.vessel.as_ref().map_or(0.0, beside_walls)
    });
    within + apply_on_sides(layout, on.faces, u, out, shares)
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
    for i in 0..out.len() {
        let here = u.here[i];
        out[i] = open[i] * (own * here + share * (6.0 * here - u.around(i)));
    }
    sum.add_product(u.here, out);
}

fn norm(on: Engine<'_>, layout: &Layout, u: [&[f32]; 3]) -> f64 {
    let mut on_sides = 0.0;
    visit_above(layout, on.faces, |c, at, _| on_sides += f64::from(u[c][at]).powi(2));
    let within = on.pool.sum(layout.cells[2], |k| {
        on.rows(
            layout,
            k,
            #[inline(always)]
            |Run { at, len, .. }, [sum, _]| FaceRuns::new(layout, u, at, len).add_squares(sum),
        )[0]
    });
    within + on_sides
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
    visit_unreached(layout, on.faces, |c, at| {
        out[c][at] = share * out[c][at] + alpha * u[c][at];
    });
}

#[inline(always)]
fn combine_row(share: f32, out: &mut [f32], alpha: f32, u: &[f32]) {
    for (out, u) in out.iter_mut().zip(u) {
        *out = share * *out + alpha * u;
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{
        grid::Grid,
        pool::Pool,
        simd::SimdClass,
        solver::{Side, Sides, Walls, flow::faces::cells},
        vessel::Vessel,
    };

    /// What is left of (1 + s D) change = rhs by the direct solution, as the kernel has D.
    #[test]
    fn the_direct_solution_leaves_rounding_for_all_sides() {
        let lid = Side::Moving(Vec3::new(1.0, 0.0, 2.0));
        let all = [
            Sides::all(Side::FreeSlip),
            Sides::all(Side::NoSlip),
            Sides::of_vessel(Walls::NoSlip),
            Sides::all(Side::NoSlip).with(1, [Side::FreeSlip, lid]).with(2, [Side::Periodic; 2]),
            Sides::all(Side::Periodic).with(0, [Side::Inflow(Vec3::X); 2]),
        ];
        let (pool, simd) = (Pool::new(2, false), SimdClass::detect());
        for (sides, size) in all.iter().flat_map(|s| [[9, 8, 7], [1, 6, 5]].map(|n| (s, n))) {
            let (grid, layout) = (Grid { cells: size, ..Grid::unit_cube(9) }, Layout::new(size));
            let faces = Faces::new(&layout, &grid, &Vessel::Box, sides, Walls::FreeSlip);
            let (ghosts, vector) = (Ghosts::new(&layout, sides), || [0; 3].map(|_| layout.zeros()));
            let on = Engine { pool: &pool, simd, faces: &faces };
            let mut room = Room::new(pool.threads());
            let mut viscous = Viscous::new(&layout, &faces, &ghosts, &mut room);
            for s in [1e-3f32, 2.0, 1e4] {
                let (mut rhs, mut change, mut back) = (vector(), vector(), vector());
                for (c, (i, j, k)) in (0..3).flat_map(|c| cells(size).map(move |cell| (c, cell))) {
                    let at = layout.index(i, j, k);
                    let wave = ((3 * i + 5 * j + 7 * k + c) as f32).sin();
                    rhs[c][at] = faces.open[c][at] * wave;
                }
                ghosts.fill(&mut rhs, Fill::Difference);
                let asked = rhs.each_ref().map(|field| field.to_vec());
                assert_eq!(viscous.solve(on, &ghosts, &mut room, s, &mut rhs, &mut change), 0);
                ghosts.fill(&mut change, Fill::Difference);
                apply(on, &layout, components(&change), &mut back, [1.0, s]);
                for (c, (i, j, k)) in (0..3).flat_map(|c| cells(size).map(move |cell| (c, cell))) {
                    let at = layout.index(i, j, k);
                    let miss = back[c][at] - faces.open[c][at] * asked[c][at];
                    assert!(miss.abs() < 2e-5, "{sides:?} {size:?} {s} {c} {miss}");
                }
            }
        }
    }
}
