//! The surface of the liquid: what is seen rippling, and what the probe presses on.
//!
//! ```text
//! touch, press -> load -> model.step -> heights and speeds at the nodes -> at, view
//! ```
//! How it moves is up to a model of the [`INDEX`]. All move without changing the volume below;
//! what comes and goes as drops is the level, which is kept here.

mod drift;
mod lattice;
mod model;
mod orbits;
mod own;
mod params;
mod round;
mod spring;
mod tear;
mod touch;
mod wave;

pub use drift::Fading;
pub use lattice::Lattice;
pub use model::{AUTO, Basin, INDEX, Load, Make, Model, ModelRow, choose, names};
pub use params::SurfaceParams;
pub use tear::Weight;
pub use touch::{Act, Answer, Touch};

use glam::Vec3;

use self::{orbits::Orbits, own::Own, tear::Change, touch::Acting};
use crate::{simd::SimdClass, snapshot::SurfaceView, solver::SetupError};

/// Heights below this, and speeds of as many metres a second, are rest.
const REST: f32 = 1e-7;

/// No height above this is kept, nor a speed of as many metres a second.
const MOST: f32 = 1e4;

/// Steps that are looked ahead at most.
const MOST_STEPS_AHEAD: f32 = 8.0;

/// What a step did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SurfaceReport {
    /// Steps that the model took; none while asleep.
    pub substeps: u32,
    /// 1 if what moved beyond all measure was slowed down.
    pub guard_actions: u32,
}

/// The surface.
pub struct Surface {
    params: SurfaceParams,
    lattice: Lattice,
    model: Box<dyn Model>,
    height_m: Vec<f32>,
    speed_m_s: Vec<f32>,
    /// What acts in the next step, and what did in the last.
    acting: [Acting; 2],
    /// What the probe's own push makes of it, while it leans on it.
    own: Own,
    /// Length of the last step.
    last_s: f32,
    /// Area of all wet nodes.
    wet_m2: f64,
    /// Height of the whole above rest, by what left and fell in.
    level_m: f64,
    /// Fastest speed and highest height, as magnitudes.
    extremes: [f32; 2],
    change: Change,
    under: Vec<(usize, f32)>,
    fading: Fading,
    /// Heights and speeds of the moment that was looked ahead to; empty before.
    then: [Vec<f32>; 2],
    /// State of the model while it looks ahead.
    kept: [Vec<f32>; 2],
    orbits: Orbits,
    simd: SimdClass,
    asleep: bool,
}

impl Surface {
    /// A surface at rest on the top of the grid's box.
    ///
    /// # Errors
    /// [`SetupError`] if there is no such model, or it knows nothing of such a vessel.
    pub fn new(params: SurfaceParams, basin: &Basin<'_>) -> Result<Self, SetupError> {
        let row = choose(params.model, basin.vessel, basin.grid)?;
        let params = SurfaceParams { model: row.name, ..params };
        let lattice = Lattice::over(basin.grid, basin.vessel, params.nodes_per_cell.max(1));
        let zeros = || vec![0.0; lattice.len()];
        Ok(Self {
            model: (row.make)(&params, &lattice, basin)?,
            height_m: zeros(),
            speed_m_s: zeros(),
            acting: Default::default(),
            own: Own::default(),
            last_s: 0.0,
            wet_m2: f64::from(lattice.node_m2()) * lattice.wet_count() as f64,
            level_m: 0.0,
            extremes: [0.0; 2],
            change: Change::default(),
            under: Vec::new(),
            fading: Fading::default(),
            then: [Vec::new(), Vec::new()],
            kept: [Vec::new(), Vec::new()],
            orbits: Orbits::new(basin.grid),
            simd: basin.simd,
            asleep: true,
            params,
            lattice,
        })
    }

    /// What the surface is made of, and the model that was taken.
    #[must_use]
    pub fn params(&self) -> &SurfaceParams {
        &self.params
    }

