//! What holds the liquid: the box of the grid itself, or a vessel standing in it.

mod bvh;
pub mod cut;
mod distance;
mod glb;
mod holes;
mod hollow;
mod mesh;
mod obj;

use std::sync::Arc;

use glam::Vec3;

use crate::{grid::Grid, solver::Refused};

pub use distance::DistanceGrid;
pub use hollow::MeshOf;
pub use mesh::{Mesh, MeshError, MeshFault};

/// The walls of an open vessel go on for so much above the liquid at rest.
pub const RIM_M: f32 = 0.02;

/// A vessel in world metres. The rest surface of the liquid is the top of the grid's box, and
/// where a vessel goes on beyond the box, the sides of the box are its walls.
///
/// The wire to the device knows planes and pots: the hand feels a [`Vessel::Bowl`] as a pot (its
/// wall goes straight up above its centre), a [`Vessel::Cylinder`] and a [`Vessel::Distance`] as
/// the grid's box.
#[derive(Clone, Debug, PartialEq)]
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
    /// The inside of a sphere, open where the top of the grid's box cuts it.
    Bowl {
        /// Centre of the sphere.
        centre_in_world_m: Vec3,
        /// Its inner radius.
        radius_m: f32,
    },
    /// The inside of a round tube without end, closed or open where the grid's box cuts it.
    Cylinder {
        /// A point on the axis.
        centre_in_world_m: Vec3,
        /// Direction of the axis, of any length but 0, which makes a sphere of it.
        axis: Vec3,
        /// Inner radius.
        radius_m: f32,
    },
    /// Any shape, by its distance at the nodes of a lattice.
    Distance(Arc<DistanceGrid>),
}

impl Vessel {
    /// The vessel whose depth in metres (distance to the wall, positive inside) is
    /// `depth_inside_m` of a point in world metres. It is taken at the corners of the cells of
    /// `grid`, linear between them; a function that is not a distance will do if it is smooth
    /// where it is 0.
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite.
    ///
    /// ```
    /// use cauldron_fluid::{Grid, Vessel, vessel::cut::Cut};
    ///
    /// // A ring, lying.
    /// let (middle_m, radius_m) = (0.3f32, 0.15f32);
    /// let grid = Grid::unit_cube(24);
    /// let ring = Vessel::from_distance(&grid, |p| {
    ///     let p = p - 0.5;
    ///     radius_m - (p.x.hypot(p.z) - middle_m).hypot(p.y)
    /// })?;
    /// let exact_m3 = 2.0 * std::f32::consts::PI.powi(2) * middle_m * radius_m.powi(2);
    /// let measured_m3 = Cut::new(&grid, &ring).volume_m3() as f32;
    /// assert!((measured_m3 / exact_m3 - 1.0).abs() < 0.02, "{measured_m3} {exact_m3}");
    /// # Ok::<(), cauldron_fluid::solver::Refused>(())
    /// ```
    pub fn from_distance(
        grid: &Grid,
        depth_inside_m: impl Fn(Vec3) -> f32,
    ) -> Result<Self, Refused> {
        Ok(Self::Distance(Arc::new(DistanceGrid::new(grid, depth_inside_m)?)))
    }

    /// The vessel that `mesh` shows, as distances at the corners of the cells of `grid`. A wall
    /// is as sharp as these cells: a finer grid than the solver's keeps more of it.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh has holes below the top of the box of `grid`, or no liquid up to
    /// there; for [`MeshOf::Wall`] also if its point lies in the wall or outside of the box, or
    /// if the liquid runs out to a side of the box: a wall has to be two cells thick.
    ///
    /// ```
    /// use cauldron_fluid::{Grid, Vessel, vessel::{Mesh, MeshOf}};
    /// use glam::Vec3;
    ///
    /// // A tent of liquid upside down: four faces to the tip, and the mouth left open.
    /// let tip = Vec3::new(0.5, 0.1, 0.5);
    /// let rim = [(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)];
    /// let mut points = vec![tip];
    /// points.extend(rim.map(|(x, z)| Vec3::new(x, 1.0, z)));
    /// let mesh = Mesh::new(points, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])?;
    /// let tent = Vessel::from_mesh(&mesh, &Grid::unit_cube(16), MeshOf::Liquid)?;
    /// assert!(tent.depth_inside_m(Vec3::new(0.5, 0.5, 0.5)) > 0.1);
    /// assert!(tent.depth_inside_m(Vec3::new(0.2, 0.5, 0.5)) < 0.0);
    /// # Ok::<(), cauldron_fluid::vessel::MeshError>(())
    /// ```
    pub fn from_mesh(mesh: &Mesh, grid: &Grid, of: MeshOf) -> Result<Self, MeshError> {
        Ok(Self::Distance(Arc::new(hollow::distance(mesh, grid, of)?)))
    }

    /// Distance from `point_in_world_m` to the inner wall, positive inside; infinite for
    /// [`Vessel::Box`], whose walls are the grid's own faces. It is the distance itself for all
    /// but [`Vessel::Distance`], which is linear between its nodes.
    #[must_use]
    pub fn depth_inside_m(&self, point_in_world_m: Vec3) -> f32 {
        match self {
            Self::Box => f32::INFINITY,
            Self::Pot { centre_in_world_m, radius_m } => {
                let mut from_axis = point_in_world_m - centre_in_world_m;
                from_axis.y = from_axis.y.min(0.0);
                radius_m - from_axis.length()
            }
            Self::Bowl { centre_in_world_m, radius_m } => {
                radius_m - point_in_world_m.distance(*centre_in_world_m)
            }
            Self::Cylinder { centre_in_world_m, axis, radius_m } => {
                let from_centre = point_in_world_m - centre_in_world_m;
                let along = axis.normalize_or_zero();
                radius_m - (from_centre - from_centre.dot(along) * along).length()
            }
            Self::Distance(grid) => grid.depth_inside_m(point_in_world_m),
        }
    }

    /// Greatest depth at a corner of the cells of `grid`: the radius of the largest sphere that
    /// finds room, but for the sides of the box.
    #[must_use]
    pub fn greatest_depth_m(&self, grid: &Grid) -> f32 {
        let depths = grid.corners().map(|at| self.depth_inside_m(at));
        depths.fold(f32::NEG_INFINITY, f32::max)
    }
}
