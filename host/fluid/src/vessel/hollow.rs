//! From a mesh to distances: where the liquid is, and how far from the wall.

use glam::Vec3;

use super::{
    bvh::{Bvh, Triangle},
    distance::DistanceGrid,
    holes::holes,
    mesh::{Mesh, MeshError, MeshFault},
};
use crate::grid::Grid;

/// What a mesh is the shape of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshOf {
    /// The liquid itself, or the inner surface that holds it. The mesh may be open, or closed by
    /// a lid, at the rest surface or above.
    Liquid,
    /// The solid wall of the vessel: an open cauldron, as it is modelled, is a closed body with a
    /// thickness. The liquid is what can be reached from a point without passing the wall.
    Wall {
        /// The point, in world metres.
        inside_in_world_m: Vec3,
    },
}

/// Part of a spacing within which a mesh ends at the rest surface.
const LID_CELLS: f32 = 0.01;
/// Least vertical part of a lid's normal.
const LID_SLOPE: f32 = 0.7;
/// Points that are so near in parts of a spacing are one.
const JOIN_CELLS: f32 = 1e-3;

/// The depths of `mesh` at the corners of `grid`.
pub(super) fn distance(mesh: &Mesh, grid: &Grid, of: MeshOf) -> Result<DistanceGrid, MeshError> {
    let body = Body::new(mesh, grid).map_err(|fault| mesh.error(fault))?;
    let depth_m = match of {
        MeshOf::Liquid => Ok(body.depths_m(grid)),
        MeshOf::Wall { inside_in_world_m } => reached(&body, grid, inside_in_world_m),
    };
    let depth_m = depth_m.map_err(|fault| mesh.error(fault))?;
    let nodes = grid.cells.map(|cells| cells + 1);
    let is_top = |place: usize| place / nodes[0] % nodes[1] == grid.cells[1];
    if !depth_m.iter().enumerate().any(|(place, depth_m)| is_top(place) && *depth_m > 0.0) {
        return Err(mesh.error(MeshFault::Dry { top_m: top_m(grid) }));
    }
    DistanceGrid::from_corners(grid, depth_m).map_err(|_| mesh.error(MeshFault::NoTriangles))
}

fn top_m(grid: &Grid) -> f32 {
    grid.origin_in_world_m.y + grid.extent_m().y
}

/// A mesh, told apart into what is a wall and what only closes it.
struct Body {
    /// Triangles that liquid can touch: neither lids nor the fans that close holes.
    skin: Bvh,
    /// All triangles.
    closed: Bvh,
    /// Two corners side by side have nothing between them if the skin is so far from one: a
    /// step, and the width of a crack if there is any.
    clear_m: f32,
    spacing_m: f32,
    top_m: f32,
}

impl Body {
    fn new(mesh: &Mesh, grid: &Grid) -> Result<Self, MeshFault> {
        let (spacing_m, top_m) = (grid.spacing_m, top_m(grid));
        let rest_m = top_m - LID_CELLS * spacing_m;
        let mut all: Vec<Triangle> =
            mesh.triangles().iter().map(|t| t.map(|c| mesh.points_m()[c as usize])).collect();
        // A lid is flat and at the rest surface or above; what goes on steeply there is wall.
        let is_wall = |t: &&Triangle| {
            let normal = (t[1] - t[0]).cross(t[2] - t[0]);
            t.iter().any(|c| c.y < rest_m) || normal.y.abs() < LID_SLOPE * normal.length()
        };
        let skin = Bvh::new(all.iter().filter(is_wall).copied().collect());
        // A corner on the skin has no side to tell: a little more than a step.
        let mut clear_m = 1.05 * spacing_m;
        for hole in holes(mesh, JOIN_CELLS * spacing_m) {
            // The mouth is open and a crack is not seen; what is between would let liquid out.
            let is_wide = hole.low_m.distance(hole.high_m) > spacing_m;
            if is_wide && hole.lowest_m.y < rest_m {
                return Err(MeshFault::Open { edges: hole.edges, at_m: hole.lowest_m });
            }
            if hole.lowest_m.y < rest_m {
                clear_m = 2.1 * spacing_m;
            }
            all.extend(hole.fan);
        }
        if skin.is_empty() {
            let no_area = Bvh::new(all).is_empty();
            return Err(if no_area { MeshFault::NoTriangles } else { MeshFault::Dry { top_m } });
        }
        Ok(Self { skin, closed: Bvh::new(all), clear_m, spacing_m, top_m })
    }

    /// True if a point is in the body. At the top of the box, where a lid may be, the liquid
    /// just below it tells.
    fn holds(&self, at_m: Vec3) -> bool {
        let below_lid_m = self.top_m - 2.0 * LID_CELLS * self.spacing_m;
        let at_m = Vec3 { y: at_m.y.min(below_lid_m), ..at_m };
        // Faces that all look inwards wind the other way.
        self.closed.winding(at_m).abs() > 0.5
    }

