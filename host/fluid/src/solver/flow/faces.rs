//! What lies between two cells: open liquid, a wall that holds it, or one it slides along.

use std::ops::Range;

use crate::{
    mask::Mask,
    solver::{
        Side, Sides, Walls,
        flow::field::{Field, Layout, Vector},
    },
};

/// Which cells are liquid and which faces open, as factors that kernels multiply by.
pub struct Faces {
    /// 1 at open faces, 0 elsewhere.
    pub open: Vector,
    /// Weight of a face's own velocity in the viscous stencil (see [`wall_weight`]).
    pub weight: Vector,
    /// 1 in liquid cells, 0 elsewhere.
    pub liquid: Field,
    /// Number of open faces of each liquid cell, 0 elsewhere.
    pub open_count: Field,
    /// The rows of each plane from the first to the last that has any liquid.
    pub live_rows: Vec<Range<usize>>,
    /// Number of liquid cells.
    pub liquid_cells: usize,
    /// True if all cells are liquid.
    pub is_box: bool,
}

impl Faces {
    /// The faces of the liquid cells of `mask`, between sides and walls as given.
    pub fn new(layout: &Layout, mask: &Mask, sides: &Sides, walls: Walls) -> Self {
        let [_, _, nz] = layout.cells;
        let vector = || [layout.zeros(), layout.zeros(), layout.zeros()];
        let (mut open, mut weight) = (vector(), vector());
        let (mut liquid, mut open_count) = (layout.zeros(), layout.zeros());
        let mut live_rows = vec![0..0; nz];
        for (i, j, k) in cells(layout.cells) {
            let (at, cell) = (layout.index(i, j, k), [i, j, k].map(|c| c as isize));
            if !mask.is_liquid(cell) {
                continue;
            }
            let first = if live_rows[k].is_empty() { j } else { live_rows[k].start };
            live_rows[k] = first..j + 1;
            liquid[at] = 1.0;
            for axis in 0..3 {
                let is_open = |end: usize| {
                    let other = neighbour(cell, axis, [-1, 1][end]);
                    let n = layout.cells[axis] as isize;
                    match sides.0[axis][end] {
                        _ if (0..n).contains(&other[axis]) => mask.is_liquid(other),
                        Side::Periodic => mask.is_liquid(wrapped(other, axis, n)),
                        side => side == Side::Outflow,
                    }
                };
                open_count[at] += f32::from(is_open(0)) + f32::from(is_open(1));
                if is_open(0) {
                    open[axis][at] = 1.0;
                    weight[axis][at] = face_weight(mask, walls, axis, cell);
                }
                let is_last = cell[axis] + 1 == layout.cells[axis] as isize;
                if is_last && sides.0[axis][1] == Side::Outflow {
                    open[axis][at + layout.strides()[axis]] = 1.0;
                }
            }
        }
        let (liquid_cells, is_box) = (mask.liquid_cells(), mask.is_box());
        Self { open, weight, liquid, open_count, live_rows, liquid_cells, is_box }
    }
}

/// All cells of a grid, x fastest.
pub fn cells([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))))
}

fn neighbour(mut cell: [isize; 3], axis: usize, step: isize) -> [isize; 3] {
    cell[axis] += step;
    cell
}

fn wrapped(mut cell: [isize; 3], axis: usize, n: isize) -> [isize; 3] {
    cell[axis] = cell[axis].rem_euclid(n);
    cell
}

/// The viscous stencil of an open face is the sum over its six neighbours minus this weight
/// times its own velocity; neighbours in a wall count 0, those beyond a side are ghosts.
fn face_weight(mask: &Mask, walls: Walls, axis: usize, cell: [isize; 3]) -> f32 {
    let sides = (0..3).flat_map(|along| [(along, -1), (along, 1)]);
    let weights = sides.map(|(along, step)| {
        let other = neighbour(cell, along, step);
        wall_weight(mask, walls, axis, along, other)
    });
    weights.sum()
}

/// What one neighbour adds to the weight: 1 if it is open, a ghost, or a face of 0 velocity one
/// spacing away. A wall beside the face is half a spacing away: its mirrored ghost makes 2
/// where the liquid sticks to it, 0 where it slides.
fn wall_weight(mask: &Mask, walls: Walls, axis: usize, along: usize, other: [isize; 3]) -> f32 {
    let is_beside = along != axis;
    let is_solid = |cell| mask.contains(cell) && !mask.is_liquid(cell);
    let is_wall = is_solid(other) && is_solid(neighbour(other, axis, -1));
    match walls {
        _ if !(is_beside && is_wall) => 1.0,
        Walls::NoSlip => 2.0,
        Walls::FreeSlip => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{grid::Grid, vessel::Vessel};

    #[test]
    fn periodic_and_outflow_sides_are_open_and_all_others_closed() {
        let layout = Layout::new([4; 3]);
        let mask = Mask::new(&Grid::unit_cube(4), &Vessel::Box);
        let sides = Sides::all(Side::NoSlip)
            .with(0, [Side::Periodic; 2])
            .with(1, [Side::Outflow, Side::FreeSlip]);
        let faces = Faces::new(&layout, &mask, &sides, Walls::NoSlip);
        let open = |axis: usize, [i, j, k]: [usize; 3]| faces.open[axis][layout.index(i, j, k)];
        assert_eq!((open(0, [0, 1, 1]), open(1, [1, 0, 1]), open(2, [1, 1, 0])), (1.0, 1.0, 0.0));
        assert_eq!((open(1, [1, 4, 1]), open(1, [1, 1, 1])), (0.0, 1.0));
        assert_eq!(faces.open_count[layout.index(0, 0, 0)], 2.0 + 2.0 + 1.0);
        assert_eq!(faces.weight[0][layout.index(2, 0, 0)], 6.0, "sides have ghosts");
    }

    #[test]
    fn open_faces_are_counted_from_both_sides() {
        let grid = Grid::unit_cube(8);
        let layout = Layout::new(grid.cells);
        let pot = Vessel::Pot { centre_in_world_m: glam::Vec3::splat(0.5), radius_m: 0.45 };
        let faces =
            Faces::new(&layout, &Mask::new(&grid, &pot), &Sides::all(Side::NoSlip), Walls::NoSlip);
        let open: f32 = faces.open.iter().flat_map(|open| open.iter()).sum();
        assert!(open > 0.0 && !faces.is_box);
        assert_eq!(faces.open_count.iter().sum::<f32>(), 2.0 * open);
        assert_eq!(faces.liquid.iter().sum::<f32>(), faces.liquid_cells as f32);
    }
}
