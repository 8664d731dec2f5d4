//! What the host shows of one moment: plain data, all that a renderer needs of the fluid.

use glam::Vec3;

use crate::{grid::Grid, vessel::Vessel};

/// The pot at one moment.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Simulated time.
    pub time_s: f64,
    /// The box that `substances` are sampled on.
    pub grid: Grid,
    /// What holds the liquid.
    pub vessel: Vessel,
    /// Colour of the clear liquid (linear RGB, 0 to 1); `None` for a scene without liquid.
    pub liquid_colour: Option<Vec3>,
    /// What was poured in, in the scene's order; empty where the scene has none.
    pub substances: Vec<SubstanceView>,
    /// The liquid's surface, where the scene has one.
    pub surface: Option<SurfaceView>,
    /// Drops in the air.
    pub drops: Vec<DropView>,
    /// Smoke in the gas above the liquid, where the scene has one.
    pub smoke: Option<SmokeView>,
}

/// A drop as it is drawn: a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DropView {
    /// Its middle.
    pub at_in_world_m: Vec3,
    /// Its radius.
    pub radius_m: f32,
    /// Linear RGB, 0 to 1.
    pub colour: Vec3,
}

/// The smoke as it is drawn.
#[derive(Clone, Debug)]
pub struct SmokeView {
    /// The box that `fraction` is sampled on.
    pub grid: Grid,
    /// Linear RGB, 0 to 1.
    pub colour: Vec3,
    /// Volume fraction in each cell, 0 to 1, laid out as [`Grid::cell`] says.
    pub fraction: Vec<f32>,
}

/// One substance as it is drawn.
#[derive(Clone, Debug)]
pub struct SubstanceView {
    /// Linear RGB, 0 to 1.
    pub colour: Vec3,
    /// Volume fraction in each cell, 0 to 1, laid out as [`Grid::cell`] says.
    pub fraction: Vec<f32>,
}

/// The height field of the surface on nodes over the grid's (x, z) plane.
#[derive(Clone, Debug)]
pub struct SurfaceView {
    /// Nodes along x and z.
    pub nodes: [usize; 2],
    /// Distance between nodes in metres.
    pub spacing_m: f32,
    /// World x and z of node (0, 0).
    pub origin_in_world_m: [f32; 2],
    /// World y of the surface at rest.
    pub rest_height_in_world_m: f32,
    /// Height above rest in metres, x fastest.
    pub height_m: Vec<f32>,
    /// Depth at which the displacement that a layer below the surface follows has fallen to 1/e
    /// (the damped layers of Mora 2008).
    pub layer_decay_m: f32,
}
