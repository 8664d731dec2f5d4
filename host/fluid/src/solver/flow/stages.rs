//! The schemes that a part of a step is computed with.

use std::mem;

use crate::solver::flow::{
    Flow,
    engine::Engine,
    field::{Vector, components},
    ghosts::Fill,
    mixture::{Accelerating, Pull, accelerating, unlike_in, working},
    momentum::{Multistep, MultistepRun, RungeKutta, RungeKuttaRun, Semi, SemiRun, Stage, Terms},
    openings::Beside,
    pressure::Prediction,
    reaction::{Solved, Viscosity},
    step::Part,
    viscous::{Viscous, implicit_share},
    walls::{Weights, correct, hold},
};

/// Ratios of the lengths of two parts between which the pressure of one predicts the other's.
const PREDICTABLE: std::ops::RangeInclusive<f64> = 0.3..=3.0;

/// Third-order strong-stability-preserving Runge-Kutta (Shu, Osher 1988): share of the start,
/// share of the advanced stage, and when in the step the force of the stage is taken.
const STAGES: [(f32, f32, f64); 3] =
    [(0.0, 1.0, 0.0), (3.0 / 4.0, 1.0 / 4.0, 1.0), (1.0 / 3.0, 2.0 / 3.0, 0.5)];

/// What each stage adds to the change of a whole step.
const STAGE_WEIGHTS: [f32; 3] = [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0];

/// What the rates of the last part are good for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct History {
    /// Length of the part that left them.
    dt_s: f64,
    /// True if viscosity is among them.
    is_viscous: bool,
}

impl Flow {
    /// The pressure of the last part predicts that of this one, unless it was that of a much
    /// shorter or longer one: a push counts there as an acceleration over the part's length.
    fn has_prediction(&mut self, part: Part) -> bool {
        let ratio = part.dt_s / mem::replace(&mut self.pressure_dt_s, part.dt_s);
        PREDICTABLE.contains(&ratio)
    }

    /// Without a prediction the part is rehearsed, and what it found of the pressure is kept.
    pub(super) fn prepare_pressure(&mut self, part: Part) {
        self.history = None;
        if self.has_prediction(part) {
            return;
        }
        self.forget_pressure();
        let obstacles = self.obstacles.take();
        self.run_stages(part);
        self.obstacles = obstacles;
        self.clear_divergence(true);
        self.learn_pressure(part);
        mem::swap(&mut self.velocity, &mut self.stage[0]);
        let Prediction { next, trend, share } = &mut self.pressure;
        next.iter_mut().zip(trend.iter()).for_each(|(p, t)| *p -= *share * t);
        self.pressure.trend.fill(0.0);
    }

    pub(super) fn forget_pressure(&mut self) {
        self.pressure.next.fill(0.0);
        self.pressure.trend.fill(0.0);
    }

