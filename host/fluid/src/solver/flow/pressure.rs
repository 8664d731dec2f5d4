//! Projection: the pressure that leaves no divergence.
//!
//! ```text
//! A psi = -delta,   u_face -= psi_i - psi_(i-1),   pressure += psi / dt
//! ```
//! delta is the sum of what flows out of a cell's faces; A is the seven-point operator on open
//! faces. In a box it is inverted directly. In a vessel both weigh a face by the part of it that
//! walls leave open (Ng, Min, Gibou 2009; Batty, Bertails, Bridson 2007), and conjugate gradients
//! use the box's direct solver (see [`super::krylov`]).

mod plane;

use self::plane::Levels;
use crate::{
    pool::Pool,
    solver::flow::{
        density::Density,
        engine::Engine,
        faces::Faces,
        field::{FaceRuns, Field, Layout, Run, Vector, components, cut, cut_mut},
        ghosts::{Fill, Ghosts},
        krylov::Operator,
        openings::survey_sides,
        poisson::{Poisson, Room, Source},
        survey::{Survey, survey_plane},
    },
};

/// Below this a velocity component is 0: at rest means at rest.
pub const REST_M_S: f32 = 1e-6;

/// The pressure of the next step, per density and spacing, extrapolated from the last two.
pub struct Prediction {
    /// The pressure that is expected.
    pub next: Field,
    /// How much it grew from step to step.
    pub trend: Field,
    /// Share of the trend that is extrapolated.
    pub share: f32,
}

/// What a projection found.
pub struct Projected {
    /// Iterations that it took: 0 where the solution is direct.
    pub iterations: u32,
    /// The velocity that it left, if that was asked for.
    pub survey: Survey,
}

