//! What holds the liquid: the box of the grid itself, or a pot standing in it.

use glam::Vec3;

/// A vessel in world metres. The rest surface of the liquid is the top of the grid's box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vessel {
    /// The walls of the grid's own box.
    Box,
    /// A pot with a round bottom: a hemisphere, and a cylinder of the same radius above it,
    /// open at the top. Its axis is vertical.
    Pot {
        /// Centre of the hemisphere.
        centre_in_world_m: Vec3,
        /// Inner radius of hemisphere and cylinder.
        radius_m: f32,
    },
}

impl Vessel {
    /// Distance from `point_in_world_m` to the pot's inner wall, positive inside; infinite for
    /// [`Vessel::Box`], whose walls are the grid's own faces.
    #[must_use]
    pub fn depth_inside_m(&self, point_in_world_m: Vec3) -> f32 {
        match *self {
            Self::Box => f32::INFINITY,
            Self::Pot { centre_in_world_m, radius_m } => {
                let mut from_axis = point_in_world_m - centre_in_world_m;
                from_axis.y = from_axis.y.min(0.0);
                radius_m - from_axis.length()
            }
        }
    }
}
