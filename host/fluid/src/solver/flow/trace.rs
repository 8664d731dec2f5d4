//! Velocities between faces, and the paths that faces are traced back along.
//!
//! Everything is done for a block of points at once, coordinate by coordinate, so that it
//! becomes vector code: a point is found in memory by arithmetic alone, and no index can leave
//! the array. Beyond a side there are ghosts: see [`super::ghosts::Fill::Carried`].
#![allow(clippy::needless_range_loop, reason = "one lane of many arrays at a time: vector code")]

mod between;

use glam::Vec3;

use crate::solver::flow::{
    engine::Engine,
    field::{BLOCK, Layout, Vector, cut, cut_mut},
    ghosts::Ghosts,
};

/// Points in cells from the grid's corner: all x, all y, all z.
pub type Points<const N: usize> = [[f32; N]; 3];

/// Position of face `c` of cell (i, j, k) in cells from the grid's corner.
pub fn face_in_cells(c: usize, i: usize, j: usize, k: usize) -> Vec3 {
    let mut point = Vec3::new(i as f32, j as f32, k as f32) + 0.5;
    point[c] -= 0.5;
    point
}

/// A block of faces in a row.
#[derive(Clone, Copy)]
pub struct FaceBlock {
    /// The component that they hold.
    pub c: usize,
    /// Index of the first.
    pub at: usize,
    /// Where they are.
    pub points: Points<BLOCK>,
}

/// Finds places in a grid.
#[derive(Clone, Copy)]
pub struct Tracer<'a> {
    layout: &'a Layout,
    wraps: [bool; 3],
}

impl<'a> Tracer<'a> {
    /// For a grid with these sides.
    pub fn new(layout: &'a Layout, ghosts: &Ghosts) -> Self {
        Self { layout, wraps: std::array::from_fn(|axis| ghosts.is_periodic(axis)) }
    }

    /// The velocity at a point, by cubics between the stored ones. Outside of the grid it is that
    /// of the nearest point inside, along a periodic axis that of the point's image.
    pub fn velocity_at(&self, velocity: [&[f32]; 3], point: Vec3) -> Vec3 {
        let points = self.held(point.to_array().map(|p| [p]));
        Vec3::from_array(std::array::from_fn(|c| self.cubic(c, velocity[c], &points)[0]))
    }

    /// As [`Tracer::velocity_at`], on straight lines between the stored velocities.
    pub fn linear_velocity_at(&self, velocity: [&[f32]; 3], point: Vec3) -> Vec3 {
        let points = self.held(point.to_array().map(|p| [p]));
        Vec3::from_array(std::array::from_fn(|c| self.linear(c, velocity[c], &points)[0]))
    }

    /// Goes from the faces for `reach` = dt / h along the flow, by the midpoint rule.
    #[inline(always)]
    pub fn trace(&self, velocity: [&[f32]; 3], faces: &FaceBlock, reach: f32) -> Points<BLOCK> {
        let here = self.at_faces(velocity, faces);
        let middle = self.held(moved(&faces.points, 0.5 * reach, &here));
        self.held(moved(&faces.points, reach, &self.linear_all(velocity, &middle)))
    }

    /// Sets the open faces of `out` to `value(faces)`, block by block.
    pub fn visit(
        &self,
        on: Engine<'_>,
        out: &mut Vector,
        value: impl Fn(&FaceBlock) -> [f32; BLOCK] + Sync,
    ) {
        let layout = self.layout;
        let outs = out.each_mut().map(|out| layout.planes(out));
        on.pool.planes(outs, [layout.plane; 3], |k, mut outs| {
            on.simd.vectorize(
                #[inline(always)]
                || {
                    for (c, out) in outs.iter_mut().enumerate() {
                        for j in on.faces.live_rows[k].clone() {
                            for i in (0..layout.cells[0]).step_by(BLOCK) {
                                let to = layout.index_in_plane(i, j);
                                let faces = self.block(c, [i, j, k]);
                                let len = BLOCK.min(layout.cells[0] - i);
                                let open = cut(&on.faces.open[c], faces.at, len);
                                let values = value(&faces);
                                let out = cut_mut(out, to, len);
                                for l in 0..len {
                                    out[l] = if open[l] > 0.0 { values[l] } else { 0.0 };
                                }
                            }
                        }
                    }
                },
            );
        });
    }

