//! The wire carries garbage while the hand stirs: what is broken is dropped and counted, nothing
//! acts that was not sent, and the stream finds its feet again.

use cauldron_protocol::{Limit, Supervisor};

use super::stirred_cauldron;
use crate::scenario::{Event, Mishap, Scenario, must};

pub const SCENARIO: Scenario = Scenario {
    name: "garbage on the wire",
    about: "bits flip and chunks are lost for a second, both ways",
    scene: || stirred_cauldron(3.0),
    seconds: 4.2,
    events: &[Event::at(1.8, Mishap::Garbage), Event::at(2.8, Mishap::Sound)],
    verdict: |trace| {
        let drops = |tick: usize| trace.states[tick].drops.total();
        must(drops(1799) == 0, || format!("{} dropped on a sound wire", drops(1799)))?;
        must(drops(2820) >= 20, || format!("only {} dropped", drops(2820)))?;
        let end = trace.states.len() - 1;
        must(drops(end) <= drops(2820) + 1, || "still dropping on a sound wire".into())?;
        must(trace.counts.missed > 0, || "no state was lost".into())?;
        let running = trace.supervisor(end) == Some(Supervisor::Running);
        must(running, || format!("ended in {:?}", trace.supervisor(end)))?;
        must(!trace.is_limited(end, Limit::Staleness), || "stale on a sound wire".into())?;
        let felt_n = trace.force_rms_n(3300..4200);
        must(felt_n >= 0.05, || format!("only {felt_n} N after it"))
    },
};
