//! The pot itself.

use cauldron_protocol::{WorldFromDevice, message::Modes};
use glam::Vec3;

use super::{
    Act, Feel, GRAVITY_M_S2, Liquid, Pour, Probe, Scene, SceneRow, Start, Story, Substance, Vessel,
    Walls,
};
use crate::{
    grid::Grid,
    surface::{AUTO, SurfaceParams},
};

pub(super) const ROW: SceneRow = SceneRow {
    name: "cauldron",
    about: "a pot of thick liquid: press through the surface, stir, pour red and green, blend",
    make,
};

/// Cells along the box; 6 mm each.
const CELLS: usize = 32;
const SPACING_M: f32 = 0.006;
const RADIUS_M: f32 = 0.09;
/// Depths at which the hand stirs, first and then.
const STIR_Y_M: [f32; 2] = [-0.045, -0.075];
const STIR_RADIUS_M: f32 = 0.05;

fn make() -> Scene {
    let half_m = 0.5 * CELLS as f32 * SPACING_M;
    Scene {
        name: ROW.name.into(),
        about: ROW.about.into(),
        grid: Grid {
            cells: [CELLS; 3],
            spacing_m: SPACING_M,
            origin_in_world_m: Vec3::new(-half_m, -2.0 * half_m, -half_m),
        },
        vessel: Vessel::Pot { centre_in_world_m: Vec3::new(0.0, -half_m, 0.0), radius_m: RADIUS_M },
        liquid: Some(POTION),
        substances: vec![
            pigment("red", Vec3::new(0.90, 0.02, 0.03), Vec3::new(-0.052, -0.05, 0.012)),
            pigment("green", Vec3::new(0.02, 0.70, 0.05), Vec3::new(-0.008, -0.05, 0.052)),
        ],
        surface: Some(SKIN),
        gas: None,
        start: Start::Rest,
        probe: Probe { radius_m: 0.026, density_kg_m3: None },
        feel: Feel {
            felt_scale: 6.0,
            world_from_device: WorldFromDevice { scale: 1.2, offset_m: [0.0; 3] },
            modes: Modes { surface: true, viscosity: true, flow: true, walls: true },
            wall_stiffness_n_per_m: 500.0,
            wall_damping_n_s_per_m: 2.0,
        },
        step_s: 0.01,
        story: story(),
    }
}

/// As thick as glycerol: what is felt of it at the scale above is between a tenth of a newton
/// and a newton.
const POTION: Liquid = Liquid {
    density_kg_m3: 1000.0,
    viscosity_m2_s: 2e-4,
    gravity_m_s2: GRAVITY_M_S2,
    walls: Walls::NoSlip,
    colour: Vec3::new(0.25, 0.42, 0.60),
};

/// The tension of glycerol, and a drag by which the slowest waves fade to half within a second. It
/// lets go of the probe at cot^2(50 deg) of the force that breaks it: as a contact angle of
/// 100 deg would have it. As springs, its shortest waves cross the pot in half a second.
const SKIN: SurfaceParams = SurfaceParams {
    model: AUTO,
    nodes_per_cell: 2,
    areal_mass_kg_m2: 20.0,
    gravity_n_per_m3: 9810.0,
    tension_n_per_m: 0.063,
    sheet_tension_n_per_m: 5.0,
    bend: 0.05,
    drag_n_s_per_m3: 60.0,
    tear_speed_m_s: 0.6,
    tear_slope: 0.577,
    layer_decay_m: 0.04,
    contact_stiffness_n_per_m: 32.0,
    break_force_n: 0.12,
    pull_force_n: 0.085,
};

fn pigment(name: &str, colour: Vec3, pour_at_m: Vec3) -> Substance {
    Substance {
        name: name.into(),
        colour,
        density_kg_m3: None,
        viscosity_m2_s: None,
        diffusivity_m2_s: 6e-5,
        pour_at_m,
        pour_radius_m: 0.04,
        pour_per_s: 9.0,
    }
}

/// Down through the surface, stir, pour, stir on, come out.
fn story() -> Story {
    let above = Vec3::new(0.0, 0.05, 0.03);
    let begin = |y: f32| Vec3::new(0.0, y, -STIR_RADIUS_M);
    let stir = |y: f32, seconds: f32| Act::Stir {
        centre_m: Vec3::new(0.0, y, 0.0),
        radius_m: STIR_RADIUS_M,
        seconds,
    };
    let [upper, lower] = STIR_Y_M;
    Story {
        start_m: above,
        acts: vec![
            Act::Rest { seconds: 0.5 },
            Act::Reach { to_m: begin(upper), seconds: 1.0 },
            stir(upper, 4.4),
            Act::Reach { to_m: begin(lower), seconds: 0.3 },
            stir(lower, 3.0),
            Act::Reach { to_m: above, seconds: 0.6 },
        ],
        pours: vec![
            Pour { substance: 0, from_s: 1.9, to_s: 2.5 },
            Pour { substance: 1, from_s: 2.9, to_s: 3.5 },
        ],
        ..Story::default()
    }
}
