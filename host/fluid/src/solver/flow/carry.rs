//! The traced step: for steps across many cells.
//!
//! A face takes the velocity that is found where the flow came from (Robert 1981; Stam 1999).
//! What interpolation and projection lose of the flow depends on how they are arranged, by
//! [`Carriage`]; in all of them the force pushes and viscosity acts between a tracing and a
//! projection, and none can raise a velocity above those it was interpolated from.

use crate::solver::{
    Refused, StepReport,
    flow::{
        Flow, MAX_SPEED_M_S,
        engine::Engine,
        field::{BLOCK, Vector, components, cut},
        ghosts::Fill,
        mixture::{Pull, accelerating},
        openings::slow_incoming,
        pressure::Projected,
        step::check_step,
        survey::Survey,
        trace::Tracer,
    },
};

/// How a traced step is put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carriage {
    /// Stable fluids on a staggered grid (Stam 1999): linear interpolation.
    SemiLagrangian,
    /// The same, corrected by half the error of going there and back, unless that leaves the
    /// range of the values around (Selle, Fedkiw, Kim, Liu, Rossignac 2008).
    MacCormack,
    /// Half a step, reflection about the velocities without divergence, half a step (Zehnder,
    /// Narain, Thomaszewski 2018), by cubic interpolation kept within the range of the values
    /// around.
    Reflection,
}

impl Flow {
    /// A whole step by that carriage, projected, with nothing but its speed guarded.
    pub(in crate::solver) fn carry_alone(
        &mut self,
        carriage: Carriage,
        dt_s: f64,
        report: &mut StepReport,
    ) -> Result<(), Refused> {
        check_step(dt_s)?;
        self.set_friction();
        self.carry(carriage, dt_s, self.force_scale, report);
        let speed_m_s = self.clear_and_count(report, 1.0).speed_m_s as f32;
        if speed_m_s > MAX_SPEED_M_S {
            let scale = MAX_SPEED_M_S / speed_m_s;
            self.velocity.iter_mut().flat_map(|u| u.iter_mut()).for_each(|u| *u *= scale);
            self.faces.hold(&mut self.velocity);
            self.survey = None;
        }
        Ok(())
    }

    /// Carries the velocity along itself for `dt_s` and leaves it to be projected. The force's
    /// scale goes from the first to the second of `force_scale`.
    pub(in crate::solver) fn carry(
        &mut self,
        carriage: Carriage,
        dt_s: f64,
        force_scale: [f64; 2],
        report: &mut StepReport,
    ) {
        self.pressure_dt_s = 0.0;
        self.history = None;
        let [start, end] = force_scale;
        if carriage == Carriage::Reflection {
            self.act(0.5 * dt_s, start, report);
            self.clear_and_count(report, 1.0);
            self.reflect(0.5 * dt_s, report);
            self.act(0.5 * dt_s, end, report);
        } else {
            self.push_all(dt_s, 0.5 * (start + end));
            self.clear_and_count(report, 1.0);
            self.trace_once(carriage, dt_s);
            report.viscous_iterations += self.diffuse(dt_s);
        }
    }

    /// Half a step there, twice the projection minus what was projected, half a step on.
    fn reflect(&mut self, half_s: f64, report: &mut StepReport) {
        self.trace_cubic(half_s, false);
        std::mem::swap(&mut self.velocity, &mut self.stage[0]);
        for (reflected, u) in self.stage[0].iter_mut().zip(&self.velocity) {
            reflected.copy_from_slice(u);
        }
        // Reflected, it counts twice.
        self.clear_and_count(report, 2.0);
        for (reflected, u) in self.stage[0].iter_mut().zip(&self.velocity) {
            reflected.iter_mut().zip(u.iter()).for_each(|(r, u)| *r = 2.0 * u - *r);
        }
        self.trace_cubic(half_s, true);
        std::mem::swap(&mut self.velocity, &mut self.stage[1]);
    }

