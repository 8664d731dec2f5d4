//! One step of [`Flow`].

use crate::solver::{
    Refused, Scheme, StepReport,
    flow::{
        Flow, MAX_SPEED_M_S,
        carry::Carriage,
        engine::Engine,
        ghosts::Fill,
        mixture::{unlike_in, working},
        pressure::{Projected, Telling},
        schedule::{Plan, plan, plan_stress},
        survey::Survey,
        within,
    },
};

/// The longest step that is accepted.
const MAX_STEP_S: f64 = 1e3;

/// Energy that the guard lets gather beyond what was there and what forces did, as a part of
/// it: the error of the work integral and of f32 sums.
const GUARD_SLACK: f64 = 1e-3;

/// Part by which the work on a mixture may be more: the books know it to the first order in the
/// step, in which density and velocity are carried one after the other.
const WORK_SLACK: f64 = 0.05;
/// Part by which the work of obstacles may be more: it is known by the mean force on them.
const STIR_SLACK: f64 = 0.1;

/// Rounds in which what forces did and what is left of a flow are fitted to each other: each halves
/// the orders of magnitude that are missing.
const GUARD_ROUNDS: u32 = 12;

/// A step that leaves less than this part of the energy ends the flow whose pressure is known.
const LITTLE_LEFT: f64 = 0.1;

/// Parts of a step with moving obstacles or a drag, after which the rest of it is traced: as many
/// as two plans would have at most.
const MOST_STIRRED_PARTS: u32 = 32;

/// One part of a step.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) dt_s: f64,
    /// Scale of the force at its start and end.
    force_scale: [f64; 2],
}

impl Part {
    pub(super) fn scale_at(&self, share: f64) -> f64 {
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
        self.set_friction();
        self.dress(dt_s);
        self.open_coupling();
        if let Some(lid) = &mut self.lid {
            lid.open(dt_s);
        }
        if self.survey.is_none() {
            self.set_drive();
        }
        let before = self.surveyed();
        if dt_s == 0.0 || (self.may_sleep && before.speed_m_s == 0.0 && !self.is_forced()) {
            self.survey = Some(before);
            if let Some(obstacles) = &mut self.obstacles {
                obstacles.close(0.0);
            }
            self.lift_obstacles();
            return Ok(self.report_of_rest(before));
        }
        if let Some(obstacles) = &mut self.obstacles {
            obstacles.sweep(&self.layout, &mut self.faces, dt_s);
        }
        let plan = self.plan_step(dt_s, before);
        let mut report =
            StepReport { substeps: plan.parts, scheme: plan.scheme, ..StepReport::at_rest() };
        self.pressure.share = plan.trend_share;
        let mut after = before;
        if self.is_stirred() || self.is_coupled() {
            after = self.advance_stirred(dt_s, before, &mut report);
        } else {
            for index in 0..plan.parts {
                let part = self.part(dt_s, plan, index);
                after = self.advance_sound(part, plan.scheme, &mut report);
            }
        }
        let given_m2_s2 = self.close_obstacles(dt_s) + self.coupled_work_m2_s2();
        let after = self.guard([before, after], given_m2_s2, dt_s, &mut report);
        self.settle(before, after);
        report.asleep = after.speed_m_s == 0.0 && !self.is_forced();
        report.kinetic_energy_j = after.energy_m2_s2 * self.cell_mass_kg();
        Ok(report)
    }

    /// Ends the accounts of obstacles. Returns the most that they can have given: their work, and
    /// the energy of what they displaced at their speed.
    fn close_obstacles(&mut self, dt_s: f64) -> f64 {
        let cell_kg = self.cell_mass_kg();
        let Some(obstacles) = &mut self.obstacles else { return 0.0 };
        obstacles.close(cell_kg / dt_s);
        let density = unlike_in(self.mixture.as_deref()).density;
        let displaced = self.faces.solids().map_or(0.0, |solids| solids.displaced_m_s(density));
        let carried_m3_s3 = 0.5 * obstacles.speed_m_s().powi(2) * displaced;
        let work_m2_s2 = obstacles.work_j(cell_kg, dt_s).max(0.0) / cell_kg;
        self.lift_obstacles();
        (1.0 + STIR_SLACK) * work_m2_s2 + carried_m3_s3 * dt_s / f64::from(self.grid.spacing_m)
    }

    /// Completes the forces on obstacles by the pressure that no step needs to know of.
    fn lift_obstacles(&mut self) {
        let weight_n = self.cell_mass_kg() * self.gravity_m_s2;
        if let (Some(obstacles), Some(mixture)) = (&mut self.obstacles, &self.mixture) {
            obstacles.lift(&self.layout, &self.faces, mixture, weight_n);
        }
    }

