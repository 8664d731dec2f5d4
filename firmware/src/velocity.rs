//! Position to velocity.
//!
//! A backward difference is useless at 1 kHz: one count is tens of mm/s. This is the critically
//! damped g-h filter (Brookner 1998, fading memory of order 1): with theta = 0.85 a step of one
//! count shows as 6 % of that. A steady speed is told without error; a change of it g/h - 1/2
//! ticks, some 12 ms, late (g and h its gains).

use crate::{TICK_S, vector::Vec3};

const THETA: f32 = 0.85;
const GAIN: f32 = 1.0 - THETA * THETA;
const RATE_GAIN: f32 = (1.0 - THETA) * (1.0 - THETA) / TICK_S;

/// A filter that follows position and velocity together.
#[derive(Clone, Debug, Default)]
pub struct Velocity {
    position_m: Option<Vec3>,
    velocity_m_s: Vec3,
}

impl Velocity {
    /// Takes a position in metres; the velocity in m/s.
    pub fn update(&mut self, measured_m: Vec3) -> Vec3 {
        let last = self.position_m.unwrap_or(measured_m);
        let predicted = last + self.velocity_m_s * TICK_S;
        let surprise = measured_m - predicted;
        self.position_m = Some(predicted + surprise * GAIN);
        self.velocity_m_s += surprise * RATE_GAIN;
        self.velocity_m_s
    }

    /// Forgets: the encoder was not to be believed.
    pub fn restart(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_followed_without_error() {
        let mut filter = Velocity::default();
        let mut v = Vec3::ZERO;
        for tick in 0..300 {
            v = filter.update(Vec3::new(0.2 * tick as f32 * TICK_S, 0.0, 0.0));
        }
        assert!((v.x - 0.2).abs() < 1e-5, "{v:?}");
    }

    #[test]
    fn one_count_is_a_fraction_of_a_backward_difference() {
        let mut filter = Velocity::default();
        filter.update(Vec3::ZERO);
        let count_m = 5e-5;
        let mut largest = 0.0;
        for _ in 0..100 {
            let v = filter.update(Vec3::new(count_m, 0.0, 0.0)).x;
            largest = if v > largest { v } else { largest };
        }
        assert!(largest > 0.0 && largest < 0.07 * count_m / TICK_S, "{largest}");
    }
}
