//! What happens, and what must be true of it.

use cauldron_fluid::scenes::Scene;
use std::fmt;

use crate::trace::Trace;

/// A scenario: a scene whose story the hand plays, and what befalls the wire.
#[derive(Clone, Copy)]
pub struct Scenario {
    /// Name.
    pub name: &'static str,
    /// What it shows.
    pub about: &'static str,
    /// The scene, with the story of this scenario.
    pub scene: fn() -> Scene,
    /// How long it lasts.
    pub seconds: f64,
    /// What befalls the wire, in order of time.
    pub events: &'static [Event],
    /// What must be true.
    pub verdict: fn(&Trace) -> Result<(), Wrong>,
}

/// What befalls the wire at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// When.
    pub at_s: f64,
    /// What.
    pub what: Mishap,
}

/// What can befall the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mishap {
    /// The cable is pulled.
    Unplug,
    /// It is plugged in again.
    Plug,
    /// The host says nothing more.
    Silence,
    /// It speaks again.
    Speak,
    /// Bits flip and chunks are lost, both ways.
    Garbage,
    /// The wire is sound again.
    Sound,
}

impl Event {
    /// `what` at `at_s`.
    #[must_use]
    pub const fn at(at_s: f64, what: Mishap) -> Self {
        Self { at_s, what }
    }
}

/// What was not true.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrong(pub String);

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// `Ok` if `holds`, else what `said` says.
///
/// # Errors
/// [`Wrong`] if it does not hold.
pub fn must(holds: bool, said: impl FnOnce() -> String) -> Result<(), Wrong> {
    if holds { Ok(()) } else { Err(Wrong(said())) }
}

impl Scenario {
    /// Judges a trace: first what must be true of every scenario, then its own verdict.
    ///
    /// # Errors
    /// [`Wrong`]: what was not true.
    pub fn judge(&self, trace: &Trace) -> Result<(), Wrong> {
        let ticks = (self.seconds * 1e3).round() as usize;
        must(trace.states.len() == ticks, || {
            format!("{} ticks, wanted {ticks}", trace.states.len())
        })?;
        let worst = trace.force_max_n(0..ticks);
        must(worst <= trace.force_limit_n, || {
            format!("{worst} N, above the limit of {} N", trace.force_limit_n)
        })?;
        let finite = trace.states.iter().all(|s| {
            let finite = |values: [f32; 3]| values.iter().all(|v| v.is_finite());
            finite(s.force.map(|f| f.0)) && finite(s.position.map(|x| x.0))
        });
        must(finite, || "a force or a position is not finite".into())?;
        (self.verdict)(trace)
    }
}
