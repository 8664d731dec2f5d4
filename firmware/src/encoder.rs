//! Counts to joint angles, and whether the counts can be believed.
//!
//! A reading follows its count with a play of one count: an encoder that stands on an edge jumps
//! to and fro, and a stiff wall would give the hand energy at each jump.

use cauldron_protocol::{Fault, message::Arm};

const TURN_RAD: f32 = core::f32::consts::TAU;

/// Fastest joint that is still believed. A hand's fastest flick is about 5 m/s; on links of
/// 0.16 m that is 31 rad/s.
const FASTEST_RAD_PER_S: f32 = 60.0;

/// Three incremental encoders.
#[derive(Clone, Debug)]
pub struct Encoder {
    home_rad: [f32; 3],
    rad_per_count: [f32; 3],
    largest_jump_counts: [u32; 3],
    reach_rad: [[f32; 2]; 3],
    last: Option<[i32; 3]>,
    held: [i32; 3],
}

impl Encoder {
    /// For the encoders of `arm`.
    #[must_use]
    pub fn new(arm: &Arm) -> Self {
        let rad_per_count = arm.counts_per_turn.map(|counts| TURN_RAD / counts as f32);
        Self {
            home_rad: arm.home.map(|h| h.0),
            rad_per_count,
            largest_jump_counts: rad_per_count
                .map(|rad| (FASTEST_RAD_PER_S * crate::TICK_S / rad) as u32 + 2),
            reach_rad: arm.reach.map(|ends| ends.map(|end| end.0)),
            last: None,
            held: [0; 3],
        }
    }

    /// Joint angles in radians.
    ///
    /// # Errors
    /// [`Fault::EncoderJump`] if a joint moved further than it can in one tick (the new counts
    /// are taken as the truth from then on), [`Fault::OutsideWorkspace`] if it stands where the
    /// mechanism cannot.
    pub fn read(&mut self, counts: [i32; 3]) -> Result<[f32; 3], Fault> {
        if self.last.is_none() {
            self.held = counts;
        }
        let last = self.last.replace(counts).unwrap_or(counts);
        for (held, count) in self.held.iter_mut().zip(counts) {
            *held = followed(*held, count);
        }
        let jumped = counts
            .into_iter()
            .zip(last)
            .zip(self.largest_jump_counts)
            .any(|((now, before), most)| now.wrapping_sub(before).unsigned_abs() > most);
        if jumped {
            return Err(Fault::EncoderJump);
        }
        let mut angles_rad = [0.0; 3];
        for (angle, ((count, scale), home)) in angles_rad
            .iter_mut()
            .zip(self.held.into_iter().zip(self.rad_per_count).zip(self.home_rad))
        {
            *angle = home + count as f32 * scale;
        }
        let reached =
            angles_rad.iter().zip(self.reach_rad).all(|(a, [low, high])| *a >= low && *a <= high);
        if reached { Ok(angles_rad) } else { Err(Fault::OutsideWorkspace) }
    }
}

/// `held`, moved as little as brings it within one of `count`.
fn followed(held: i32, count: i32) -> i32 {
    let ahead = count.saturating_sub(held);
    if ahead > 1 {
        count.saturating_sub(1)
    } else if ahead < -1 {
        count.saturating_add(1)
    } else {
        held
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::tests::ARM;

    #[test]
    fn a_turn_is_a_turn() {
        let mut encoder = Encoder::new(&ARM);
        let per_turn = ARM.counts_per_turn[0];
        let home = encoder.read([0, 0, 0]).unwrap();
        let mut quarter = home;
        for i in 0..=per_turn / 4 / 20 {
            quarter = encoder.read([i * 20, 0, 0]).unwrap();
        }
        assert!((quarter[0] - home[0] - core::f32::consts::FRAC_PI_2).abs() < 4e-4);
    }

    #[test]
    fn an_encoder_on_an_edge_reads_still() {
        let mut encoder = Encoder::new(&ARM);
        let first = encoder.read([50, 50, 50]).unwrap();
        for count in [51, 50, 51, 49, 50] {
            assert_eq!(encoder.read([count; 3]).unwrap(), first);
        }
        assert_ne!(encoder.read([52, 50, 50]).unwrap(), first);
    }

    #[test]
    fn a_joint_beyond_its_stop_is_a_fault() {
        let mut encoder = Encoder::new(&ARM);
        let beyond = (2.0 / encoder.rad_per_count[0]) as i32;
        let readings: Vec<_> =
            (0..=beyond / 100).map(|i| encoder.read([100 * i, 0, 0]).is_ok()).collect();
        let stop = readings.iter().position(|ok| !ok).unwrap();
        let angle = 100.0 * stop as f32 * encoder.rad_per_count[0];
        assert!((1.8..1.85).contains(&angle), "{angle}");
    }

    #[test]
    fn a_jump_is_a_fault_and_the_next_reading_is_believed() {
        let mut encoder = Encoder::new(&ARM);
        encoder.read([0, 0, 0]).unwrap();
        assert_eq!(encoder.read([0, 3000, 0]), Err(Fault::EncoderJump));
        assert!(encoder.read([0, 3001, 0]).is_ok());
        assert_eq!(encoder.read([0, i32::MIN, 0]), Err(Fault::EncoderJump));
        assert_eq!(encoder.read([0, i32::MIN, 0]), Err(Fault::OutsideWorkspace));
    }
}
