//! The cable is pulled while the hand leans on a wall: safe within 10 ms, a named fault, and
//! everything back after it is plugged in again.

use cauldron_fluid::scenes::Act;
use cauldron_protocol::{Fault, Supervisor};
use glam::Vec3;

use super::scene;
use super::wall::{FLOOR_Y_M, STIFFNESS_N_PER_M};
use crate::{
    scenario::{Event, Mishap, Scenario, must},
    trace::position_m,
};

const PULLED: usize = 1500;
const PLUGGED: usize = 2000;

pub const SCENARIO: Scenario = Scenario {
    name: "unplug while pressing",
    about: "the cable is pulled while the hand leans on a wall, and plugged in again",
    scene: || {
        let acts = vec![
            Act::Rest { seconds: 0.5 },
            Act::Reach { to_m: Vec3::new(0.0, -0.076, 0.0), seconds: 0.8 },
        ];
        scene("empty", Vec3::ZERO, acts)
    },
    seconds: 3.5,
    events: &[Event::at(1.5, Mishap::Unplug), Event::at(2.0, Mishap::Plug)],
    verdict: |trace| {
        let before_n = trace.force_n(PULLED - 1);
        must(before_n > 0.5, || format!("pressing with {before_n} N only"))?;
        let after_n = trace.force_max_n(PULLED + 10..PLUGGED);
        must(after_n <= 0.1, || format!("{after_n} N 10 ms after the cable was pulled"))?;
        let fault = trace.supervisor(PULLED + 10);
        must(fault == Some(Supervisor::Fault(Fault::CableGone)), || format!("{fault:?}"))?;
        let running = trace.first(PLUGGED, |s| s.supervisor == Supervisor::Running);
        must(running.is_some_and(|t| t < PLUGGED + 600), || format!("back at {running:?}"))?;
        let again_n = trace.force_n(3499);
        let sunk_m = FLOOR_Y_M - position_m(&trace.states[3499]).y;
        must((again_n / (STIFFNESS_N_PER_M * sunk_m) - 1.0).abs() < 0.05, || {
            format!("{again_n} N after the plug, {sunk_m} m deep")
        })?;
        must(trace.counts.setups == 2, || format!("set up {} times", trace.counts.setups))
    },
};
