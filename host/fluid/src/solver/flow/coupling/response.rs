//! What liquid at rest does with a push.

use glam::DVec3;

use super::Coupling;
use crate::solver::{
    Scheme, StepReport,
    flow::{
        Flow,
        engine::Engine,
        exchange::Kernel,
        field::{Layout, Vector, components, cut, cut_mut},
        ghosts::Fill,
        mixture::unlike_in,
        pressure::{REST_M_S, Telling, masses},
        step::Part,
    },
};

/// Liquid that keeps less than this part of a push once it is projected is shut in: what it keeps
/// is rounding.
const SHUT_IN: f64 = 1e-3;

impl Flow {
    /// Sets what liquid at rest does with a push, in units of a cell's mass times velocity, of
    /// which friction then takes what it does implicitly in `thick_s`. Returns the mean around the
    /// body.
    pub(super) fn respond(
        &mut self,
        coupling: &mut Coupling,
        push: DVec3,
        thick_s: f64,
        report: &mut StepReport,
    ) -> DVec3 {
        let Coupling { drag, response, friction, pressure, .. } = coupling;
        let number = self.diffusion_number(thick_s);
        let centre = self.in_cells(drag.centre_in_world_m);
        let radius = drag.radius_m / self.grid.spacing_m;
        // What moving solids do is done already.
        let vessel = self.faces.vessel.as_mut();
        let solids = vessel.and_then(|vessel| vessel.solids.take());
        let Self { layout, faces, ghosts, stage: [rhs, _], projection, viscous, mixture, .. } =
            self;
        let on = Engine { pool: &self.pool, simd: self.simd, faces };
        *friction = 0.0;
        response.iter_mut().for_each(|u| u.fill(0.0));
        let density = mixture.as_ref().and_then(|mixture| mixture.weight());
        let kernel = Kernel::new(layout, faces, masses(faces, density), centre, radius);
        kernel.push(response.each_mut().map(|u| &mut **u), push, f32::MAX);
        response.iter_mut().for_each(|u| ghosts.wrap_cells(u));
        let pushed = kernel.gather(components(response));
        let projected = projection.project(on, ghosts, response, Telling::Nothing, density, true);
        report.pressure_iterations += projected.iterations;
        let mut moved = kernel.gather(components(response));
        if moved.dot(push) < SHUT_IN * pushed.dot(push) {
            response.iter_mut().for_each(|u| u.fill(0.0));
            moved = DVec3::ZERO;
        } else if number > 0.0 {
            pressure.copy_from_slice(projection.found());
            std::mem::swap(response, rhs);
            ghosts.fill(rhs, Fill::Difference);
            response.iter_mut().for_each(|u| u.fill(0.0));
            if let Some(obstacles) = &mut self.obstacles {
                obstacles.keep(faces, rhs, 0);
            }
            let mixture = mixture.as_mut();
            let thick = mixture.and_then(|mixture| mixture.thick_somewhere());
            *friction = if thick.is_some() { thick_s } else { number };
            report.viscous_iterations += match (thick, viscous) {
                (Some(thick), _) => thick.advance(on, ghosts, [0.0, thick_s as f32], rhs, response),
                (None, Some(viscous)) => {
                    let (s, room) = (*friction as f32, projection.room());
                    viscous.solve(on, ghosts, room, s, rhs, response)
                }
                (None, None) => 0,
            };
            ghosts.fill(response, Fill::Difference);
            if let Some(obstacles) = &mut self.obstacles {
                obstacles.keep(faces, response, 1);
            }
            let density = self.mixture.as_ref().and_then(|mixture| mixture.weight());
            let projected =
                projection.project(on, ghosts, response, Telling::Nothing, density, true);
            report.pressure_iterations += projected.iterations;
            let kernel = Kernel::new(layout, faces, masses(faces, density), centre, radius);
            moved = kernel.gather(components(response));
        }
        if let Some(vessel) = &mut self.faces.vessel {
            vessel.solids = solids;
        }
        moved
    }

    /// Adds `share` of a response to the velocity and to what is known of pressure and obstacles.
    pub(super) fn take_response(
        &mut self,
        coupling: &Coupling,
        share: f64,
        part: Part,
        scheme: Scheme,
    ) {
        let friction = coupling.friction;
        // More than f32 has is asked of liquid that stands still only: nothing else gives way so
        // little.
        let share = share.clamp(f64::from(f32::MIN), f64::from(f32::MAX));
        let Self { layout, faces, ghosts, velocity, pool, simd, projection, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        add(on, layout, velocity, share as f32, components(&coupling.response));
        if let Some(obstacles) = &mut self.obstacles {
            obstacles.press(layout, faces, projection.found(), share);
            if friction > 0.0 {
                obstacles.press(layout, faces, &coupling.pressure, share);
                let unlike = unlike_in(self.mixture.as_deref());
                obstacles.count_response(layout, faces, friction, share, unlike);
            }
        }
        // The push comes without its own divergence. What friction at walls makes of it anew is
        // like that of the free part: the next one may expect it.
        if scheme == Scheme::MultistepImplicit && friction > 0.0 {
            projection.learn(on, ghosts, &mut self.pressure, (share / part.dt_s) as f32);
        }
    }
}

/// velocity += share response, beyond the last plane too; what is nearly at rest is.
fn add(on: Engine<'_>, layout: &Layout, velocity: &mut Vector, share: f32, response: [&[f32]; 3]) {
    let outs = velocity.each_mut().map(|u| &mut u[layout.plane..]);
    on.pool.planes(outs, [layout.plane; 3], |k, outs| {
        on.simd.vectorize(
            #[inline(always)]
            || {
                for (u, response) in outs.into_iter().zip(response) {
                    let response = cut(response, (k + 1) * layout.plane, layout.plane);
                    let u = cut_mut(u, 0, layout.plane);
                    for i in 0..u.len() {
                        let next = u[i] + share * response[i];
                        u[i] = if next.abs() < REST_M_S { 0.0 } else { next };
                    }
                }
            },
        );
    });
}
