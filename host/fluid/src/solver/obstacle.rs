//! Solids that stand or move in a flow.

use std::sync::Arc;

use glam::{Quat, Vec3};

use super::{Refused, within};
use crate::{grid::Grid, vessel::DistanceGrid};

/// No point of an obstacle moves faster.
const MAX_SPEED_M_S: f64 = 1e3;

/// No obstacle is larger, or farther away.
const MAX_LENGTH_M: f64 = 1e9;

/// The shape of an obstacle, about an origin of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball about the origin.
    Sphere {
        /// Its radius, above 0.
        radius_m: f32,
    },
    /// Any shape, by its distance at the nodes of a lattice: see [`Shape::from_distance`].
    Distance(Arc<DistanceGrid>),
}

impl Shape {
    /// The shape with this signed distance in metres (positive outside of it) of a point in its own
    /// frame. It is taken at the corners of the cells of `grid`, linear between them, and the
    /// shape ends at the sides of that grid's box. A function that is not a distance will do if
    /// it is smooth where it is 0.
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite.
    ///
    /// ```
    /// use cauldron_fluid::{Grid, solver::obstacle::Shape};
    /// use glam::Vec3;
    ///
    /// // A rod of 2 cm by 10 cm, lying along x.
    /// let origin_in_world_m = Vec3::new(-0.06, -0.02, -0.02);
    /// let own = Grid { cells: [24, 8, 8], spacing_m: 0.005, origin_in_world_m };
    /// let rod = Shape::from_distance(&own, |p| {
    ///     let end_m = p.x.abs() - 0.05;
    ///     end_m.max(p.y.hypot(p.z) - 0.01)
    /// })?;
    /// assert!(rod.distance_m(Vec3::ZERO) < 0.0 && rod.distance_m(Vec3::Y) > 0.9);
    /// # Ok::<(), cauldron_fluid::solver::Refused>(())
    /// ```
    pub fn from_distance(grid: &Grid, distance_m: impl Fn(Vec3) -> f32) -> Result<Self, Refused> {
        let distances = DistanceGrid::new(grid, distance_m);
        let distances = distances.map_err(|refused| Refused { what: "distance_m", ..refused })?;
        Ok(Self::Distance(Arc::new(distances)))
    }

    /// Distance to a point in the shape's own frame, negative inside.
    #[must_use]
    pub fn distance_m(&self, point: Vec3) -> f32 {
        match self {
            Self::Sphere { radius_m } => point.length() - radius_m,
            Self::Distance(distances) => {
                let [low, high] = distances.corners();
                let to_box_m = point.distance(point.clamp(low, high));
                let distance_m = distances.depth_inside_m(point);
                if to_box_m > 0.0 { distance_m.max(to_box_m) } else { distance_m }
            }
        }
    }

    /// Lowest and highest corner of a box around the shape in its own frame.
    #[must_use]
    pub fn bounds_m(&self) -> [Vec3; 2] {
        match self {
            Self::Sphere { radius_m } => [Vec3::splat(-radius_m), Vec3::splat(*radius_m)],
            Self::Distance(distances) => distances.corners(),
        }
    }

    /// Distance from its own origin to the farthest point of the box around it.
    pub(super) fn reach_m(&self) -> f32 {
        match self {
            Self::Sphere { radius_m } => *radius_m,
            Self::Distance(_) => {
                let [low, high] = self.bounds_m();
                low.abs().max(high.abs()).length()
            }
        }
    }
}

/// Where an obstacle is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Place of the shape's own origin, about which it turns.
    pub centre_in_world_m: Vec3,
    /// How it is turned; of any length but 0.
    pub rotation: Quat,
    /// Velocity of that place.
    pub velocity_m_s: Vec3,
    /// Axis and speed of its turning.
    pub angular_velocity_rad_s: Vec3,
}

impl Motion {
    /// At rest at a place.
    #[must_use]
    pub fn at(centre_in_world_m: Vec3) -> Self {
        let (rotation, rest) = (Quat::IDENTITY, Vec3::ZERO);
        Self { centre_in_world_m, rotation, velocity_m_s: rest, angular_velocity_rad_s: rest }
    }

    /// Moving at a place without turning.
    #[must_use]
    pub fn moving(centre_in_world_m: Vec3, velocity_m_s: Vec3) -> Self {
        Self { velocity_m_s, ..Self::at(centre_in_world_m) }
    }

