//! The pot, full of light oil that turns: its surface dips, and it carries the hand along.

use glam::Vec3;

use super::{
    Act, Liquid, Pour, Probe, Scene, SceneRow, Start, Story, Substance, Walls, Whirl, cauldron,
};
use crate::surface::SurfaceParams;

pub(super) const ROW: SceneRow = SceneRow {
    name: "whirl",
    about: "the pot, full of thin liquid that turns: it dips, winds cream up, carries the hand",
    make,
};

/// Where the hand is held into the current, and where cream is poured.
const HAND_M: Vec3 = Vec3::new(-0.05, -0.03, 0.0);
const CREAM_M: Vec3 = Vec3::new(-0.03, -0.02, 0.02);

fn make() -> Scene {
    let pot = (cauldron::ROW.make)();
    Scene {
        name: ROW.name.into(),
        about: ROW.about.into(),
        liquid: pot.liquid.map(|potion| Liquid {
            // A light oil's. In water, what the wall stirs up is finer than cells of this size, and
            // breaks the whirl up within seconds.
            viscosity_m2_s: 1e-5,
            // It would slow down near a wall that it clings to.
            walls: Walls::FreeSlip,
            ..potion
        }),
        substances: vec![Substance {
            name: "cream".into(),
            colour: Vec3::new(0.95, 0.90, 0.80),
            density_kg_m3: None,
            viscosity_m2_s: None,
            diffusivity_m2_s: 1e-7,
            pour_at_m: CREAM_M,
            pour_radius_m: 0.015,
            pour_per_s: 12.0,
        }],
        surface: pot.surface.map(|skin| SurfaceParams {
            tension_n_per_m: SurfaceParams::WATER.tension_n_per_m,
            drag_n_s_per_m3: 100.0,
            // The whirl alone is as steep as a wave that breaks.
            tear_slope: 3.0,
            ..skin
        }),
        start: Start::Whirl(Whirl { speed_m_s: 0.5, core_m: 0.04 }),
        probe: Probe { radius_m: 0.014, density_kg_m3: None },
        story: story(),
        ..pot
    }
}

/// Cream is poured; the hand goes in, is held against the current, and comes out.
fn story() -> Story {
    let above = Vec3::new(HAND_M.x, 0.05, HAND_M.z);
    Story {
        start_m: above,
        acts: vec![
            Act::Rest { seconds: 3.0 },
            Act::Reach { to_m: HAND_M, seconds: 1.0 },
            Act::Rest { seconds: 3.0 },
            Act::Reach { to_m: above, seconds: 1.0 },
        ],
        pours: vec![Pour { substance: 0, from_s: 0.3, to_s: 1.3 }],
        ..Story::default()
    }
}
