//! Which cells of a grid hold liquid.

use glam::Vec3;

use crate::{
    grid::Grid,
    vessel::{Vessel, cut::Cut},
};

/// The liquid cells of a vessel: those that it leaves any liquid in (see [`Cut`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    cells: [usize; 3],
    liquid: Vec<bool>,
    liquid_cells: usize,
}

impl Mask {
    /// The cells of `grid` that `vessel` holds.
    #[must_use]
    pub fn new(grid: &Grid, vessel: &Vessel) -> Self {
        match vessel {
            Vessel::Box => Self::full(grid),
            vessel => Self::of_cut(grid, &Cut::new(grid, vessel)),
        }
    }

    /// All cells of `grid`.
    #[must_use]
    pub fn full(grid: &Grid) -> Self {
        Self::of(grid.cells, vec![true; grid.len()])
    }

    /// The cells of `grid` that `cut` leaves any liquid in.
    #[must_use]
    pub fn of_cut(grid: &Grid, cut: &Cut) -> Self {
        Self::of(grid.cells, cut.volume.iter().map(|volume| *volume > 0.0).collect())
    }

    fn of(cells: [usize; 3], liquid: Vec<bool>) -> Self {
        let liquid_cells = liquid.iter().filter(|is_liquid| **is_liquid).count();
        Self { cells, liquid, liquid_cells }
    }

    /// Memory that it takes.
    pub(crate) fn bytes(&self) -> usize {
        self.liquid.len()
    }

    /// Number of liquid cells.
    #[must_use]
    pub fn liquid_cells(&self) -> usize {
        self.liquid_cells
    }

    /// True if the cell is inside the grid.
    #[must_use]
    pub fn contains(&self, cell: [isize; 3]) -> bool {
        (0..3).all(|d| (0..self.cells[d] as isize).contains(&cell[d]))
    }

    /// True if the cell is inside the grid and liquid; any index may be asked for.
    #[must_use]
    pub fn is_liquid(&self, cell: [isize; 3]) -> bool {
        let [i, j, k] = cell.map(|c| c as usize);
        self.contains(cell) && self.liquid[i + self.cells[0] * (j + self.cells[1] * k)]
    }

    /// True if the cell that contains `point_in_world_m` is liquid.
    #[must_use]
    pub fn holds(&self, grid: &Grid, point_in_world_m: Vec3) -> bool {
        let cell = (point_in_world_m - grid.origin_in_world_m) / grid.spacing_m;
        point_in_world_m.is_finite() && self.is_liquid(cell.to_array().map(|c| c.floor() as isize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_liquid_throughout_and_nowhere_else() {
        let mask = Mask::new(&Grid::unit_cube(4), &Vessel::Box);
        assert_eq!(mask.liquid_cells(), 64);
        assert!(!mask.holds(&Grid::unit_cube(4), Vec3::splat(f32::NAN)));
        assert!(!mask.is_liquid([-1, 0, 0]));
    }

    #[test]
    fn a_pot_has_the_volume_of_its_hemisphere_and_cylinder() {
        let (radius, height) = (0.12f32, 0.256f32);
        let grid = Grid { cells: [64; 3], spacing_m: height / 64.0, origin_in_world_m: Vec3::ZERO };
        let centre = Vec3::new(0.128, 0.128, 0.128);
        let pot = Vessel::Pot { centre_in_world_m: centre, radius_m: radius };
        let mask = Mask::new(&grid, &pot);
        let pi = std::f32::consts::PI;
        let exact = pi * radius * radius * ((height - 0.128) + 2.0 / 3.0 * radius);
        let measured = mask.liquid_cells() as f32 * grid.cell_volume_m3();
        assert!((1.02..1.08).contains(&(measured / exact)), "cut cells too: {measured} {exact}");
        assert!(mask.holds(&grid, centre) && !mask.holds(&grid, Vec3::ZERO));
        assert!(!mask.holds(&grid, Vec3::splat(9.0)));
    }
}
