//! Cells that a curved wall cuts: how much of each and of its faces is liquid.
//!
//! The depth of the vessel is taken at the corners of the cells. A face is four triangles about
//! its centre, a cell 24 tetrahedra about its own, with means of corners at the centres and the
//! depth linear on each. So faces and cells have one wall between them, made of planes: areas and
//! volumes are exact for a flat wall and of second order in the spacing for a curved one, the
//! divergence theorem holds in each cell, and mirrored vessels are cut into mirrored cells.
//! Straight lines between points of a curved function err to one side, on average over a cell by
//! h^2/12 of its second derivatives: the corners are moved by as much the other way, which leaves
//! errors of both signs to cancel.
//! (Finite volumes in cut cells: Ng, Min, Gibou 2009; Weymouth & Yue 2011.)

use std::ops::Range;

use glam::Vec3;

use super::Vessel;
use crate::grid::Grid;

/// Fractions below it count as 0 and above its complement as 1, for areas and volumes: a wall
/// moves by at most so much of a spacing. A millionth of the area of all cut faces is at stake,
/// which is what f32 keeps of it, and no cell is left that a flow could fill in no time.
pub const SMALLEST_FRACTION: f32 = 1e-3;

/// Cells around those that an obstacle cuts whose depth is asked for.
const KNOWN: usize = 3;

/// Depths beyond it, in cells, are told apart by nothing, and infinity is none to compute with.
const FAR: f32 = 1e6;

/// A second difference of a distance above it, in cells, is that of an edge or of no room, and
/// tells of no curvature.
const SHARPEST: f32 = 0.5;

/// A box of cells, from the first to behind the last along each axis.
pub type CellBox = [Range<usize>; 3];

/// The open parts of the cells and faces of a grid in a vessel, with or without obstacles.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    grid: Grid,
    /// Depth in cells at the corners, x fastest, in the vessel alone, as moved for lines.
    vessel_depth: Vec<f32>,
    /// The same with what stands in it.
    depth: Vec<f32>,
    /// Distance to what stands in it, where that was last asked for.
    room: Vec<f32>,
    /// Open part of the faces across x, y and z, 0 to 1, laid out as [`Cut::face_index`] says:
    /// 0 between cells of which one holds no liquid. Those on the sides of the grid's box tell
    /// what of the side the vessel leaves open; whether liquid passes there is for the solver.
    pub face: [Vec<f32>; 3],
    /// Liquid part of each cell, 0 to 1, laid out as [`Grid::cell`] says. Above 0, the cell has
    /// an open face.
    pub volume: Vec<f32>,
}

impl Cut {
    /// The cells of `grid` as `vessel` cuts them.
    #[must_use]
    pub fn new(grid: &Grid, vessel: &Vessel) -> Self {
        let in_cells = |at| match vessel.depth_inside_m(at) / grid.spacing_m {
            depth if depth.is_nan() => -FAR,
            depth => depth.clamp(-FAR, FAR),
        };
        let room: Vec<f32> = grid.corners().map(in_cells).collect();
        let nodes = grid.cells.map(|cells| cells + 1);
        let all = nodes.map(|nodes| 0..nodes);
        let mut depth = Vec::with_capacity(room.len());
        each(&all, |at| depth.push(for_lines(&room, nodes, &all, at)));
        let faces = |axis| vec![0.0; count(plus(grid.cells, axis))];
        let mut cut = Self {
            grid: *grid,
            vessel_depth: depth.clone(),
            depth,
            room,
            face: [faces(0), faces(1), faces(2)],
            volume: vec![0.0; grid.len()],
        };
        cut.refresh(&grid.cells.map(|cells| 0..cells));
        cut
    }

