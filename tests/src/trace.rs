//! What a rig saw of a scenario.

use cauldron_firmware::trace::TraceHash;
use cauldron_fluid::splash::SplashBooks;
use cauldron_link::session::Counts;
use cauldron_protocol::{Limit, State, Supervisor, state::Flags};
use glam::DVec3;

/// The device's states, tick by tick, and what the host counted.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Every tick of the device, whether or not the host heard of it.
    pub states: Vec<State>,
    /// What the host's session counted.
    pub counts: Counts,
    /// Largest norm of the force that the device may give.
    pub force_limit_n: f64,
    /// Momentum given to the liquid, and how far its books are open.
    pub impulse_n_s: f64,
    /// See [`Trace::impulse_n_s`].
    pub momentum_residual_rel: f64,
    /// What left the surface as drops, and what came back.
    pub splash: SplashBooks,
    /// Volume of the drops that were in the air at the end.
    pub airborne_m3: f64,
    /// Physical energy that left as waves where the surface broke or let go.
    pub released_j: f64,
}

impl Trace {
    /// Norm of the force in a tick.
    #[must_use]
    pub fn force_n(&self, tick: usize) -> f64 {
        self.states.get(tick).map_or(0.0, |s| force_n(s).length())
    }

    /// Largest norm of the force over some ticks.
    #[must_use]
    pub fn force_max_n(&self, ticks: std::ops::Range<usize>) -> f64 {
        self.slice(ticks).iter().map(|s| force_n(s).length()).fold(0.0, f64::max)
    }

    /// Root mean square of the norm of the force over some ticks.
    #[must_use]
    pub fn force_rms_n(&self, ticks: std::ops::Range<usize>) -> f64 {
        let states = self.slice(ticks);
        let sum: f64 = states.iter().map(|s| force_n(s).length_squared()).sum();
        (sum / states.len().max(1) as f64).sqrt()
    }

    /// Where the supervisor stood in a tick.
    #[must_use]
    pub fn supervisor(&self, tick: usize) -> Option<Supervisor> {
        self.states.get(tick).map(|s| s.supervisor)
    }

    /// True if all flags of `flags` held in a tick.
    #[must_use]
    pub fn has(&self, tick: usize, flags: Flags) -> bool {
        self.states.get(tick).is_some_and(|s| s.flags.contains(flags))
    }

    /// True if `limit` acted in a tick.
    #[must_use]
    pub fn is_limited(&self, tick: usize, limit: Limit) -> bool {
        self.states.get(tick).is_some_and(|s| s.limits.contains(limit))
    }

    /// First tick at or after `from` in which `holds` is true.
    #[must_use]
    pub fn first(&self, from: usize, holds: impl Fn(&State) -> bool) -> Option<usize> {
        self.states.iter().skip(from).position(holds).map(|at| from + at)
    }

    /// Sum of f . dx over some ticks: what the device gave to the hand.
    #[must_use]
    pub fn energy_to_hand_j(&self, ticks: std::ops::Range<usize>) -> f64 {
        let step = |w: &[State]| force_n(&w[0]).dot(position_m(&w[1]) - position_m(&w[0]));
        self.slice(ticks).windows(2).map(step).sum()
    }

    /// Hash over tick, position and force bits.
    #[must_use]
    pub fn hash(&self) -> u64 {
        let mut hash = TraceHash::default();
        self.states.iter().for_each(|s| hash.add(s));
        hash.value()
    }

    fn slice(&self, ticks: std::ops::Range<usize>) -> &[State] {
        let end = ticks.end.min(self.states.len());
        self.states.get(ticks.start.min(end)..end).unwrap_or(&[])
    }
}

/// Force of a tick in newtons.
#[must_use]
pub fn force_n(state: &State) -> DVec3 {
    DVec3::from_array(state.force.map(|f| f64::from(f.0)))
}

/// Position of a tick in device metres.
#[must_use]
pub fn position_m(state: &State) -> DVec3 {
    DVec3::from_array(state.position.map(|x| f64::from(x.0)))
}
