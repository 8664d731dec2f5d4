//! The direct solver of the pressure equation in a box.
//!
//! ```text
//! A psi = rhs,   (A psi)_i = sum over the faces of i that liquid may pass of (psi_i - psi_neighbour)
//! ```
//! Transforms to the modes of x and y leave one tridiagonal system along z for each pair of
//! modes. A plane is transformed as a whole while it is in the nearest cache; between the two
//! transforms stands one array of modes, in which the columns along z are solved in place.

pub mod basis;
mod column;
mod lanes;
mod product;
mod transform;

use self::{
    basis::Ends,
    column::{Columns, WIDTH},
    product::{Rows, multiply},
    transform::Transform,
};
use crate::{
    pool::Pool,
    simd::SimdClass,
    solver::flow::field::{Field, Layout},
};

/// Values in a row of modes are a multiple of this.
const PAD: usize = 8;

/// Tables and work space for one grid.
pub struct Poisson {
    layout: Layout,
    x: Transform,
    y: Transform,
    z: Columns,
    /// All modes, by z, y mode and x mode.
    modes: Field,
    /// Values from one plane of modes to the next.
    plane: usize,
    /// Two planes for each thread.
    scratch: Field,
}

impl Poisson {
    /// The solver for a grid of this layout, to run on `threads` threads at most.
    pub fn new(layout: &Layout, ends: [Ends; 3], threads: usize) -> Self {
        let [nx, ny, nz] = layout.cells;
        let (mut x, y) = (Transform::new(nx, ends[0], PAD), Transform::new(ny, ends[1], 1));
        let plane = (ny * x.len).next_multiple_of(WIDTH);
        // Planes a multiple of 4 KiB apart would fall on the same lines of a cache.
        let plane = if plane.is_multiple_of(512) { plane + WIDTH } else { plane };
        let mut eigenvalues: Vec<f64> =
            y.eigenvalues.iter().flat_map(|y| x.eigenvalues.iter().map(move |x| x + y)).collect();
        eigenvalues.resize(plane, 1.0);
        let z = Columns::new(&eigenvalues, nz, ends[2]);
        x.scale(z.scale());
        Self {
            layout: *layout,
            z,
            modes: Field::zeros(nz * plane),
            plane,
            scratch: Field::zeros(threads * 2 * ny * x.len),
            x,
            y,
        }
    }

    /// Solves in place: `psi` is a padded array that comes in as the right-hand side.
    pub fn solve_in_place(&mut self, pool: &Pool, simd: SimdClass, psi: &mut Field) {
        self.transform(pool, simd, psi);
        self.solve_columns(pool, simd);
        self.transform_back(pool, simd, psi);
    }

    /// Solves for `psi`; both are padded arrays.
    pub fn solve(&mut self, pool: &Pool, simd: SimdClass, rhs: &[f32], psi: &mut Field) {
        self.transform(pool, simd, rhs);
        self.solve_columns(pool, simd);
        self.transform_back(pool, simd, psi);
    }

    fn transform(&mut self, pool: &Pool, simd: SimdClass, rhs: &[f32]) {
        let (layout, x, y) = (self.layout, &self.x, &self.y);
        let ny = layout.cells[1];
        pool.planes_with(&mut self.scratch, [&mut *self.modes], [self.plane], |k, [out], work| {
            simd.vectorize_as(
                #[inline(always)]
                |class| {
                    let (folded, rows) = work[..2 * ny * x.len].split_at_mut(ny * x.len);
                    for (j, folded) in folded.chunks_exact_mut(x.len).enumerate() {
                        x.fold(&rhs[layout.index(0, j, k)..], folded);
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

    fn solve_columns(&mut self, pool: &Pool, simd: SimdClass) {
        let z = &self.z;
        pool.columns(&mut self.modes, self.plane, WIDTH, |c, mut column| {
            simd.vectorize_as(
                #[inline(always)]
                |class| z.solve(class, c, &mut column),
            );
        });
    }

    fn transform_back(&mut self, pool: &Pool, simd: SimdClass, psi: &mut Field) {
        let (layout, x, y, modes) = (self.layout, &self.x, &self.y, &*self.modes);
        let ([_, ny, _], plane) = (layout.cells, self.plane);
        let outs = [layout.planes(psi)];
        pool.planes_with(&mut self.scratch, outs, [layout.plane], |k, [psi], work| {
            simd.vectorize_as(
                #[inline(always)]
                |class| {
                    let (folded, rows) = work[..2 * ny * x.len].split_at_mut(ny * x.len);
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
                        x.unfold(folded, &mut psi[layout.index_in_plane(0, j)..]);
                    }
                },
            );
        });
    }
}

#[cfg(test)]
mod tests;