    /// How fast liquid gives way to obstacles, or round a body that drags it, is known only once it
    /// did: each part is planned anew.
    fn advance_stirred(&mut self, dt_s: f64, before: Survey, report: &mut StepReport) -> Survey {
        let whole = Part { dt_s, force_scale: self.force_scale };
        let (mut after, mut done) = (before, 0.0);
        report.substeps = 0;
        while done < 1.0 {
            let mut plan = self.plan_step((1.0 - done) * dt_s, after);
            if report.substeps >= MOST_STIRRED_PARTS {
                plan = Plan { scheme: Scheme::Traced, parts: 1, trend_share: 0.0 };
            }
            let end =
                if plan.parts == 1 { 1.0 } else { done + (1.0 - done) / f64::from(plan.parts) };
            let ends = [done, end].map(|share| whole.scale_at(share));
            let part = Part { dt_s: (end - done) * dt_s, force_scale: ends };
            self.pressure.share = plan.trend_share;
            after = self.advance_sound(part, plan.scheme, report);
            report.scheme = plan.scheme;
            report.substeps += 1;
            done = end;
        }
        after
    }

    fn advance_part(&mut self, part: Part, scheme: Scheme, report: &mut StepReport) -> Survey {
        match scheme {
            Scheme::Traced => {
                self.carry(Carriage::Reflection, part.dt_s, part.force_scale, report);
            }
            Scheme::Multistep => self.extrapolate(part),
            Scheme::MultistepImplicit => report.viscous_iterations += self.relax(part),
            _ => {
                self.prepare_pressure(part);
                self.run_stages(part);
            }
        }
        let is_learnt = matches!(scheme, Scheme::Central | Scheme::MultistepImplicit);
        let is_kept = is_learnt || self.keeps_pressure();
        let Projected { iterations, survey } = self.clear_divergence(is_kept);
        report.pressure_iterations += iterations;
        self.count_pressure(1.0);
        if is_learnt {
            if let Some(lid) = &mut self.lid {
                lid.press(&self.layout, &self.pressure.next, part.dt_s);
            }
            if let Some(obstacles) = &mut self.obstacles {
                obstacles.press(&self.layout, &self.faces, &self.pressure.next, part.dt_s);
            }
            self.learn_pressure(part);
        }
        self.drag_along(part, scheme, survey, report)
    }

    fn plan_step(&self, dt_s: f64, before: Survey) -> Plan {
        let spacing_m = f64::from(self.grid.spacing_m);
        let scale = self.force_scale[0].abs().max(self.force_scale[1].abs());
        let pull = self.force.as_ref().map_or(0.0, |force| force.largest_m_s2 * scale)
            + self.mixture.as_ref().map_or(0.0, |mixture| mixture.largest_m_s2);
        let solids_m_s = self.obstacles.as_ref().map_or(0.0, |obstacles| obstacles.speed_m_s());
        let given_m_s = self.side_speed_m_s.max(solids_m_s).max(self.drag_speed_m_s());
        let speed_m_s = before.speed_m_s.max(given_m_s) + pull * dt_s;
        let cfl = speed_m_s * dt_s / spacing_m;
        let number = self.diffusion_number(dt_s);
        // Between two projections stresses act on gradients, too: twice as fast.
        match self.thick_per_s() {
            Some(_) => plan_stress(cfl, 24.0 * number, self.forced),
            None => plan(cfl, 12.0 * number, self.forced),
        }
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
        let is_pulled = self.mixture.as_ref().is_some_and(|mixture| mixture.largest_m_s2 > 0.0);
        let is_moved = self.side_speed_m_s > 0.0 || self.is_stirred() || self.is_dragged();
        is_pushed || is_pulled || is_moved
    }

    /// True if an obstacle moves.
    pub(super) fn is_stirred(&self) -> bool {
        self.faces.solids().is_some_and(|solids| solids.is_moving)
    }

    /// True if somebody wants to know what a projection finds.
    pub(super) fn keeps_pressure(&self) -> bool {
        self.obstacles.is_some() || self.lid.is_some()
    }

    /// Counts the last projection as a push on obstacles and lid.
    pub(super) fn count_pressure(&mut self, times: f64) {
        self.press_lid(times);
        if let Some(obstacles) = &mut self.obstacles {
            obstacles.press(&self.layout, &self.faces, self.projection.found(), times);
        }
    }

    /// How fast friction is at most, where it differs from place to place.
    pub(super) fn thick_per_s(&self) -> Option<f64> {
        self.mixture.as_ref().and_then(|mixture| mixture.stiffness_per_s())
    }

    /// nu dt / h^2, of which 12 times is what the stiffest mode without divergence decays by.
    pub(super) fn diffusion_number(&self, dt_s: f64) -> f64 {
        if let Some(stiffness_per_s) = self.thick_per_s() {
            return stiffness_per_s * dt_s / 24.0;
        }
        self.viscosity_m2_s * dt_s / f64::from(self.grid.spacing_m).powi(2)
    }

    /// Projects, and surveys what that leaves. What that finds of the pressure is there afterwards
    /// if it is kept.
    pub(super) fn clear_divergence(&mut self, is_kept: bool) -> Projected {
        self.set_drive();
        let Self { faces, ghosts, velocity, pool, simd, projection, .. } = self;
        let force = working(self.force.as_ref(), self.mixture.as_deref());
        let on = Engine { pool, simd: *simd, faces };
        let density = self.mixture.as_ref().and_then(|mixture| mixture.weight());
        projection.project(on, ghosts, velocity, Telling::All(force), density, is_kept)
    }

