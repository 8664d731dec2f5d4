//! What lies between two cells: open liquid, a wall that holds it, or one it slides along.

use std::ops::Range;

use crate::{
    mask::Mask,
    solver::{
        Walls,
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
    /// The faces of the liquid cells of `mask`.
    pub fn new(layout: &Layout, mask: &Mask, walls: Walls) -> Self {
        let [_, ny, nz] = layout.cells;
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
                let above = neighbour(cell, axis, 1);
                let both = [mask.is_open(axis, cell), mask.is_open(axis, above)];
                open_count[at] += both.map(f32::from).iter().sum::<f32>();
                if both[0] {
                    open[axis][at] = 1.0;
                    weight[axis][at] = face_weight(mask, walls, ny, axis, cell);
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

/// The viscous stencil of an open face is the sum over its six neighbours minus this weight
/// times its own velocity, neighbours that are not open counting 0.
fn face_weight(mask: &Mask, walls: Walls, ny: usize, axis: usize, cell: [isize; 3]) -> f32 {
    let sides = (0..3).flat_map(|along| [(along, -1), (along, 1)]);
    let weights = sides.map(|(along, step)| {
        let other = neighbour(cell, along, step);
        let is_lid = along == 1 && other[1] == ny as isize;
        wall_weight(mask, if is_lid { Walls::FreeSlip } else { walls }, axis, along, other)
    });
    weights.sum()
}

/// What one neighbour adds to the weight: 1 if it is open, or a face of 0 velocity one spacing
/// away. A wall beside the face is half a spacing away: its mirrored ghost makes 2 where the
/// liquid sticks to it, 0 where it slides.
fn wall_weight(mask: &Mask, walls: Walls, axis: usize, along: usize, other: [isize; 3]) -> f32 {
    let is_beside = along != axis;
    let is_solid = !mask.is_liquid(other) && !mask.is_liquid(neighbour(other, axis, -1));
    match walls {
        _ if !(is_beside && is_solid) => 1.0,
        Walls::NoSlip => 2.0,
        Walls::FreeSlip => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{grid::Grid, vessel::Vessel};

    #[test]
    fn walls_of_a_box_hold_or_let_slide_and_the_lid_always_does() {
        let layout = Layout::new([4; 3]);
        let mask = Mask::new(&Grid::unit_cube(4), &Vessel::Box);
        let weight = |walls, axis: usize, at: [usize; 3]| {
            Faces::new(&layout, &mask, walls).weight[axis][layout.index(at[0], at[1], at[2])]
        };
        assert_eq!(weight(Walls::NoSlip, 0, [2, 1, 1]), 6.0);
        assert_eq!(weight(Walls::NoSlip, 0, [2, 0, 1]), 7.0, "floor");
        assert_eq!(weight(Walls::NoSlip, 0, [2, 3, 1]), 5.0, "lid");
        assert_eq!(weight(Walls::NoSlip, 1, [2, 3, 1]), 6.0, "normal to the lid");
        assert_eq!(weight(Walls::FreeSlip, 0, [2, 0, 0]), 4.0);
        assert_eq!(weight(Walls::FreeSlip, 0, [0, 1, 1]), 0.0, "closed");
    }

    #[test]
    fn open_faces_are_counted_from_both_sides() {
        let grid = Grid::unit_cube(8);
        let layout = Layout::new(grid.cells);
        let pot = Vessel::Pot { centre_in_world_m: glam::Vec3::splat(0.5), radius_m: 0.45 };
        let faces = Faces::new(&layout, &Mask::new(&grid, &pot), Walls::NoSlip);
        let open: f32 = faces.open.iter().flat_map(|open| open.iter()).sum();
        assert!(open > 0.0 && !faces.is_box);
        assert_eq!(faces.open_count.iter().sum::<f32>(), 2.0 * open);
        assert_eq!(faces.liquid.iter().sum::<f32>(), faces.liquid_cells as f32);
    }
}
