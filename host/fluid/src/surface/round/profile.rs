//! The wall of a round vessel.

use glam::Vec3;

use crate::{
    grid::Grid,
    solver::{Refused, SetupError},
    vessel::Vessel,
};

/// A wall all around a vertical axis: down to some depth below the surface its squared radius is
/// a quadratic of the depth, as that of an upright cylinder, a sphere and a paraboloid is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Depth of its lower end.
    pub down_to_m: f64,
    /// Of these numbers a, b, c: the squared radius at the depth d is a + b d + c d^2.
    pub square: [f64; 3],
}

impl Piece {
    /// The squared radius in m^2 at a depth, and its slope by the depth in m.
    pub fn square_and_slope(&self, depth_m: f64) -> [f64; 2] {
        let [c0, c1, c2] = self.square;
        [c0 + depth_m * (c1 + depth_m * c2), c1 + 2.0 * depth_m * c2]
    }

    /// The squared radius in m^2 where it may be least or greatest: at its ends, the upper first,
    /// and where its slope is 0, if that is between.
    fn extremes_m2(&self, above_m: f64) -> [f64; 3] {
        let [_, c1, c2] = self.square;
        let turn_m = if c2 == 0.0 { above_m } else { -0.5 * c1 / c2 };
        let between_m = if turn_m > above_m && turn_m < self.down_to_m { turn_m } else { above_m };
        [above_m, self.down_to_m, between_m].map(|depth_m| self.square_and_slope(depth_m)[0])
    }
}

/// A round vessel below the rest surface, and where its axis stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// x and z of the axis in world metres.
    pub axis_in_world_m: [f64; 2],
    /// The wall, from the surface down.
    pub pieces: Vec<Piece>,
}

/// A side of the box may cut so much off a vessel, of its radius, which leaves it round enough.
const CUT_OFF: f64 = 0.01;

impl Profile {
    /// The profile of a wall of these pieces.
    ///
    /// # Errors
    /// [`Refused`] if a depth is not finite or not below the one before, or a squared radius
    /// above the lowest depth is not positive.
    pub fn new(axis_in_world_m: [f64; 2], pieces: Vec<Piece>) -> Result<Self, Refused> {
        let mut above_m = 0.0;
        for piece in &pieces {
            positive("depth of a round vessel in m", piece.down_to_m - above_m)?;
            let [top_m2, bottom_m2, between_m2] = piece.extremes_m2(above_m);
            // It may end in a point, but for rounding.
            for square_m2 in [top_m2, bottom_m2 + 1e-6 * top_m2, between_m2] {
                positive("squared radius of a round vessel in m^2", square_m2)?;
            }
            above_m = piece.down_to_m;
        }
        positive("depth of a round vessel in m", above_m)?;
        Ok(Self { axis_in_world_m, pieces })
    }

    /// The profile of the liquid that `vessel` holds in the box of `grid`.
    ///
    /// # Errors
    /// [`SetupError::Unsupported`] if that is not round: another shape, a cylinder that does not
    /// stand upright, or one that the sides of the box cut. [`SetupError::Refused`] as
    /// [`Profile::new`] does, also if the vessel ends below the surface.
    pub fn of_vessel(vessel: &Vessel, grid: &Grid) -> Result<Self, SetupError> {
        let low = grid.origin_in_world_m.as_dvec3();
        let high = low + grid.extent_m().as_dvec3();
        let floor_m = high.y - low.y;
        let (centre, radius_m) = match vessel {
            Vessel::Cylinder { axis, .. } if !is_upright(*axis) => {
                return Err(SetupError::Unsupported("waves in a cylinder need it upright"));
            }
            Vessel::Pot { centre_in_world_m, radius_m }
            | Vessel::Bowl { centre_in_world_m, radius_m }
            | Vessel::Cylinder { centre_in_world_m, radius_m, .. } => {
                (centre_in_world_m.as_dvec3(), f64::from(*radius_m))
            }
            Vessel::Box | Vessel::Distance(_) => {
                return Err(SetupError::Unsupported("these waves need a round vessel"));
            }
        };
        positive("radius of a round vessel in m", radius_m)?;
        let (square_m2, centre_depth_m) = (radius_m * radius_m, high.y - centre.y);
        let upright = |down_to_m| Piece { down_to_m, square: [square_m2, 0.0, 0.0] };
        let round = Piece {
            down_to_m: floor_m.min(centre_depth_m + radius_m),
            square: [square_m2 - centre_depth_m.powi(2), 2.0 * centre_depth_m, -1.0],
        };
        let pieces = match vessel {
            Vessel::Bowl { .. } => vec![round],
            Vessel::Pot { .. } if centre_depth_m <= 0.0 => vec![round],
            Vessel::Pot { .. } if centre_depth_m < floor_m => vec![upright(centre_depth_m), round],
            _ => vec![upright(floor_m)],
        };
        let profile = Self::new([centre.x, centre.z], pieces)?;
        let room_m = (centre - low).min(high - centre);
        if room_m.x.min(room_m.z) < (1.0 - CUT_OFF) * profile.widest_m() {
            return Err(SetupError::Unsupported("a side of the box cuts the round vessel"));
        }
        Ok(profile)
    }

    /// Radius of the surface in m.
    pub fn radius_m(&self) -> f64 {
        self.pieces[0].square_and_slope(0.0)[0].sqrt()
    }

    /// Greatest depth in m.
    pub fn depth_m(&self) -> f64 {
        self.pieces[self.pieces.len() - 1].down_to_m
    }

    /// Greatest radius in m.
    fn widest_m(&self) -> f64 {
        let tops = self.pieces.iter().map(|piece| piece.down_to_m);
        let pieces = self.pieces.iter().zip(std::iter::once(0.0).chain(tops));
        pieces.flat_map(|(piece, above_m)| piece.extremes_m2(above_m)).fold(0.0, f64::max).sqrt()
    }
}

fn positive(what: &'static str, value: f64) -> Result<(), Refused> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(Refused { what, value }) }
}

/// But for rounding.
fn is_upright(axis: Vec3) -> bool {
    axis.y != 0.0 && axis.cross(Vec3::Y).length() <= 1e-6 * axis.length()
}
