//! A hand comes out of the liquid slowly: the surface clings to it, holds it back ever harder up to
//! the pull force, and lets go. What the neck held then is a wave's, and the hand has paid for it.

use cauldron_fluid::scenes::Act;
use cauldron_protocol::state::Flags;
use glam::Vec3;

use super::small_cauldron;
use crate::scenario::{Scenario, must};

const ABOVE_M: Vec3 = Vec3::new(0.0, 0.03, 0.0);

/// Felt force at which the surface of the cauldron lets go: 0.085 N physical, felt sixfold.
const PULL_N: f64 = 0.51;
/// Felt joules of a physical one: felt scale 6 over a world 1.2 times as large.
const FELT: f64 = 6.0 / 1.2;

pub const SCENARIO: Scenario = Scenario {
    name: "pull out",
    about: "a hand comes out of the liquid, which clings to it and lets go",
    scene: || {
        let acts = vec![
            Act::Rest { seconds: 0.5 },
            Act::Reach { to_m: Vec3::new(0.0, -0.03, 0.0), seconds: 0.8 },
            Act::Rest { seconds: 0.3 },
            Act::Reach { to_m: ABOVE_M, seconds: 1.8 },
        ];
        small_cauldron(ABOVE_M, acts)
    },
    seconds: 3.6,
    events: &[],
    verdict: |trace| {
        let wet = trace.first(0, |s| s.flags.contains(Flags::WET)).unwrap_or(usize::MAX);
        let clings = trace.first(wet.min(3600), |s| s.flags.contains(Flags::CLINGING));
        let clings = clings.unwrap_or(usize::MAX);
        must(wet < 1300 && (1600..3400).contains(&clings), || {
            format!("in at {wet}, clinging at {clings}")
        })?;
        let off = trace.first(clings, |s| !s.flags.contains(Flags::CLINGING)).unwrap_or(3600);
        must(off < 3500 && !trace.has(off, Flags::WET), || format!("let go at {off}"))?;
        let held_n = trace.force_max_n(clings..off);
        must((0.95 * PULL_N..1.001 * PULL_N).contains(&held_n), || {
            format!("let go at {held_n} N, wanted {PULL_N} N")
        })?;
        let downwards = (clings..off).all(|t| trace.states[t].force[1].0 <= 0.0);
        must(downwards, || "what clings pushed".into())?;
        let left_n = trace.force_max_n(off + 5..3600);
        must(left_n == 0.0, || format!("{left_n} N after it let go"))?;
        let touches = trace.states[off..].iter().any(|s| s.flags.contains(Flags::ON_SURFACE));
        must(!touches, || "the surface came after the hand".into())?;
        let least_j = 0.3 * 0.085 * 0.085 / (2.0 * 32.0);
        must(trace.released_j >= least_j, || format!("{} J as a wave", trace.released_j))?;
        let paid_j = -trace.energy_to_hand_j(0..3600);
        must(paid_j >= FELT * trace.released_j, || {
            format!("the hand paid {paid_j} J for a wave of {} J", trace.released_j)
        })
    },
};