    /// Puts obstacles into the vessel: at the corners of `cells`, and of some more around them so
    /// that depths and their curvature are known at all faces beside the cut ones, there is as
    /// much room as `distance_m` (of a point in world metres to the nearest obstacle, positive
    /// outside of it) and the vessel leave, whatever stood there before; where it is not a
    /// number, the vessel's. An obstacle that moves needs the boxes of where it was and where it is
    /// (see [`Cut::cells_about`]). The cost is that of these cells; nothing is allocated. Cells
    /// beyond the grid are left out.
    pub fn obstruct(&mut self, cells: &CellBox, distance_m: impl Fn(Vec3) -> f32) {
        let (origin, spacing_m) = (self.grid.origin_in_world_m, self.grid.spacing_m);
        let cells = grown(cells, 0, self.grid.cells);
        if cells.iter().any(Range::is_empty) {
            return;
        }
        let nodes = self.grid.cells.map(|cells| cells + 1);
        let known = grown(&cells, KNOWN, self.grid.cells);
        let corners = known.map(|range| range.start..range.end + 1);
        // The curvature at the last of them needs one more.
        let around = grown(&corners, 1, nodes);
        each(&around, |at| {
            let corner = origin + spacing_m * Vec3::from_array(at.map(|c| c as f32));
            self.room[flat(nodes, at)] = distance_m(corner) / spacing_m;
        });
        each(&corners, |at| {
            let room = for_lines(&self.room, nodes, &around, at);
            let index = flat(nodes, at);
            self.depth[index] = self.vessel_depth[index].min(room).max(-FAR);
        });
        self.refresh(&cells);
    }

    /// The cells that an obstacle within the world box from `low_m` to `high_m` can cut, and one
    /// more to each side, so that no edge is cut from one end alone.
    #[must_use]
    pub fn cells_about(&self, low_m: Vec3, high_m: Vec3) -> CellBox {
        let in_cells = |at: Vec3| (at - self.grid.origin_in_world_m) / self.grid.spacing_m;
        let (low, high) = (in_cells(low_m).floor() - 1.0, in_cells(high_m).ceil() + 1.0);
        std::array::from_fn(|axis| {
            let most = self.grid.cells[axis];
            (low[axis].max(0.0) as usize).min(most)..(high[axis].max(0.0) as usize).min(most)
        })
    }

    /// Place in [`Cut::face`] of the lower face across `axis` of a cell. Its upper face is the
    /// lower one of the next cell, which may be one beyond the last.
    #[must_use]
    pub fn face_index(&self, axis: usize, cell: [usize; 3]) -> usize {
        flat(plus(self.grid.cells, axis), cell)
    }

    /// Open parts of the lower and the upper face of a cell across `axis`.
    #[must_use]
    pub fn faces_of(&self, axis: usize, cell: [usize; 3]) -> [f32; 2] {
        [cell, plus(cell, axis)].map(|cell| self.face[axis][self.face_index(axis, cell)])
    }

