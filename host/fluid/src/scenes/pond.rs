//! Water in a tank, on which something knocks: ripples that are seen and felt, and a splash.

use cauldron_protocol::{WorldFromDevice, message::Modes};
use glam::Vec3;

use super::{
    Act, Feel, GRAVITY_M_S2, Liquid, Poke, Probe, Scene, SceneRow, Start, Story, Vessel, Walls,
};
use crate::{grid::Grid, surface::SurfaceParams};

pub(super) const ROW: SceneRow = SceneRow {
    name: "pond",
    about: "water in a tank: ripples reach a hand that rests on it, and a stone makes it splash",
    make,
};

const CELLS: [usize; 3] = [32, 16, 32];
const SPACING_M: f32 = 0.008;
const HALF_M: f32 = 0.5 * CELLS[0] as f32 * SPACING_M;

/// Where the hand rests, and where it is knocked.
const HAND_M: Vec3 = Vec3::new(0.055, 0.0, 0.0);
const KNOCK_M: Vec3 = Vec3::new(-0.055, 0.0, 0.0);

fn make() -> Scene {
    Scene {
        name: ROW.name.into(),
        about: ROW.about.into(),
        grid: Grid {
            cells: CELLS,
            spacing_m: SPACING_M,
            origin_in_world_m: Vec3::new(-HALF_M, -(CELLS[1] as f32) * SPACING_M, -HALF_M),
        },
        vessel: Vessel::Box,
        liquid: Some(Liquid {
            density_kg_m3: 1000.0,
            viscosity_m2_s: 4e-6,
            gravity_m_s2: GRAVITY_M_S2,
            walls: Walls::FreeSlip,
            colour: Vec3::new(0.25, 0.42, 0.60),
        }),
        substances: Vec::new(),
        surface: Some(SurfaceParams {
            nodes_per_cell: 4,
            drag_n_s_per_m3: 20.0,
            contact_stiffness_n_per_m: 30.0,
            break_force_n: 0.4,
            pull_force_n: 0.1,
            ..SurfaceParams::WATER
        }),
        gas: None,
        start: Start::Rest,
        probe: Probe { radius_m: 0.02, density_kg_m3: None },
        feel: Feel {
            felt_scale: 8.0,
            world_from_device: WorldFromDevice { scale: 1.6, offset_m: [0.0; 3] },
            modes: Modes { surface: true, viscosity: true, flow: true, walls: true },
            wall_stiffness_n_per_m: 500.0,
            wall_damping_n_s_per_m: 2.0,
        },
        step_s: 0.01,
        story: story(),
    }
}

/// Rests on the water; knocks of a felt newton, then a stone.
fn story() -> Story {
    let knock = |from_s: f32| Poke {
        at_m: KNOCK_M,
        radius_m: 0.03,
        force_n: -0.125,
        from_s,
        to_s: from_s + 0.1,
    };
    let stone = Poke { at_m: KNOCK_M, radius_m: 0.015, force_n: -1.5, from_s: 4.5, to_s: 4.52 };
    Story {
        start_m: HAND_M + 0.04 * Vec3::Y,
        acts: vec![
            Act::Rest { seconds: 0.5 },
            Act::Reach { to_m: HAND_M - 0.004 * Vec3::Y, seconds: 1.0 },
            Act::Rest { seconds: 4.5 },
            Act::Reach { to_m: HAND_M + 0.04 * Vec3::Y, seconds: 0.8 },
        ],
        pokes: vec![knock(2.5), knock(3.5), stone],
        ..Story::default()
    }
}
