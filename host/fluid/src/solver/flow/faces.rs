//! What lies between two cells: open liquid, a wall that holds it, or one that cuts the face.

use std::ops::Range;

use crate::{
    grid::Grid,
    solver::{
        Side, Sides, Walls,
        flow::{
            field::{Field, Layout, Vector},
            solids::Solids,
            walls::{Depth, WallFaces},
        },
    },
    vessel::{
        Vessel,
        cut::{CellBox, Cut, each},
    },
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
    /// The sides of the box.
    pub sides: Sides,
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
    /// What obstacles do; `None` where there never was one.
    pub solids: Option<Solids>,
}

/// What is cut of a grid between its sides.
#[derive(Clone, Copy)]
pub struct Section<'a> {
    /// How the arrays lie.
    pub layout: &'a Layout,
    /// The sides of the box.
    pub sides: &'a Sides,
    /// The walls.
    pub cut: &'a Cut,
}

impl Faces {
    /// The faces of the liquid in `vessel`, between sides and walls as given.
    pub fn new(layout: &Layout, grid: &Grid, vessel: &Vessel, sides: &Sides, walls: Walls) -> Self {
        let cut = (*vessel != Vessel::Box).then(|| Cut::new(grid, vessel));
        let cut = cut.filter(|cut| {
            let mut parts = cut.face.iter().flatten().chain(&cut.volume);
            parts.any(|part| *part < 1.0)
        });
        match cut {
            Some(cut) => {
                let mut depth = (walls == Walls::NoSlip).then(|| Depth::new(layout));
                Self::of_section(Section { layout, sides, cut: &cut }, depth.as_mut())
            }
            None => Self::of_box(layout, sides),
        }
    }

    fn of_box(layout: &Layout, sides: &Sides) -> Self {
        let [nx, ny, nz] = layout.cells;
        let mut faces = Self::none(layout, sides, None);
        faces.live_rows.fill(0..ny);
        faces.liquid_cells = nx * ny * nz;
        for (i, j, k) in cells(layout.cells) {
            faces.liquid[layout.index(i, j, k)] = 1.0;
            faces.set_open(layout, sides, [i, j, k], |_, _| true);
        }
        faces
    }

    /// The faces of what is cut, as if any of it could be cut further; `depth` is asked for where
    /// the liquid sticks to the walls, and kept up to date.
    pub fn of_section(section: Section<'_>, depth: Option<&mut Depth>) -> Self {
        let layout = section.layout;
        let vessel = VesselFaces {
            area: layout.zero_vector(),
            open_area: layout.zeros(),
            lift: layout.zeros(),
            walls: WallFaces::new(layout),
            solids: None,
        };
        let mut faces = Self::none(layout, section.sides, Some(vessel));
        faces.refresh(section, depth, &layout.cells.map(|n| 0..n));
        for (k, rows) in faces.live_rows.iter_mut().enumerate() {
            let is_live = |j: &usize| {
                faces.liquid[layout.index(0, *j, k)..][..layout.cells[0]].contains(&1.0)
            };
            let all = 0..layout.cells[1];
            let first = all.clone().find(is_live).unwrap_or_default();
            *rows = first..all.rev().find(is_live).map_or(first, |last| last + 1);
        }
        faces
    }

    fn none(layout: &Layout, sides: &Sides, vessel: Option<VesselFaces>) -> Self {
        Self {
            open: layout.zero_vector(),
            liquid: layout.zeros(),
            live_rows: vec![0..0; layout.cells[2]],
            liquid_cells: 0,
            is_box: vessel.is_none(),
            sides: *sides,
            vessel,
        }
    }

    /// Brings all but the live rows up to date where walls have changed: nothing else may have
    /// within one cell of there.
    pub fn refresh(&mut self, section: Section<'_>, depth: Option<&mut Depth>, changed: &CellBox) {
        let Section { layout, sides, cut } = section;
        let Some(mut vessel) = self.vessel.take() else { return };
        section.each_padded(changed, |padded, at| {
            for (c, area) in vessel.area.iter_mut().enumerate() {
                area[at] = section.area(c, padded);
            }
        });
        each(changed, |cell| {
            let [i, j, k] = cell;
            let at = layout.index(i, j, k);
            let is_liquid = cut.holds_liquid(cell);
            self.liquid_cells += usize::from(is_liquid);
            self.liquid_cells -= usize::from(self.liquid[at] > 0.0);
            self.liquid[at] = f32::from(is_liquid);
            self.set_open(layout, sides, cell, |axis, at| is_liquid && vessel.area[axis][at] > 0.0);
            [vessel.open_area[at], vessel.lift[at]] = match is_liquid {
                true => cell_area(layout, sides, &vessel.area, cell),
                false => [0.0; 2],
            };
        });
        vessel.walls.refresh(section, [&self.open, &vessel.area], depth, changed);
        self.vessel = Some(vessel);
    }