    /// The wall in a cell as an area: its direction is the normal out of the liquid, its length
    /// the area in squared spacings. With the open faces it adds up to nothing: the divergence
    /// theorem for a constant.
    #[must_use]
    pub fn wall(&self, cell: [usize; 3]) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|axis| {
            let [lower, upper] = self.faces_of(axis, cell);
            lower - upper
        }))
    }

    /// Depth of the centre of a cell below the nearest wall or obstacle, from its corners.
    #[must_use]
    pub fn depth_m(&self, cell: [usize; 3]) -> f32 {
        self.grid.spacing_m * mean(&self.corner_depths(cell))
    }

    /// Mean depth below the nearest wall or obstacle, in spacings, over the open part of the
    /// lower face of a cell across `axis`: 0 where nothing is open. As with
    /// [`Cut::face_index`], the cell may be one beyond the last along `axis`.
    #[must_use]
    pub fn face_depth(&self, axis: usize, cell: [usize; 3]) -> f32 {
        let around = self.corners_about(axis, cell).map(|corner| self.corner_depth(corner));
        let centre = mean(&around);
        let triangle = |n: usize| 0.25 * triangle_depth([around[n], around[(n + 1) % 4], centre]);
        let open = face_fraction(around);
        if open > 0.0 { (0..4).map(triangle).sum::<f32>() / open } else { 0.0 }
    }

    /// Sum of the second differences of the depth, in spacings, about that face: what the wall's
    /// curvature makes of it. Edges count as flat.
    #[must_use]
    pub fn face_bend(&self, axis: usize, cell: [usize; 3]) -> f32 {
        let nodes = self.grid.cells.map(|cells| cells + 1);
        let all = nodes.map(|nodes| 0..nodes);
        mean(&self.corners_about(axis, cell).map(|at| bend(&self.depth, nodes, &all, at)))
    }

    /// True if a cell holds liquid.
    #[must_use]
    pub fn holds_liquid(&self, cell: [usize; 3]) -> bool {
        self.volume[flat(self.grid.cells, cell)] > 0.0
    }

    /// Number of cells that hold liquid.
    #[must_use]
    pub fn liquid_cells(&self) -> usize {
        self.volume.iter().filter(|volume| **volume > 0.0).count()
    }

    /// Volume of the liquid in cubic metres.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        let cells: f64 = self.volume.iter().copied().map(f64::from).sum();
        cells * f64::from(self.grid.spacing_m).powi(3)
    }

    /// Brings volumes and faces up to date where the corners of `cells` have changed.
    fn refresh(&mut self, cells: &CellBox) {
        let all = self.grid.cells;
        // A corner belongs to cells beside `cells` too, and what these lose or gain decides
        // whether their own neighbours keep an open face.
        let (touched, concerned) = (grown(cells, 1, all), grown(cells, 2, all));
        each(&concerned, |cell| {
            self.volume[flat(all, cell)] = snapped(cell_fraction(&self.corner_depths(cell)));
        });
        for axis in 0..3 {
            let mut faces = touched.clone();
            faces[axis].end += 1;
            each(&faces, |cell| {
                let index = self.face_index(axis, cell);
                self.face[axis][index] = self.open_part(axis, cell);
            });
        }
        each(&concerned, |cell| {
            let index = flat(all, cell);
            let is_closed = || (0..3).all(|axis| self.faces_of(axis, cell) == [0.0; 2]);
            if self.volume[index] > 0.0 && is_closed() {
                self.volume[index] = 0.0;
            }
        });
    }

    /// Open part of the lower face of `cell` across `axis`.
    fn open_part(&self, axis: usize, cell: [usize; 3]) -> f32 {
        let all = self.grid.cells;
        let is_dry = |cell: [usize; 3]| self.volume[flat(all, cell)] == 0.0;
        let below = cell[axis].checked_sub(1).map(|c| {
            let mut below = cell;
            below[axis] = c;
            below
        });
        if below.is_some_and(is_dry) || (cell[axis] < all[axis] && is_dry(cell)) {
            return 0.0;
        }
        let around = self.corners_about(axis, cell);
        snapped(face_fraction(around.map(|corner| self.corner_depth(corner))))
    }

    /// The corners of the lower face of `cell` across `axis`, in turn.
    fn corners_about(&self, axis: usize, cell: [usize; 3]) -> [[usize; 3]; 4] {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        [cell, plus(cell, u), plus(plus(cell, u), v), plus(cell, v)]
    }

    fn corner_depth(&self, corner: [usize; 3]) -> f32 {
        self.depth[flat(self.grid.cells.map(|cells| cells + 1), corner)]
    }

    /// Depths of the corners of a cell, x fastest.
    fn corner_depths(&self, [i, j, k]: [usize; 3]) -> [f32; 8] {
        std::array::from_fn(|c| self.corner_depth([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)]))
    }
}

/// The value at a corner, less the mean error of straight lines about it.
fn for_lines(values: &[f32], nodes: [usize; 3], known: &CellBox, at: [usize; 3]) -> f32 {
    values[flat(nodes, at)] - bend(values, nodes, known, at) / 12.0
}

/// Sum of second differences at a corner. Only corners of `known` are read; at its ends the
/// curvature is that of the next one inside.
fn bend(values: &[f32], nodes: [usize; 3], known: &CellBox, at: [usize; 3]) -> f32 {
    let second = |axis: usize| {
        let Range { start, end } = known[axis];
        if end - start < 3 {
            return 0.0;
        }
        let middle = at[axis].clamp(start + 1, end - 2);
        let [before, here, after] = [middle - 1, middle, middle + 1].map(|place| {
            let mut at = at;
            at[axis] = place;
            values[flat(nodes, at)]
        });
        before - 2.0 * here + after
    };
    [0, 1, 2].map(second).into_iter().filter(|second| second.abs() < SHARPEST).sum()
}

/// Part of a square above 0, from its corners in turn.
fn face_fraction(around: [f32; 4]) -> f32 {
    if let Some(whole) = uncut(&around) {
        return whole;
    }
    let centre = mean(&around);
    let triangle = |n: usize| triangle_fraction([around[n], around[(n + 1) % 4], centre]);
    0.25 * (0..4).map(triangle).sum::<f32>()
}

/// Part of a cube above 0, from its corners, x fastest.
fn cell_fraction(corners: &[f32; 8]) -> f32 {
    /// The corners of each face, in turn.
    const FACES: [[usize; 4]; 6] =
        [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];
    if let Some(whole) = uncut(corners) {
        return whole;
    }
    let centre = mean(corners);
    let pyramid = |face: [usize; 4]| {
        let around = face.map(|c| corners[c]);
        let middle = mean(&around);
        if let Some(whole) = uncut(&[around[0], around[1], around[2], around[3], centre]) {
            return 4.0 * whole;
        }
        let part =
            |n: usize| tetrahedron_fraction([around[n], around[(n + 1) % 4], middle, centre]);
        (0..4).map(part).sum::<f32>()
    };
    FACES.map(pyramid).iter().sum::<f32>() / 24.0
}