    #[inline(always)]
    fn block(&self, c: usize, [i, j, k]: [usize; 3]) -> FaceBlock {
        let first = face_in_cells(c, i, j, k);
        let mut points = [[first.x; BLOCK], [first.y; BLOCK], [first.z; BLOCK]];
        for l in 0..BLOCK {
            points[0][l] += l as f32;
        }
        FaceBlock { c, at: self.layout.index(i, j, k), points }
    }

    /// The velocity at faces: of other components, the mean of the four around.
    #[inline(always)]
    fn at_faces(&self, velocity: [&[f32]; 3], faces: &FaceBlock) -> Points<BLOCK> {
        let (strides, mut out) = (self.layout.strides(), [[0.0; BLOCK]; 3]);
        for d in 0..3 {
            let (up, back) = (strides[d], strides[faces.c]);
            let low = cut(velocity[d], faces.at, BLOCK);
            let high = cut(velocity[d], faces.at + up, BLOCK);
            let low_behind = cut(velocity[d], faces.at - back, BLOCK);
            let high_behind = cut(velocity[d], faces.at + up - back, BLOCK);
            for l in 0..BLOCK {
                let mean = 0.25 * ((low[l] + high[l]) + (low_behind[l] + high_behind[l]));
                out[d][l] = if d == faces.c { low[l] } else { mean };
            }
        }
        out
    }

    #[inline(always)]
    fn linear_all<const N: usize>(&self, velocity: [&[f32]; 3], points: &Points<N>) -> Points<N> {
        [
            self.linear(0, velocity[0], points),
            self.linear(1, velocity[1], points),
            self.linear(2, velocity[2], points),
        ]
    }

    /// The points moved into the grid, those that are not numbers to its corner.
    #[inline(always)]
    fn held<const N: usize>(&self, mut points: Points<N>) -> Points<N> {
        for d in 0..3 {
            let n = self.layout.cells[d] as f32;
            for l in 0..N {
                let mut p = points[d][l];
                if self.wraps[d] {
                    p -= n * (p / n).floor();
                }
                // Comparisons that are false for NaN: clamp would keep it.
                p = if p > 0.0 { p } else { 0.0 };
                points[d][l] = if p < n { p } else { n };
            }
        }
        points
    }
}

/// Where to go from `from` at `velocity`.
#[inline(always)]
fn moved<const N: usize>(from: &Points<N>, reach: f32, velocity: &Points<N>) -> Points<N> {
    let mut to = [[0.0; N]; 3];
    for d in 0..3 {
        for l in 0..N {
            to[d][l] = from[d][l] + reach * velocity[d][l];
        }
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{
        Side, Sides,
        flow::{faces::cells, field::components, ghosts::Fill},
    };

    #[test]
    fn points_come_in_again_where_the_axis_is_periodic_and_stay_at_a_side() {
        let layout = Layout::new([9, 5, 4]);
        let sides = Sides::all(Side::FreeSlip).with(0, [Side::Periodic; 2]);
        let ghosts = Ghosts::new(&layout, &sides);
        let tracer = Tracer::new(&layout, &ghosts);
        let held = tracer.held([[-1.0, 10.5, f32::NAN], [-1.0, 10.5, 2.0], [1e30, -1e30, 0.5]]);
        assert_eq!(held, [[8.0, 1.5, 0.0], [0.0, 5.0, 2.0], [4.0, 0.0, 0.5]]);
        let mut velocity = [layout.zeros(), layout.zeros(), layout.zeros()];
        for (i, j, k) in cells(layout.cells) {
            velocity[0][layout.index(i, j, k)] = i as f32;
        }
        ghosts.fill(&mut velocity, Fill::Carried);
        let at = |x| tracer.velocity_at(components(&velocity), Vec3::new(x, 2.0, 2.0)).x;
        assert_eq!([at(8.0), at(9.0)], [8.0, 0.0]);
        assert_eq!(at(8.5), at(-0.5), "the image of a point");
    }
}
