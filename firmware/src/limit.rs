//! The gate before the motors: what of the wanted force may act. Last, and it names itself.

use cauldron_protocol::{Fault, Limit, Limits, message::Ceilings};

use crate::{TICK_S, math::clamp, supervisor::Gate, vector::Vec3};

/// A safe state is reached within so many ticks of full force.
const SAFE_TICKS: f32 = 2.0;

/// Rounding may not lift a clamped norm over the ceiling.
const UNDER: f32 = 1.0 - 1e-6;

/// Remembers the force that acted in the last tick.
#[derive(Clone, Debug, Default)]
pub struct Limiter {
    acted_n: Vec3,
}

/// The force that acts, and what held it back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Acted {
    /// The force.
    pub force_n: Vec3,
    /// What held the wanted one back.
    pub limits: Limits,
    /// The wanted one was not finite: nothing acts, and this is why.
    pub fault: Option<Fault>,
}

impl Limiter {
    /// Scales by gate and pose, clamps the norm, then the slew.
    pub fn apply(
        &mut self,
        wanted_n: Vec3,
        gate: Gate,
        regularity: f32,
        ceilings: &Ceilings,
    ) -> Acted {
        let mut acted = Acted::default();
        if !wanted_n.is_finite() {
            acted.fault = Some(Fault::NonFiniteForce);
        }
        let open = !gate.safe && acted.fault.is_none();
        let target_n = if open {
            self.held(wanted_n, gate, regularity, ceilings, &mut acted.limits)
        } else {
            Vec3::ZERO
        };
        let step_n = if open { ceilings.slew.0 * TICK_S } else { ceilings.force.0 / SAFE_TICKS };
        let change_n = target_n - self.acted_n;
        if change_n.norm() > step_n {
            acted.limits.insert(Limit::Slew);
            self.acted_n += change_n.shortened_to(step_n);
        } else {
            self.acted_n = target_n;
        }
        acted.force_n = self.acted_n;
        acted
    }

    fn held(
        &self,
        wanted_n: Vec3,
        gate: Gate,
        regularity: f32,
        ceilings: &Ceilings,
        limits: &mut Limits,
    ) -> Vec3 {
        let wants = wanted_n != Vec3::ZERO;
        if gate.gain < 1.0 && wants {
            limits.insert(Limit::ArmingRamp);
        }
        if regularity < 1.0 && wants {
            limits.insert(Limit::Singularity);
        }
        let scaled_n = bounded(wanted_n) * (gate.gain * regularity);
        let most_n = ceilings.force.0 * UNDER;
        if scaled_n.norm() > most_n {
            limits.insert(Limit::Force);
            return scaled_n.shortened_to(most_n);
        }
        scaled_n
    }
}

/// Each axis within a giganewton: the square of a force that is merely finite may not be.
fn bounded(force_n: Vec3) -> Vec3 {
    Vec3::from_array(force_n.to_array().map(|f| clamp(f, -1e9, 1e9)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cauldron_protocol::units::{Newtons, NewtonsPerSecond};

    const CEILINGS: Ceilings = Ceilings { force: Newtons(3.0), slew: NewtonsPerSecond(500.0) };
    const OPEN: Gate = Gate { gain: 1.0, safe: false };
    const SAFE: Gate = Gate { gain: 0.0, safe: true };

    fn up(n: f32) -> Vec3 {
        Vec3::new(0.0, n, 0.0)
    }

    #[test]
    fn a_force_within_limits_passes_as_it_is() {
        let acted = Limiter::default().apply(up(0.4), OPEN, 1.0, &CEILINGS);
        assert_eq!((acted.force_n, acted.limits.is_empty()), (up(0.4), true));
    }

    #[test]
    fn norm_and_slew_are_held_and_named() {
        let mut limiter = Limiter::default();
        let mut last = Vec3::ZERO;
        for _ in 0..20 {
            let acted = limiter.apply(Vec3::new(3e38, -1e30, 2e30), OPEN, 1.0, &CEILINGS);
            assert!(acted.limits.contains(Limit::Force));
            assert!((acted.force_n - last).norm() <= 0.5 * 1.0001);
            assert!(acted.force_n.norm() <= 3.0);
            last = acted.force_n;
        }
        assert!(last.norm() > 2.99);
    }

    #[test]
    fn safe_is_reached_in_two_ticks_from_anywhere() {
        let mut limiter = Limiter::default();
        for _ in 0..20 {
            limiter.apply(up(9.0), OPEN, 1.0, &CEILINGS);
        }
        limiter.apply(up(9.0), SAFE, 1.0, &CEILINGS);
        assert_eq!(limiter.apply(up(9.0), SAFE, 1.0, &CEILINGS).force_n, Vec3::ZERO);
    }

    #[test]
    fn what_is_not_a_number_never_acts() {
        let mut limiter = Limiter::default();
        limiter.apply(up(0.5), OPEN, 1.0, &CEILINGS);
        for bad in [f32::NAN, f32::INFINITY] {
            let acted = limiter.apply(Vec3::new(bad, 0.0, 0.0), OPEN, 1.0, &CEILINGS);
            assert_eq!(acted.fault, Some(Fault::NonFiniteForce));
            assert_eq!(acted.force_n, Vec3::ZERO);
        }
    }

    #[test]
    fn ramp_and_singular_pose_scale_and_are_named() {
        let gate = Gate { gain: 0.5, safe: false };
        let acted = Limiter::default().apply(up(0.4), gate, 0.5, &CEILINGS);
        assert!((acted.force_n.y - 0.1).abs() < 1e-7);
        assert!(acted.limits.contains(Limit::ArmingRamp));
        assert!(acted.limits.contains(Limit::Singularity));
    }
}
