//! The force on obstacles: what walls and pressure took from the liquid's momentum.
//!
//! ```text
//! pressure:  sum over covered faces of (1 - a) (p_(i-1) - p_i),      p = 0 in the solid
//! walls:     -sum over faces beside it of [ a du - what open neighbours gave ]
//! ```
//! Both are exact for the scheme: the first is the sum by parts of the pressure's gradient on
//! open faces, in the second the neighbours' exchange of momentum adds up to nothing over all
//! faces. It holds friction, and also what the inertia of faces beside a wall
//! (see [`super::walls`]), which is more than their liquid's, takes of their momentum.
//! Amounts are in units of velocity times the mass of a cell, full of liquid of the density that
//! the flow counts by; where densities weigh, du is by that of the face.

use glam::{DVec3, Vec3};

use crate::solver::{
    Motion,
    flow::{
        faces::Faces,
        field::{Layout, Vector},
        mixture::{Mixture, Unlike},
        momentum::Stage,
        obstacles::{Body, Obstacles},
        thick::Thick,
        walls::{WallFace, Weights},
    },
};

/// A force, or an impulse, and its moment about the centre of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    pub force: DVec3,
    pub torque: DVec3,
}

impl Wrench {
    /// None.
    pub const ZERO: Self = Self { force: DVec3::ZERO, torque: DVec3::ZERO };

    fn add(&mut self, share: f64, other: Self) {
        self.force += share * other.force;
        self.torque += share * other.torque;
    }

    fn scaled(self, by: f64) -> Self {
        Self { force: by * self.force, torque: by * self.torque }
    }
}

/// What a body was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Account {
    /// In the step so far.
    sum: Wrench,
    /// What was measured last, and before that, in a second.
    rate: [Wrench; 2],
    /// Mean over the last step, in newtons and newton metres.
    pub mean: Wrench,
}

impl Default for Account {
    fn default() -> Self {
        Self { sum: Wrench::ZERO, rate: [Wrench::ZERO; 2], mean: Wrench::ZERO }
    }
}

/// Whether what viscosity does is known at once, or solved for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Viscosity {
    Explicit,
    Implicit,
}