    /// Distances to the skin at the corners of the cells, positive in the body.
    fn depths_m(&self, grid: &Grid) -> Vec<f32> {
        let row = grid.cells[0] + 1;
        let mut nearest: Vec<Vec3> = Vec::with_capacity(row * grid.cells[1]);
        let mut holds = false;
        let depth = |(n, at): (usize, Vec3)| {
            // What is nearest to the corners before it, along and across, is near to this one.
            let known = [n.checked_sub(1), n.checked_sub(row)].map(|n| nearest.get(n?).copied());
            let known = known.into_iter().flatten();
            let known = known.min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
            let on = self.skin.nearest(at, known.unwrap_or(Vec3::INFINITY));
            nearest.push(on);
            let away_m = on.distance(at);
            if n % row == 0 || away_m < self.clear_m {
                holds = self.holds(at);
            }
            if holds { away_m } else { -away_m }
        };
        grid.corners().enumerate().map(depth).collect()
    }
}

/// Depths in the room outside of a body that can be reached from `inside_m`.
fn reached(body: &Body, grid: &Grid, inside_m: Vec3) -> Result<Vec<f32>, MeshFault> {
    let nodes = grid.cells.map(|cells| cells + 1);
    let low = cell_of(grid, inside_m).ok_or(MeshFault::OutOfBox(inside_m))?;
    if body.holds(inside_m) {
        return Err(MeshFault::InWall(inside_m));
    }
    let mut room_m: Vec<f32> = body.depths_m(grid).iter().map(|depth_m| -depth_m).collect();
    let around = (0..8).map(|c| [low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2)]);
    let open = around.filter(|place| room_m[flat(nodes, *place)] > 0.0);
    let away_m = |place: &[usize; 3]| corner_m(grid, *place).distance(inside_m);
    let nearest = open.min_by(|a, b| away_m(a).total_cmp(&away_m(b)));
    let first = flat(nodes, nearest.ok_or(MeshFault::InWall(inside_m))?);
    let mut is_wet = vec![false; room_m.len()];
    let mut next = vec![first];
    is_wet[first] = true;
    while let Some(at) = next.pop() {
        let place = places(nodes, at);
        let is_at_side = |axis: usize| place[axis] == 0 || place[axis] + 1 == nodes[axis];
        if is_at_side(0) || is_at_side(2) || place[1] == 0 {
            return Err(MeshFault::Leaks(corner_m(grid, place)));
        }
        for beside in beside(nodes, at) {
            if room_m[beside] > 0.0 && !is_wet[beside] {
                is_wet[beside] = true;
                next.push(beside);
            }
        }
    }
    for at in 0..room_m.len() {
        if !is_wet[at] {
            let wet = || beside(nodes, at).filter(|beside| is_wet[*beside]);
            let behind_m = behind_m(body, grid, places(nodes, at), wet().map(|w| places(nodes, w)));
            room_m[at] = behind_m.min(-room_m[at].abs());
        }
    }
    Ok(room_m)
}

/// The cell that a point is in; `None` outside of the box.
fn cell_of(grid: &Grid, at_m: Vec3) -> Option<[usize; 3]> {
    let cell = (at_m - grid.origin_in_world_m) / grid.spacing_m;
    let is_in_box = (0..3).all(|axis| (0.0..=grid.cells[axis] as f32).contains(&cell[axis]));
    is_in_box.then(|| std::array::from_fn(|axis| (cell[axis] as usize).min(grid.cells[axis] - 1)))
}

/// Depth of a corner behind the wall that liquid beside it sees, as a plane through the wall's
/// nearest point: a thin wall is nearer to its far side, which is no matter of the liquid's. No
/// liquid beside it is none behind.
fn behind_m(
    body: &Body,
    grid: &Grid,
    place: [usize; 3],
    wet: impl Iterator<Item = [usize; 3]>,
) -> f32 {
    let at_m = corner_m(grid, place);
    let (mut sum_m, mut count) = (0.0, 0);
    for place in wet {
        let wet_m = corner_m(grid, place);
        let on_m = body.skin.nearest(wet_m, Vec3::INFINITY);
        sum_m += (at_m - on_m).dot((wet_m - on_m).normalize_or_zero());
        count += 1;
    }
    if count > 0 { sum_m / count as f32 } else { 0.0 }
}

fn corner_m(grid: &Grid, place: [usize; 3]) -> Vec3 {
    grid.origin_in_world_m + grid.spacing_m * Vec3::from_array(place.map(|c| c as f32))
}

fn flat(nodes: [usize; 3], [i, j, k]: [usize; 3]) -> usize {
    i + nodes[0] * (j + nodes[1] * k)
}

fn places([nx, ny, _]: [usize; 3], at: usize) -> [usize; 3] {
    [at % nx, at / nx % ny, at / (nx * ny)]
}

/// The corners next to one.
fn beside(nodes: [usize; 3], at: usize) -> impl Iterator<Item = usize> {
    let place = places(nodes, at);
    let strides = [1, nodes[0], nodes[0] * nodes[1]];
    (0..3).flat_map(move |axis| {
        let lower = (place[axis] > 0).then(|| at - strides[axis]);
        let upper = (place[axis] + 1 < nodes[axis]).then(|| at + strides[axis]);
        lower.into_iter().chain(upper)
    })
}
