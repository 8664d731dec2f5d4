//! The direct solver of the pressure equation in a box.
//!
//! ```text
//! A psi = rhs,   (A psi)_i = sum over the open faces of i of (psi_i - psi_neighbour)
//! ```
//! and of (A + shift) psi = rhs, which is that of implicit viscosity.
//! Transforms to the modes of x and y leave one tridiagonal system along z for each pair of
//! modes. A plane is transformed as a whole while it is in the nearest cache; between the two
//! transforms stands one array of modes, in which the columns along z are solved in place.

mod column;

use self::column::{Columns, WIDTH};
use crate::{
    pool::{Partial, Pool, Turn},
    simd::SimdClass,
    solver::flow::field::{BLOCK, Field, Layout, cut},
    spectral::{Rows, Transform, basis::Ends, multiply},
};

/// Values in a row of modes are a multiple of this.
const PAD: usize = 8;

/// Solves for all cells of one grid.
pub struct Poisson {
    modal: Modal,
    room: Room,
}

impl Poisson {
    /// The solver for a grid of this layout, to run on `threads` threads at most.
    pub fn new(layout: &Layout, ends: [Ends; 3], threads: usize) -> Self {
        let all = Unknowns { first: [0; 3], count: layout.cells };
        let modal = Modal::new(layout, all, ends);
        let mut room = Room::new(threads);
        room.make_for(&modal);
        Self { modal, room }
    }

    /// Work space, free between two solutions.
    pub fn room(&mut self) -> &mut Room {
        &mut self.room
    }

    /// Memory that it takes, work space and all.
    pub fn bytes(&self) -> usize {
        self.modal.bytes() + self.room.modes.bytes() + self.room.scratch.bytes()
    }

    /// Solves for `psi`, a padded array.
    pub fn solve(&mut self, pool: &Pool, simd: SimdClass, rhs: impl Source, psi: &mut Field) {
        self.find_modes(pool, simd, rhs);
        self.modal.transform_back(pool, simd, &mut self.room, psi);
    }

    /// The first part of a solution, of which [`Poisson::pass_by`] is the other.
    pub fn find_modes(&mut self, pool: &Pool, simd: SimdClass, rhs: impl Source) {
        self.modal.transform(pool, simd, &mut self.room, rhs);
        self.modal.solve_columns(pool, simd, &mut self.room);
    }

    /// Calls `body(k, [below, here], planes)` with plane k of the solution and the one below, each
    /// padded by zeros, and the planes of `outs`; combines what it returns as [`Pool::fold`]. The
    /// solution is stored nowhere.
    pub fn pass_by<const M: usize>(
        &mut self,
        pool: &Pool,
        simd: SimdClass,
        outs: [&mut [f32]; M],
        body: impl Fn(usize, [&[f32]; 2], [&mut [f32]; M]) -> Partial + Sync,
        combine: impl Fn(Partial, Partial) -> Partial,
    ) -> Partial {
        let Self { modal, room: Room { modes, scratch, .. } } = self;
        let plane = modal.layout.plane;
        let body = |Turn { k, is_first }: Turn, planes: [&mut [f32]; M], work: &mut [f32]| {
            let (work, psi) = work.split_at_mut(modal.work());
            let psi = &mut psi[..2 * plane];
            if is_first {
                // What was left of others; from now on only unknowns are written.
                psi.fill(0.0);
            }
            let (even, odd) = psi.split_at_mut(plane);
            let (here, below) = if k % 2 == 0 { (even, odd) } else { (odd, even) };
            if is_first && k > 0 {
                modal.plane_back(simd, modes, k - 1, below, work);
            }
            modal.plane_back(simd, modes, k, here, work);
            body(k, [below, here], planes)
        };
        pool.fold_with(scratch, outs, [plane; M], body, combine)
    }
}

/// A right-hand side, which is asked for plane by plane.
pub trait Source: Sync {
    /// Plane `k` of a padded array; `room` is as large, for what is stored nowhere else. To be
    /// `#[inline(always)]`.
    fn plane<'a>(&'a self, k: usize, room: &'a mut [f32]) -> &'a [f32];
}

