//! The direct solver of the pressure equation in a closed box.
//!
//! ```text
//! A psi = rhs,   (A psi)_i = sum over inner faces of i of (psi_i - psi_neighbour)
//! ```
//! Cosine transforms along x and y leave one tridiagonal system along z for each pair of modes,
//! (l_x + l_y) psi_k + (second difference of psi)_k = rhs_k, which elimination without pivoting
//! (Thomas 1949) solves with tabled inverse pivots g:
//! ```text
//! y_k = (rhs_k + y_(k-1)) g_k   upwards,   psi_k = y_k + g_k psi_(k+1)   downwards
//! ```
//! The constant mode is singular: its last pivot is 0 and counts as infinite, which makes the
//! mean of psi over the last plane 0.

use crate::{
    pool::Pool,
    simd::SimdClass,
    solver::flow::{
        field::{Field, Layout},
        transform::{Rows, Transform, multiply},
    },
};

/// Modes along y that are worked on together.
const MODES: usize = 8;

/// What the pressure meets at one end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// A wall.
    Closed,
    /// An opening.
    Open,
}

/// What it meets at both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Each other.
    Periodic,
    /// These, the lower one first.
    Between([End; 2]),
}

/// Tables and work space for one grid.
pub struct Poisson {
    layout: Layout,
    x: Transform,
    y: Transform,
    /// Inverse pivots, laid out as `modes`.
    inverse_pivot: Field,
    /// Rows folded along x, by z, y and x.
    folded: Field,
    /// Rows of x modes, by z, y and x mode.
    half_way: Field,
    /// All modes, by y mode, z and x mode.
    modes: Field,
}

impl Poisson {
    /// The solver for a grid of this layout.
    pub fn new(layout: &Layout, _ends: [Ends; 3]) -> Self {
        let [nx, ny, nz] = layout.cells;
        let (x, y) = (Transform::new(nx), Transform::new(ny));
        let inverse_pivot = inverse_pivots(&x.eigenvalues(), &y.eigenvalues(), nz);
        let rows = || Field::zeros(nz * ny * x.len);
        let (folded, half_way, modes) = (rows(), rows(), Field::zeros(y.len * nz * x.len));
        Self { layout: *layout, inverse_pivot, folded, half_way, modes, x, y }
    }

    /// Solves for `psi`; both are padded arrays.
    pub fn solve(&mut self, pool: &Pool, simd: SimdClass, rhs: &[f32], psi: &mut Field) {
        self.transform_x(pool, simd, rhs);
        self.solve_modes(pool, simd);
        self.transform_back(pool, simd, psi);
    }

    fn transform_x(&mut self, pool: &Pool, simd: SimdClass, rhs: &[f32]) {
        let (layout, x, y) = (self.layout, &self.x, &self.y);
        let [_, ny, _] = layout.cells;
        let plane = ny * x.len;
        let outs = [&mut *self.folded, &mut *self.half_way];
        pool.planes(outs, [plane; 2], |k, [folded, out]| {
            simd.vectorize(
                #[inline(always)]
                || {
                    for (j, folded) in folded.chunks_exact_mut(x.len).enumerate() {
                        x.fold(&rhs[layout.index(0, j, k)..], folded);
                    }
                    for half in x.halves.iter().filter(|half| half.count > 0) {
                        let a = Rows(&folded[half.start..], x.len);
                        let table = Rows(&half.by_value, half.padded);
                        let size = [ny, half.count, half.padded];
                        multiply(size, a, table, &mut out[half.start..], x.len);
                    }
                    y.fold_rows(out, x.len);
                },
            );
        });
    }

    fn solve_modes(&mut self, pool: &Pool, simd: SimdClass) {
        let (x, [even, odd]) = (&self.x, &self.y.halves);
        let [_, ny, nz] = self.layout.cells;
        let (block, plane) = (MODES * nz * x.len, ny * x.len);
        let (half_way, inverse_pivot) = (&*self.half_way, &*self.inverse_pivot);
        pool.planes([&mut *self.modes], [block], |b, [out]| {
            let first = b * MODES;
            let (half, rows_before) = if first < odd.start { (even, 0) } else { (odd, even.count) };
            simd.vectorize(
                #[inline(always)]
                || {
                    let table =
                        Rows(&half.by_mode[(first - half.start) * half.padded..], half.padded);
                    for k in 0..nz {
                        let rows = Rows(&half_way[k * plane + rows_before * x.len..], x.len);
                        let size = [MODES, half.count, x.len];
                        multiply(size, table, rows, &mut out[k * x.len..], nz * x.len);
                    }
                    let pivots = inverse_pivot[b * block..].chunks_exact(nz * x.len);
                    for (mode, pivots) in out.chunks_exact_mut(nz * x.len).zip(pivots) {
                        eliminate(mode, pivots, x.len);
                    }
                },
            );
        });
    }

