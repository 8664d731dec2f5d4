//! One step of [`Flow`].

use crate::solver::{
    Refused, Scheme, StepReport,
    flow::{
        Flow, MAX_SPEED_M_S,
        carry::Carriage,
        engine::Engine,
        field::{Vector, components},
        ghosts::Fill,
        momentum::{Multistep, MultistepRun, RungeKutta, RungeKuttaRun, Stage, Terms},
        pressure::{Prediction, Projected},
        schedule::{Plan, plan},
        survey::Survey,
        viscous,
        walls::hold,
        within,
    },
};

/// The longest step that is accepted.
const MAX_STEP_S: f64 = 1e3;

/// Energy that the guard lets gather beyond what was there and what forces did, as a part of
/// it: the error of the work integral and of f32 sums.
const GUARD_SLACK: f64 = 1e-3;

/// Ratios of the lengths of two parts between which the pressure of one predicts the other's.
const PREDICTABLE: std::ops::RangeInclusive<f64> = 0.3..=3.0;

/// Third-order strong-stability-preserving Runge-Kutta (Shu, Osher 1988): share of the start,
/// share of the advanced stage, and when in the step the force of the stage is taken.
const STAGES: [(f32, f32, f64); 3] =
    [(0.0, 1.0, 0.0), (3.0 / 4.0, 1.0 / 4.0, 1.0), (1.0 / 3.0, 2.0 / 3.0, 0.5)];

/// One part of a step.
#[derive(Clone, Copy)]
struct Part {
    dt_s: f64,
    /// Scale of the force at its start and end.
    force_scale: [f64; 2],
}

impl Part {
    fn scale_at(&self, share: f64) -> f64 {
        self.force_scale[0] + share * (self.force_scale[1] - self.force_scale[0])
    }
}

/// Accepts the length of a step.
pub(super) fn check_step(dt_s: f64) -> Result<(), Refused> {
    within("dt_s", if dt_s < 0.0 { f64::NAN } else { dt_s }, MAX_STEP_S)
        .map(|_| ())
        .map_err(|refused| Refused { value: dt_s, ..refused })
}

impl Flow {
    /// See [`crate::solver::Solver::step`].
    pub(super) fn advance(&mut self, dt_s: f64) -> Result<StepReport, Refused> {
        check_step(dt_s)?;
        let before = self.surveyed();
        if dt_s == 0.0 || (self.may_sleep && before.speed_m_s == 0.0 && !self.is_forced()) {
            self.survey = Some(before);
            return Ok(self.report_of_rest(before));
        }
        let plan = self.plan(dt_s, before);
        let mut report =
            StepReport { substeps: plan.parts, scheme: plan.scheme, ..StepReport::at_rest() };
        self.pressure.share = plan.trend_share;
        let mut after = before;
        for index in 0..plan.parts {
            after = self.advance_part(self.part(dt_s, plan, index), plan.scheme, &mut report);
        }
        let after = self.guard(before, after, dt_s, &mut report);
        self.settle(after);
        report.asleep = after.speed_m_s == 0.0 && !self.is_forced();
        report.kinetic_energy_j = after.energy_m2_s2 * self.cell_mass_kg();
        Ok(report)
    }

    fn advance_part(&mut self, part: Part, scheme: Scheme, report: &mut StepReport) -> Survey {
        match scheme {
            Scheme::Traced => {
                self.carry(Carriage::Reflection, part.dt_s, part.force_scale, report);
            }
            Scheme::Multistep => self.extrapolate(part),
            _ => {
                self.prepare_pressure(part, scheme);
                self.run_stages(part, scheme == Scheme::Central);
                if scheme == Scheme::CentralImplicit {
                    report.viscous_iterations += self.diffuse(part.dt_s);
                }
            }
        }
        let Projected { iterations, survey } = self.clear_divergence();
        report.pressure_iterations += iterations;
        if scheme != Scheme::Multistep && scheme != Scheme::Traced {
            self.learn_pressure(part);
        }
        survey
    }

    fn plan(&self, dt_s: f64, before: Survey) -> Plan {
        let spacing_m = f64::from(self.grid.spacing_m);
        let scale = self.force_scale[0].abs().max(self.force_scale[1].abs());
        let pull = self.force.as_ref().map_or(0.0, |force| force.largest_m_s2 * scale);
        let speed_m_s = before.speed_m_s.max(self.side_speed_m_s) + pull * dt_s;
        let cfl = speed_m_s * dt_s / spacing_m;
        plan(cfl, 12.0 * self.diffusion_number(dt_s), self.forced)
    }

    fn part(&self, dt_s: f64, plan: Plan, index: u32) -> Part {
        let whole = Part { dt_s, force_scale: self.force_scale };
        let parts = f64::from(plan.parts);
        let ends = [index, index + 1].map(|end| whole.scale_at(f64::from(end) / parts));
        Part { dt_s: dt_s / parts, force_scale: ends }
    }

    fn is_forced(&self) -> bool {
        let is_pushed = self.force.as_ref().is_some_and(|force| force.largest_m_s2 > 0.0)
            && self.force_scale != [0.0; 2];
        is_pushed || self.side_speed_m_s > 0.0
    }