/// What came of an implicit part, beside a face.
#[derive(Clone, Copy)]
pub struct Solved<'a> {
    /// nu dt / h^2, and the part of it that acted on the change; where friction differs from place
    /// to place, what is left of them without nu / h^2.
    pub number: f64,
    pub s: f64,
    /// What pushed: the pressure per density and spacing, and the force, both times these.
    pub pressure: Option<(&'a [f32], f64)>,
    pub force: Option<([&'a [f32]; 3], f64)>,
    /// What the liquid is there.
    pub unlike: Unlike<'a>,
}

impl Unlike<'_> {
    /// Drag of the wall beside a face, in units of nu / h^2 if that is the same everywhere.
    fn drag(&self, c: usize, face: &WallFace) -> f64 {
        let differs = |thick: &Thick| thick.friction(c, face.at as usize)[1];
        f64::from(self.friction.map_or(face.drag, differs))
    }
}

impl Obstacles {
    /// Adds up, as new rates, what walls give the liquid: `gift(component, face, wall's velocity)`
    /// for all faces beside a body.
    fn gather(
        &mut self,
        layout: &Layout,
        faces: &Faces,
        mut gift: impl FnMut(usize, &WallFace, Vec3) -> f64,
    ) {
        let Some(vessel) = &faces.vessel else { return };
        self.bodies.iter_mut().for_each(|body| body.account.rate[0] = Wrench::ZERO);
        for c in 0..3 {
            for face in vessel.walls.of_component(c) {
                let Some(owner) = face.owner else { continue };
                let Some(index) = self.bodies.iter().position(|body| body.id == owner) else {
                    continue;
                };
                let (wall_m_s, arm) =
                    self.wall_at(layout, c, face.at as usize, &self.bodies[index]);
                let given = gift(c, face, wall_m_s);
                self.bodies[index].account.rate[0].add(-given, of_axis(c, arm.as_dvec3()));
            }
        }
    }

    /// Measures what the walls give the liquid in a stage of this length; in 1 s, as rates.
    pub fn measure(
        &mut self,
        faces: &Faces,
        stage: Stage<'_>,
        time_s: f32,
        how: Viscosity,
        unlike: Unlike<'_>,
    ) {
        let Some(vessel) = &faces.vessel else { return };
        let weights = Weights::of(stage.terms, time_s);
        self.gather(&stage.layout, faces, |c, face, wall_m_s| {
            let at = face.at as usize;
            let advection = f64::from(weights.advection) * unlike.density_at(&stage.layout, c, at);
            let [carried, carried_on] = face
                .advection(&stage, &vessel.area, c, wall_m_s)
                .map(|flux| advection * f64::from(flux));
            if how == Viscosity::Implicit {
                return carried - carried_on;
            }
            let u = stage.velocity[c];
            let more_m_s = f64::from(wall_m_s[c]) - f64::from(u[at]);
            let [exchanged, pull] = match unlike.friction {
                Some(thick) => {
                    let [friction, drag] = thick.friction(c, at).map(f64::from);
                    let kept = drag * f64::from(u[at]) - friction;
                    [kept, drag * more_m_s].map(|rate| f64::from(time_s) * rate)
                }
                None => {
                    let viscous =
                        f64::from(weights.viscous) * unlike.density_at(&stage.layout, c, at);
                    let kept = face.around(&stage.layout, u) - face.area() * u[at];
                    [viscous * f64::from(kept), viscous * f64::from(face.drag) * more_m_s]
                }
            };
            let share = f64::from(vessel.area[c][at] * face.per_inertia);
            share * (carried + exchanged + pull) - (carried_on + exchanged)
        });
    }

    /// Adds what was measured last, and before, by these weights.
    pub fn count(&mut self, new: f64, old: f64) {
        for Account { sum, rate, .. } in self.bodies.iter_mut().map(|body| &mut body.account) {
            sum.add(new, rate[0]);
            sum.add(old, rate[1]);
            rate[1] = rate[0];
        }
    }

    /// Keeps the velocities beside bodies from before an implicit part (0) or after it (1).
    pub fn keep(&mut self, faces: &Faces, velocity: &Vector, when: usize) {
        let Some(vessel) = &faces.vessel else { return };
        for (c, kept) in self.beside[when].iter_mut().enumerate() {
            kept.clear();
            let owned = vessel.walls.of_component(c).filter(|face| face.owner.is_some());
            kept.extend(owned.map(|face| velocity[c][face.at as usize]));
        }
    }

    /// Counts what walls gave in an implicit part.
    pub fn count_solved(&mut self, layout: &Layout, faces: &Faces, solved: Solved<'_>) {
        let Some(vessel) = &faces.vessel else { return };
        let [before, after] = std::mem::take(&mut self.beside);
        let mut places = [0; 3];
        self.gather(layout, faces, |c, face, wall_m_s| {
            let place = places[c];
            places[c] += 1;
            let (at, drag) = (face.at as usize, solved.unlike.drag(c, face));
            let density = solved.unlike.density_at(layout, c, at);
            let here = f64::from(before[c][place]);
            let change = f64::from(after[c][place]) - here;
            let pressed = solved.pressure.map_or(0.0, |(p, dt_s)| {
                dt_s * (f64::from(p[at - layout.strides()[c]]) - f64::from(p[at])) / density
            });
            let forced = solved.force.map_or(0.0, |(f, push_s)| push_s * f64::from(f[c][at]));
            let lacking = f64::from(vessel.area[c][at]) - f64::from(face.inertia);
            density * lacking * (change - pressed - forced)
                + solved.number * drag * (f64::from(wall_m_s[c]) - here)
                - solved.s * drag * change
        });
        self.beside = [before, after];
        for Account { sum, rate, .. } in self.bodies.iter_mut().map(|body| &mut body.account) {
            sum.add(1.0, rate[0]);
        }
    }

    /// Counts `share` of what walls gave to a push that was kept before and after friction acted on
    /// it, with s as in [`Solved`]: they met it at rest.
    pub fn count_response(
        &mut self,
        layout: &Layout,
        faces: &Faces,
        s: f64,
        share: f64,
        unlike: Unlike<'_>,
    ) {
        let Some(vessel) = &faces.vessel else { return };
        let [before, after] = std::mem::take(&mut self.beside);
        let mut places = [0; 3];
        self.gather(layout, faces, |c, face, _| {
            let [before, after] = [&before, &after].map(|kept| f64::from(kept[c][places[c]]));
            places[c] += 1;
            let at = face.at as usize;
            let lacking = f64::from(vessel.area[c][at]) - f64::from(face.inertia);
            unlike.density_at(layout, c, at) * lacking * (after - before)
                - s * unlike.drag(c, face) * after
        });
        self.beside = [before, after];
        for Account { sum, rate, .. } in self.bodies.iter_mut().map(|body| &mut body.account) {
            sum.add(share, rate[0]);
        }
    }

    /// Counts a pressure, per density and spacing, times `share`.
    pub fn press(&mut self, layout: &Layout, faces: &Faces, pressure: &[f32], share: f64) {
        let Some(solids) = faces.solids() else { return };
        self.displacing_m2_s2 -= share * solids.displaced_by(pressure);
        for c in 0..3 {
            for face in solids.covered(c) {
                let at = face.at as usize;
                let rise = f64::from(pressure[at - layout.strides()[c]]) - f64::from(pressure[at]);
                if rise == 0.0 {
                    continue;
                }
                let Some(index) = self.bodies.iter().position(|body| body.id == face.owner) else {
                    continue;
                };
                let (_, arm) = self.wall_at(layout, c, at, &self.bodies[index]);
                let given = share * f64::from(face.part) * rise;
                self.bodies[index].account.sum.add(given, of_axis(c, arm.as_dvec3()));
            }
        }
    }

    /// What bodies did to the liquid in the last step, whose sums are of this mass: by the force on
    /// them, or, if that is more, by what pressure met in all that they displaced. The first knows
    /// of friction, the second also of what liquid that is shut in gave up.
    pub fn work_j(&mut self, mass_kg: f64, dt_s: f64) -> f64 {
        let power_w = |body: &Body| {
            let (Motion { velocity_m_s, angular_velocity_rad_s, .. }, mean) =
                (body.obstacle.motion, body.account.mean);
            mean.force.dot(velocity_m_s.as_dvec3())
                + mean.torque.dot(angular_velocity_rad_s.as_dvec3())
        };
        let by_force_j = -dt_s * self.bodies.iter().map(power_w).sum::<f64>();
        by_force_j.max(mass_kg * std::mem::take(&mut self.displacing_m2_s2))
    }

    /// Adds to the forces what gravity lifts by beyond what it would in liquid of the density that
    /// the flow counts by: the pressure that it makes of what floats at each level is in no other.
    pub fn lift(
        &mut self,
        layout: &Layout,
        faces: &Faces,
        mixture: &Mixture,
        cell_weight_n: DVec3,
    ) {
        let Some(solids) = faces.solids() else { return };
        for c in (0..3).filter(|c| cell_weight_n[*c] != 0.0) {
            for face in solids.covered(c) {
                let at = face.at as usize;
                let Some(floating) = mixture.floating(c, layout.cell_of(at)[c]) else { continue };
                let Some(index) = self.bodies.iter().position(|body| body.id == face.owner) else {
                    continue;
                };
                let (_, arm) = self.wall_at(layout, c, at, &self.bodies[index]);
                let given = -f64::from(face.part) * (f64::from(floating) - 1.0) * cell_weight_n[c];
                self.bodies[index].account.mean.add(given, of_axis(c, arm.as_dvec3()));
            }
        }
    }

    /// Ends a step: `per_s` turns sums into forces.
    pub fn close(&mut self, per_s: f64) {
        for account in self.bodies.iter_mut().map(|body| &mut body.account) {
            account.mean = account.sum.scaled(per_s);
            account.sum = Wrench::ZERO;
        }
    }
}

/// A unit of force along an axis at a place.
fn of_axis(c: usize, arm: DVec3) -> Wrench {
    let force = DVec3::AXES[c];
    Wrench { force, torque: arm.cross(force) }
}
