//! The static geometry: what never goes stale, since a wall must not vanish under a pressing hand.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::units::{Metres, NewtonSecondsPerMetre, NewtonsPerMetre};

/// Walls that a vessel can be made of.
pub const MAX_WALLS: usize = 8;

/// A wall that keeps the probe on its inner side, in device metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Wall {
    /// The side of a plane that `normal` (of unit length) points to:
    /// `normal . p >= offset`.
    Plane {
        /// Unit normal, towards where the probe may be.
        normal: [f32; 3],
        /// Distance of the plane from the origin along `normal`.
        offset: Metres,
    },
    /// The inside of a pot: a hemisphere below `centre` and a vertical cylinder of the same
    /// radius above it, open at the top.
    Pot {
        /// Centre of the hemisphere.
        centre: [Metres; 3],
        /// Inner radius, less the probe's own.
        radius: Metres,
        /// Height of the rim above `centre`; above it there is no wall.
        rim: Metres,
    },
}

/// The vessel: walls, and how hard they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Vessel {
    /// The walls; none is a free space.
    pub walls: Vec<Wall, MAX_WALLS>,
    /// Penalty stiffness of every wall.
    pub stiffness: NewtonsPerMetre,
    /// Damping of every wall, against motion into it.
    pub damping: NewtonSecondsPerMetre,
}
