//! Diffusion of one substance, bounded at any length of step.
//!
//! Short steps exchange between neighbours explicitly. Long ones are implicit along x, then y,
//! then z, each line solved for what passes its faces,
//! ```text
//! g[f] = alpha (d[f] + theta (g[f+1] - 2 g[f] + g[f-1])),    phi[i] += g[i+1] - g[i]
//! ```
//! with d the differences before, alpha = kappa dt / h^2, by the elimination of Thomas (1949).
//! What leaves a cell enters the next whatever rounding does to g. theta is 1/2 (Crank, Nicolson
//! 1947) up to alpha = 1, and just so much more beyond that no old fraction counts negatively.

use super::{
    cells::{Cells, Extent, STORED},
    sweep::TRACE,
};
use crate::solver::flow::{
    engine::Engine,
    field::{Layout, Star, cut},
};

/// Diffuses `cells` by an explicit step of diffusion number `spread`, at most 1/6. `work` is
/// overwritten. Returns the number of cells computed.
pub fn explicit(
    on: Engine<'_>,
    layout: &Layout,
    cells: &mut Cells,
    work: &mut Cells,
    spread: f32,
) -> f64 {
    let from = &*cells;
    let outs = work.slabs(layout);
    let computed = on.pool.planes_sum(outs, [layout.plane, STORED], |k, [out, stored]| {
        Extent::load(stored).clear(layout, out);
        let nearby = k.saturating_sub(1)..k + 2;
        let reach = nearby.fold(Extent::default(), |reach, k| reach.with(from.extent(k)));
        let is_plane = k < layout.cells[2] && !reach.is_empty();
        let reach = if is_plane { reach.grown(layout, 1) } else { Extent::default() };
        reach.store(stored);
        on.simd.vectorize(
            #[inline(always)]
            || {
                for j in reach.rows() {
                    let at = layout.index(reach.x[0], j, k);
                    let to = layout.index_in_plane(reach.x[0], j);
                    let out = &mut out[to..][..reach.columns().len()];
                    exchange(on, layout, &from.fraction, at, out, spread);
                }
            },
        );
        reach.cells() as f64
    });
    std::mem::swap(cells, work);
    computed
}

#[inline(always)]
fn exchange(
    on: Engine<'_>,
    layout: &Layout,
    from: &[f32],
    at: usize,
    out: &mut [f32],
    spread: f32,
) {
    let len = out.len();
    let Star { here, x, y, z } = Star::new(layout, from, at, len);
    let open = |axis: usize| {
        let open = &on.faces.open[axis];
        (cut(open, at, len), cut(open, at + layout.strides()[axis], len))
    };
    let (ox, oy, oz) = (open(0), open(1), open(2));
    for i in 0..len {
        let q = here[i];
        let gain = (ox.0[i] * (x.0[i] - q) + ox.1[i] * (x.1[i] - q))
            + (oy.0[i] * (y.0[i] - q) + oy.1[i] * (y.1[i] - q))
            + (oz.0[i] * (z.0[i] - q) + oz.1[i] * (z.1[i] - q));
        let next = q + spread * gain;
        out[i] = if next < TRACE { 0.0 } else { next };
    }
}

/// Diffuses `cells` by an implicit step of diffusion number `spread`, above 0. `work`
/// and `spare` are overwritten; they have room for all planes of the layout.
pub fn implicit(
    on: Engine<'_>,
    layout: &Layout,
    cells: &mut Cells,
    [work, spare]: [&mut [f32]; 2],
    spread: f64,
) {
    let theta = (1.0 - 0.5 / spread).max(0.5);
    let solve = |axis: usize, base: usize, open_from: usize, [phi, c, g]: [&mut [f32]; 3]| {
        let [nx, ny, _] = layout.cells;
        let strides = layout.strides();
        // Lines along y and z lie side by side in rows, those along x above each other.
        let (across, lanes, rows) = [(1, ny, 1), (0, nx, 1), (0, nx, ny)][axis];
        on.simd.vectorize(
            #[inline(always)]
            || {
                for row in 0..rows {
                    let lines = Lines {
                        n: layout.cells[axis],
                        stride: strides[axis],
                        lanes,
                        across: strides[across],
                        base: base + row * strides[1],
                        per_alpha_theta: (1.0 / (spread * theta)) as f32,
                        per_theta: (1.0 / theta) as f32,
                    };
                    lines.solve([&mut *phi, &mut *c, &mut *g], &on.faces.open[axis][open_from..]);
                }
            },
        );
    };
    let (whole, corner) = (layout.index(0, 0, 0), layout.index_in_plane(0, 0));
    for axis in [0, 1] {
        let outs =
            [&mut *cells.fraction, &mut *work, &mut *spare].map(|field| layout.planes(field));
        on.pool.planes(outs, [layout.plane; 3], |k, outs| {
            solve(axis, corner, (k + 1) * layout.plane, outs);
        });
    }
    solve(2, whole, 0, [&mut cells.fraction, &mut *work, &mut *spare]);
    cells.spread(layout);
}

/// Lines that are solved side by side.
struct Lines {
    /// Cells of a line, and from one to the next in memory.
    n: usize,
    stride: usize,
    /// Number of lines, and from one to the next.
    lanes: usize,
    across: usize,
    /// The first cell of the first line.
    base: usize,
    per_alpha_theta: f32,
    per_theta: f32,
}

impl Lines {
    /// `c` and `g` are work space laid out as `phi`.
    #[inline(always)]
    fn solve(&self, [phi, c, g]: [&mut [f32]; 3], open: &[f32]) {
        let Self { n, stride, lanes, across, base, per_alpha_theta, per_theta } = *self;
        let each = |p: usize| (0..lanes).map(move |l| base + p * stride + l * across);
        for at in each(0).chain(each(n)) {
            (c[at], g[at]) = (0.0, 0.0);
        }
        for p in 1..n {
            for at in each(p) {
                let below = at - stride;
                let m = open[at] / (per_alpha_theta + 2.0 - c[below]);
                let step = per_theta * (phi[at] - phi[below]);
                (c[at], g[at]) = (m, m * (step + g[below]));
            }
        }
        for p in (1..n).rev() {
            for at in each(p) {
                g[at] += c[at] * g[at + stride];
            }
        }
        for p in 0..n {
            for at in each(p) {
                let next = phi[at] + (g[at + stride] - g[at]);
                phi[at] = if next < TRACE { 0.0 } else { next };
            }
        }
    }
}
