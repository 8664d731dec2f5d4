//! The host falls silent while the hand stirs: first the field is held, then it fades to the
//! medium at rest, which only resists; a short silence ends with a ramp, a long one is a fault.

use cauldron_protocol::{Fault, Limit, Supervisor};

use super::stirred_cauldron;
use crate::{
    scenario::{Event, Mishap, Scenario, Wrong, must},
    trace::{Trace, force_n},
};
use glam::DVec3;

pub const SCENARIO: Scenario = Scenario {
    name: "host silent",
    about: "the host falls silent while the hand stirs, first for 0.2 s, then for 0.6 s",
    scene: || stirred_cauldron(3.5),
    seconds: 4.5,
    events: &[
        Event::at(2.0, Mishap::Silence),
        Event::at(2.2, Mishap::Speak),
        Event::at(2.8, Mishap::Silence),
        Event::at(3.4, Mishap::Speak),
    ],
    verdict: |trace| {
        short_silence(trace)?;
        long_silence(trace)
    },
};

/// The last field acts from 18 ms on and lives for 10; then 60 ms to the rest.
const FADED: usize = 2000 + 28 + 60 + 2;

fn short_silence(trace: &Trace) -> Result<(), Wrong> {
    must(!trace.is_limited(2010, Limit::Staleness), || "stale at once".into())?;
    must(trace.is_limited(2150, Limit::Staleness), || "not stale after 150 ms".into())?;
    let resists = trace.states[FADED..2200].iter().all(|s| {
        let velocity = DVec3::from_array(s.velocity.map(|v| f64::from(v.0)));
        force_n(s).dot(velocity) <= 1e-9
    });
    must(resists, || "a stale field drove the hand".into())?;
    let running = (2000..2800).all(|t| trace.supervisor(t) == Some(Supervisor::Running));
    must(running, || "0.2 s of silence is no fault".into())?;
    must(!trace.is_limited(2600, Limit::Staleness), || "still stale 0.4 s later".into())?;
    let jump_n = (2200..2500)
        .map(|t| (force_n(&trace.states[t + 1]) - force_n(&trace.states[t])).length())
        .fold(0.0, f64::max);
    must(jump_n < 0.2, || format!("came back with a jump of {jump_n} N"))
}

fn long_silence(trace: &Trace) -> Result<(), Wrong> {
    let fault = trace.first(2800, |s| s.supervisor == Supervisor::Fault(Fault::HostSilent));
    must(fault.is_some_and(|t| (3040..3060).contains(&t)), || format!("fault at {fault:?}"))?;
    let safe = fault.unwrap_or(0) + 2;
    let left_n = trace.force_max_n(safe..3400);
    must(left_n <= 0.1, || format!("{left_n} N in a fault"))?;
    let back = trace.first(3400, |s| s.supervisor == Supervisor::Running);
    must(back.is_some_and(|t| t < 4000), || format!("running again at {back:?}"))
}
