//! One sweep along one axis: what leaves a cell enters the next.
//!
//! Of three sweeps each sees the volumes that those before it left: a cell that has lost liquid
//! along x and will get it back along y is smaller in between (Easter 1993). So an even field
//! stays even in a flow without divergence, whatever the order of the sweeps.

use std::{array, ops::Range};

use super::face::Face;
use crate::{
    lanes::{each, subtract, times},
    solver::flow::field::{BLOCK, Block, Layout, blocks, blocks_mut, cut, cut_mut},
};

/// Columns that a sweep works on at once, in buffers on the stack.
const WIDTH: usize = 64;

/// Less than this in a cell is nothing: an f32 cannot tell it from 0 beside 1, yet it would take
/// ever more cells to compute, down to subnormal numbers, which the processor computes a hundred
/// times slower. What is taken so is owed, and given back where there is more.
pub const TRACE: f32 = 1e-8;

/// A cell is never divided by less than this volume.
const LEAST_VOLUME: f32 = 1e-6;

/// One sweep.
#[derive(Clone, Copy)]
pub struct Sweep<'a> {
    /// How the arrays lie.
    pub layout: &'a Layout,
    /// On the faces.
    pub velocity: [&'a [f32]; 3],
    /// 1 at open faces; `None` where all but the outermost are open.
    pub open: Option<[&'a [f32]; 3]>,
    /// dt / h.
    pub dt_per_spacing_s_m: f32,
    /// No fraction exceeds this.
    pub highest: f32,
    /// Along which axis.
    pub axis: usize,
    /// The axes that have been swept.
    pub before: &'a [usize],
}

/// Rows of values across lines that are swept, and where to put the new ones.
pub struct Rows<'a> {
    /// Where to read, and the index of the first row there; `None` if where they are put.
    pub from: Option<(&'a [f32], usize)>,
    /// Where to put them.
    pub to: &'a mut [f32],
    /// Index there of the row at place `first`.
    pub start: usize,
    /// The first place that `to` has.
    pub first: usize,
    /// Values from one row to the next.
    pub stride: usize,
}

impl Rows<'_> {
    /// `len` values from `column` at place `p` of the lines.
    #[inline(always)]
    fn read(&self, p: usize, column: usize, len: usize) -> &[f32] {
        match self.from {
            Some((from, at)) => cut(from, at + p * self.stride + column, len),
            None => cut(self.to, self.start + (p - self.first) * self.stride + column, len),
        }
    }

    /// The place for the new ones.
    #[inline(always)]
    fn write(&mut self, p: usize, column: usize, len: usize) -> &mut [f32] {
        cut_mut(self.to, self.start + (p - self.first) * self.stride + column, len)
    }
}

/// Work space of a sweep along rows. A narrow extent has many short rows: space made anew for
/// each would cost as much as what is computed in it.
pub struct RowRoom {
    old: [f32; WIDTH + BLOCK + 1],
    steps: [f32; WIDTH + BLOCK],
    volumes: [f32; WIDTH + BLOCK],
    per_volume: [f32; WIDTH + BLOCK],
    flux: [f32; WIDTH + 1],
    next: [f32; WIDTH],
}

impl RowRoom {
    /// Room for any row.
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            old: [0.0; WIDTH + BLOCK + 1],
            steps: [0.0; WIDTH + BLOCK],
            volumes: [0.0; WIDTH + BLOCK],
            per_volume: [0.0; WIDTH + BLOCK],
            flux: [0.0; WIDTH + 1],
            next: [0.0; WIDTH],
        }
    }
}

/// Work space of a sweep along lines.
pub struct LineRoom {
    /// Step across face f in row f modulo the number.
    steps: [[f32; WIDTH]; 8],
    /// Of cell f in row f modulo the number, and their inverses.
    volumes: [[f32; WIDTH]; 2],
    per_volume: [[f32; WIDTH]; 2],
    /// Through face f in row f modulo the number.
    flux: [[f32; WIDTH]; 2],
    next: [f32; WIDTH],
}

