//! The list. A scenario is one file and one row here.

mod free_air;
mod garbage;
mod host_silent;
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
    unplug::SCENARIO,
    host_silent::SCENARIO,
    garbage::SCENARIO,
];

/// A scene of the index, with another story.
fn scene(name: &str, start_m: Vec3, acts: Vec<Act>) -> Scene {
    let row = scenes::INDEX.iter().find(|row| row.name == name).unwrap_or(&scenes::INDEX[0]);
    Scene { story: Story { start_m, acts, pours: Vec::new() }, ..(row.make)() }
}

/// The cauldron on a grid of 16 cells, which is enough for what is asked of it here.
fn small_cauldron(start_m: Vec3, acts: Vec<Act>) -> Scene {
    let mut scene = scene("cauldron", start_m, acts);
    scene.regrid(16);
    scene
}
