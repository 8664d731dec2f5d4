//! What the medium got: the impulse of the force that acted, summed in integers so that neither
//! a lost frame nor hours of rounding break the books.

use cauldron_protocol::units::PiconewtonSeconds;

use crate::{TICK_S, math::clamp, servo::Wanted, vector::Vec3};

const PICO: f32 = 1e12;

/// Impulse given to the medium since boot.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    to_fluid: [i64; 3],
}

impl Ledger {
    /// Books a tick in which `acted_n` acted on the hand: the medium got the opposite of its
    /// share for a tick's time.
    pub fn book(&mut self, wanted: &Wanted, acted_n: Vec3) {
        let share_n = medium_share_n(wanted, acted_n);
        for (sum, force_n) in self.to_fluid.iter_mut().zip(share_n.to_array()) {
            // A float to integer cast saturates, and takes NaN for zero.
            *sum = sum.saturating_sub((force_n * TICK_S * PICO) as i64);
        }
    }

    /// The sum for the wire.
    #[must_use]
    pub fn impulse_to_fluid(&self) -> [PiconewtonSeconds; 3] {
        self.to_fluid.map(PiconewtonSeconds)
    }
}

/// The medium's share of a force that limits may have changed. As far as what acted is the wanted
/// force made smaller, all that wanted it are made smaller alike; what else a limit did, medium,
/// walls and bias bear by their weights.
fn medium_share_n(wanted: &Wanted, acted_n: Vec3) -> Vec3 {
    let (medium_n, total_n) = (wanted.medium_n, wanted.total_n());
    if acted_n == Vec3::ZERO || medium_n == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let squared = total_n.dot(total_n);
    let part = if squared > 0.0 { clamp(acted_n.dot(total_n) / squared, 0.0, 1.0) } else { 0.0 };
    let others_n = wanted.walls_n.norm() + wanted.bias_n.norm();
    let weight = medium_n.norm() / (medium_n.norm() + others_n);
    medium_n * part + (acted_n - total_n * part) * weight
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newton_for_a_tick_is_a_billion_piconewton_seconds_the_other_way() {
        let mut ledger = Ledger::default();
        let medium_n = Vec3::new(1.0, 0.0, -0.5);
        ledger.book(&Wanted { medium_n, ..Wanted::default() }, medium_n);
        let [x, y, z] = ledger.impulse_to_fluid().map(|p| p.0);
        assert!((x + 1_000_000_000).abs() < 100 && y == 0 && (z - 500_000_000).abs() < 100);
    }

    #[test]
    fn walls_keep_their_own() {
        let wanted = Wanted {
            medium_n: Vec3::new(1.0, 0.0, 0.0),
            walls_n: Vec3::new(3.0, 2.0, 0.0),
            ..Wanted::default()
        };
        let whole = medium_share_n(&wanted, wanted.total_n());
        assert!((whole - Vec3::new(1.0, 0.0, 0.0)).norm() < 1e-6);
        let halved = medium_share_n(&wanted, wanted.total_n() * 0.5);
        assert!((halved - Vec3::new(0.5, 0.0, 0.0)).norm() < 1e-6);
    }

    #[test]
    fn weight_and_buoyancy_are_nobodys() {
        let bias_n = Vec3::new(0.0, -2.0, 0.0);
        let medium_n = Vec3::new(0.0, 0.5, 0.1);
        let wanted = Wanted { medium_n, bias_n, ..Wanted::default() };
        assert!((medium_share_n(&wanted, wanted.total_n()) - medium_n).norm() < 1e-6);
        let sinking = Wanted { bias_n, ..Wanted::default() };
        assert_eq!(medium_share_n(&sinking, bias_n), Vec3::ZERO);
    }

    #[test]
    fn what_did_not_act_was_not_given() {
        let wanted = Wanted {
            medium_n: Vec3::new(1.0, 0.0, 0.0),
            walls_n: Vec3::new(-1.0, 0.0, 0.5),
            ..Wanted::default()
        };
        assert_eq!(medium_share_n(&wanted, Vec3::ZERO), Vec3::ZERO);
        let whole = medium_share_n(&wanted, wanted.total_n());
        assert!((whole - wanted.medium_n).norm() < 1e-6);
    }
}
