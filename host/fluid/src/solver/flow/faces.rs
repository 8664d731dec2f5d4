//! What lies between two cells: open liquid, a wall that holds it, or one that cuts the face.

use std::ops::Range;

use crate::{
    grid::Grid,
    mask::Mask,
    solver::{
        Side, Sides, Walls,
        flow::{
            field::{Field, Layout, Vector},
            walls::{Depth, WallFaces},
        },
    },
    vessel::{Vessel, cut::Cut},
};

/// Which cells are liquid and which faces open, as factors that kernels multiply by.
pub struct Faces {
    /// 1 at faces that liquid passes as it likes, 0 elsewhere.
    pub open: Vector,
    /// 1 in liquid cells, 0 elsewhere.
    pub liquid: Field,
    /// The rows of each plane from the first to the last that has any liquid.
    pub live_rows: Vec<Range<usize>>,
    /// Number of liquid cells.
    pub liquid_cells: usize,
    /// What walls cut; `None` if all cells are liquid throughout.
    pub vessel: Option<VesselFaces>,
    /// True if there is nothing that walls cut.
    pub is_box: bool,
}

/// The cut faces of a vessel.
pub struct VesselFaces {
    /// Part of each face that walls leave open, 0 to 1; on the sides of the box too, whether
    /// liquid passes there or not, and beyond them as next to them. It is the mass of the liquid
    /// that has the face's velocity, per density and cell volume.
    pub area: Vector,
    /// Area of the faces of each liquid cell that liquid passes as it likes, 0 elsewhere.
    pub open_area: Field,
    /// What the inverse of that has more than in a cell that no wall cuts, 0 elsewhere.
    pub lift: Field,
    /// How a flow near the walls differs from one far from them.
    pub walls: WallFaces,
}

impl Faces {
    /// The faces of the liquid in `vessel`, between sides and walls as given.
    pub fn new(layout: &Layout, grid: &Grid, vessel: &Vessel, sides: &Sides, walls: Walls) -> Self {
        let cut = (*vessel != Vessel::Box).then(|| Cut::new(grid, vessel));
        let cut = cut.filter(|cut| {
            let mut parts = cut.face.iter().flatten().chain(&cut.volume);
            parts.any(|part| *part < 1.0)
        });
        let mask = cut.as_ref().map_or_else(|| Mask::full(grid), |cut| Mask::of_cut(grid, cut));
        let vector = || [layout.zeros(), layout.zeros(), layout.zeros()];
        let (mut open, mut liquid) = (vector(), layout.zeros());
        let mut live_rows = vec![0..0; layout.cells[2]];
        let area = cut.as_ref().map(|cut| {
            per_face(layout, sides, |axis, face| cut.face[axis][cut.face_index(axis, face)])
        });
        let is_passed =
            |axis: usize, at: usize| area.as_ref().is_none_or(|area: &Vector| area[axis][at] > 0.0);
        for (i, j, k) in cells(layout.cells) {
            let (at, cell) = (layout.index(i, j, k), [i, j, k]);
            if !mask.is_liquid(cell.map(|c| c as isize)) {
                continue;
            }
            let first = if live_rows[k].is_empty() { j } else { live_rows[k].start };
            live_rows[k] = first..j + 1;
            liquid[at] = 1.0;
            for axis in 0..3 {
                let [lower, upper] = are_free(layout, sides, axis, cell);
                if lower && is_passed(axis, at) {
                    open[axis][at] = 1.0;
                }
                let above = at + layout.strides()[axis];
                let is_last = cell[axis] + 1 == layout.cells[axis];
                if is_last && upper && !sides.is_periodic(axis) && is_passed(axis, above) {
                    open[axis][above] = 1.0;
                }
            }
        }
        let vessel = cut.zip(area).map(|(cut, area)| {
            let depth = (walls == Walls::NoSlip).then(|| Depth {
                below_wall: per_face(layout, sides, |axis, face| cut.face_depth(axis, face)),
                bend: per_face(layout, sides, |axis, face| cut.face_bend(axis, face)),
            });
            let walls = WallFaces::new(layout, &open, &area, depth);
            let (open_area, lift) = cell_areas(layout, sides, &mask, &area);
            VesselFaces { area, open_area, lift, walls }
        });
        let (liquid_cells, is_box) = (mask.liquid_cells(), vessel.is_none());
        Self { open, liquid, live_rows, liquid_cells, vessel, is_box }
    }
}

/// All cells of a grid, x fastest.
pub fn cells([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))))
}