/// What a projection is to tell of the velocity that it leaves.
#[derive(Clone, Copy)]
pub enum Telling<'a> {
    /// Nothing: its survey is empty.
    Nothing,
    /// All, with the power of this acceleration.
    All(Option<[&'a [f32]; 3]>),
}

/// Solves for the pressure on one grid.
pub struct Projection {
    layout: Layout,
    poisson: Poisson,
    /// Solution of the last solve; ghosts are of use at open and periodic sides only.
    psi: Field,
    /// Residual, preconditioned residual, search direction, and A times it; `None` as long as the
    /// direct solver is all it takes.
    krylov: Option<[Field; 4]>,
}

impl Projection {
    /// For the liquid that `faces` describe, between the sides of `ghosts`.
    pub fn new(layout: &Layout, faces: &Faces, ghosts: &Ghosts, pool: &Pool) -> Self {
        let poisson = Poisson::new(layout, ghosts.pressure_ends(), pool.threads());
        let zeros = || layout.zeros();
        let mut projection = Self { layout: *layout, poisson, psi: zeros(), krylov: None };
        if !faces.is_box {
            projection.make_room();
        }
        projection
    }

    /// Work space of the direct solver, free between two projections.
    pub fn room(&mut self) -> &mut Room {
        self.poisson.room()
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        let krylov = self.krylov.iter().flatten().map(Field::bytes).sum::<usize>();
        self.poisson.bytes() + self.psi.bytes() + krylov
    }

    /// True if no iterations are needed, but for densities that differ much.
    pub fn is_direct(&self) -> bool {
        self.krylov.is_none()
    }

    /// Makes room for what the direct solver alone cannot solve.
    pub fn make_room(&mut self) {
        let zeros = || self.layout.zeros();
        self.krylov.get_or_insert_with(|| [zeros(), zeros(), zeros(), zeros()]);
    }

    /// Takes the divergence out of `velocity`, whose ghosts are filled before and after. What it
    /// finds is there afterwards if it `is_kept`.
    pub fn project(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        velocity: &mut Vector,
        telling: Telling<'_>,
        density: Option<&Density>,
        is_kept: bool,
    ) -> Projected {
        let operator = Operator::new(on.faces, density);
        if !is_kept && operator.is_none() && ghosts.are_walls() {
            return self.project_in_passing(on, ghosts, velocity, telling);
        }
        let Self { layout, poisson, psi, krylov } = self;
        let iterations = match operator.zip(krylov.as_mut()) {
            Some((operator, krylov)) => {
                let squares = set_residual(on, layout, components(velocity), &mut krylov[0]);
                on.iterate((layout, ghosts), poisson, operator, psi, krylov, squares)
            }
            None => {
                let inflow = Inflow { on, layout, velocity: components(velocity) };
                poisson.solve(on.pool, on.simd, inflow, psi);
                0
            }
        };
        ghosts.fill_pressure(psi);
        let survey = self.correct(on, ghosts, velocity, telling, density);
        Projected { iterations, survey }
    }

    /// Where walls alone bound a box, each plane is corrected by what has just been transformed
    /// back, which is stored nowhere.
    fn project_in_passing(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        velocity: &mut Vector,
        telling: Telling<'_>,
    ) -> Projected {
        let Self { layout, poisson, .. } = self;
        let inflow = Inflow { on, layout, velocity: components(velocity) };
        poisson.find_modes(on.pool, on.simd, inflow);
        let outs = velocity.each_mut().map(|field| layout.planes(field));
        let body = |k: usize, [below, here]: [&[f32]; 2], [x, y, z]: [&mut [f32]; 3]| {
            let Some(run) = on.live_run(layout, k) else { return [0.0; 4] };
            let psi = Levels::in_planes(layout, [below, here], run);
            let part = on.correct_plane(layout, run, k, psi, [&mut *x, &mut *y, &mut *z], telling);
            ghosts.close_plane(k, [x, y, z]);
            part
        };
        let parts = poisson.pass_by(on.pool, on.simd, outs, body, Survey::combine);
        for (c, field) in velocity.iter_mut().enumerate() {
            ghosts.fill_ends(c, field, Fill::Projected);
        }
        Projected { iterations: 0, survey: Survey::from_parts(parts) }
    }

    /// What the last projection found, times the step: the pressure per density and spacing.
    pub fn found(&self) -> &[f32] {
        &self.psi
    }

    /// Subtracts the gradient of psi, snaps what is nearly at rest, and tells of the outcome.
    fn correct(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        velocity: &mut Vector,
        telling: Telling<'_>,
        density: Option<&Density>,
    ) -> Survey {
        let (layout, psi) = (self.layout, &*self.psi);
        let lightness = density.map_or(&on.faces.open, |density| &density.lightness);
        let mass = masses(on.faces, density);
        let [_, ny, nz] = layout.cells;
        let beyond = usize::from(ghosts.is_free(1, 1));
        let outs = velocity.each_mut().map(|field| layout.planes(field));
        let body = |k: usize, [x, y, z]: [&mut [f32]; 3]| {
            let rows = on.faces.live_rows[k].clone();
            if rows.is_empty() {
                return [0.0; 4];
            }
            let rows = if rows.end == ny { rows.start..ny + beyond } else { rows };
            let run = layout.run(rows, k);
            let psi = Levels::new(&layout, psi, run);
            if on.faces.is_box && density.is_none() {
                let out = [&mut *x, &mut *y, &mut *z];
                let part = on.correct_plane(&layout, run, k, psi, out, telling);
                ghosts.close_plane(k, [x, y, z]);
                return part;
            }
            on.simd.vectorize(
                #[inline(always)]
                || {
                    let all = [&mut *x, &mut *y, &mut *z].into_iter().zip(psi.before);
                    for (c, (u, below)) in all.enumerate() {
                        let u = cut_mut(u, run.to, run.len);
                        let lightness = cut(&lightness[c], run.at, run.len);
                        correct_open(u, lightness, psi.here, below);
                    }
                },
            );
            ghosts.close_plane(k, [&mut *x, &mut *y, &mut *z]);
            let Telling::All(force) = telling else { return [0.0; 4] };
            let force = force.map(|force| force.map(|f| &f[(k + 1) * layout.plane..]));
            survey_plane(on, &layout, [x, y, z], force, mass, k)
        };
        let parts = on.pool.fold(None, outs, [layout.plane; 3], body, Survey::combine);
        if ghosts.is_free(2, 1) {
            let last = cut(psi, nz * layout.plane, layout.plane);
            let top = cut_mut(&mut velocity[2], (nz + 1) * layout.plane, layout.plane);
            match density {
                None => top.iter_mut().zip(last).for_each(|(w, psi)| *w = rested(*w + psi)),
                Some(density) => {
                    let lightness =
                        cut(&density.lightness[2], (nz + 1) * layout.plane, layout.plane);
                    let pairs = last.iter().zip(lightness);
                    let next = |w: f32, (psi, light): (&f32, &f32)| rested(w + light * psi);
                    top.iter_mut().zip(pairs).for_each(|(w, pair)| *w = next(*w, pair));
                }
            }
        }
        for (c, field) in velocity.iter_mut().enumerate() {
            ghosts.fill_ends(c, field, Fill::Projected);
        }
        if let Telling::All(force) = telling {
            let on_sides = survey_sides(&layout, on.faces, components(velocity), force, mass);
            return Survey::from_parts(Survey::combine(parts, on_sides));
        }
        Survey::from_parts(parts)
    }

    /// Adds what the last projection took, times `rate_per_s` = 1/dt, to the prediction of the
    /// pressure: that is what it was mispredicted by.
    pub fn learn(&self, on: Engine<'_>, ghosts: &Ghosts, p: &mut Prediction, rate_per_s: f32) {
        let (layout, psi, share) = (self.layout, &*self.psi, p.share);
        let outs = [layout.planes(&mut p.next), layout.planes(&mut p.trend)];
        on.pool.planes(outs, [layout.plane; 2], |k, [next, trend]| {
            on.run(
                &layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    let (next, trend) = (cut_mut(next, to, len), cut_mut(trend, to, len));
                    predict(next, trend, rate_per_s, share, cut(psi, at, len));
                },
            );
        });
        ghosts.wrap_cells(&mut p.next);
    }
}