    fn diffusion_number(&self, dt_s: f64) -> f64 {
        self.viscosity_m2_s * dt_s / f64::from(self.grid.spacing_m).powi(2)
    }

    /// The pressure of the last part predicts that of this one, unless it was that of a much
    /// shorter or longer one: a push counts there as an acceleration over the part's length.
    /// Without a prediction the part is rehearsed, and what it found of the pressure is kept.
    fn prepare_pressure(&mut self, part: Part, scheme: Scheme) {
        self.history_dt_s = 0.0;
        let ratio = part.dt_s / std::mem::replace(&mut self.pressure_dt_s, part.dt_s);
        if PREDICTABLE.contains(&ratio) {
            return;
        }
        self.forget_pressure();
        self.run_stages(part, scheme == Scheme::Central);
        self.clear_divergence();
        self.learn_pressure(part);
        std::mem::swap(&mut self.velocity, &mut self.stage[0]);
        let Prediction { next, trend, share } = &mut self.pressure;
        next.iter_mut().zip(trend.iter()).for_each(|(p, t)| *p -= *share * t);
        self.pressure.trend.fill(0.0);
    }

    fn forget_pressure(&mut self) {
        self.pressure.next.fill(0.0);
        self.pressure.trend.fill(0.0);
    }

    fn learn_pressure(&mut self, part: Part) {
        let Self { faces, ghosts, pressure, pool, simd, projection, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        projection.learn(on, ghosts, pressure, (1.0 / part.dt_s) as f32);
    }

    /// The terms of a stage at `share` of the part.
    fn terms(&self, part: Part, share: f64, with_viscosity: bool) -> Terms {
        let spacing_m = f64::from(self.grid.spacing_m);
        let viscosity_m2_s = if with_viscosity { self.viscosity_m2_s } else { 0.0 };
        Terms {
            advection_per_m: (-1.0 / (4.0 * spacing_m)) as f32,
            viscous_per_s: (viscosity_m2_s / (spacing_m * spacing_m)) as f32,
            force: part.scale_at(share) as f32,
        }
    }

    /// Second-order Adams-Bashforth, for a step that may differ from the last: a first one has
    /// no history and is Euler's.
    fn extrapolate(&mut self, part: Part) {
        self.pressure_dt_s = 0.0;
        let last_dt_s = std::mem::replace(&mut self.history_dt_s, part.dt_s);
        let ratio = if last_dt_s > 0.0 { (part.dt_s / last_dt_s).min(4.0) } else { 0.0 };
        let advance = Multistep {
            new_s: (part.dt_s * (1.0 + 0.5 * ratio)) as f32,
            old_s: (-0.5 * part.dt_s * ratio) as f32,
        };
        let terms = self.terms(part, 0.0, true);
        let Self { layout, faces, ghosts, velocity, stage: [out, history], pool, simd, .. } = self;
        let force = self.force.as_ref().map(|force| components(&force.acceleration_m_s2));
        let stage = Stage { layout: *layout, velocity: components(velocity), force, terms };
        let on = Engine { pool, simd: *simd, faces };
        let [x, y, z] = out.each_mut().map(|field| layout.planes(field));
        let [gx, gy, gz] = history.each_mut().map(|field| layout.planes(field));
        on.pool.planes([x, y, z, gx, gy, gz], [layout.plane; 6], |k, [x, y, z, gx, gy, gz]| {
            let Some(run) = on.live_run(layout, k) else { return };
            let (history, out) = ([&mut *gx, &mut *gy, &mut *gz], [&mut *x, &mut *y, &mut *z]);
            on.simd.run(MultistepRun { stage, advance, run, history, out });
            if !faces.is_box {
                let rates = [gx, gy, gz];
                hold(on, &stage, run, advance.new_s, [x, y, z], Some(rates));
            }
        });
        ghosts.fill(out, Fill::Unprojected);
        std::mem::swap(velocity, out);
    }

    fn run_stages(&mut self, part: Part, with_viscosity: bool) {
        let terms = STAGES.map(|(.., at)| self.terms(part, at, with_viscosity));
        let Self { layout, faces, ghosts, velocity, stage, pressure, pool, simd, .. } = self;
        let [first, second] = stage;
        let force = self.force.as_ref().map(|force| components(&force.acceleration_m_s2));
        let on = Engine { pool, simd: *simd, faces };
        for (index, (start_share, own_share, _)) in STAGES.into_iter().enumerate() {
            let (from, to): (&Vector, &mut Vector) = match index {
                0 => (velocity, &mut *first),
                1 => (&*first, &mut *second),
                _ => (&*second, &mut *first),
            };
            let (layout, velocity) = (*layout, components(velocity));
            let stage = Stage { layout, velocity: components(from), force, terms: terms[index] };
            let advance = RungeKutta {
                start: velocity,
                pressure: &pressure.next,
                start_share,
                own_share,
                dt_s: part.dt_s as f32,
            };
            let outs = to.each_mut().map(|out| layout.planes(out));
            on.pool.planes(outs, [layout.plane; 3], |k, mut out| {
                let Some(run) = on.live_run(&layout, k) else { return };
                let reborrowed = out.each_mut().map(|out| &mut **out);
                on.simd.run(RungeKuttaRun { stage, advance, run, out: reborrowed });
                if !faces.is_box {
                    hold(on, &stage, run, own_share * advance.dt_s, out, None);
                }
            });
            ghosts.fill(to, Fill::Unprojected);
        }
        std::mem::swap(velocity, first);
    }

    pub(super) fn diffuse(&mut self, dt_s: f64) -> u32 {
        let number = self.diffusion_number(dt_s) as f32;
        if number == 0.0 {
            return 0;
        }
        let Self { layout, faces, ghosts, velocity, stage, krylov, pool, simd, .. } = self;
        let [residual, direction] = stage;
        let on = Engine { pool, simd: *simd, faces };
        let product = krylov;
        let work = viscous::Work { residual, direction, product };
        viscous::solve(on, layout, ghosts, velocity, work, number)
    }

    pub(super) fn clear_divergence(&mut self) -> Projected {
        let Self { faces, ghosts, velocity, pool, simd, projection, .. } = self;
        let force = self.force.as_ref().map(|force| components(&force.acceleration_m_s2));
        let on = Engine { pool, simd: *simd, faces };
        projection.project(on, ghosts, velocity, force)
    }

    /// Energy may not exceed what it was plus what forces did, nor speed what f32 can square.
    /// What it does exceed it by is added up until it is worth an action. What moving sides and
    /// openings give is not known here: there only the speed is bounded.
    fn guard(
        &mut self,
        before: Survey,
        after: Survey,
        dt_s: f64,
        report: &mut StepReport,
    ) -> Survey {
        let [start, end] = self.force_scale;
        let work = 0.5 * dt_s * (start * before.power_m2_s3 + end * after.power_m2_s3);
        let gain = after.energy_m2_s2 - before.energy_m2_s2 - work;
        self.excess_m2_s2 = if self.is_driven { 0.0 } else { (self.excess_m2_s2 + gain).max(0.0) };
        let is_tolerated = self.excess_m2_s2 <= GUARD_SLACK * (before.energy_m2_s2 + work.abs());
        let excess = if is_tolerated { 0.0 } else { self.excess_m2_s2 };
        let for_energy = ((after.energy_m2_s2 - excess)
            / after.energy_m2_s2.max(f64::MIN_POSITIVE))
        .clamp(0.0, 1.0)
        .sqrt();
        let scale = for_energy.min(f64::from(MAX_SPEED_M_S) / after.speed_m_s.max(1e-9));
        if (is_tolerated && scale >= for_energy) || after.energy_m2_s2 == 0.0 {
            return after;
        }
        report.guard_actions += 1;
        self.excess_m2_s2 = 0.0;
        self.pressure_dt_s = 0.0;
        self.history_dt_s = 0.0;
        for u in self.velocity.iter_mut().flat_map(|u| u.iter_mut()) {
            *u *= scale as f32;
        }
        self.ghosts.fill(&mut self.velocity, Fill::Projected);
        self.survey = None;
        self.surveyed()
    }

    /// Liquid that has come to rest keeps no pressure: a step from here computes zeros.
    fn settle(&mut self, after: Survey) {
        if after.speed_m_s == 0.0 {
            self.forget_pressure();
            self.pressure_dt_s = 0.0;
            self.history_dt_s = 0.0;
        }
        self.survey = Some(after);
    }

    fn report_of_rest(&self, survey: Survey) -> StepReport {
        StepReport {
            asleep: survey.speed_m_s == 0.0 && !self.is_forced(),
            kinetic_energy_j: survey.energy_m2_s2 * self.cell_mass_kg(),
            ..StepReport::at_rest()
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::{grid::Grid, solver::Setup, vessel::Vessel};

    #[test]
    fn skipping_liquid_at_rest_changes_no_bits() {
        let run = |may_sleep| {
            let vessel = Vessel::Pot { centre_in_world_m: Vec3::splat(0.5), radius_m: 0.45 };
            let grid = Grid::unit_cube(8);
            let setup = Setup { viscosity_m2_s: 0.1, ..Setup::new(grid, vessel) };
            let mut flow = Flow::new(&setup).expect("a flow");
            flow.may_sleep = may_sleep;
            let (mut slept, mut bits) = (0, Vec::new());
            for push in 0..3 {
                let impulse = DVec3::new(1e-3, f64::from(push), 0.0);
                flow.push(Vec3::splat(0.5), 0.2, impulse).expect("finite");
                for _ in 0..200 {
                    slept +=
                        u32::from(flow.advance(0.05).expect("in range").scheme == Scheme::Rest);
                    let u = flow.velocity.iter().flat_map(|u| u.iter());
                    bits.extend(u.map(|u| u.to_bits()));
                }
            }
            (slept, bits)
        };
        let ((slept, sleeping), (never, awake)) = (run(true), run(false));
        assert!(slept > 100 && never == 0, "{slept} {never}");
        assert_eq!(sleeping, awake);
    }
}