    pub(super) fn learn_pressure(&mut self, part: Part) {
        let Self { faces, ghosts, pressure, pool, simd, projection, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        projection.learn(on, ghosts, pressure, (1.0 / part.dt_s) as f32);
    }

    /// The terms of a stage at `share` of the part.
    fn terms(&self, part: Part, share: f64, with_viscosity: bool) -> Terms {
        let spacing_m = f64::from(self.grid.spacing_m);
        let is_uniform = self.thick_per_s().is_none();
        let viscosity_m2_s = if with_viscosity && is_uniform { self.viscosity_m2_s } else { 0.0 };
        Terms {
            advection_per_m: (-1.0 / (4.0 * spacing_m)) as f32,
            viscous_per_s: (viscosity_m2_s / (spacing_m * spacing_m)) as f32,
            // The drive of a mixture has the scale in it.
            force: if self.mixture.is_some() { 1.0 } else { part.scale_at(share) as f32 },
        }
    }

    /// Second-order Adams-Bashforth weights for a part that may differ from the last: a first
    /// one has no history and is Euler's.
    fn multistep(&mut self, part: Part, is_viscous: bool) -> Multistep {
        let history = self.history.replace(History { dt_s: part.dt_s, is_viscous });
        let last = history.filter(|history| history.is_viscous == is_viscous);
        let ratio = last.map_or(0.0, |last| (part.dt_s / last.dt_s).min(4.0));
        Multistep {
            new_s: (part.dt_s * (1.0 + 0.5 * ratio)) as f32,
            old_s: (-0.5 * part.dt_s * ratio) as f32,
        }
    }

    /// One multistep part, explicit throughout.
    pub(super) fn extrapolate(&mut self, part: Part) {
        self.pressure_dt_s = 0.0;
        let advance = self.multistep(part, true);
        let terms = self.terms(part, advance.force_at(), true);
        let scale = part.scale_at(advance.force_at());
        let Self { layout, faces, ghosts, openings, velocity, stage: [out, history], .. } = self;
        let (pool, simd) = (&self.pool, &self.simd);
        let on = Engine { pool, simd: *simd, faces };
        let pull = Pull { slowed: Some(components(velocity)), ..Pull::of(scale) };
        let Accelerating { force, unlike, .. } =
            accelerating(on, layout, &self.force, &mut self.mixture, pull);
        let stage = Stage { layout: *layout, velocity: components(velocity), force, terms };
        if let Some(obstacles) = &mut self.obstacles {
            obstacles.measure(faces, stage, 1.0, Viscosity::Explicit, unlike);
            obstacles.count(advance.new_s.into(), advance.old_s.into());
        }
        let [x, y, z] = out.each_mut().map(|field| layout.planes(field));
        let [gx, gy, gz] = history.each_mut().map(|field| layout.planes(field));
        on.pool.planes([x, y, z, gx, gy, gz], [layout.plane; 6], |k, [x, y, z, gx, gy, gz]| {
            let Some(run) = on.live_run(layout, k) else { return };
            let (history, out) = ([&mut *gx, &mut *gy, &mut *gz], [&mut *x, &mut *y, &mut *z]);
            let part = MultistepRun { stage, advance, run, history, out };
            on.simd.vectorize_as(
                #[inline(always)]
                |class| part.compute(class),
            );
            if faces.is_box {
                ghosts.fill_normals_in_plane(k, x, y);
                return;
            }
            let rates = Weights::of(terms, 1.0);
            hold(on, stage, k, run, Weights::of(terms, advance.new_s), [x, y, z]);
            correct(on, stage, k, rates, [gx, gy, gz]);
        });
        openings.extrapolate(Beside { stage, faces }, advance, [history, out]);
        if faces.is_box {
            ghosts.fill_ends(2, &mut out[2], Fill::Unprojected);
        } else {
            faces.hold(out);
            ghosts.fill_normals(out);
        }
        mem::swap(velocity, out);
    }

    /// One multistep part with viscosity implicit (Van Kan 1986): what it changes is solved
    /// for with the last pressure, which the projection then corrects. Returns the iterations.
    pub(super) fn relax(&mut self, part: Part) -> u32 {
        self.make_viscous();
        if !self.has_prediction(part) {
            self.forget_pressure();
        }
        let rates = self.multistep(part, false);
        let terms = self.terms(part, rates.force_at(), false);
        let number = self.diffusion_number(part.dt_s);
        let scale = part.scale_at(rates.force_at());
        let is_uniform = self.thick_per_s().is_none();
        let Self { layout, faces, ghosts, openings, velocity, stage: [out, history], .. } = self;
        let (pool, simd) = (&self.pool, &self.simd);
        let on = Engine { pool, simd: *simd, faces };
        let Accelerating { force, pressure, unlike } =
            accelerating(on, layout, &self.force, &mut self.mixture, Pull::of(scale));
        let stage = Stage { layout: *layout, velocity: components(velocity), force, terms };
        let (dt_s, theta) = (part.dt_s as f32, implicit_share(number));
        let viscous = if is_uniform { number as f32 } else { 0.0 };
        let pressure = pressure.unwrap_or(&self.pressure.next);
        let advance = Semi { rates, pressure, dt_s, viscous };
        if let Some(obstacles) = &mut self.obstacles {
            obstacles.measure(faces, stage, 1.0, Viscosity::Implicit, unlike);
            obstacles.count(rates.new_s.into(), rates.old_s.into());
            obstacles.keep(faces, velocity, 0);
        }
        let [x, y, z] = out.each_mut().map(|field| layout.planes(field));
        let [gx, gy, gz] = history.each_mut().map(|field| layout.planes(field));
        on.pool.planes([x, y, z, gx, gy, gz], [layout.plane; 6], |k, [x, y, z, gx, gy, gz]| {
            let Some(run) = on.live_run(layout, k) else { return };
            let out = [&mut *x, &mut *y, &mut *z];
            let history = [&mut *gx, &mut *gy, &mut *gz];
            let part = SemiRun { stage, advance, run, history, out };
            on.simd.vectorize_as(
                #[inline(always)]
                |class| part.compute(class),
            );
            if !faces.is_box {
                let rates = Weights::of(terms, 1.0);
                let weights = Weights { viscous, ..Weights::of(terms, advance.rates.new_s) };
                hold(on, stage, k, run, weights, [x, y, z]);
                correct(on, stage, k, rates, [gx, gy, gz]);
            }
        });
        openings.relax(Beside { stage, faces }, advance, !is_uniform, [history, out]);
        if let Some(weight) = self.mixture.as_ref().and_then(|mixture| mixture.weight()) {
            weight.press(on, layout, &self.pressure.next, dt_s, out);
        }
        let (number, iterations) =
            match self.mixture.as_mut().and_then(|mixture| mixture.thick_somewhere()) {
                Some(thick) => {
                    let times_s = [dt_s, theta as f32 * dt_s];
                    (part.dt_s, thick.advance(on, ghosts, times_s, out, velocity))
                }
                None => {
                    let Some(viscous) = &mut self.viscous else { return 0 };
                    ghosts.fill(out, Fill::Difference);
                    let (s, room) = ((theta * number) as f32, self.projection.room());
                    (number, viscous.solve(on, ghosts, room, s, out, velocity))
                }
            };
        if let Some(obstacles) = &mut self.obstacles {
            let pressure = Some((&*self.pressure.next, part.dt_s));
            let force = working(self.force.as_ref(), self.mixture.as_deref());
            let force = force.map(|force| (force, part.dt_s * f64::from(terms.force)));
            let (s, unlike) = (theta * number, unlike_in(self.mixture.as_deref()));
            obstacles.keep(faces, velocity, 1);
            obstacles.count_solved(layout, faces, Solved { number, s, pressure, force, unlike });
        }
        iterations
    }

    /// Prepares to solve for thick liquid.
    pub(super) fn make_viscous(&mut self) {
        let Self { layout, faces, ghosts, projection, .. } = self;
        let make = || Viscous::new(layout, faces, ghosts, projection.room());
        self.viscous.get_or_insert_with(make);
    }

    /// Adds what viscosity alone does in `dt_s`. Returns the iterations.
    pub(super) fn diffuse(&mut self, dt_s: f64) -> u32 {
        let number = self.diffusion_number(dt_s);
        if number == 0.0 {
            return 0;
        }
        self.make_viscous();
        let theta = implicit_share(number);
        let Self { layout, faces, ghosts, velocity, stage: [rhs, _], pool, simd, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        if let Some(obstacles) = &mut self.obstacles {
            obstacles.keep(faces, velocity, 0);
        }
        // What was traced or pushed need not stick to a side yet. A ghost on a parabola would call
        // for more than what is solved for can give, and the flow would swing beyond rest.
        ghosts.fill(velocity, Fill::Carried);
        let (number, iterations) =
            match self.mixture.as_mut().and_then(|mixture| mixture.thick_somewhere()) {
                Some(thick) => {
                    rhs.iter_mut().for_each(|rhs| rhs.fill(0.0));
                    let times_s = [dt_s as f32, (theta * dt_s) as f32];
                    (dt_s, thick.advance(on, ghosts, times_s, rhs, velocity))
                }
                None => {
                    let Some(viscous) = &mut self.viscous else { return 0 };
                    viscous.set_rhs(on, velocity, rhs, number as f32);
                    let (s, room) = ((theta * number) as f32, self.projection.room());
                    (number, viscous.solve(on, ghosts, room, s, rhs, velocity))
                }
            };
        if let Some(obstacles) = &mut self.obstacles {
            obstacles.keep(faces, velocity, 1);
            let (s, unlike) = (theta * number, unlike_in(self.mixture.as_deref()));
            let solved = Solved { number, s, pressure: None, force: None, unlike };
            obstacles.count_solved(layout, faces, solved);
        }
        iterations
    }

    /// One part in three stages, explicit throughout.
    pub(super) fn run_stages(&mut self, part: Part) {
        let terms = STAGES.map(|(.., at)| self.terms(part, at, true));
        let Self { layout, faces, ghosts, openings, velocity, stage, pressure, .. } = self;
        let (pool, simd) = (&self.pool, &self.simd);
        let [first, second] = stage;
        let on = Engine { pool, simd: *simd, faces };
        for (index, (start_share, own_share, at)) in STAGES.into_iter().enumerate() {
            let (from, to): (&Vector, &mut Vector) = match index {
                0 => (velocity, &mut *first),
                1 => (&*first, &mut *second),
                _ => (&*second, &mut *first),
            };
            let (slowed, predicted) = (Some(components(from)), Some(&pressure.next));
            let pull = Pull { slowed, pressure: predicted, ..Pull::of(part.scale_at(at)) };
            let accelerating = accelerating(on, layout, &self.force, &mut self.mixture, pull);
            let force = accelerating.force;
            let (layout, velocity) = (*layout, components(velocity));
            let stage = Stage { layout, velocity: components(from), force, terms: terms[index] };
            if let Some(obstacles) = &mut self.obstacles {
                let time_s = STAGE_WEIGHTS[index] * part.dt_s as f32;
                obstacles.measure(faces, stage, time_s, Viscosity::Explicit, accelerating.unlike);
                obstacles.count(1.0, 0.0);
            }
            let advance = RungeKutta {
                start: velocity,
                pressure: accelerating.pressure.unwrap_or(&pressure.next),
                start_share,
                own_share,
                dt_s: part.dt_s as f32,
            };
            let outs = to.each_mut().map(|out| layout.planes(out));
            on.pool.planes(outs, [layout.plane; 3], |k, mut out| {
                let Some(run) = on.live_run(&layout, k) else { return };
                let reborrowed = out.each_mut().map(|out| &mut **out);
                let part = RungeKuttaRun { stage, advance, run, out: reborrowed };
                on.simd.vectorize_as(
                    #[inline(always)]
                    |class| part.compute(class),
                );
                if !faces.is_box {
                    let weights = Weights::of(stage.terms, own_share * advance.dt_s);
                    hold(on, stage, k, run, weights, out);
                }
            });
            openings.advance(Beside { stage, faces }, advance, to);
            faces.hold(to);
            ghosts.fill(to, Fill::Unprojected);
        }
        mem::swap(velocity, first);
    }
}