/// 1 or 0 if no wall passes between the corners.
fn uncut(corners: &[f32]) -> Option<f32> {
    let above = corners.iter().filter(|depth| **depth > 0.0).count();
    match above {
        0 => Some(0.0),
        _ if above == corners.len() => Some(1.0),
        _ => None,
    }
}

/// Part of an edge from a corner above 0 to one that is not.
fn along(above: f32, below: f32) -> f32 {
    above / (above - below)
}

/// Part of a triangle where a linear function with these corner values is above 0.
fn triangle_fraction([a, b, c]: [f32; 3]) -> f32 {
    let (a, b) = sorted(a, b);
    let (b, c) = sorted(b, c);
    let (a, b) = sorted(a, b);
    match [a, b, c].map(|value| value > 0.0) {
        [true, ..] => 1.0,
        [false, true, _] => 1.0 - (1.0 - along(b, a)) * (1.0 - along(c, a)),
        [_, false, true] => along(c, a) * along(c, b),
        _ => 0.0,
    }
}

/// Integral, over a triangle of area 1, of a linear function with these corner values where it is
/// above 0.
fn triangle_depth(corners: [f32; 3]) -> f32 {
    let (least, most) = corners
        .iter()
        .fold((f32::MAX, f32::MIN), |(low, high), value| (low.min(*value), high.max(*value)));
    let above = triangle_fraction(corners);
    // Where one corner is alone on its side, its part is a triangle.
    match corners.iter().filter(|value| **value > 0.0).count() {
        0 => 0.0,
        1 => above * most / 3.0,
        _ => mean(&corners) - (1.0 - above) * least / 3.0,
    }
}

/// Part of a tetrahedron where a linear function with these corner values is above 0.
fn tetrahedron_fraction([a, b, c, d]: [f32; 4]) -> f32 {
    let ((a, b), (c, d)) = (sorted(a, b), sorted(c, d));
    let ((a, c), (b, d)) = (sorted(a, c), sorted(b, d));
    let (b, c) = sorted(b, c);
    match [a, b, c, d].map(|value| value > 0.0) {
        [true, ..] => 1.0,
        [false, true, ..] => 1.0 - (1.0 - along(b, a)) * (1.0 - along(c, a)) * (1.0 - along(d, a)),
        [_, false, true, _] => {
            // A wedge between edge cd and the wall, as three tetrahedra.
            let [ca, cb, da, db] = [along(c, a), along(c, b), along(d, a), along(d, b)];
            ca * cb + da * db * (1.0 - cb) + da * cb * (1.0 - ca)
        }
        [.., false, true] => along(d, a) * along(d, b) * along(d, c),
        _ => 0.0,
    }
}

fn sorted(a: f32, b: f32) -> (f32, f32) {
    (a.min(b), a.max(b))
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

fn snapped(fraction: f32) -> f32 {
    match fraction {
        f if f < SMALLEST_FRACTION => 0.0,
        f if f > 1.0 - SMALLEST_FRACTION => 1.0,
        f => f,
    }
}

fn count(size: [usize; 3]) -> usize {
    size.iter().product()
}

fn flat([nx, ny, _]: [usize; 3], [i, j, k]: [usize; 3]) -> usize {
    i + nx * (j + ny * k)
}

/// One more along `axis`.
fn plus(mut at: [usize; 3], axis: usize) -> [usize; 3] {
    at[axis] += 1;
    at
}

/// `cells` and `by` more to each side, inside of a grid of `all`.
pub(crate) fn grown(cells: &CellBox, by: usize, all: [usize; 3]) -> CellBox {
    std::array::from_fn(|axis| {
        let Range { start, end } = cells[axis];
        start.saturating_sub(by)..end.saturating_add(by).min(all[axis])
    })
}

/// Does something at all places in a box, x fastest.
pub(crate) fn each([x, y, z]: &CellBox, mut act: impl FnMut([usize; 3])) {
    for k in z.clone() {
        for j in y.clone() {
            for i in x.clone() {
                act([i, j, k]);
            }
        }
    }
}
