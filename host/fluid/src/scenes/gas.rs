//! The gas above the liquid, as a scene describes it.

use glam::Vec3;

use super::check::{Bound, Wrong, colour, number};
use crate::grid::Grid;

/// Gas, and the smoke that comes into it from the liquid's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gas {
    /// How far up it is computed; beyond, and beside the grid's box, it is open to the room.
    pub height_m: f32,
    /// Density.
    pub density_kg_m3: f32,
    /// Kinematic viscosity.
    pub viscosity_m2_s: f32,
    /// Diffusivity of smoke and of warmth.
    pub diffusivity_m2_s: f32,
    /// Temperature of the room.
    pub ambient_k: f32,
    /// How much hotter what comes from the vents is: at most so much that it is lighter by a tenth,
    /// beyond which buoyancy beside open sides is not known (see
    /// [`Flow::set_medium`](crate::solver::flow::Flow::set_medium)).
    pub hotter_k: f32,
    /// Number of vents that are open at a time.
    pub vents: usize,
    /// How wide a vent is.
    pub vent_radius_m: f32,
    /// Volume fraction of smoke that a second adds in a vent's middle.
    pub smoke_per_s: f32,
    /// Colour of the smoke: linear RGB, 0 to 1.
    pub colour: Vec3,
}

impl Gas {
    /// The box of cells that it is computed in: as wide as that of the liquid below, from its top.
    #[must_use]
    pub fn grid_over(&self, below: &Grid) -> Grid {
        let [nx, ny, nz] = below.cells;
        let rows = (self.height_m / below.spacing_m).round().max(1.0) as usize;
        let top_m = ny as f32 * below.spacing_m * Vec3::Y;
        Grid { cells: [nx, rows, nz], origin_in_world_m: below.origin_in_world_m + top_m, ..*below }
    }

    pub(super) fn check(&self) -> Result<(), Wrong> {
        number("gas.height_m", self.height_m, Bound::new(1e-3, 100.0))?;
        number("gas.density_kg_m3", self.density_kg_m3, Bound::new(1e-2, 100.0))?;
        number("gas.viscosity_m2_s", self.viscosity_m2_s, Bound::new(0.0, 1e4))?;
        number("gas.diffusivity_m2_s", self.diffusivity_m2_s, Bound::new(0.0, 1.0))?;
        number("gas.ambient_k", self.ambient_k, Bound::new(1.0, 5e3))?;
        number("gas.hotter_k", self.hotter_k, Bound::new(0.0, self.ambient_k / 9.0))?;
        number("gas.vents", self.vents as f32, Bound::new(0.0, 64.0))?;
        number("gas.vent_radius_m", self.vent_radius_m, Bound::new(1e-4, 1.0))?;
        number("gas.smoke_per_s", self.smoke_per_s, Bound::new(0.0, 1e3))?;
        colour("gas.colour", self.colour)
    }
}
