//! A hand moves in free air and feels nothing.

use cauldron_fluid::scenes::Act;
use cauldron_protocol::Supervisor;
use glam::Vec3;

use super::scene;
use crate::scenario::{Scenario, must};

pub const SCENARIO: Scenario = Scenario {
    name: "free air",
    about: "a hand waves in an empty box and feels nothing",
    scene: || {
        let acts = vec![
            Act::Rest { seconds: 0.5 },
            Act::Reach { to_m: Vec3::new(0.05, 0.03, -0.04), seconds: 0.5 },
            Act::Reach { to_m: Vec3::new(-0.05, -0.03, 0.04), seconds: 0.4 },
        ];
        scene("empty", Vec3::ZERO, acts)
    },
    seconds: 1.6,
    events: &[],
    verdict: |trace| {
        must(trace.supervisor(400) == Some(Supervisor::Running), || "not running".into())?;
        // The threshold of the hand is 20.8 mN (Lee & Hannaford 2003); air may not come near it.
        let felt = trace.force_max_n(0..trace.states.len());
        must(felt <= 0.005, || format!("{felt} N in free air"))?;
        must(trace.counts.missed == 0, || format!("{} ticks missed", trace.counts.missed))
    },
};