/// The mass of faces, per density and cell volume; `None` where all are whole and alike.
pub fn masses<'a>(faces: &'a Faces, density: Option<&'a Density>) -> Option<&'a Vector> {
    let area = || faces.vessel.as_ref().map(|vessel| &vessel.area);
    density.map(|density| &density.mass).or_else(area)
}

/// -delta in a box.
struct Inflow<'a> {
    on: Engine<'a>,
    layout: &'a Layout,
    velocity: [&'a [f32]; 3],
}

impl Source for Inflow<'_> {
    #[inline(always)]
    fn plane<'a>(&'a self, k: usize, room: &'a mut [f32]) -> &'a [f32] {
        let Self { on, layout, velocity } = self;
        if let Some(Run { at, to, len }) = on.live_run(layout, k) {
            let (out, faces) = (cut_mut(room, to, len), FaceRuns::new(layout, *velocity, at, len));
            #[allow(clippy::needless_range_loop, reason = "iterators leave a rest one by one")]
            for i in 0..len {
                out[i] = -faces.outflow(i);
            }
        }
        room
    }
}

/// residual = -delta; returns its squared norm and that of the velocity.
fn set_residual(
    on: Engine<'_>,
    layout: &Layout,
    velocity: [&[f32]; 3],
    residual: &mut Field,
) -> [f64; 2] {
    let body = |k, [out]: [&mut [f32]; 1]| {
        on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, sums| {
                let out = cut_mut(out, to, len);
                let faces = FaceRuns::new(layout, velocity, at, len);
                if let Some(vessel) = &on.faces.vessel {
                    let area = FaceRuns::new(layout, components(&vessel.area), at, len);
                    let liquid = cut(&on.faces.liquid, at, len);
                    for i in 0..out.len() {
                        out[i] = -liquid[i] * faces.outflow_through(&area, i);
                    }
                    if let Some(solids) = &vessel.solids {
                        let swell = cut(&solids.swell, at, len);
                        (0..out.len()).for_each(|i| out[i] -= liquid[i] * swell[i]);
                    }
                } else {
                    let liquid = cut(&on.faces.liquid, at, len);
                    for i in 0..out.len() {
                        out[i] = -liquid[i] * faces.outflow(i);
                    }
                }
                sums[0].add_product(out, out);
                faces.add_squares(&mut sums[1]);
            },
        )
    };
    let outs = [layout.planes(residual)];
    let combine = |a: [f64; 4], b: [f64; 4]| [a[0] + b[0], a[1] + b[1], 0.0, 0.0];
    let [square, speed_square, ..] = on.pool.fold(None, outs, [layout.plane], body, combine);
    [square, speed_square]
}

/// At rest means at rest.
#[inline(always)]
fn rested(u: f32) -> f32 {
    if u.abs() < REST_M_S { 0.0 } else { u }
}

#[inline(always)]
fn correct_open(u: &mut [f32], lightness: &[f32], above: &[f32], below: &[f32]) {
    for i in 0..u.len() {
        u[i] = rested(u[i] - lightness[i] * (above[i] - below[i]));
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
