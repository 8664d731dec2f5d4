//! Where obstacles are in a grid, which may be one period of a larger one.

use std::ops::Range;

use glam::Vec3;

use super::Body;
use crate::{
    grid::Grid,
    solver::{Motion, Obstacle, Shape, flow::trace::face_in_cells},
    vessel::cut::CellBox,
};

/// Cells about those that a wall passes whose faces it can change.
const MARGIN: f32 = 1.0;

/// Cells, those beyond the sides too.
pub type Span = [Range<isize>; 3];

/// The grid, which may be one period of a larger one.
#[derive(Clone, Copy)]
pub struct Place {
    pub grid: Grid,
    pub is_periodic: [bool; 3],
}

impl Place {
    /// From the centre of an obstacle, or its nearest image, to a point.
    pub fn way_to_m(&self, motion: &Motion, point_in_world_m: Vec3) -> Vec3 {
        let mut from = point_in_world_m - motion.centre_in_world_m;
        let extent_m = self.grid.extent_m();
        for axis in (0..3).filter(|axis| self.is_periodic[*axis]) {
            from[axis] -= extent_m[axis] * (from[axis] / extent_m[axis]).round();
        }
        from
    }

    fn distance_m(&self, obstacle: &Obstacle, point_in_world_m: Vec3) -> f32 {
        let from = self.way_to_m(&obstacle.motion, point_in_world_m);
        obstacle.shape.distance_m(obstacle.motion.rotation.inverse() * from)
    }

    /// The nearest obstacle to a point and its distance.
    pub fn nearest<'a>(
        &self,
        bodies: &'a [Body],
        point_in_world_m: Vec3,
    ) -> (Option<&'a Body>, f32) {
        let mut nearest = (None, f32::INFINITY);
        for body in bodies {
            let distance_m = self.distance_m(&body.obstacle, point_in_world_m);
            if distance_m < nearest.1 {
                nearest = (Some(body), distance_m);
            }
        }
        nearest
    }

    /// Face `c` of a cell in world metres.
    pub fn face_in_world_m(&self, c: usize, [i, j, k]: [usize; 3]) -> Vec3 {
        self.grid.origin_in_world_m + self.grid.spacing_m * face_in_cells(c, i, j, k)
    }

    /// The cells that an obstacle has to do with.
    pub fn span(&self, obstacle: &Obstacle) -> Span {
        let motion = obstacle.motion;
        let corners = obstacle.shape.bounds_m();
        let turned = (0..8).map(|corner: usize| {
            let at = |axis: usize| corners[corner >> axis & 1][axis];
            motion.rotation * Vec3::new(at(0), at(1), at(2))
        });
        let is_round = matches!(obstacle.shape, Shape::Sphere { .. });
        let [low, high] = match is_round {
            true => corners,
            false => turned.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], at| {
                [low.min(at), high.max(at)]
            }),
        };
        let centre = (motion.centre_in_world_m - self.grid.origin_in_world_m) / self.grid.spacing_m;
        std::array::from_fn(|axis| {
            let n = self.grid.cells[axis] as f32;
            let home =
                if self.is_periodic[axis] { centre[axis].rem_euclid(n) } else { centre[axis] };
            let [low, high] = [low, high].map(|end| home + end[axis] / self.grid.spacing_m);
            let within = |cell: f32| cell.clamp(-n - 9.0, 2.0 * n + 9.0) as isize;
            within(low.floor() - MARGIN)..within(high.ceil() + MARGIN)
        })
    }

    /// The parts of a span that are in the grid, where they come in again through periodic sides
    /// too.
    pub fn parts(&self, span: &Span) -> impl Iterator<Item = CellBox> + use<> {
        let (cells, is_periodic, span) = (self.grid.cells, self.is_periodic, span.clone());
        let part = move |number: isize| {
            let part: CellBox = std::array::from_fn(|axis| {
                let n = cells[axis] as isize;
                let shift = (number / 3isize.pow(axis as u32) % 3 - 1) * n;
                let ends = [span[axis].start, span[axis].end];
                let [start, end] = ends.map(|end| (end + shift).clamp(0, n) as usize);
                if shift != 0 && !is_periodic[axis] { 0..0 } else { start..end }
            });
            part.iter().all(|range| !range.is_empty()).then_some(part)
        };
        (0..27).filter_map(part)
    }
}

/// Two spans, or one if that is no more.
pub fn united(a: Span, b: Span) -> Vec<Span> {
    let size = |span: &Span| span.iter().map(|range| range.len()).product::<usize>();
    let both: Span =
        std::array::from_fn(|axis| a[axis].start.min(b[axis].start)..a[axis].end.max(b[axis].end));
    if size(&both) <= size(&a) + size(&b) { vec![both] } else { vec![a, b] }
}
