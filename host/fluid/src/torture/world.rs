//! The liquid of a case, and all that is done to it, through nothing but the crate's public API.
//!
//! What a case draws and the solver has no API for yet is named in [`NOT_TAKEN`]: this file is
//! the one place to give it to the solver once it has.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use oorandom::Rand64;

use super::draw::{Case, direction, log_uniform};
use crate::{
    pool::Pool,
    simd::SimdClass,
    solver::{
        Motion, Obstacle, ObstacleId, Refused, Setup, SetupError, Side, Solver, StepReport,
        flow::Flow,
    },
    substance::{Substances, TransportReport},
};

/// Farthest that a push reaches, in cells.
const WIDEST_PUSH_CELLS: f64 = 8.0;

/// Steps in which the body force is on, and then off.
const FORCE_BLOCK: usize = 8;

/// Something that is drawn, and whether a case has it.
type Drawn = (&'static str, fn(&Case) -> bool);

/// What is drawn and not taken yet.
pub const NOT_TAKEN: &[Drawn] = &[];

/// A case that runs.
pub struct World<'a> {
    /// What is done.
    pub case: &'a Case,
    /// What the flow was made from.
    pub setup: Setup,
    /// The liquid.
    pub flow: Flow,
    /// What is in it.
    pub substances: Substances,
    /// The ball that jumps, where it is, and how often it has.
    ball: Option<(ObstacleId, Vec3)>,
    jumps: usize,
    draws: Rand64,
}

impl<'a> World<'a> {
    /// The liquid of a case in its first flow, which is free of divergence.
    ///
    /// # Errors
    /// [`SetupError`] if the solver refuses the case.
    pub fn new(case: &'a Case, pool: &Arc<Pool>, simd: SimdClass) -> Result<Self, SetupError> {
        let setup = Setup {
            density_kg_m3: case.density_kg_m3,
            viscosity_m2_s: case.viscosity_m2_s,
            gravity_m_s2: Vec3::NEG_Y * case.gravity_m_s2,
            sides: case.sides,
            walls: case.walls,
            pool: Arc::clone(pool),
            simd,
            ..Setup::new(case.grid, case.vessel.clone())
        };
        let properties: Vec<_> = case.substances.iter().map(|s| s.properties).collect();
        let mut world = Self {
            case,
            flow: Flow::new(&setup)?,
            substances: Substances::new(&setup, &properties),
            setup,
            ball: None,
            jumps: 0,
            // Not the stream that the case itself was drawn from.
            draws: Rand64::new(u128::from(case.seed) ^ (1 << 100)),
        };
        let (per_m, speed_m_s) = (world.wave_per_m(), case.speed_m_s() / 3.0);
        world.flow.set_velocity(&|p| speed_m_s * swirl(per_m * p))?;
        world.flow.project();
        if let Some(ball) = case.obstacle {
            let at = world.place();
            let id = world.flow.add_obstacle(Obstacle::sphere(at, ball.radius_m))?;
            world.ball = Some((id, at));
        }
        world.flow.set_force(&|p| case.acceleration_m_s2 * swirl(2.0 * per_m * p))?;
        Ok(world)
    }

    /// A few waves along each edge.
    fn wave_per_m(&self) -> DVec3 {
        let waves = self.case.grid.cells.map(|n| (n as f64 / 4.0).clamp(0.5, 3.0));
        std::f64::consts::TAU * DVec3::from_array(waves) / self.case.grid.extent_m().as_dvec3()
    }

    /// The acceleration at a point while the force is on.
    pub fn acceleration_m_s2(&self, point: DVec3) -> DVec3 {
        self.case.acceleration_m_s2 * swirl(2.0 * self.wave_per_m() * point)
    }

    /// Somewhere in the box, or a little beside it.
    fn place(&mut self) -> Vec3 {
        let mut share = || 1.1 * self.draws.rand_float() as f32 - 0.05;
        let share = Vec3::new(share(), share(), share());
        self.case.grid.origin_in_world_m + share * self.case.grid.extent_m()
    }

    /// A push that changes the mean velocity around a point at once. Returns true if it did.
    pub fn jerk(&mut self, step: usize) -> Result<bool, Refused> {
        if !step.is_multiple_of(self.case.jerk_every) {
            return Ok(false);
        }
        let at = self.place();
        let cells = log_uniform(&mut self.draws, [1.0, WIDEST_PUSH_CELLS]) as f32;
        let radius_m = cells * self.case.grid.spacing_m;
        let change_m_s = direction(&mut self.draws).as_dvec3() * self.case.jerk_m_s;
        let mass_kg = self.flow.effective_mass_kg(at, radius_m);
        // Out of the liquid's reach any push has to be as good as none.
        let mass_kg = if mass_kg.is_finite() { mass_kg } else { 1.0 };
        self.flow.push(at, radius_m, change_m_s * mass_kg)?;
        Ok(true)
    }

