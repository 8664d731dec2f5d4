//! Nothing but walls: for a look at the device itself.

use cauldron_protocol::{WorldFromDevice, message::Modes};
use glam::Vec3;

use super::{Act, Feel, Probe, Scene, SceneRow, Start, Story, Vessel};
use crate::grid::Grid;

pub(super) const ROW: SceneRow = SceneRow {
    name: "empty",
    about: "a box without liquid: the device alone, free air and walls",
    make,
};

fn make() -> Scene {
    Scene {
        name: ROW.name.into(),
        about: ROW.about.into(),
        grid: Grid { cells: [8; 3], spacing_m: 0.02, origin_in_world_m: Vec3::splat(-0.08) },
        vessel: Vessel::Box,
        liquid: None,
        substances: Vec::new(),
        surface: None,
        gas: None,
        start: Start::Rest,
        probe: Probe { radius_m: 0.01, density_kg_m3: None },
        feel: Feel {
            felt_scale: 1.0,
            world_from_device: WorldFromDevice::default(),
            modes: Modes { walls: true, ..Modes::default() },
            wall_stiffness_n_per_m: 500.0,
            wall_damping_n_s_per_m: 2.0,
        },
        step_s: 0.01,
        story: Story {
            start_m: Vec3::ZERO,
            acts: vec![
                Act::Rest { seconds: 0.5 },
                Act::Reach { to_m: Vec3::new(0.0, -0.074, 0.0), seconds: 1.0 },
                Act::Rest { seconds: 1.0 },
                Act::Reach { to_m: Vec3::ZERO, seconds: 1.0 },
            ],
            ..Story::default()
        },
    }
}