    /// Where its nodes stand.
    #[must_use]
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Memory that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let arrays = [&self.height_m, &self.speed_m_s].into_iter().chain(&self.then);
        let nodes = arrays.chain(&self.kept).map(|a| size_of_val(a.as_slice())).sum::<usize>();
        let acting = self.acting.iter().map(Acting::bytes).sum::<usize>();
        nodes + acting + self.own.bytes() + self.lattice.len() + self.model.bytes()
    }

    /// True while nothing moves, and a step costs nothing.
    #[must_use]
    pub fn is_asleep(&self) -> bool {
        self.asleep
    }

    /// World y of the surface at rest.
    #[must_use]
    pub fn rest_height_in_world_m(&self) -> f32 {
        self.lattice.origin_in_world_m.y
    }

    /// Heights of all nodes above [`Surface::level_m`].
    #[must_use]
    pub fn height_m(&self) -> &[f32] {
        &self.height_m
    }

    /// Vertical speeds of all nodes.
    #[must_use]
    pub fn speed_m_s(&self) -> &[f32] {
        &self.speed_m_s
    }

    /// Energy in joules: of motion, of height, and of tension.
    #[must_use]
    pub fn energy_j(&self) -> f64 {
        if self.asleep { 0.0 } else { self.model.energy_j() }
    }

    /// Sets height and vertical speed at each place of x and z in world metres. The mean of both
    /// is left out, and so is what the model cannot tell.
    pub fn set(&mut self, height_m: impl Fn(f32, f32) -> f32, speed_m_s: impl Fn(f32, f32) -> f32) {
        for node in 0..self.lattice.len() {
            let (at, wet) = (self.lattice.in_world_m(node), self.lattice.wet[node]);
            let known = |value: f32| if wet && value.is_finite() { value } else { 0.0 };
            self.height_m[node] = known(height_m(at.x, at.z));
            self.speed_m_s[node] = known(speed_m_s(at.x, at.z));
        }
        self.own.forget();
        self.model.scale(0.0);
        self.model.add(&self.height_m, &self.speed_m_s);
        self.asleep = false;
        self.look();
    }

    /// What a probe of some radius does to the surface at a world place during the next step: it
    /// pushes by a vertical force in newtons, and damps what is under it. Nodes under the probe
    /// share both, most in its middle; what is not finite, or beside the liquid, is left out.
    pub fn touch(&mut self, at_m: Vec3, radius_m: f32, force_n: f32, damping_n_s_per_m: f32) {
        let idle = force_n == 0.0 && self.asleep;
        if !idle && (force_n + damping_n_s_per_m).is_finite() {
            self.put(at_m, radius_m, Touch { force_n, damping_n_s_per_m, ..Touch::default() });
        }
    }

    /// What the hand's probe does: as [`Surface::touch`], but what its push makes of the surface
    /// is left out of what [`Surface::ahead`] tells, for as long as it leans on it in every step,
    /// be it by a force of 0: the spring that the hand feels is the whole dent already.
    pub fn lean(&mut self, at_m: Vec3, radius_m: f32, force_n: f32, damping_n_s_per_m: f32) {
        let idle = force_n == 0.0 && self.asleep;
        if !idle && (force_n + damping_n_s_per_m).is_finite() {
            let push = Touch { force_n, damping_n_s_per_m, ..Touch::default() };
            self.asleep &= !self.acting[0].lean(&self.lattice, at_m, radius_m, push);
        }
    }

    /// Gives what is under a probe `energy_j` at once: up if it is positive, down if not. So what
    /// a torn membrane held becomes a wave.
    pub fn kick(&mut self, at_m: Vec3, radius_m: f32, energy_j: f32) {
        if energy_j != 0.0 && energy_j.is_finite() {
            self.put(at_m, radius_m, Touch { kick_j: energy_j, ..Touch::default() });
        }
    }

    fn put(&mut self, at_m: Vec3, radius_m: f32, touch: Touch) {
        self.asleep &= !self.acting[0].put(&self.lattice, at_m, radius_m, touch);
    }

    /// The liquid presses from below during the next step, by a pressure in pascal at each place
    /// in world metres; one that is not finite counts as 0.
    pub fn press(&mut self, pressure_pa: impl Fn(Vec3) -> f32) {
        self.asleep &= !self.acting[0].press(&self.lattice, pressure_pa);
    }

    /// One step. If its length is not positive or not finite nothing moves, and what was to act in
    /// it is gone.
    pub fn step(&mut self, dt_s: f32) -> SurfaceReport {
        if self.asleep {
            return SurfaceReport::default();
        }
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            self.acting[0].clear();
            return SurfaceReport::default();
        }
        match self.acting[0].leaning() {
            Some(push) => self.own.step(&mut *self.model, push, dt_s),
            None => self.own.forget(),
        }
        let substeps = self.model.step(dt_s, self.acting[0].load());
        self.acting.swap(0, 1);
        self.acting[0].clear();
        self.acting[1].calm();
        self.last_s = dt_s;
        SurfaceReport { substeps, guard_actions: self.look() }
    }

    /// Reads the nodes. What is at rest falls asleep; what left all measure is slowed down,
    /// which is returned as 1.
    fn look(&mut self) -> u32 {
        self.model.read(&mut self.height_m, &mut self.speed_m_s);
        self.extremes = [&self.speed_m_s, &self.height_m].map(|field| largest(self.simd, field));
        let [fastest, highest] = self.extremes;
        let (rest, guarded) = match if highest < fastest { fastest } else { highest } {
            most if most < REST => (true, 0),
            ..=MOST => (false, 0),
            most if most.is_finite() => {
                self.own.forget();
                self.model.scale(0.5 * MOST / most);
                self.model.read(&mut self.height_m, &mut self.speed_m_s);
                (false, 1)
            }
            _ => (true, 1),
        };
        if rest {
            self.own.forget();
            self.model.scale(0.0);
            self.height_m.fill(0.0);
            self.speed_m_s.fill(0.0);
            self.orbits.rest();
            self.asleep = true;
        }
        guarded
    }

    /// Height above rest and vertical speed at a world place, in m and m/s.
    #[must_use]
    pub fn at(&self, at_in_world_m: Vec3) -> (f32, f32) {
        if self.asleep {
            return (self.level_m(), 0.0);
        }
        let [height_m, speed_m_s] = [&self.height_m, &self.speed_m_s]
            .map(|field| self.lattice.between(field, at_in_world_m));
        (self.level_m() + height_m, speed_m_s)
    }

    /// Height of the whole above rest: what drops brought and took, spread over it.
    #[must_use]
    pub fn level_m(&self) -> f32 {
        self.level_m as f32
    }

    /// Volume above rest: below, if more left by drops than fell in.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        let waves: f64 = self.height_m.iter().map(|y| f64::from(*y)).sum();
        waves * f64::from(self.lattice.node_m2()) + self.level_m * self.wet_m2
    }

    /// Looks ahead: what [`Surface::ahead`] tells is of the moment `ahead_s` from now, if what
    /// acted in the last step goes on acting until then, and what is sudden does not come again.
    /// What a probe that leans on the surface made of it is left out.
    pub fn look_ahead(&mut self, ahead_s: f32) {
        if self.asleep || self.last_s <= 0.0 || !(ahead_s > 0.0 && ahead_s.is_finite()) {
            self.then.iter_mut().for_each(Vec::clear);
            return;
        }
        let steps = (ahead_s / self.last_s).ceil().clamp(1.0, MOST_STEPS_AHEAD);
        self.kept.iter_mut().zip(self.model.state()).for_each(|(to, now)| to.clone_from(now));
        self.own.take_from(&mut *self.model);
        for _ in 0..steps as u32 {
            self.model.step(ahead_s / steps, self.acting[1].load());
        }
        let [height_m, speed_m_s] = &mut self.then;
        height_m.resize(self.lattice.len(), 0.0);
        speed_m_s.resize(self.lattice.len(), 0.0);
        self.model.read(height_m, speed_m_s);
        self.model.state().into_iter().zip(&self.kept).for_each(|(to, kept)| to.clone_from(kept));
    }

    /// As [`Surface::at`], of the moment that was looked ahead to last.
    #[must_use]
    pub fn ahead(&self, at_in_world_m: Vec3) -> (f32, f32) {
        if self.asleep || self.then[0].is_empty() {
            return self.at(at_in_world_m);
        }
        let [height_m, speed_m_s] =
            self.then.each_ref().map(|field| self.lattice.between(field, at_in_world_m));
        (self.level_m() + height_m, speed_m_s)
    }

    /// Looks below: [`Surface::orbit_m_s`] tells what is at about this place.
    pub fn look_below(&mut self, at_in_world_m: Vec3) {
        let depth_m = self.rest_height_in_world_m() - at_in_world_m.y;
        if !self.asleep && depth_m.is_finite() {
            self.orbits.find(&mut *self.model, self.lattice.len(), depth_m);
        }
    }

    /// Velocity of the liquid by the waves above it, around where was looked last.
    #[must_use]
    pub fn orbit_m_s(&self, at_in_world_m: Vec3) -> Vec3 {
        self.orbits.at(&self.lattice, at_in_world_m)
    }

    /// What is drawn: it ends in the wall, not before.
    #[must_use]
    pub fn view(&self) -> SurfaceView {
        const RINGS_IN_WALL: usize = 2;
        let Lattice { nodes, spacing_m, origin_in_world_m: origin, .. } = self.lattice;
        SurfaceView {
            nodes,
            spacing_m,
            origin_in_world_m: [origin.x, origin.z],
            rest_height_in_world_m: origin.y + self.level_m(),
            height_m: self.lattice.spread(&self.height_m, RINGS_IN_WALL),
            layer_decay_m: self.params.layer_decay_m,
        }
    }
}

/// The largest magnitude; no number if one of them is none.
fn largest(simd: SimdClass, values: &[f32]) -> f32 {
    // As numbers of all bits but the sign's, magnitudes keep their order, with NaN above all.
    let most = simd.vectorize(
        #[inline(always)]
        || values.iter().fold(0, |most, v| most.max(v.to_bits() & !(1 << 31))),
    );
    f32::from_bits(most)
}

#[cfg(test)]
mod tests;