impl LineRoom {
    /// Room for any lines.
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            steps: [[0.0; WIDTH]; 8],
            volumes: [[1.0; WIDTH]; 2],
            per_volume: [[1.0; WIDTH]; 2],
            flux: [[0.0; WIDTH]; 2],
            next: [0.0; WIDTH],
        }
    }
}

impl Sweep<'_> {
    /// Volumes, in cells, that the sweeps `before` left of the cells from index `at`, and their
    /// inverses.
    #[inline(always)]
    fn set_volumes(&self, at: usize, volumes: &mut [f32], inverses: &mut [f32]) {
        let len = volumes.len();
        let (volumes, inverses) = (blocks_mut(volumes, 0, len), blocks_mut(inverses, 0, len));
        let faces = |axis: usize| {
            let stride = self.layout.strides()[axis];
            (blocks(self.velocity[axis], at, len), blocks(self.velocity[axis], at + stride, len))
        };
        let scale = [self.dt_per_spacing_s_m; BLOCK];
        match *self.before {
            [] => (volumes.fill([1.0; BLOCK]), inverses.fill([1.0; BLOCK])).0,
            [a] => {
                let a = faces(a);
                for (b, (volume, inverse)) in volumes.iter_mut().zip(inverses).enumerate() {
                    let lost = times(scale, subtract(a.1[b], a.0[b]));
                    *volume = subtract([1.0; BLOCK], lost);
                    *inverse = inverses_of(*volume);
                }
            }
            [a, c, ..] => {
                let (a, c) = (faces(a), faces(c));
                for (b, (volume, inverse)) in volumes.iter_mut().zip(inverses).enumerate() {
                    let lost = times(scale, subtract(a.1[b], a.0[b]));
                    let lost_then = times(scale, subtract(c.1[b], c.0[b]));
                    *volume = subtract(subtract([1.0; BLOCK], lost), lost_then);
                    *inverse = inverses_of(*volume);
                }
            }
        }
    }

    /// New fractions from old ones, volumes, and fluxes and velocities below and above.
    #[inline(always)]
    fn set_next(
        &self,
        next: &mut [f32],
        [old, volumes]: [&[f32]; 2],
        flux: [&[f32]; 2],
        velocity: [&[f32]; 2],
    ) {
        // After the last sweep all cells are as large as before the first.
        let is_last = self.before.len() == 2;
        let len = next.len();
        let [old, volumes] = [old, volumes].map(|values| blocks(values, 0, len));
        let ([f0, f1], [u0, u1]) =
            (flux.map(|f| blocks(f, 0, len)), velocity.map(|u| blocks(u, 0, len)));
        let scale = [self.dt_per_spacing_s_m; BLOCK];
        for (b, next) in blocks_mut(next, 0, len).iter_mut().enumerate() {
            let mut fraction = subtract(times(old[b], volumes[b]), subtract(f1[b], f0[b]));
            if !is_last {
                let net = times(scale, subtract(u1[b], u0[b]));
                fraction = times(fraction, inverses_of(subtract(volumes[b], net)));
            }
            *next = each(
                #[inline(always)]
                |i| if fraction[i] < TRACE { 0.0 } else { fraction[i] },
            );
        }
    }

    /// Sweeps `columns` of one row along x, in place. Cell 0 of it is at `to` in `plane`, and at
    /// `at` in whole arrays. Nothing passes the first face: it is a wall, or no substance is near.
    #[inline(always)]
    pub fn row(
        &self,
        plane: &mut [f32],
        to: usize,
        at: usize,
        columns: Range<usize>,
        room: &mut RowRoom,
    ) {
        let RowRoom { old, steps, volumes, per_volume, flux, next } = room;
        let (mut behind, mut flux_behind) = ([0.0; 3], 0.0);
        for start in columns.clone().step_by(WIDTH) {
            let count = (columns.end - start).min(WIDTH);
            let len = count.next_multiple_of(BLOCK);
            // One block more than needed: whole blocks cost less than what is left of one.
            let more = len + BLOCK;
            old[..3].copy_from_slice(&behind);
            put(&mut old[3..][..len], cut(plane, to + start, len), len);
            old[len + 3..][..3].copy_from_slice(cut(plane, to + start + len, 3));
            self.set_row_steps(&mut steps[..more], old, at, start);
            // What passes the last face, the side of the box, is not for a sweep to take.
            let side = self.layout.cells[0] - start;
            // Of the cell after the last, too, if anything may come from there.
            let known = if count == len && len < side { more } else { len };
            self.set_volumes(at + start, &mut volumes[..known], per_volume);
            flux[0] = flux_behind;
            let u = cut(self.velocity[0], at + start, len + 2);
            let s: [&[f32]; 5] = array::from_fn(|m| cut(steps, m + 1, len));
            let beside = [cut(old, 3, len), cut(old, 4, len)];
            let flow = [cut(u, 0, len), cut(u, 1, len), cut(u, 2, len)];
            let per_volume = [cut(per_volume, 0, len), cut(per_volume, 1, len)];
            self.set_flux(cut_mut(flux, 1, len), s, beside, flow, per_volume);
            if side <= len {
                flux[side] = 0.0;
            }
            let fluxes = [cut(flux, 0, len), cut(flux, 1, len)];
            let volumes = cut(volumes, 0, len);
            self.set_next(&mut next[..len], [beside[0], volumes], fluxes, [flow[0], flow[1]]);
            behind.copy_from_slice(cut(old, count, 3));
            flux_behind = flux[count];
            put(cut_mut(plane, to + start, len), next, count);
        }
    }

    /// Differences across the faces from `start - 2` of a row, whose cells from `start - 3` are
    /// `old`. Here is all that says what lies beyond the ends of a row: walls.
    #[inline(always)]
    fn set_row_steps(&self, steps: &mut [f32], old: &[f32], at: usize, start: usize) {
        let len = steps.len();
        let open = self.open.map(|open| cut(open[0], at + start - 2, len));
        set_steps(steps, [cut(old, 0, len), cut(old, 1, len)], open);
        if start < 3 {
            steps[..3 - start].fill(0.0);
        }
        let side = self.layout.cells[0] + 2 - start;
        if side < len {
            steps[side..].fill(0.0);
        }
    }

    #[inline(always)]
    fn set_flux(
        &self,
        flux: &mut [f32],
        s: [&[f32]; 5],
        beside: [&[f32]; 2],
        flow: [&[f32]; 3],
        per_volume: [&[f32]; 2],
    ) {
        let (scale, highest) = (self.dt_per_spacing_s_m, self.highest);
        for i in 0..flux.len() {
            let face = Face {
                steps: [s[0][i], s[1][i], s[2][i], s[3][i], s[4][i]],
                beside: [beside[0][i], beside[1][i]],
                flow: [scale * flow[0][i], scale * flow[1][i], scale * flow[2][i]],
                per_volume: [per_volume[0][i], per_volume[1][i]],
                highest,
            };
            flux[i] = face.flux();
        }
    }

    /// Sweeps cells `places` of `columns` lines along y or z; the first cell of the first line
    /// is at `at` in whole arrays.
    #[inline(always)]
    pub fn lines(
        &self,
        rows: &mut Rows<'_>,
        at: usize,
        columns: usize,
        places: Range<usize>,
        room: &mut LineRoom,
    ) {
        for first in (0..columns).step_by(WIDTH) {
            let count = (columns - first).min(WIDTH);
            self.strip(rows, at + first, first..first + count, places.clone(), room);
        }
    }

    #[inline(always)]
    fn strip(
        &self,
        rows: &mut Rows<'_>,
        at: usize,
        columns: Range<usize>,
        places: Range<usize>,
        room: &mut LineRoom,
    ) {
        let LineRoom { steps, volumes, per_volume, flux, next } = room;
        let (first, len) = (columns.start, columns.len().next_multiple_of(BLOCK));
        let (n, stride) = (self.layout.cells[self.axis], self.layout.strides()[self.axis]);
        let velocity = |face: usize| cut(self.velocity[self.axis], at + face * stride, len);
        // What lies before the first cell of a line, or after its last.
        (steps[6], steps[7]) = ([0.0; WIDTH], [0.0; WIDTH]);
        *per_volume = [[1.0; WIDTH]; 2];
        for face in places.start.saturating_sub(2)..places.start + 2 {
            self.set_line_steps(&mut steps[face % 8][..len], rows, at, first, face);
        }
        for face in places.start.saturating_sub(1)..=places.end {
            let (this, other) = (face % 2, (face + 1) % 2);
            if face < n {
                let inverses = &mut per_volume[this];
                self.set_volumes(at + face * stride, &mut volumes[this][..len], inverses);
            }
            if face < places.start {
                continue;
            }
            self.set_line_steps(&mut steps[(face + 2) % 8][..len], rows, at, first, face + 2);
            let s = array::from_fn(|m| &steps[(face + 6 + m) % 8][..len]);
            let beside =
                [rows.read(face.max(1) - 1, first, len), rows.read(face.min(n - 1), first, len)];
            let flow = [
                cut(self.velocity[self.axis], at + face * stride - stride, len),
                velocity(face),
                velocity((face + 1).min(n)),
            ];
            let inverses = [&per_volume[other][..len], &per_volume[this][..len]];
            if face == 0 || face == n {
                flux[this][..len].fill(0.0);
            } else {
                self.set_flux(&mut flux[this][..len], s, beside, flow, inverses);
            }
            if face > places.start {
                let fluxes = [&flux[other][..len], &flux[this][..len]];
                let old = [beside[0], &volumes[other][..len]];
                self.set_next(&mut next[..len], old, fluxes, [flow[0], flow[1]]);
                put(rows.write(face - 1, first, len), next, columns.len());
            }
        }
    }

    /// Differences across one face of the lines. Here is all that says what lies beyond the ends
    /// of a line: walls.
    #[inline(always)]
    fn set_line_steps(
        &self,
        steps: &mut [f32],
        rows: &Rows<'_>,
        at: usize,
        first: usize,
        face: usize,
    ) {
        let len = steps.len();
        if face == 0 || face >= self.layout.cells[self.axis] {
            steps.fill(0.0);
            return;
        }
        let from = at + face * self.layout.strides()[self.axis];
        let open = self.open.map(|open| cut(open[self.axis], from, len));
        set_steps(steps, [rows.read(face - 1, first, len), rows.read(face, first, len)], open);
    }
}

