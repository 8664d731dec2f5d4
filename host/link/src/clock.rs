//! The device's tick is the clock. The host learns its own clock's offset to it from the states
//! that come in.

use cauldron_protocol::units::Ticks;

/// Length of a tick on the host's clock.
const TICK_US: i64 = 1000;

/// States in a span; the fastest of the last one or two counts.
const SPAN: u32 = 500;

/// Maps the host's clock to the device's ticks by the fastest arrivals of the last half to one
/// second: a frame that was held up shifts nothing, and a clock that drifts, or a device that
/// lost time, is followed within a second.
#[derive(Clone, Copy, Debug, Default)]
pub struct DeviceClock {
    /// Arrivals are told as microseconds after that of this tick would be.
    base: Option<(u64, Ticks)>,
    seen: u32,
    fastest_us: i64,
    fastest_before_us: i64,
}

impl DeviceClock {
    /// A state of `tick` came at `now_us`.
    pub fn see(&mut self, now_us: u64, tick: Ticks) {
        let (base_us, base) = *self.base.get_or_insert_with(|| {
            (self.fastest_us, self.fastest_before_us) = (0, 0);
            (now_us, tick)
        });
        let late_us = now_us as i64 - base_us as i64 - i64::from(tick.since(base)) * TICK_US;
        if self.seen == SPAN {
            (self.fastest_before_us, self.fastest_us) = (self.fastest_us, late_us);
            self.seen = 0;
        }
        self.seen += 1;
        self.fastest_us = self.fastest_us.min(late_us);
    }

    /// The device's tick at `now_us`; `None` before the first state.
    #[must_use]
    pub fn tick_at(&self, now_us: u64) -> Option<Ticks> {
        let (base_us, base) = self.base?;
        let fastest_us = self.fastest_us.min(self.fastest_before_us);
        let ticks = (now_us as i64 - base_us as i64 - fastest_us).div_euclid(TICK_US);
        Some(base.plus(ticks as u32))
    }

    /// Forgets: another device, or the same one started anew.
    pub fn restart(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_arrivals_do_not_shift_the_clock_and_drift_is_followed() {
        let mut clock = DeviceClock::default();
        assert_eq!(clock.tick_at(5), None);
        for i in 0..10_000_u64 {
            // 50 ppm fast host clock, up to 4 ms late, at least 0.2 ms on the way.
            let true_us = 500_000 + i * 1000 + i / 20;
            clock.see(true_us + 200 + (i % 5) * 1000, Ticks(100 + i as u32));
        }
        let now_us = 500_000 + 10_000 * 1000 + 500 + 200;
        let tick = clock.tick_at(now_us).unwrap();
        assert!(tick.since(Ticks(10_100)).abs() <= 1, "{tick:?}");
    }

    #[test]
    fn a_device_that_lost_time_is_followed_within_a_second() {
        let mut clock = DeviceClock::default();
        for i in 0..3000_u64 {
            let stall_us = if i < 1500 { 0 } else { 40_000 };
            clock.see(i * 1000 + stall_us, Ticks(i as u32));
        }
        assert_eq!(clock.tick_at(3_000_000 + 40_000), Some(Ticks(3000)));
    }
}
