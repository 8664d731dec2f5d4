//! A stone falls into the water beside a hand that rests on it: drops leave, fly and fall back, the
//! books of what they carry stay closed, and the hand is given nothing but what it can bear.

use cauldron_fluid::scenes::{Act, Poke, Scene};
use glam::Vec3;

use super::scene;
use crate::scenario::{Scenario, must};

const HAND_M: Vec3 = Vec3::new(0.055, 0.0, 0.0);
const STONE_S: f32 = 2.0;
/// Its waves rock the hand, which takes their work up: a fifth of the burst that a field may give.
const MOST_GIVEN_J: f64 = 1e-2;

fn pond() -> Scene {
    let acts = vec![
        Act::Rest { seconds: 0.4 },
        Act::Reach { to_m: HAND_M - 0.004 * Vec3::Y, seconds: 0.8 },
        Act::Rest { seconds: 3.5 },
    ];
    let mut scene = scene("pond", HAND_M + 0.04 * Vec3::Y, acts);
    scene.story.pokes = vec![Poke {
        at_m: Vec3::new(-0.04, 0.0, 0.01),
        radius_m: 0.015,
        force_n: -1.5,
        from_s: STONE_S,
        to_s: STONE_S + 0.02,
    }];
    scene
}

pub const SCENARIO: Scenario = Scenario {
    name: "splash",
    about: "a stone falls into the water: drops leave, fly and fall back",
    scene: pond,
    seconds: 5.0,
    events: &[],
    verdict: |trace| {
        let books = &trace.splash;
        must(books.drops >= 20, || format!("{} drops left", books.drops))?;
        let down = (books.merged_m3 + books.spilled_m3) / books.left_m3;
        must(down >= 0.99, || format!("only {down} of what left came down"))?;
        let known = down + trace.airborne_m3 / books.left_m3;
        must((known - 1.0).abs() <= 1e-5, || format!("{known} of what left is known of"))?;
        let open = books.residual_rel();
        must(open <= 1e-5, || format!("their books of momentum are open by {open}"))?;
        let stone = (f64::from(STONE_S) * 1e3) as usize;
        must(trace.force_max_n(0..stone) < 0.5, || "the hand presses too hard".into())?;
        let given_j = trace.energy_to_hand_j(1300..5000);
        must(given_j <= MOST_GIVEN_J, || format!("{given_j} J given to the hand"))
    },
};