    /// Sets the lower faces of a cell, and those of its upper ones that are a side of the box.
    fn set_open(
        &mut self,
        layout: &Layout,
        sides: &Sides,
        cell: [usize; 3],
        is_passed: impl Fn(usize, usize) -> bool,
    ) {
        let [i, j, k] = cell;
        let at = layout.index(i, j, k);
        for axis in 0..3 {
            let [lower, upper] = are_free(layout, sides, axis, cell);
            self.open[axis][at] = f32::from(lower && is_passed(axis, at));
            if cell[axis] + 1 == layout.cells[axis] && !sides.is_periodic(axis) {
                let above = at + layout.strides()[axis];
                self.open[axis][above] = f32::from(upper && is_passed(axis, above));
            }
        }
    }

    /// True if the side lets out what comes.
    pub fn is_free(&self, axis: usize, end: usize) -> bool {
        self.sides.0[axis][end] == Side::Outflow
    }

    /// What obstacles do, if there are any.
    pub fn solids(&self) -> Option<&Solids> {
        self.vessel.as_ref().and_then(|vessel| vessel.solids.as_ref())
    }

    /// Gives faces that obstacles cover wholly their velocity.
    pub fn hold(&self, velocity: &mut Vector) {
        if let Some(solids) = self.solids() {
            solids.hold(velocity);
        }
    }

    /// Open part of a face: the liquid that has its velocity, per cell volume.
    pub fn mass(&self, axis: usize, at: usize) -> f64 {
        self.vessel.as_ref().map_or(1.0, |vessel| f64::from(vessel.area[axis][at]))
    }
}

impl Section<'_> {
    /// Part of a face that is open. As all faces here, it is counted from the one beyond the
    /// lower sides: what is beyond a side is as next to it, or the same on the other side.
    pub fn area(&self, c: usize, padded: [usize; 3]) -> f32 {
        self.least(c, padded, |face| self.cut.face[c][self.cut.face_index(c, face)])
    }

    /// Mean depth below the walls over the open part of a face, in spacings.
    pub fn depth(&self, c: usize, padded: [usize; 3]) -> f32 {
        self.least(c, padded, |face| self.cut.face_depth(c, face))
    }

    /// Sum of the second differences of the depth about a face.
    pub fn bend(&self, c: usize, padded: [usize; 3]) -> f32 {
        self.least(c, padded, |face| self.cut.face_bend(c, face))
    }

    /// Calls `act(face, index)` for all faces of `cells` and one more to each side.
    pub fn each_padded(&self, cells: &CellBox, mut act: impl FnMut([usize; 3], usize)) {
        let [_, sy, sz] = self.layout.strides();
        let padded = cells.clone().map(|range| range.start..range.end + 2);
        each(&padded, |face| act(face, face[0] + face[1] * sy + face[2] * sz));
    }

    /// The least of a value for the places that a face has in a periodic box.
    fn least(&self, c: usize, padded: [usize; 3], value: impl Fn([usize; 3]) -> f32) -> f32 {
        let face = std::array::from_fn(|axis| {
            let n = self.layout.cells[axis];
            let last = if axis == c { n } else { n - 1 };
            match self.sides.is_periodic(axis) {
                true => (padded[axis] + n - 1) % n,
                false => padded[axis].saturating_sub(1).min(last),
            }
        });
        let least = value(face);
        if self.sides.is_periodic(c) && face[c] == 0 {
            let mut same = face;
            same[c] = self.layout.cells[c];
            return least.min(value(same));
        }
        least
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

/// Open area of a liquid cell, and what its inverse has more than without walls.
fn cell_area(layout: &Layout, sides: &Sides, area: &Vector, cell: [usize; 3]) -> [f32; 2] {
    let [i, j, k] = cell;
    let at = layout.index(i, j, k);
    let (mut open, mut whole) = (0.0, 0.0);
    for (axis, area) in area.iter().enumerate() {
        for (end, is_free) in are_free(layout, sides, axis, cell).into_iter().enumerate() {
            let free = f32::from(is_free);
            open += free * area[at + end * layout.strides()[axis]];
            whole += free;
        }
    }
    [open, if open > 0.0 { 1.0 / open - 1.0 / whole } else { 0.0 }]
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
