//! The wire carries garbage while the hand stirs: what is broken is dropped and counted, nothing
//! acts that was not sent, and the stream finds its feet again.

use cauldron_fluid::scenes::Act;
use cauldron_protocol::{Limit, Supervisor};
use glam::Vec3;

use super::small_cauldron;
use crate::scenario::{Event, Mishap, Scenario, must};

const CENTRE_M: Vec3 = Vec3::new(0.0, -0.05, 0.0);
const RADIUS_M: f32 = 0.045;

pub const SCENARIO: Scenario = Scenario {
    name: "garbage on the wire",
    about: "bits flip and chunks are lost for a second, both ways",
    scene: || {
        let acts = vec![
            Act::Rest { seconds: 0.4 },
            Act::Reach { to_m: CENTRE_M - RADIUS_M * Vec3::Z, seconds: 0.8 },
            Act::Stir { centre_m: CENTRE_M, radius_m: RADIUS_M, seconds: 3.0 },
        ];
        small_cauldron(Vec3::new(0.0, 0.05, 0.0), acts)
    },
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