/// Differences of what is above faces to what is below, where they are open.
#[inline(always)]
fn set_steps(steps: &mut [f32], [below, above]: [&[f32]; 2], open: Option<&[f32]>) {
    let len = steps.len();
    let (below, above) = (blocks(below, 0, len), blocks(above, 0, len));
    let open = open.map(|open| blocks(open, 0, len));
    for (b, step) in blocks_mut(steps, 0, len).iter_mut().enumerate() {
        *step = subtract(above[b], below[b]);
        if let Some(open) = open {
            *step = times(open[b], *step);
        }
    }
}

/// Puts the first `count` values of `from` to `to`, in whole blocks: what is beyond them stays.
/// Copies of any other length would cost calls, or tests of each value.
#[inline(always)]
fn put(to: &mut [f32], from: &[f32], count: usize) {
    let (to, _) = to.as_chunks_mut::<BLOCK>();
    let (from, _) = from.as_chunks::<BLOCK>();
    for (b, (to, from)) in to.iter_mut().zip(from).enumerate() {
        let (old, left) = (*to, count.saturating_sub(b * BLOCK));
        *to = each(
            #[inline(always)]
            |i| if i < left { from[i] } else { old[i] },
        );
    }
}

#[inline(always)]
fn inverses_of(volumes: Block) -> Block {
    each(
        #[inline(always)]
        |i| inverse(volumes[i]),
    )
}

/// 1 / volume, or 0 where hardly any is left: there is nothing in it then.
#[inline(always)]
fn inverse(volume: f32) -> f32 {
    if volume > LEAST_VOLUME { 1.0 / volume } else { 0.0 }
}