    /// Turns the body force on and off. Returns the largest scale within the next step.
    pub fn force(&mut self, step: usize) -> Result<f64, Refused> {
        let is_on = |step: usize| (step / FORCE_BLOCK) % 2 == 1;
        let [start, end] = [step, step + 1].map(|step| f64::from(u8::from(is_on(step))));
        self.flow.scale_force(start, end)?;
        Ok(if self.case.acceleration_m_s2 > 0.0 { start.max(end) } else { 0.0 })
    }

    /// Turns the sources on at every even step, and the drain at every odd one.
    pub fn pour_or_drain(&mut self, step: usize) -> Result<(), Refused> {
        let (dt_s, radius_m) = (self.case.dt_s, 3.0 * self.case.grid.spacing_m);
        for (index, substance) in self.case.substances.iter().enumerate() {
            let at = self.place();
            let rate_per_s = (substance.poured_per_step / dt_s) as f32;
            if step.is_multiple_of(2) {
                self.substances.pour(index, at, radius_m, rate_per_s, dt_s)?;
            } else if index == 0 {
                self.substances.drain(at, radius_m, rate_per_s, dt_s)?;
            }
        }
        Ok(())
    }

    /// The ball jumps to another place, and every other time has a speed there, too. Returns the
    /// speed that it has.
    pub fn jump_obstacle(&mut self, step: usize) -> Result<f64, Refused> {
        let (Some((id, _)), Some(ball)) = (self.ball, self.case.obstacle) else { return Ok(0.0) };
        if step.is_multiple_of(ball.jumps_every) {
            let (at, way) = (self.place(), direction(&mut self.draws));
            self.jumps += 1;
            let speed_m_s = if self.jumps.is_multiple_of(2) { self.case.jerk_m_s } else { 0.0 };
            self.ball = Some((id, at));
            self.flow.move_obstacle(id, Motion::moving(at, way * speed_m_s as f32))?;
        }
        Ok(if self.jumps.is_multiple_of(2) && self.jumps > 0 { self.case.jerk_m_s } else { 0.0 })
    }

    /// Mass of a cell full of the densest that there may be.
    pub fn heaviest_cell_kg(&self) -> f64 {
        let densities = self.case.substances.iter().map(|s| s.properties.density_kg_m3);
        let densest = f64::from(densities.fold(self.case.density_kg_m3, f32::max));
        densest * f64::from(self.case.grid.cell_volume_m3())
    }

    /// Half of all mass there may be, times gravity squared: what it gives from rest in 1 s. 0
    /// where nothing is denser or lighter than the liquid.
    pub fn gravity_j_s2(&self) -> f64 {
        let liquid = self.case.density_kg_m3;
        if self.case.substances.iter().all(|s| s.properties.density_kg_m3 == liquid) {
            return 0.0;
        }
        // Half of what passes an open lid is beyond it.
        let [nx, _, nz] = self.case.grid.cells;
        let above = if self.case.sides.0[1][1] == Side::Outflow { nx * nz } else { 0 };
        let mass_kg = (self.flow.liquid_cells() + above) as f64 * self.heaviest_cell_kg();
        0.5 * mass_kg * f64::from(self.case.gravity_m_s2).powi(2)
    }

    /// Advances the liquid, and what is in it with it.
    pub fn step(&mut self, dt_s: f64) -> Result<(StepReport, TransportReport), Refused> {
        self.flow.set_mixture(&self.substances);
        let report = self.flow.step(dt_s)?;
        Ok((report, self.substances.step(&self.flow, dt_s)?))
    }

    /// Stops force and gravity, and takes out the ball: what is left comes to rest.
    pub fn leave_alone(&mut self) -> Result<(), Refused> {
        if let Some((id, _)) = self.ball.take() {
            self.flow.remove_obstacle(id)?;
        }
        self.flow.set_gravity_m_s2(Vec3::ZERO)?;
        self.flow.scale_force(0.0, 0.0)
    }

    /// All that is stored, as one number that any changed bit changes.
    pub fn fingerprint(&self) -> u64 {
        // FNV-1a (Fowler, Noll, Vo), by values instead of bytes.
        let mix = |hash: u64, bits: u64| (hash ^ bits).wrapping_mul(0x0100_0000_01b3);
        let mut hash = 0xcbf2_9ce4_8422_2325;
        self.flow.visit(&mut |_, _, value| hash = mix(hash, value.to_bits()));
        let mut fractions = vec![0.0; self.case.grid.len()];
        for index in 0..self.substances.len() {
            self.substances.copy_fraction(index, &mut fractions);
            hash = fractions.iter().fold(hash, |hash, f| mix(hash, u64::from(f.to_bits())));
        }
        hash
    }

    /// A draw for whoever tortures this world.
    pub fn draw(&mut self, below: usize) -> usize {
        self.draws.rand_range(0..below as u64) as usize
    }
}

/// Three waves that are nowhere above 1, free of divergence.
fn swirl(phase: DVec3) -> DVec3 {
    DVec3::new(phase.y.sin(), phase.z.cos(), phase.x.sin())
}