/// A padded array, as it is.
#[derive(Clone, Copy)]
pub struct Stored<'a>(pub &'a Layout, pub &'a [f32]);

impl Source for Stored<'_> {
    #[inline(always)]
    fn plane<'a>(&'a self, k: usize, _room: &'a mut [f32]) -> &'a [f32] {
        let Self(layout, values) = self;
        cut(values, (k + 1) * layout.plane, layout.plane)
    }
}

/// Where the unknowns lie in a padded array.
#[derive(Clone, Copy)]
pub struct Unknowns {
    /// The first along each axis.
    pub first: [usize; 3],
    /// Their number along each axis, at least 1.
    pub count: [usize; 3],
}

/// Work space, for one solver after the other.
pub struct Room {
    threads: usize,
    /// All modes, by z, y mode and x mode.
    modes: Field,
    /// Two planes of modes and two padded ones for each thread.
    scratch: Field,
}

impl Room {
    /// For `threads` threads at most, and no solver yet.
    pub fn new(threads: usize) -> Self {
        Self { threads, modes: Field::zeros(0), scratch: Field::zeros(0) }
    }

    /// Makes it large enough for `modal`.
    pub fn make_for(&mut self, modal: &Modal) {
        let [.., nz] = modal.unknowns.count;
        let grow = |field: &mut Field, len: usize| {
            if field.len() < len {
                *field = Field::zeros(len);
            }
        };
        grow(&mut self.modes, nz * modal.plane);
        let share = modal.work() + 2 * modal.layout.plane;
        grow(&mut self.scratch, self.threads * share.next_multiple_of(BLOCK));
    }
}

/// Tables of one system (A + shift) psi = rhs.
pub struct Modal {
    layout: Layout,
    unknowns: Unknowns,
    x: Transform,
    y: Transform,
    z: Columns,
    /// Values from one plane of modes to the next.
    plane: usize,
    shift: f64,
}

impl Modal {
    /// The system without a shift.
    pub fn new(layout: &Layout, unknowns: Unknowns, ends: [Ends; 3]) -> Self {
        let [nx, ny, nz] = unknowns.count;
        let (mut x, y) = (Transform::new(nx, ends[0], PAD), Transform::new(ny, ends[1], 1));
        let plane = (ny * x.len).next_multiple_of(WIDTH);
        // Planes a multiple of 4 KiB apart would fall on the same lines of a cache.
        let plane = if plane.is_multiple_of(512) { plane + WIDTH } else { plane };
        let z = Columns::new(plane, nz, ends[2]);
        x.scale(z.scale());
        let mut modal = Self { layout: *layout, unknowns, x, y, z, plane, shift: f64::NAN };
        modal.set_shift(0.0);
        modal
    }

    /// Memory that the tables take; those of x and y are small.
    pub fn bytes(&self) -> usize {
        self.z.bytes()
    }

    /// Makes `shift` that of the system; 0 or more.
    pub fn set_shift(&mut self, shift: f64) {
        if self.shift == shift {
            return;
        }
        self.shift = shift;
        let ny = self.unknowns.count[1];
        for (m, y) in self.y.eigenvalues[..ny].iter().enumerate() {
            for (l, x) in self.x.eigenvalues.iter().enumerate() {
                self.z.set(m * self.x.len + l, x + y + shift);
            }
        }
        for pad in ny * self.x.len..self.plane {
            self.z.set(pad, 1.0);
        }
    }

    /// Solves in place: `psi` is a padded array that comes in as the right-hand side.
    pub fn solve_in_place(&self, pool: &Pool, simd: SimdClass, room: &mut Room, psi: &mut Field) {
        self.transform(pool, simd, room, Stored(&self.layout, psi));
        self.solve_columns(pool, simd, room);
        self.transform_back(pool, simd, room, psi);
    }

