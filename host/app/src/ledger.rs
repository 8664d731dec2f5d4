//! What the probe gave to the pot, from the device's cumulative impulse.

use cauldron_protocol::{
    STATES_PER_FRAME, State,
    state::Flags,
    units::{PiconewtonSeconds, Ticks},
};
use glam::DVec3;
use std::collections::VecDeque;

const PICO: f64 = 1e-12;

/// A gap of states longer than this is spread over this.
const MOST_SPREAD_TICKS: i32 = 1000;

/// Impulse in physical newton seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Given {
    /// To the liquid, while the probe is in it.
    pub to_liquid_n_s: DVec3,
    /// To the surface, upwards, while the probe presses on it or the surface clings to it.
    pub to_surface_n_s: f64,
}

/// Differences of the device's sum, waiting for the step of the pot that they belong to.
///
/// States come four ticks at a time, so a step that took all that is there would get the impulse
/// of 8 ticks, then of 12: a saw of 50 Hz that the hand feels. Each step gets that of as many
/// ticks as it is long, a frame late.
#[derive(Clone, Debug)]
pub struct Ledger {
    felt_scale: f64,
    step_ticks: u32,
    last: Option<State>,
    waiting: VecDeque<(Ticks, Given)>,
    drawn_to: Option<Ticks>,
}

impl Ledger {
    /// For a felt scale and a step's length.
    #[must_use]
    pub fn new(felt_scale: f64, step_ticks: u32) -> Self {
        Self { felt_scale, step_ticks, last: None, waiting: VecDeque::new(), drawn_to: None }
    }

    /// Books the impulse since the state before. A lost state loses nothing: its impulse is in
    /// the next one's sum.
    pub fn note(&mut self, state: &State) {
        let last = self.last.replace(*state).unwrap_or(*state);
        let ticks = state.tick.since(last.tick);
        if ticks < 0 {
            self.waiting.clear();
            self.drawn_to = None;
            return; // the device started anew, and its sum with it
        }
        let sum = |s: &State| s.impulse_to_fluid.map(|PiconewtonSeconds(p)| p);
        let (now, before) = (sum(state), sum(&last));
        let felt = [0, 1, 2].map(|i| now[i].wrapping_sub(before[i]) as f64 * PICO);
        // What lost states held is spread over their ticks: a blow would be another thing.
        let lost = ticks.clamp(1, MOST_SPREAD_TICKS) as u32;
        let physical = DVec3::from_array(felt) / (self.felt_scale * f64::from(lost));
        let mut given = Given::default();
        if state.flags.contains(Flags::WET) {
            given.to_liquid_n_s = physical;
        } else {
            given.to_surface_n_s = physical.y;
        }
        for ago in (0..lost).rev() {
            self.waiting.push_back((state.tick.plus(0u32.wrapping_sub(ago)), given));
        }
    }

    /// What belongs to the step that begins now.
    pub fn draw(&mut self) -> Given {
        let Some(last) = self.last else { return Given::default() };
        let newest = last.tick;
        let a_frame_ago = newest.plus(0u32.wrapping_sub(STATES_PER_FRAME as u32));
        let next = self.drawn_to.map_or(a_frame_ago, |to| to.plus(self.step_ticks));
        let behind = newest.since(next);
        let slack = 2 * STATES_PER_FRAME as i32 + self.step_ticks as i32;
        let to = match behind {
            ..0 => a_frame_ago, // the host's clock ran ahead
            _ if behind <= slack => next,
            _ => next.plus(self.step_ticks), // states were lost: catch up at double pace
        };
        self.drawn_to = Some(to);
        let mut sum = Given::default();
        while let Some((_, given)) = self.waiting.pop_front_if(|(tick, _)| to.since(*tick) >= 0) {
            sum.to_liquid_n_s += given.to_liquid_n_s;
            sum.to_surface_n_s += given.to_surface_n_s;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(tick: u32, per_tick: i64) -> State {
        let sum = PiconewtonSeconds(i64::from(tick) * per_tick);
        State {
            tick: Ticks(tick),
            impulse_to_fluid: [sum; 3],
            flags: Flags::WET,
            ..State::default()
        }
    }

    #[test]
    fn every_step_gets_the_impulse_of_its_own_ticks() {
        let mut ledger = Ledger::new(2.0, 10);
        let mut drawn = Vec::new();
        for tick in 0..400 {
            if tick % 4 == 3 {
                (tick - 3..=tick).for_each(|t| ledger.note(&state(t, 1_000_000_000)));
            }
            if tick % 10 == 9 {
                drawn.push(ledger.draw().to_liquid_n_s.x);
            }
        }
        // 1e9 pN s a tick felt is 0.5e-3 N s physical, of ten ticks.
        assert!(drawn[2..].iter().all(|j| (j - 5e-3).abs() < 1e-9), "{drawn:?}");
    }

    #[test]
    fn what_clings_pulls_the_surface_up_and_not_the_liquid() {
        let mut ledger = Ledger::new(2.0, 10);
        let mut sum = Given::default();
        for tick in 0..100 {
            let flags = if tick < 50 { Flags::ON_SURFACE } else { Flags::CLINGING };
            ledger.note(&State { flags, ..state(tick, 1_000_000) });
            if tick % 10 == 9 {
                sum.to_surface_n_s += ledger.draw().to_surface_n_s;
            }
        }
        assert!((sum.to_surface_n_s - 0.5e-6 * 95.0).abs() < 1e-9, "{sum:?}");
        assert_eq!(sum.to_liquid_n_s, DVec3::ZERO);
    }

    #[test]
    fn what_was_lost_on_the_way_is_in_the_next_sum() {
        let mut ledger = Ledger::new(1.0, 10);
        let mut sum = 0.0;
        for tick in 0..1000 {
            if tick % 7 != 0 && !(300..420).contains(&tick) {
                ledger.note(&state(tick, 1_000_000));
            }
            if tick % 10 == 9 {
                sum += ledger.draw().to_liquid_n_s.y;
            }
        }
        assert!((sum - 1e-6 * 985.0).abs() < 2e-5, "{sum}");
    }

    #[test]
    fn a_device_that_starts_anew_gives_nothing_back() {
        let mut ledger = Ledger::new(1.0, 10);
        ledger.note(&state(500, 1_000_000));
        ledger.note(&state(0, 1_000_000));
        ledger.note(&state(1, 1_000_000));
        let given: f64 = (0..5).map(|_| ledger.draw().to_liquid_n_s.x).sum();
        assert!(given.abs() < 1e-5, "{given}");
        let mut later = 0.0;
        for tick in 2..200 {
            ledger.note(&state(tick, 1_000_000));
            later += if tick % 10 == 9 { ledger.draw().to_liquid_n_s.x } else { 0.0 };
        }
        assert!((later - 1e-6 * 195.0).abs() < 1e-5, "and takes what it then gives: {later}");
    }

    #[test]
    fn a_gap_is_no_blow() {
        let mut ledger = Ledger::new(1.0, 10);
        (0..100).for_each(|tick| ledger.note(&state(tick, 1_000_000)));
        for _ in 0..9 {
            ledger.draw();
        }
        ledger.note(&state(400, 1_000_000));
        let mut largest = 0.0_f64;
        for tick in 401..900 {
            ledger.note(&state(tick, 1_000_000));
            let given = if tick % 10 == 9 { ledger.draw().to_liquid_n_s.x } else { 0.0 };
            largest = largest.max(given);
        }
        assert!(largest < 2.5e-5, "ten ticks are 1e-5 N s, the gap 3e-4 in all: {largest}");
    }
}
