//! A vortex of which everything is known.

use cauldron_protocol::{WorldFromDevice, message::Modes};
use glam::Vec3;

use super::{Act, Feel, GRAVITY_M_S2, Liquid, Probe, Scene, SceneRow, Start, Story, Vessel, Walls};
use crate::grid::Grid;

pub(super) const ROW: SceneRow = SceneRow {
    name: "taylor-green",
    about: "the vortex of Taylor and Green in a box: its current carries the hand, and decays",
    make,
};

fn make() -> Scene {
    Scene {
        name: ROW.name.into(),
        about: ROW.about.into(),
        grid: Grid { cells: [32, 32, 16], spacing_m: 0.008, origin_in_world_m: CORNER },
        vessel: Vessel::Box,
        liquid: Some(Liquid {
            density_kg_m3: 1000.0,
            viscosity_m2_s: 2e-4,
            gravity_m_s2: GRAVITY_M_S2,
            walls: Walls::FreeSlip,
            colour: Vec3::new(0.25, 0.42, 0.60),
        }),
        substances: Vec::new(),
        surface: None,
        gas: None,
        start: Start::TaylorGreen(0.3),
        probe: Probe { radius_m: 0.012, density_kg_m3: None },
        feel: Feel {
            felt_scale: 8.0,
            world_from_device: WorldFromDevice { scale: 1.6, offset_m: [0.0, -0.128, 0.0] },
            modes: Modes { viscosity: true, flow: true, walls: true, ..Modes::default() },
            wall_stiffness_n_per_m: 500.0,
            wall_damping_n_s_per_m: 2.0,
        },
        step_s: 0.01,
        story: Story {
            start_m: Vec3::new(-0.06, -0.128, 0.0),
            acts: vec![
                Act::Rest { seconds: 2.0 },
                Act::Reach { to_m: Vec3::new(0.06, -0.128, 0.0), seconds: 2.0 },
            ],
            ..Story::default()
        },
    }
}

const CORNER: Vec3 = Vec3::new(-0.128, -0.256, -0.064);
