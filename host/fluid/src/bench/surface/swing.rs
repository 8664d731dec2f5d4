//! How a mode swings: its frequency and decay, from amplitudes and speeds at many times.
//!
//! What swings by two roots s and s* has a part 2 c = a - i (w + gamma a) / omega that turns as
//! exp(s t). Held against the turn that is expected, c exp(-s t) / c(0) stands still; the slopes of
//! its phase and logarithm over time are what frequency and decay are off by.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::law::{Root, times};

/// A mode is followed until this part of it is left.
const LEFT: f64 = 0.1;

/// A mode that is followed.
pub struct Swing {
    root: Root,
    first: Option<DVec2>,
    phase: f64,
    /// Sums of 1, t, t^2, phase, phase t, logarithm, logarithm t.
    sums: [f64; 7],
    lasts_s: f64,
}

impl Swing {
    /// Nothing of a mode that is to swing by this root.
    pub fn new(root: Root) -> Self {
        Self { root, first: None, phase: 0.0, sums: [0.0; 7], lasts_s: 0.0 }
    }

    /// Enters amplitude and speed at a time.
    pub fn enter(&mut self, time_s: f64, [height_m, speed_m_s]: [f64; 2]) {
        let (gamma, omega) = (-self.root.x, self.root.y);
        let left = (-gamma * time_s).exp();
        if left < LEFT {
            return;
        }
        let part = DVec2::new(height_m, -(speed_m_s + gamma * height_m) / omega);
        let back = DVec2::from_angle(-omega * time_s) / left;
        let stands = times(part, back);
        let first = *self.first.get_or_insert(stands);
        let off = times(stands, DVec2::new(first.x, -first.y)) / first.length_squared();
        // The nearest turn to that before.
        let turned = off.to_angle() - self.phase;
        self.phase += turned - TAU * ((turned + PI) / TAU).floor();
        let (t, ln) = (time_s, off.length().ln());
        let more = [1.0, t, t * t, self.phase, self.phase * t, ln, ln * t];
        self.sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        self.lasts_s = time_s;
    }

    /// What the frequency is off by, as a part of it.
    pub fn frequency_error(&self) -> f64 {
        self.slope(3) / self.root.y
    }

    /// What the decay is off by, as a part of it.
    pub fn decay_error(&self) -> f64 {
        self.slope(5) / self.root.x
    }

    /// The part of the amplitude that was to decay while it was followed.
    pub fn lost(&self) -> f64 {
        -(self.root.x * self.lasts_s).exp_m1()
    }

    /// Slope over time, by least squares, of what is summed from this place on.
    fn slope(&self, place: usize) -> f64 {
        let [count, t, t2, ..] = self.sums;
        let [value, value_t] = [self.sums[place], self.sums[place + 1]];
        (count * value_t - t * value) / (count * t2 - t * t)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::law, *};

    #[test]
    fn what_a_mode_is_off_by_is_found() {
        let root = DVec2::new(-0.2, 30.0);
        let real = DVec2::new(-0.21, 30.03);
        let mut swing = Swing::new(root);
        for step in 0..=100 {
            let time_s = 0.05 * f64::from(step);
            swing.enter(time_s, law::let_go(real, time_s));
        }
        assert!((swing.frequency_error() - 1e-3).abs() < 2e-5, "{}", swing.frequency_error());
        assert!((swing.decay_error() - 0.05).abs() < 0.01, "{}", swing.decay_error());
        assert!((swing.lost() - (1.0 - (-1.0_f64).exp())).abs() < 1e-9);
    }
}