    fn transform_back(&mut self, pool: &Pool, simd: SimdClass, psi: &mut Field) {
        let (layout, x, y, modes) = (self.layout, &self.x, &self.y, &*self.modes);
        let [_, ny, nz] = layout.cells;
        let plane = ny * x.len;
        let outs = [layout.planes(psi), &mut *self.half_way, &mut *self.folded];
        pool.planes(outs, [layout.plane, plane, plane], |k, [psi, rows, folded]| {
            simd.vectorize(
                #[inline(always)]
                || {
                    let mut first_row = 0;
                    for half in y.halves.iter().filter(|half| half.count > 0) {
                        let table = Rows(&half.by_value, half.padded);
                        let b = Rows(&modes[(half.start * nz + k) * x.len..], nz * x.len);
                        let size = [half.count, half.count, x.len];
                        multiply(size, table, b, &mut rows[first_row * x.len..], x.len);
                        first_row += half.count;
                    }
                    y.fold_rows(rows, x.len);
                    for half in x.halves.iter().filter(|half| half.count > 0) {
                        let a = Rows(&rows[half.start..], x.len);
                        let table = Rows(&half.by_mode, half.padded);
                        let size = [ny, half.count, half.padded];
                        multiply(size, a, table, &mut folded[half.start..], x.len);
                    }
                    for (j, folded) in folded.chunks_exact(x.len).enumerate() {
                        x.unfold(folded, &mut psi[layout.index_in_plane(0, j)..]);
                    }
                },
            );
        });
    }
}

/// One system along z for each of `row` modes at once: see the module.
#[inline(always)]
fn eliminate(modes: &mut [f32], inverse_pivot: &[f32], row: usize) {
    let planes = modes.len() / row;
    modes[..row].iter_mut().zip(inverse_pivot).for_each(|(mode, g)| *mode *= g);
    for k in 1..planes {
        let (done, rest) = modes.split_at_mut(k * row);
        let below = &done[(k - 1) * row..];
        for_blocks(&mut rest[..row], below, &inverse_pivot[k * row..], |here, y, g| (here + y) * g);
    }
    for k in (1..planes).rev() {
        let (rest, done) = modes.split_at_mut(k * row);
        let (here, pivot) = (&mut rest[(k - 1) * row..], &inverse_pivot[(k - 1) * row..]);
        for_blocks(here, &done[..row], pivot, |here, psi, g| here + g * psi);
    }
}

/// here = next(here, other, pivot), a block at a time: that the optimiser sees at once that
/// what it writes lies apart from what it reads.
#[inline(always)]
fn for_blocks(here: &mut [f32], other: &[f32], pivot: &[f32], next: impl Fn(f32, f32, f32) -> f32) {
    let others = other.as_chunks::<MODES>().0.iter().zip(pivot.as_chunks::<MODES>().0);
    for (here, (other, pivot)) in here.as_chunks_mut::<MODES>().0.iter_mut().zip(others) {
        *here = std::array::from_fn(
            #[inline(always)]
            |i| next(here[i], other[i], pivot[i]),
        );
    }
}

fn inverse_pivots(x: &[f64], y: &[f64], nz: usize) -> Field {
    let mut table = Field::zeros(x.len() * y.len() * nz);
    for (m, eigenvalue_y) in y.iter().enumerate() {
        for (l, eigenvalue_x) in x.iter().enumerate() {
            let mut below = 0.0;
            for k in 0..nz {
                let neighbours = f64::from(u8::from(k > 0) + u8::from(k + 1 < nz));
                let pivot = eigenvalue_x + eigenvalue_y + neighbours - below;
                below = if pivot > 1e-9 { 1.0 / pivot } else { 0.0 };
                table[(m * nz + k) * x.len() + l] = below as f32;
            }
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::flow::faces::cells;

    /// Largest |A psi - rhs| over the largest |rhs|.
    fn residual(layout: &Layout, psi: &Field, rhs: &Field) -> f32 {
        let [nx, ny, nz] = layout.cells;
        let at = |i: isize, j: isize, k: isize| {
            let inside = |c: isize, n: usize| (0..n as isize).contains(&c);
            (inside(i, nx) && inside(j, ny) && inside(k, nz))
                .then(|| psi[layout.index(i as usize, j as usize, k as usize)])
        };
        let worst = cells(layout.cells).map(|(i, j, k)| {
            let [x, y, z] = [i, j, k].map(|c| c as isize);
            let around = [(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1)];
            let here = psi[layout.index(i, j, k)];
            let sum: f32 =
                around.iter().filter_map(|d| at(x + d.0, y + d.1, z + d.2)).map(|p| here - p).sum();
            (sum - rhs[layout.index(i, j, k)]).abs()
        });
        worst.fold(0.0, f32::max) / rhs.iter().fold(0f32, |a, b| a.max(b.abs()))
    }

    #[test]
    fn the_residual_is_rounding_for_any_shape_of_box() {
        let pool = Pool::new(2, false);
        for size in
            [[16, 16, 16], [2, 2, 2], [1, 8, 8], [8, 1, 1], [5, 9, 1], [3, 1, 5], [31, 12, 20]]
        {
            let layout = Layout::new(size);
            let (mut rhs, mut psi) = (layout.zeros(), layout.zeros());
            let mut mean = 0.0;
            for (i, j, k) in cells(size) {
                let at = layout.index(i, j, k);
                rhs[at] = ((3 * i + 5 * j + 7 * k) as f32).sin() + (i as f32 * 0.2).cos();
                mean += rhs[at] / size.iter().product::<usize>() as f32;
            }
            cells(size).for_each(|(i, j, k)| rhs[layout.index(i, j, k)] -= mean);
            let mut poisson = Poisson::new(&layout, [Ends::Between([End::Closed; 2]); 3]);
            for simd in SimdClass::ALL {
                poisson.solve(&pool, simd, &rhs, &mut psi);
                let residual = residual(&layout, &psi, &rhs);
                assert!(residual < 3e-5, "{size:?} {simd}: {residual}");
            }
        }
    }
}
