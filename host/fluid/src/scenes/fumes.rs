//! The pot, so hot that it smokes.

use glam::Vec3;

use super::{Gas, Scene, SceneRow, cauldron};

pub(super) const ROW: SceneRow = SceneRow {
    name: "fumes",
    about: "the pot, hot: smoke rises from its surface, rides on its waves, and drifts away",
    make,
};

fn make() -> Scene {
    let below = (cauldron::ROW.make)();
    Scene { name: ROW.name.into(), about: ROW.about.into(), gas: Some(FUMES), ..below }
}

/// Air that is 30 K warmer above the pot, which makes it lighter by a tenth. Thicker than air is
/// (1.5e-5 m^2/s), by what eddies smaller than a cell would carry.
const FUMES: Gas = Gas {
    height_m: 0.18,
    density_kg_m3: 1.2,
    viscosity_m2_s: 2e-4,
    diffusivity_m2_s: 2e-5,
    ambient_k: 293.0,
    hotter_k: 30.0,
    vents: 6,
    vent_radius_m: 0.02,
    smoke_per_s: 15.0,
    colour: Vec3::new(0.55, 0.55, 0.58),
};
