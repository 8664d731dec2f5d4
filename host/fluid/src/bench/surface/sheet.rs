//! The surfaces that are measured: square ones of 32 cm over 8 cm of liquid, and strips of them.

use glam::Vec3;

use crate::{
    grid::Grid,
    simd::SimdClass,
    solver::SetupError,
    surface::{Basin, Surface, SurfaceParams},
    vessel::Vessel,
};

/// Edge of the square.
pub const EDGE_M: f64 = 0.32;

/// Depth below it.
pub const DEPTH_M: f64 = 0.08;

/// Density of the liquid.
pub const DENSITY_KG_M3: f64 = 1000.0;

/// Gravity.
pub const GRAVITY_M_S2: f64 = 9.81;

/// Kinematic viscosity of water.
pub const WATER_M2_S: f64 = 1e-6;

/// The surface of a model: waves with the tension of water; springs with their own.
pub fn of_model(model: &'static str) -> SurfaceParams {
    SurfaceParams {
        model,
        tension_n_per_m: if model == super::WAVE { 0.072 } else { 5.0 },
        ..SurfaceParams::WATER
    }
}

/// Way between nodes where n are along the edge.
pub fn spacing_m(n: usize) -> f64 {
    EDGE_M / n as f64
}

/// A surface with `nodes` along x and z, n of which make up the edge of the square.
pub fn over_box(
    params: SurfaceParams,
    n: usize,
    nodes: [usize; 2],
    viscosity_m2_s: f64,
    simd: SimdClass,
) -> Result<Surface, SetupError> {
    let layers = (DEPTH_M / spacing_m(n)).round().max(1.0) as usize;
    let grid = Grid {
        cells: [nodes[0], layers, nodes[1]],
        spacing_m: spacing_m(n) as f32,
        origin_in_world_m: Vec3::ZERO,
    };
    over(params, &grid, &Vessel::Box, viscosity_m2_s, simd)
}

/// A surface over any vessel.
pub fn over(
    params: SurfaceParams,
    grid: &Grid,
    vessel: &Vessel,
    viscosity_m2_s: f64,
    simd: SimdClass,
) -> Result<Surface, SetupError> {
    let basin = Basin {
        grid,
        vessel,
        density_kg_m3: DENSITY_KG_M3 as f32,
        viscosity_m2_s: viscosity_m2_s as f32,
        gravity_m_s2: GRAVITY_M_S2 as f32,
        simd,
    };
    Surface::new(params, &basin)
}
