//! The box of cells that everything on the host is computed in.

use glam::Vec3;

/// A regular grid of cubic cells in world metres, y up.
///
/// Cell (0, 0, 0) has its lower corner at `origin_in_world_m`. Cell arrays are flat,
/// x fastest, then y, then z: see [`Grid::cell`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Cells along x, y and z; each at least 1.
    pub cells: [usize; 3],
    /// Edge of a cell in metres.
    pub spacing_m: f32,
    /// Lower corner of the box in world metres.
    pub origin_in_world_m: Vec3,
}

impl Grid {
    /// The unit cube cut into n x n x n cells, lower corner at the origin: the benchmarks' box.
    #[must_use]
    pub fn unit_cube(n: usize) -> Self {
        Self { cells: [n; 3], spacing_m: 1.0 / n as f32, origin_in_world_m: Vec3::ZERO }
    }

    /// Number of cells in the box.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.iter().product()
    }

    /// True if the box has no cell, which a validated scene never has.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Index of cell (i, j, k) in a flat cell array.
    #[must_use]
    pub fn cell(&self, i: usize, j: usize, k: usize) -> usize {
        i + self.cells[0] * (j + self.cells[1] * k)
    }

    /// Centre of cell (i, j, k) in world metres.
    #[must_use]
    pub fn centre_in_world_m(&self, i: usize, j: usize, k: usize) -> Vec3 {
        self.origin_in_world_m
            + self.spacing_m * Vec3::new(i as f32 + 0.5, j as f32 + 0.5, k as f32 + 0.5)
    }

    /// The corners of all cells in world metres, one more along each axis than there are cells,
    /// x fastest, then y, then z.
    pub fn corners(&self) -> impl Iterator<Item = Vec3> + use<> {
        let (origin, spacing_m) = (self.origin_in_world_m, self.spacing_m);
        let [nx, ny, nz] = self.cells;
        let corner = move |i, j, k| origin + spacing_m * Vec3::new(i as f32, j as f32, k as f32);
        (0..=nz)
            .flat_map(move |k| (0..=ny).flat_map(move |j| (0..=nx).map(move |i| corner(i, j, k))))
    }

    /// Edges of the whole box in metres.
    #[must_use]
    pub fn extent_m(&self) -> Vec3 {
        let [nx, ny, nz] = self.cells;
        self.spacing_m * Vec3::new(nx as f32, ny as f32, nz as f32)
    }

    /// Volume of a cell in cubic metres.
    #[must_use]
    pub fn cell_volume_m3(&self) -> f32 {
        self.spacing_m * self.spacing_m * self.spacing_m
    }
}
