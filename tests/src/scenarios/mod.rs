//! The list. A scenario is one file and one row here.

mod float;
mod free_air;
mod garbage;
mod host_silent;
mod pull_out;
mod ripple;
mod splash;
mod stir;
mod through_surface;
mod unplug;
mod wall;

use cauldron_fluid::scenes::{self, Act, Scene, Story};
use glam::Vec3;

use crate::scenario::Scenario;

/// Every scenario, for every rig.
pub const LIST: &[Scenario] = &[
    free_air::SCENARIO,
    wall::SCENARIO,
    stir::SCENARIO,
    through_surface::SCENARIO,
    pull_out::SCENARIO,
    float::SCENARIO,
    ripple::SCENARIO,
    splash::SCENARIO,
    unplug::SCENARIO,
    host_silent::SCENARIO,
    garbage::SCENARIO,
];

/// A scene of the index, with another story.
fn scene(name: &str, start_m: Vec3, acts: Vec<Act>) -> Scene {
    let row = scenes::INDEX.iter().find(|row| row.name == name).unwrap_or(&scenes::INDEX[0]);
    Scene { story: Story { start_m, acts, ..Story::default() }, ..(row.make)() }
}

/// The cauldron on a grid of 16 cells, which is enough for what is asked of it here.
fn small_cauldron(start_m: Vec3, acts: Vec<Act>) -> Scene {
    let mut scene = scene("cauldron", start_m, acts);
    scene.regrid(16);
    scene
}

/// The small cauldron, and a hand that dives in within 1.2 s and stirs from then on.
fn stirred_cauldron(seconds: f32) -> Scene {
    const CENTRE_M: Vec3 = Vec3::new(0.0, -0.05, 0.0);
    const RADIUS_M: f32 = 0.045;
    let acts = vec![
        Act::Rest { seconds: 0.4 },
        Act::Reach { to_m: CENTRE_M - RADIUS_M * Vec3::Z, seconds: 0.8 },
        Act::Stir { centre_m: CENTRE_M, radius_m: RADIUS_M, seconds },
    ];
    small_cauldron(Vec3::new(0.0, 0.05, 0.0), acts)
}
