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
    #[allow(dead_code)]
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
            let mut poisson = Poisson::new(&layout, [Ends::CLOSED; 3], pool.threads());
            for simd in SimdClass::ALL {
                poisson.solve(&pool, simd, &rhs, &mut psi);
                let residual = residual(&layout, &psi, &rhs);
                assert!(residual < 3e-5, "{size:?} {simd}: {residual}");
            }
        }
    }

    #[test]
    fn timing() {
        let list = |name: &str, or: &str| -> Vec<usize> {
            let text = std::env::var(name).unwrap_or(or.into());
            text.split(',').map(|s| s.parse().expect("number")).collect()
        };
        for threads in list("THREADS", "1") {
            let pool = Pool::new(threads, true);
            for n in list("N", "16,32,48,64,96,128") {
                let layout = Layout::new([n; 3]);
                let mut rhs = layout.zeros();
                cells([n; 3]).for_each(|(i, j, k)| {
                    rhs[layout.index(i, j, k)] = ((3 * i + 5 * j + 7 * k) as f32).sin();
                });
                let mut psi = layout.zeros();
                let mut poisson = Poisson::new(&layout, [Ends::CLOSED; 3], pool.threads());
                for simd in list("SIMD", "1,2").into_iter().map(|s| SimdClass::ALL[s]) {
                    let mut times = vec![];
                    let mut part = [1e9f64; 3];
                    for _ in 0..(list("REPS", "300000000")[0] / (n * n * n * n)).clamp(20, 200_000)
                    {
                        let t = std::time::Instant::now();
                        poisson.transform(&pool, simd, &rhs);
                        let a = t.elapsed().as_secs_f64() * 1e3;
                        poisson.solve_columns(&pool, simd);
                        let b = t.elapsed().as_secs_f64() * 1e3;
                        poisson.transform_back(&pool, simd, &mut psi);
                        let c = t.elapsed().as_secs_f64() * 1e3;
                        for (m, v) in part.iter_mut().zip([a, b - a, c - b]) {
                            *m = m.min(v);
                        }
                        times.push(c);
                    }
                    times.sort_by(f64::total_cmp);
                    let median = times[times.len() / 2];
                    println!(
                        "threads {threads} n {n} {simd}: {:.4} {median:.4} ms, {part:.4?}",
                        times[0]
                    );
                }
            }
        }
    }
}