    /// Velocity of the solid at a point that is `from_centre_m` from its centre.
    #[must_use]
    pub fn velocity_at(&self, from_centre_m: Vec3) -> Vec3 {
        self.velocity_m_s + self.angular_velocity_rad_s.cross(from_centre_m)
    }
}

/// A rigid solid in a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Its shape.
    pub shape: Shape,
    /// Where it is and how it moves.
    pub motion: Motion,
}

impl Obstacle {
    /// A resting ball.
    #[must_use]
    pub fn sphere(centre_in_world_m: Vec3, radius_m: f32) -> Self {
        Self { shape: Shape::Sphere { radius_m }, motion: Motion::at(centre_in_world_m) }
    }

    /// Checks that a flow can take it.
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite, the radius is not above 0, the rotation has no length,
    /// it is larger or farther away than 10^9 m, or a point of it moves faster than 1000 m/s.
    pub fn check(&self) -> Result<(), Refused> {
        if let Shape::Sphere { radius_m } = self.shape
            && radius_m <= 0.0
        {
            return Err(Refused { what: "radius_m", value: f64::from(radius_m) });
        }
        let Motion { centre_in_world_m, rotation, velocity_m_s, angular_velocity_rad_s } =
            self.motion;
        let reach_m = f64::from(self.shape.reach_m());
        within("radius_m", reach_m, MAX_LENGTH_M)?;
        each_within("centre_in_world_m", centre_in_world_m, MAX_LENGTH_M)?;
        let length = f64::from(rotation.length());
        if !(length.is_finite() && length > 0.0) {
            return Err(Refused { what: "rotation", value: length });
        }
        each_within("velocity_m_s", velocity_m_s, MAX_SPEED_M_S)?;
        let most_rad_s = MAX_SPEED_M_S / reach_m.max(1e-9);
        each_within("angular_velocity_rad_s", angular_velocity_rad_s, most_rad_s)
    }
}

fn each_within(what: &'static str, vector: Vec3, limit: f64) -> Result<(), Refused> {
    vector.to_array().into_iter().try_for_each(|x| within(what, f64::from(x), limit).map(drop))
}

/// Names an obstacle of a flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ObstacleId(pub(super) u32);

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(change: impl Fn(&mut Obstacle)) -> &'static str {
        let mut ball = Obstacle::sphere(Vec3::ZERO, 0.1);
        assert_eq!(ball.check(), Ok(()));
        change(&mut ball);
        ball.check().expect_err("it cannot be").what
    }

    #[test]
    fn what_cannot_be_is_refused_by_its_name() {
        assert_eq!(refused(|o| o.shape = Shape::Sphere { radius_m: f32::NAN }), "radius_m");
        assert_eq!(refused(|o| o.shape = Shape::Sphere { radius_m: 0.0 }), "radius_m");
        assert_eq!(refused(|o| o.motion.centre_in_world_m.y = f32::INFINITY), "centre_in_world_m");
        assert_eq!(
            refused(|o| o.motion.rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
            "rotation"
        );
        assert_eq!(refused(|o| o.motion.velocity_m_s.z = -1001.0), "velocity_m_s");
        // A tenth of a metre from the axis 20 000 rad/s are 2000 m/s.
        assert_eq!(refused(|o| o.motion.angular_velocity_rad_s.x = 2e4), "angular_velocity_rad_s");
        let own = Grid::unit_cube(2);
        assert_eq!(Shape::from_distance(&own, |_| f32::NAN).unwrap_err().what, "distance_m");
    }

    #[test]
    fn a_shape_ends_at_the_sides_of_its_own_box() {
        let solid = Shape::from_distance(&Grid::unit_cube(2), |_| -1.0).expect("finite");
        assert_eq!(solid.distance_m(Vec3::splat(0.5)), -1.0);
        assert_eq!(solid.distance_m(Vec3::new(3.0, 0.5, 0.5)), 2.0);
    }

    #[test]
    fn a_point_of_a_turning_solid_moves_across_its_arm() {
        let mut motion = Motion::moving(Vec3::ONE, Vec3::X);
        motion.angular_velocity_rad_s = 2.0 * Vec3::Z;
        assert_eq!(motion.velocity_at(Vec3::X), Vec3::new(1.0, 2.0, 0.0));
    }
}
