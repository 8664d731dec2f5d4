//! The first eight seeds: fixed corners of what can be drawn.

use super::case::Case;
use crate::surface::SurfaceParams;

/// A corner: its name, and what it makes of a tame case.
type Corner = (&'static str, fn(&mut Case));

/// Seeds 0 to 7.
const CORNERS: [Corner; 8] = [
    ("256^2", |case| case.set_nodes([256; 2], 1e-3, false)),
    ("2x2", |case| {
        case.set_nodes([2; 2], 1e-2, false);
        (case.params.model, case.poke_n, case.dt_s) = ("spring", 1e4, 0.1);
    }),
    ("dt-1s", |case| {
        (case.params.model, case.params.tension_n_per_m, case.dt_s) = ("spring", 5.0, 1.0);
    }),
    ("stiffest", |case| {
        case.set_nodes([48, 33], 1e-3, false);
        (case.params.model, case.params.tension_n_per_m, case.dt_s) = ("spring", 1e7, 1.0);
        (case.params.bend, case.poke_n) = (10.0, 1e4);
    }),
    ("dragged", |case| {
        (case.params.model, case.params.drag_n_s_per_m3, case.dt_s) = ("spring", 1e7, 0.1);
    }),
    ("thickest", |case| (case.viscosity_m2_s, case.dt_s) = (1e4, 1.0)),
    ("weightless", |case| {
        (case.gravity_m_s2, case.params.gravity_n_per_m3) = (0.0, 0.0);
        (case.params.tension_n_per_m, case.poke_n, case.dt_s) = (0.0, 1e4, 1.0);
    }),
    ("splash", |case| {
        case.splashes = true;
        case.set_nodes([40, 30], 5e-3, false);
        (case.poke_n, case.kick_j, case.jump_m) = (10.0, 1.0, 0.02);
    }),
];

/// Name of the corner that a seed is.
#[must_use]
pub fn name(seed: u64) -> Option<&'static str> {
    CORNERS.get(seed as usize).map(|(name, _)| *name)
}

/// The corner of a seed; `drawn` beyond the corners.
pub fn of_seed(seed: u64, drawn: Case) -> Case {
    let Some((name, change)) = CORNERS.get(seed as usize) else { return drawn };
    let params = SurfaceParams {
        model: "wave",
        areal_mass_kg_m2: 20.0,
        gravity_n_per_m3: 9810.0,
        tension_n_per_m: 0.072,
        bend: 0.0,
        drag_n_s_per_m3: 10.0,
        tear_speed_m_s: 0.6,
        ..drawn.params
    };
    let mut case = Case {
        corner: Some(name),
        params,
        density_kg_m3: 1000.0,
        viscosity_m2_s: 1e-6,
        gravity_m_s2: 9.81,
        dt_s: 0.01,
        poke_n: 1.0,
        damping_n_s_per_m: 1.0,
        kick_j: 1e-3,
        press_pa: 10.0,
        jump_m: 1e-3,
        splashes: false,
        ..drawn
    };
    case.set_nodes([32, 24], 1e-2, false);
    change(&mut case);
    case
}