/// True for the lower and the upper face of a cell if it is no side of the box, or one that lets
/// pass what comes.
fn are_free(layout: &Layout, sides: &Sides, axis: usize, cell: [usize; 3]) -> [bool; 2] {
    let is_free = |side: Side| matches!(side, Side::Periodic | Side::Outflow);
    let [lower, upper] = sides.0[axis].map(is_free);
    [cell[axis] > 0 || lower, cell[axis] + 1 < layout.cells[axis] || upper]
}

/// The least of `value(axis, face)` for the places that a face has in a periodic box. Beyond
/// the sides it is as next to them.
fn per_face(layout: &Layout, sides: &Sides, value: impl Fn(usize, [usize; 3]) -> f32) -> Vector {
    let mut out = [layout.zeros(), layout.zeros(), layout.zeros()];
    let [_, sy, sz] = layout.strides();
    for (c, out) in out.iter_mut().enumerate() {
        for (i, j, k) in cells(layout.cells.map(|n| n + 2)) {
            let padded = [i, j, k];
            let face = std::array::from_fn(|axis| {
                let n = layout.cells[axis];
                let last = if axis == c { n } else { n - 1 };
                match sides.is_periodic(axis) {
                    true => (padded[axis] + n - 1) % n,
                    false => padded[axis].saturating_sub(1).min(last),
                }
            });
            let mut least = value(c, face);
            if sides.is_periodic(c) && face[c] == 0 {
                let mut same = face;
                same[c] = layout.cells[c];
                least = least.min(value(c, same));
            }
            out[i + j * sy + k * sz] = least;
        }
    }
    out
}

/// Open area of every liquid cell, and what its inverse has more than without walls.
fn cell_areas(layout: &Layout, sides: &Sides, mask: &Mask, area: &Vector) -> (Field, Field) {
    let (mut open_area, mut lift) = (layout.zeros(), layout.zeros());
    for (i, j, k) in cells(layout.cells) {
        let (at, cell) = (layout.index(i, j, k), [i, j, k]);
        if !mask.is_liquid(cell.map(|c| c as isize)) {
            continue;
        }
        let (mut open, mut whole) = (0.0, 0.0);
        for (axis, area) in area.iter().enumerate() {
            for (end, is_free) in are_free(layout, sides, axis, cell).into_iter().enumerate() {
                let free = f32::from(is_free);
                open += free * area[at + end * layout.strides()[axis]];
                whole += free;
            }
        }
        open_area[at] = open;
        lift[at] = if open > 0.0 { 1.0 / open - 1.0 / whole } else { 0.0 };
    }
    (open_area, lift)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces_of(grid: &Grid, vessel: &Vessel, sides: &Sides) -> (Layout, Faces) {
        let layout = Layout::new(grid.cells);
        (layout, Faces::new(&layout, grid, vessel, sides, Walls::NoSlip))
    }

    #[test]
    fn periodic_and_outflow_sides_are_open_and_all_others_closed() {
        let sides = Sides::all(Side::NoSlip)
            .with(0, [Side::Periodic; 2])
            .with(1, [Side::Outflow, Side::FreeSlip]);
        let (layout, faces) = faces_of(&Grid::unit_cube(4), &Vessel::Box, &sides);
        let open = |axis: usize, [i, j, k]: [usize; 3]| faces.open[axis][layout.index(i, j, k)];
        assert_eq!((open(0, [0, 1, 1]), open(1, [1, 0, 1]), open(2, [1, 1, 0])), (1.0, 1.0, 0.0));
        assert_eq!((open(1, [1, 4, 1]), open(1, [1, 1, 1])), (0.0, 1.0));
        assert!(faces.is_box && faces.vessel.is_none());
    }

    #[test]
    fn open_faces_are_counted_from_both_sides_and_cells_have_some() {
        let pot = Vessel::Pot { centre_in_world_m: glam::Vec3::splat(0.5), radius_m: 0.45 };
        let (layout, faces) = faces_of(&Grid::unit_cube(8), &pot, &Sides::all(Side::NoSlip));
        let vessel = faces.vessel.as_ref().expect("no box");
        let mut open = 0.0;
        for (i, j, k) in cells(layout.cells) {
            let at = layout.index(i, j, k);
            open += (0..3).map(|c| faces.open[c][at] * vessel.area[c][at]).sum::<f32>();
            assert_eq!(faces.liquid[at] > 0.0, vessel.open_area[at] > 0.0);
        }
        let counted = vessel.open_area.iter().sum::<f32>();
        assert!(open > 0.0 && (counted - 2.0 * open).abs() < 1e-3, "{counted} {open}");
        assert_eq!(faces.liquid.iter().sum::<f32>(), faces.liquid_cells as f32);
    }
}