    fn transform(&self, pool: &Pool, simd: SimdClass, room: &mut Room, rhs: impl Source) {
        let (layout, x, y) = (self.layout, &self.x, &self.y);
        let (ny, [i0, j0, k0]) = (self.unknowns.count[1], self.unknowns.first);
        let modes = &mut room.modes[..self.unknowns.count[2] * self.plane];
        pool.planes_with(&mut room.scratch, [modes], [self.plane], |k, [out], work| {
            simd.vectorize_as(
                #[inline(always)]
                |class| {
                    let (folded, work) = work.split_at_mut(ny * x.len);
                    let (rows, room) = work.split_at_mut(ny * x.len);
                    let rhs = rhs.plane(k0 + k, &mut room[..layout.plane]);
                    for (j, folded) in folded.chunks_exact_mut(x.len).enumerate() {
                        x.fold(&rhs[layout.index_in_plane(i0, j0 + j)..], folded);
                    }
                    y.fold_rows(folded, x.len);
                    for part in &x.parts {
                        let (a, b) = (&folded[part.from..], &part.by_value);
                        let size = [ny, part.count, part.padded];
                        let (a, b) = (Rows(a, x.len), Rows(b, part.padded));
                        multiply(class, size, a, b, &mut rows[part.start..], x.len);
                    }
                    for part in &y.parts {
                        let (a, b) = (&part.by_mode, &rows[part.from * x.len..]);
                        let size = [part.count, part.count, x.len];
                        let (a, b) = (Rows(a, part.padded), Rows(b, x.len));
                        multiply(class, size, a, b, &mut out[part.start * x.len..], x.len);
                    }
                },
            );
        });
    }

    fn solve_columns(&self, pool: &Pool, simd: SimdClass, room: &mut Room) {
        let z = &self.z;
        let modes = &mut room.modes[..self.unknowns.count[2] * self.plane];
        pool.columns(modes, self.plane, WIDTH, |c, mut column| {
            simd.vectorize_as(
                #[inline(always)]
                |class| z.solve(class, c, &mut column),
            );
        });
    }

    fn transform_back(&self, pool: &Pool, simd: SimdClass, room: &mut Room, psi: &mut Field) {
        let Self { layout, unknowns: Unknowns { first: [_, _, k0], count: [.., nz] }, .. } = self;
        let Room { modes, scratch, .. } = room;
        let outs = [&mut layout.planes(psi)[k0 * layout.plane..][..nz * layout.plane]];
        pool.planes_with(scratch, outs, [layout.plane], |k, [psi], work| {
            self.plane_back(simd, modes, k, psi, work);
        });
    }

    /// Values that a plane's transform works on.
    fn work(&self) -> usize {
        2 * self.unknowns.count[1] * self.x.len
    }

    /// The unknowns of plane `k`, of its modes.
    fn plane_back(
        &self,
        simd: SimdClass,
        modes: &[f32],
        k: usize,
        psi: &mut [f32],
        work: &mut [f32],
    ) {
        let (layout, x, y, plane) = (&self.layout, &self.x, &self.y, self.plane);
        let ([_, ny, _], [i0, j0, _]) = (self.unknowns.count, self.unknowns.first);
        simd.vectorize_as(
            #[inline(always)]
            |class| {
                let (folded, rows) = work[..self.work()].split_at_mut(ny * x.len);
                for part in &y.parts {
                    let b = &modes[k * plane + part.start * x.len..];
                    let size = [part.count, part.count, x.len];
                    let (a, b) = (Rows(&part.by_value, part.padded), Rows(b, x.len));
                    multiply(class, size, a, b, &mut rows[part.from * x.len..], x.len);
                }
                for part in &x.parts {
                    let (a, b) = (&rows[part.start..], &part.by_mode);
                    let size = [ny, part.count, part.padded];
                    let (a, b) = (Rows(a, x.len), Rows(b, part.padded));
                    multiply(class, size, a, b, &mut folded[part.from..], x.len);
                }
                y.unfold_rows(folded, x.len);
                for (j, folded) in folded.chunks_exact_mut(x.len).enumerate() {
                    x.unfold(folded, &mut psi[layout.index_in_plane(i0, j0 + j)..]);
                }
            },
        );
    }
}

#[cfg(test)]
mod tests;
