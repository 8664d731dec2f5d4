//! What is seen of the cauldron: clear, then red, then green, then the blend; and a pot that
//! nobody stirs does not blend.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use cauldron::world::{Options, World};
use cauldron_fluid::scenes::{self, Act};
use cauldron_render::{Camera, Shares, View, render};

/// Moments at which a picture is taken.
const LOOKS_S: [f64; 5] = [1.5, 2.6, 3.6, 6.0, 9.9];

/// Shares of the liquid's pixels at those moments.
fn looks(stirred: bool) -> Vec<Shares> {
    let mut scene = (scenes::INDEX[0].make)();
    if !stirred {
        for act in &mut scene.story.acts {
            if let Act::Stir { seconds, .. } = *act {
                *act = Act::Rest { seconds };
            }
        }
    }
    let mut world = World::new(&scene, &Options::new(1)).expect("a world");
    let look = |at_s: &f64| {
        while world.now_s() < *at_s {
            world.tick().unwrap();
        }
        let snapshot = world.host.pot.snapshot();
        let view = View { snapshot: &snapshot, handle: None, camera: Camera::over(&snapshot) };
        Shares::of(&render(&view, 240, 180, 2).resolve()).of_liquid()
    };
    LOOKS_S.iter().map(look).collect()
}

/// The story as it must be seen; what is wrong with it, if anything.
fn judge(looks: &[Shares]) -> Result<(), String> {
    let [clear, red, green, mixing, blended] = looks else { return Err("five looks".into()) };
    let coloured = |s: &Shares| s.red + s.green + s.blend;
    let checks = [
        ("clear at first", clear.clear > 0.95 && coloured(clear) < 0.01, clear),
        ("red after red", red.red > 0.08 && red.green < 0.005, red),
        ("green after green", green.red > 0.08 && green.green > 0.04, green),
        ("blending", mixing.blend > green.blend, mixing),
        ("blended at last", blended.blend > 0.5 * coloured(blended), blended),
        ("most of the pot is coloured", coloured(blended) > 0.5, blended),
    ];
    match checks.into_iter().find(|(_, holds, _)| !holds) {
        Some((what, _, shares)) => Err(format!("not {what}: {shares:?}")),
        None => Ok(()),
    }
}

#[test]
fn stirring_blends_red_and_green() {
    let looks = looks(true);
    assert_eq!(judge(&looks), Ok(()), "{looks:#?}");
}

#[test]
fn a_pot_that_nobody_stirs_does_not_blend() {
    let looks = looks(false);
    let said = judge(&looks).unwrap_err();
    assert!(said.contains("blend"), "{said}: it should have failed for want of a blend");
    assert!(looks[2].red > 0.04 && looks[2].green > 0.04, "poured all the same: {looks:#?}");
}
