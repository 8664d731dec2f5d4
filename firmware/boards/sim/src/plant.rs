//! The mechanism: a mass at the handle, friction, and motors that lag.

use glam::DVec3;

/// Steps of the plant in a tick of the servo.
const SUBSTEPS: u32 = 10;

/// What the mechanism is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantParams {
    /// Apparent mass at the handle.
    pub mass_kg: f64,
    /// Viscous friction.
    pub damping_n_s_per_m: f64,
    /// Coulomb friction.
    pub friction_n: f64,
    /// Time constant of the motor currents.
    pub motor_lag_s: f64,
}

impl PlantParams {
    /// A desktop stylus like the Phantom Omni: 45 g and 0.26 N at the handle.
    pub const OMNI_LIKE: Self =
        Self { mass_kg: 0.045, damping_n_s_per_m: 0.1, friction_n: 0.26, motor_lag_s: 0.5e-3 };
}

/// Where the handle is and how it moves, in device space.
#[derive(Clone, Debug)]
pub struct Plant {
    params: PlantParams,
    /// Position in metres.
    pub position_m: DVec3,
    /// Velocity in m/s.
    pub velocity_m_s: DVec3,
    motor_n: DVec3,
}

impl Plant {
    /// At rest at `position_m`.
    #[must_use]
    pub fn new(params: PlantParams, position_m: DVec3) -> Self {
        Self { params, position_m, velocity_m_s: DVec3::ZERO, motor_n: DVec3::ZERO }
    }

    /// Moves on by `tick_s` while the motors are asked for `command_n` at the handle and a hand
    /// that adds `hand_mass_kg` pushes by `hand_n(position, velocity)`.
    ///
    /// Symplectic Euler, v += a dt, x += v dt, in ten steps a tick. Coulomb friction takes at
    /// most the momentum that is there, so that it sticks instead of chattering.
    pub fn advance(
        &mut self,
        tick_s: f64,
        command_n: DVec3,
        hand_mass_kg: f64,
        hand_n: impl Fn(DVec3, DVec3) -> DVec3,
    ) {
        let dt_s = tick_s / f64::from(SUBSTEPS);
        let mass_kg = self.params.mass_kg + hand_mass_kg;
        let lag = dt_s / (dt_s + self.params.motor_lag_s);
        for _ in 0..SUBSTEPS {
            self.motor_n += (command_n - self.motor_n) * lag;
            let drag_n = -self.velocity_m_s * self.params.damping_n_s_per_m;
            let push_n = self.motor_n + drag_n + hand_n(self.position_m, self.velocity_m_s);
            let free_m_s = self.velocity_m_s + push_n * (dt_s / mass_kg);
            self.velocity_m_s = slowed(free_m_s, self.params.friction_n * dt_s / mass_kg);
            self.position_m += self.velocity_m_s * dt_s;
        }
    }
}

/// `velocity` made slower by `by`, to a stand at most.
fn slowed(velocity: DVec3, by: f64) -> DVec3 {
    let speed = velocity.length();
    if speed <= by { DVec3::ZERO } else { velocity * (1.0 - by / speed) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMOOTH: PlantParams =
        PlantParams { mass_kg: 0.1, damping_n_s_per_m: 0.5, friction_n: 0.0, motor_lag_s: 0.0 };

    fn run(plant: &mut Plant, ticks: usize, command_n: DVec3) {
        for _ in 0..ticks {
            plant.advance(1e-3, command_n, 0.0, |_, _| DVec3::ZERO);
        }
    }

    #[test]
    fn a_constant_force_on_a_damped_mass_follows_the_exponential() {
        let mut plant = Plant::new(SMOOTH, DVec3::ZERO);
        run(&mut plant, 200, DVec3::X);
        let exact = 2.0 * (1.0 - (-0.5 / 0.1 * 0.2_f64).exp());
        assert!((plant.velocity_m_s.x / exact - 1.0).abs() < 1e-3, "{}", plant.velocity_m_s.x);
    }

    #[test]
    fn friction_sticks_below_its_force_and_slides_above() {
        let rough = PlantParams { friction_n: 0.3, ..SMOOTH };
        let mut plant = Plant::new(rough, DVec3::ZERO);
        run(&mut plant, 100, DVec3::X * 0.29);
        assert_eq!(plant.velocity_m_s, DVec3::ZERO);
        run(&mut plant, 100, DVec3::X * 0.4);
        let exact = 0.2 * (1.0 - (-5.0 * 0.1_f64).exp());
        assert!((plant.velocity_m_s.x / exact - 1.0).abs() < 2e-2);
    }

    #[test]
    fn motors_lag() {
        let lagging = PlantParams { motor_lag_s: 5e-3, ..SMOOTH };
        let mut plant = Plant::new(lagging, DVec3::ZERO);
        run(&mut plant, 5, DVec3::X);
        assert!((plant.motor_n.x - (1.0 - (-1.0_f64).exp())).abs() < 0.01, "{}", plant.motor_n.x);
    }
}