    /// Energy may not exceed what it was plus what forces, obstacles and a drag did (the last two:
    /// `given_m2_s2`), nor speed what f32 can square. What it does exceed it by is added up until
    /// it is worth an action. Through openings none comes in: beyond them all is at rest. What
    /// moving sides give is not known here: there only the speed is bounded.
    fn guard(
        &mut self,
        [before, after]: [Survey; 2],
        given_m2_s2: f64,
        dt_s: f64,
        report: &mut StepReport,
    ) -> Survey {
        // As u'^2 - u^2 = (u' + u)(u' - u): exact, however the force changes meanwhile.
        // The drive of a mixture has the scale in it.
        let scale = 0.5 * (self.force_scale[0] + self.force_scale[1]);
        let push_s = if self.mixture.is_some() { dt_s } else { dt_s * scale };
        let is_mixed = self.mixture.is_some();
        // If so much of the velocity after the step is left.
        let work_by = |share: f64| {
            let after_m2_s3 = share * after.power_m2_s3;
            let mean_m2_s3 = 0.5 * (before.power_m2_s3 + after_m2_s3);
            // What is heavier is carried, and falls, with the velocity after the step; a multistep
            // part follows what is poured to its middle.
            let mixed_m2_s3 = || mean_m2_s3.max(after_m2_s3) + WORK_SLACK * mean_m2_s3.abs();
            push_s * if is_mixed { mixed_m2_s3() } else { mean_m2_s3 } + given_m2_s2
        };
        let work = work_by(1.0);
        let gain = after.energy_m2_s2 - before.energy_m2_s2 - work;
        let is_driven = self.side_speed_m_s > 0.0;
        self.excess_m2_s2 = if is_driven { 0.0 } else { (self.excess_m2_s2 + gain).max(0.0) };
        let is_tolerated = self.excess_m2_s2 <= GUARD_SLACK * (before.energy_m2_s2 + work.abs());
        let excess = if is_tolerated { 0.0 } else { self.excess_m2_s2 };
        let mut for_energy = 1.0;
        // A slower flow takes less from the same forces: what they may have given is less, too.
        for _ in 0..GUARD_ROUNDS * u32::from(!is_tolerated) {
            let left_m2_s2 = after.energy_m2_s2 - excess - (work - work_by(for_energy));
            let share = left_m2_s2 / after.energy_m2_s2.max(f64::MIN_POSITIVE);
            for_energy = share.clamp(0.0, for_energy * for_energy).sqrt();
        }
        let scale = for_energy.min(f64::from(MAX_SPEED_M_S) / after.speed_m_s.max(1e-9));
        if (is_tolerated && scale >= for_energy) || after.energy_m2_s2 == 0.0 {
            return after;
        }
        report.guard_actions += 1;
        self.excess_m2_s2 = 0.0;
        self.pressure_dt_s = 0.0;
        self.history = None;
        for u in self.velocity.iter_mut().flat_map(|u| u.iter_mut()) {
            *u *= scale as f32;
        }
        self.faces.hold(&mut self.velocity);
        self.ghosts.fill(&mut self.velocity, Fill::Projected);
        self.survey = None;
        self.surveyed()
    }

    /// One part, with what is no number brought to rest.
    fn advance_sound(&mut self, part: Part, scheme: Scheme, report: &mut StepReport) -> Survey {
        let after = self.advance_part(part, scheme, report);
        if after.energy_m2_s2.is_finite() { after } else { self.recover(report) }
    }

    /// What light liquid is torn along at may leave f32 within a step, before the guard sees it:
    /// what is no number is at rest then, and nothing is faster than what is kept.
    fn recover(&mut self, report: &mut StepReport) -> Survey {
        report.guard_actions += 1;
        self.excess_m2_s2 = 0.0;
        self.pressure_dt_s = 0.0;
        self.history = None;
        self.forget_pressure();
        for u in self.velocity.iter_mut().flat_map(|u| u.iter_mut()) {
            *u = if u.is_finite() { u.clamp(-MAX_SPEED_M_S, MAX_SPEED_M_S) } else { 0.0 };
        }
        self.faces.hold(&mut self.velocity);
        self.ghosts.fill(&mut self.velocity, Fill::Projected);
        self.set_drive();
        self.survey = None;
        self.surveyed()
    }

    /// Liquid that has come to rest keeps no pressure: a step from here computes zeros. Nor does
    /// that of a flow predict anything once hardly any of it is left: what it was wrong by would
    /// be all that the next steps have to do.
    fn settle(&mut self, before: Survey, after: Survey) {
        if after.energy_m2_s2 < LITTLE_LEFT * before.energy_m2_s2 {
            self.pressure_dt_s = 0.0;
        }
        if after.speed_m_s == 0.0 {
            self.forget_pressure();
            self.pressure_dt_s = 0.0;
            self.history = None;
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