    /// Traces the velocity, or what `stage[0]` holds, along the velocity: from there into
    /// `stage[0]` or `stage[1]`.
    fn trace_cubic(&mut self, dt_s: f64, is_reflected: bool) {
        let reach = self.reach(dt_s);
        let Self { layout, faces, ghosts, velocity, stage: [first, second], pool, simd, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        let tracer = Tracer::new(layout, ghosts);
        ghosts.fill(velocity, Fill::Carried);
        slow_incoming(layout, faces, velocity);
        let along = components(velocity);
        let (from, out): ([&[f32]; 3], &mut Vector) = if is_reflected {
            ghosts.fill(first, Fill::Carried);
            slow_incoming(layout, faces, first);
            (components(first), second)
        } else {
            (along, first)
        };
        tracer.visit(
            on,
            out,
            #[inline(always)]
            |faces| {
                let departure = tracer.trace(along, faces, -reach);
                let mut values = tracer.cubic(faces.c, from[faces.c], &departure);
                let [low, high] = tracer.range(faces.c, from[faces.c], &departure);
                for l in 0..BLOCK {
                    let raised = if values[l] > low[l] { values[l] } else { low[l] };
                    values[l] = if raised < high[l] { raised } else { high[l] };
                }
                values
            },
        );
        faces.hold(out);
        ghosts.fill(out, Fill::Inside);
    }

    fn trace_once(&mut self, carriage: Carriage, dt_s: f64) {
        let reach = self.reach(dt_s);
        let Self { layout, faces, ghosts, velocity, stage: [once, out], pool, simd, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        let tracer = Tracer::new(layout, ghosts);
        ghosts.fill(velocity, Fill::Carried);
        slow_incoming(layout, faces, velocity);
        let u = components(velocity);
        tracer.visit(
            on,
            once,
            #[inline(always)]
            |faces| tracer.linear(faces.c, u[faces.c], &tracer.trace(u, faces, -reach)),
        );
        faces.hold(once);
        if carriage == Carriage::SemiLagrangian {
            ghosts.fill(once, Fill::Inside);
            std::mem::swap(velocity, once);
            return;
        }
        ghosts.fill(once, Fill::Carried);
        slow_incoming(layout, faces, once);
        let moved = components(once);
        tracer.visit(
            on,
            out,
            #[inline(always)]
            |faces| {
                let (u, moved) = (u, moved[faces.c]);
                let departure = tracer.trace(u, faces, -reach);
                let [low, high] = tracer.range(faces.c, u[faces.c], &departure);
                let arrival = tracer.trace(u, faces, reach);
                let back = tracer.linear(faces.c, moved, &arrival);
                let here = cut(u[faces.c], faces.at, BLOCK);
                let there = cut(moved, faces.at, BLOCK);
                let mut values = [0.0; BLOCK];
                for l in 0..BLOCK {
                    let corrected = there[l] + 0.5 * (here[l] - back[l]);
                    let is_within = low[l] <= corrected && corrected <= high[l];
                    values[l] = if is_within { corrected } else { there[l] };
                }
                values
            },
        );
        faces.hold(out);
        ghosts.fill(out, Fill::Inside);
        std::mem::swap(velocity, out);
    }

    /// Cells that a velocity of 1 m/s crosses.
    fn reach(&self, dt_s: f64) -> f32 {
        (dt_s / f64::from(self.grid.spacing_m)) as f32
    }

    fn act(&mut self, dt_s: f64, force_scale: f64, report: &mut StepReport) {
        self.push_all(dt_s, force_scale);
        report.viscous_iterations += self.diffuse(dt_s);
    }

    /// Adds the force times `force_scale`; no speed is raised above what is kept.
    fn push_all(&mut self, dt_s: f64, force_scale: f64) {
        let Self { layout, faces, pool, simd, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        let push_s = if self.mixture.is_some() { dt_s } else { dt_s * force_scale } as f32;
        let force = accelerating(on, layout, &self.force, &mut self.mixture, Pull::of(force_scale));
        let Some(force) = force.force else { return };
        for (u, f) in self.velocity.iter_mut().zip(force) {
            let pairs = u.iter_mut().zip(f);
            pairs.for_each(|(u, f)| *u = (*u + push_s * f).clamp(-MAX_SPEED_M_S, MAX_SPEED_M_S));
        }
        self.faces.hold(&mut self.velocity);
        self.ghosts.fill(&mut self.velocity, Fill::Unprojected);
    }

    /// Projects; obstacles are pressed `times` as hard.
    fn clear_and_count(&mut self, report: &mut StepReport, times: f64) -> Survey {
        let Projected { iterations, survey } = self.clear_divergence(self.keeps_pressure());
        self.count_pressure(times);
        report.pressure_iterations += iterations;
        self.survey = Some(survey);
        survey
    }
}
