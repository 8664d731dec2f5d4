//! A vessel of any shape: its depth at the nodes of a lattice.

use std::fmt;

use glam::{UVec3, Vec3};

use crate::{grid::Grid, solver::Refused};

/// Distances to a wall, positive inside, at the corners of the cells of a grid; linear between
/// them, and beyond the grid's box as at the nearest point of it.
#[derive(Clone, PartialEq)]
pub struct DistanceGrid {
    grid: Grid,
    /// Depth in metres at each corner, x fastest, then y, then z.
    depth_m: Vec<f32>,
}

/// A lattice has more numbers than a message has room for.
impl fmt::Debug for DistanceGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DistanceGrid").field("grid", &self.grid).finish_non_exhaustive()
    }
}

impl DistanceGrid {
    /// Takes `depth_inside_m` of each corner, in world metres.
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite.
    pub fn new(grid: &Grid, depth_inside_m: impl Fn(Vec3) -> f32) -> Result<Self, Refused> {
        Self::from_corners(grid, grid.corners().map(depth_inside_m).collect())
    }

    /// The same from the depths at [`Grid::corners`].
    pub(super) fn from_corners(grid: &Grid, depth_m: Vec<f32>) -> Result<Self, Refused> {
        match depth_m.iter().find(|depth| !depth.is_finite()) {
            Some(&depth) => Err(Refused { what: "depth_inside_m", value: f64::from(depth) }),
            None => Ok(Self { grid: *grid, depth_m }),
        }
    }

    /// Lowest and highest corner of the grid's box.
    #[must_use]
    pub fn corners(&self) -> [Vec3; 2] {
        let low = self.grid.origin_in_world_m;
        [low, low + self.grid.extent_m()]
    }

    /// Depth at a point.
    #[must_use]
    pub fn depth_inside_m(&self, point_in_world_m: Vec3) -> f32 {
        let cells = UVec3::from_array(self.grid.cells.map(|cells| cells as u32));
        let at = (point_in_world_m - self.grid.origin_in_world_m) / self.grid.spacing_m;
        let at = at.max(Vec3::ZERO).min(cells.as_vec3());
        let low = at.as_uvec3().min(cells - 1);
        let part = at - low.as_vec3();
        let [i, j, k] = low.to_array().map(|c| c as usize);
        let [nx, ny, _] = self.grid.cells.map(|cells| cells + 1);
        let along_x = |j: usize, k: usize| {
            let first = i + nx * (j + ny * k);
            lerp(self.depth_m[first], self.depth_m[first + 1], part.x)
        };
        let across = |k: usize| lerp(along_x(j, k), along_x(j + 1, k), part.y);
        lerp(across(k), across(k + 1), part.z)
    }
}

fn lerp(a: f32, b: f32, part: f32) -> f32 {
    a + part * (b - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_is_kept_and_the_edge_goes_on() {
        let grid =
            Grid { cells: [3, 4, 5], spacing_m: 0.5, origin_in_world_m: Vec3::new(1.0, 2.0, 3.0) };
        let slope = Vec3::new(0.3, -0.7, 0.2);
        let lattice = DistanceGrid::new(&grid, |p| slope.dot(p) + 0.1).unwrap();
        for p in [Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.5, 4.0, 5.5), Vec3::new(1.3, 2.9, 4.1)] {
            let exact = slope.dot(p) + 0.1;
            assert!((lattice.depth_inside_m(p) - exact).abs() < 1e-5);
        }
        let (above, top) = (Vec3::new(1.5, 9.0, 4.0), Vec3::new(1.5, 4.0, 4.0));
        assert_eq!(lattice.depth_inside_m(above), lattice.depth_inside_m(top));
        assert!(lattice.depth_inside_m(Vec3::NAN).is_finite());
        let refused = DistanceGrid::new(&grid, |_| f32::NAN).unwrap_err();
        assert_eq!(refused.what, "depth_inside_m");
    }
}
