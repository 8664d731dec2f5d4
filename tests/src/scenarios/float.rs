//! A hand presses a light ball onto the surface and lets go: it floats where its weight is borne,
//! rides there, and is taken hold of again without a jerk.

use cauldron_fluid::{
    force::Floating,
    scenes::{Act, Probe, Scene},
};
use glam::Vec3;

use super::small_cauldron;
use crate::{
    scenario::{Scenario, must},
    trace::{force_n, position_m},
};

const ABOVE_M: Vec3 = Vec3::new(0.0, 0.035, 0.0);
/// World metres of a device metre, in the cauldron.
const SCALE: f64 = 1.2;

/// Lets go, and takes hold again.
const FREE: std::ops::Range<usize> = 2000..4500;

/// The arm's dry friction, 0.26 N, holds the ball up to 1 mm from where it would float, and the
/// dent that its weight makes lowers it by some 2 mm more.
const NEAR_M: f64 = 4e-3;

fn ball() -> Scene {
    let acts = vec![
        Act::Rest { seconds: 0.6 },
        Act::Reach { to_m: Vec3::new(0.0, 0.002, 0.0), seconds: 1.0 },
        Act::Rest { seconds: 0.4 },
        Act::LetGo { seconds: 2.5 },
        Act::Rest { seconds: 0.3 },
        Act::Reach { to_m: ABOVE_M, seconds: 0.8 },
        Act::Rest { seconds: 0.4 },
    ];
    let mut scene = small_cauldron(ABOVE_M, acts);
    scene.regrid(20);
    scene.probe = Probe { radius_m: 0.02, density_kg_m3: Some(700.0) };
    scene
}

/// Depth of the ball's centre at which buoyancy and the surface's spring bear its weight.
fn floating_depth_m(scene: &Scene) -> f64 {
    let stiffness = scene.surface.map_or(0.0, |s| f64::from(s.contact_stiffness_n_per_m));
    let up_n = |depth_m: f64| {
        let buoyant_n = Floating::of(scene).map_or(0.0, |f| f.force_n(depth_m));
        buoyant_n + stiffness * depth_m.max(0.0)
    };
    let (mut high_m, mut low_m) = (-0.02, 0.02);
    for _ in 0..50 {
        let middle_m = 0.5 * (high_m + low_m);
        if up_n(middle_m) > 0.0 { low_m = middle_m } else { high_m = middle_m }
    }
    high_m
}

pub const SCENARIO: Scenario = Scenario {
    name: "float",
    about: "a hand presses a light ball onto the surface, lets go, and takes it up again",
    scene: ball,
    seconds: 6.0,
    events: &[],
    verdict: |trace| {
        let floating_m = -floating_depth_m(&ball());
        let y_m = |tick: usize| SCALE * position_m(&trace.states[tick]).y;
        let afloat = FREE.start + 1000..FREE.end - 400;
        for tick in afloat.clone() {
            must((y_m(tick) - floating_m).abs() <= NEAR_M, || {
                format!("at {} m in tick {tick}, floats at {floating_m} m", y_m(tick))
            })?;
        }
        let weight_n = -force_n(&trace.states[500]).y;
        must((1.3..1.45).contains(&weight_n), || format!("weighs {weight_n} N in the air"))?;
        let borne_n = trace.force_rms_n(afloat);
        must(borne_n <= 0.27, || format!("{borne_n} N afloat: more than friction holds"))?;
        let jerk_n = (FREE.end - 450..FREE.end + 200)
            .map(|t| (force_n(&trace.states[t + 1]) - force_n(&trace.states[t])).length())
            .fold(0.0, f64::max);
        must(jerk_n <= 0.1, || format!("taken up with a jerk of {jerk_n} N"))?;
        // But for what its weight gave or took, where it did not come back to where it was.
        let rise_m = (y_m(5999) - y_m(500)) / SCALE;
        let given_j = trace.energy_to_hand_j(500..6000) + weight_n * rise_m;
        must(given_j <= 1e-3, || format!("{given_j} J given to the hand"))
    },
};
