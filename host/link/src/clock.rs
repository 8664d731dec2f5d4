//! The device's tick is the clock. The host learns its own clock's offset to it from the states
//! that come in.

use cauldron_protocol::units::Ticks;

/// Length of a tick on the host's clock.
const TICK_US: i64 = 1000;

/// How fast the offset may creep towards later arrivals, in microseconds a state: more than two
/// clocks drift apart (100 ppm is 0.1 us a state), less than a slow frame pulls.
const CREEP_US: i64 = 1;

/// Maps the host's clock to the device's ticks by the fastest arrivals seen lately.
#[derive(Clone, Copy, Debug, Default)]
pub struct DeviceClock {
    /// Arrival less tick time of the fastest state, and that state's tick.
    reference: Option<(i64, Ticks)>,
}

impl DeviceClock {
    /// A state of `tick` came at `now_us`.
    pub fn see(&mut self, now_us: u64, tick: Ticks) {
        let arrival_us = now_us as i64;
        self.reference = Some(match self.reference {
            None => (arrival_us, tick),
            Some((base_us, base)) => {
                let expected_us = base_us + i64::from(tick.since(base)) * TICK_US;
                (arrival_us.min(expected_us + CREEP_US), tick)
            }
        });
    }

    /// The device's tick at `now_us`; `None` before the first state.
    #[must_use]
    pub fn tick_at(&self, now_us: u64) -> Option<Ticks> {
        let (base_us, base) = self.reference?;
        let ticks = (now_us as i64 - base_us).div_euclid(TICK_US);
        Some(base.plus(ticks as u32))
    }

    /// Forgets: another device, or the same one started anew.
    pub fn restart(&mut self) {
        self.reference = None;
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
}
