//! The hand: it follows its script through a grip that gives, and trembles a little.

use glam::DVec3;
use oorandom::Rand64;
use std::f64::consts::TAU;

use crate::script::Script;

/// Impedance of a grip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Spring between where the hand means to be and the handle.
    pub stiffness_n_per_m: f64,
    /// Damper along with it.
    pub damping_n_s_per_m: f64,
    /// Mass that moves with the handle.
    pub mass_kg: f64,
    /// Amplitude of physiological tremor.
    pub tremor_m: f64,
}

impl Grip {
    /// A relaxed pen grip.
    pub const RELAXED: Self =
        Self { stiffness_n_per_m: 400.0, damping_n_s_per_m: 6.0, mass_kg: 0.08, tremor_m: 3e-5 };

    /// A grip that holds still: no tremor.
    pub const STEADY: Self = Self { tremor_m: 0.0, ..Self::RELAXED };
}

/// A hand that does what its script says.
#[derive(Clone, Debug)]
pub struct Hand {
    script: Script,
    grip: Grip,
    phase: [f64; 3],
}

/// Physiological tremor is 8 to 12 Hz.
const TREMOR_HZ: [f64; 3] = [9.1, 8.3, 10.7];

impl Hand {
    /// A hand whose tremor begins where `random` says.
    #[must_use]
    pub fn new(script: Script, grip: Grip, random: &mut Rand64) -> Self {
        let phase = [0; 3].map(|_| random.rand_float() * TAU);
        Self { script, grip, phase }
    }

    /// Mass that moves with the handle: none of a hand that let go.
    #[must_use]
    pub fn mass_kg(&self, time_s: f64) -> f64 {
        self.script.hold(time_s) * self.grip.mass_kg
    }

    /// Buttons held, a bit each.
    #[must_use]
    pub fn buttons(&self, time_s: f64) -> u8 {
        self.script.buttons(time_s)
    }

    /// The force of the hand on the handle in newtons, over a tick that begins at `time_s`, as a
    /// function of the handle's position and velocity.
    pub fn force_n(&self, time_s: f64, tick_s: f64) -> impl Fn(DVec3, DVec3) -> DVec3 {
        let (grip, hold) = (self.grip, self.script.hold(time_s));
        let aim_m = self.aim_m(time_s);
        let aim_m_s = (self.aim_m(time_s + tick_s) - aim_m) / tick_s;
        move |position_m, velocity_m_s| {
            hold * grip.stiffness_n_per_m * (aim_m - position_m)
                + hold * grip.damping_n_s_per_m * (aim_m_s - velocity_m_s)
        }
    }

    fn aim_m(&self, time_s: f64) -> DVec3 {
        let shake = [0, 1, 2].map(|i| (TAU * TREMOR_HZ[i] * time_s + self.phase[i]).sin());
        self.script.target_m(time_s) + self.grip.tremor_m * DVec3::from_array(shake)
    }
}
