//! A hand presses on the surface: it gives, it pops, and it closes again behind the hand.

use cauldron_fluid::scenes::Act;
use cauldron_protocol::state::Flags;
use glam::Vec3;

use super::small_cauldron;
use crate::scenario::{Scenario, must};

const ABOVE_M: Vec3 = Vec3::new(0.0, 0.03, 0.0);

/// Felt force at which the surface of the cauldron breaks: 0.12 N physical, felt sixfold.
const BREAK_N: f64 = 0.72;

pub const SCENARIO: Scenario = Scenario {
    name: "through the surface",
    about: "a hand presses through the surface and comes out again",
    scene: || {
        let acts = vec![
            Act::Rest { seconds: 0.5 },
            Act::Reach { to_m: Vec3::new(0.0, -0.04, 0.0), seconds: 1.2 },
            Act::Rest { seconds: 0.3 },
            Act::Reach { to_m: ABOVE_M, seconds: 0.8 },
        ];
        small_cauldron(ABOVE_M, acts)
    },
    seconds: 3.0,
    events: &[],
    verdict: |trace| {
        let touch = trace.first(0, |s| s.flags.contains(Flags::ON_SURFACE));
        let touch = touch.unwrap_or(usize::MAX);
        let pop = trace.first(touch.min(3000), |s| s.flags.contains(Flags::WET));
        let pop = pop.unwrap_or(usize::MAX);
        must(touch < pop && pop < 1700, || format!("touched at {touch}, through at {pop}"))?;
        let pressed_n = trace.force_max_n(touch..pop);
        must((0.95 * BREAK_N..1.05 * BREAK_N).contains(&pressed_n), || {
            format!("broke at {pressed_n} N, wanted {BREAK_N} N")
        })?;
        let relieved_n = trace.force_n(pop + 20);
        must(relieved_n < 0.6 * pressed_n, || format!("no pop: {relieved_n} N after it"))?;
        let again = trace.first(pop, |s| s.flags.contains(Flags::ON_SURFACE));
        must(again.is_none(), || format!("pressed on the surface again at {again:?}"))?;
        let most_j = (0.12 * 0.12 + 0.085 * 0.085) / (2.0 * 32.0);
        must((0.2 * most_j..most_j).contains(&trace.released_j), || {
            format!("{} J as waves, of at most {most_j} J", trace.released_j)
        })?;
        let out = trace.first(pop, |s| !s.flags.contains(Flags::WET)).unwrap_or(usize::MAX);
        must((2000..3000).contains(&out), || format!("came out at {out}"))?;
        let left_n = trace.force_n(2999);
        must(left_n == 0.0, || format!("{left_n} N in the air"))
    },
};
