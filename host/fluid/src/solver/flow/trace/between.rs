//! Values between those of a component, for a block of points at once.
#![allow(clippy::needless_range_loop, reason = "one lane of many arrays at a time: vector code")]

use crate::solver::flow::{
    field::{Layout, cut},
    trace::{Points, Tracer},
};

impl Tracer<'_> {
    /// The component between its eight values around each point.
    #[inline(always)]
    pub fn linear<const N: usize>(&self, c: usize, field: &[f32], points: &Points<N>) -> [f32; N] {
        let corners = Corners::new(self.layout, field);
        let (index, [x, y, z]) = self.places(c, points);
        let mut out = [0.0; N];
        for l in 0..N {
            let v = corners.at(index[l]);
            let low = (v[0] + x[l] * (v[1] - v[0]), v[2] + x[l] * (v[3] - v[2]));
            let high = (v[4] + x[l] * (v[5] - v[4]), v[6] + x[l] * (v[7] - v[6]));
            let (low, high) = (low.0 + y[l] * (low.1 - low.0), high.0 + y[l] * (high.1 - high.0));
            out[l] = low + z[l] * (high - low);
        }
        out
    }

    /// The smallest and the largest of the eight values around each point.
    #[inline(always)]
    pub fn range<const N: usize>(
        &self,
        c: usize,
        field: &[f32],
        points: &Points<N>,
    ) -> [[f32; N]; 2] {
        let corners = Corners::new(self.layout, field);
        let (index, _) = self.places(c, points);
        let mut range = [[0.0; N]; 2];
        for l in 0..N {
            let v = corners.at(index[l]);
            range[0][l] = least(
                least(least(v[0], v[1]), least(v[2], v[3])),
                least(least(v[4], v[5]), least(v[6], v[7])),
            );
            range[1][l] = -least(
                least(least(-v[0], -v[1]), least(-v[2], -v[3])),
                least(least(-v[4], -v[5]), least(-v[6], -v[7])),
            );
        }
        range
    }

    /// The component by cubic interpolation of its values around each point (Keys 1981); where a
    /// side leaves too few, the missing one is that of the parabola through the next three.
    #[inline(always)]
    pub fn cubic<const N: usize>(&self, c: usize, field: &[f32], points: &Points<N>) -> [f32; N] {
        if self.layout.cells[0] < 3 {
            return self.linear(c, field, points);
        }
        let [_, row, plane] = self.layout.strides();
        let x = self.window(c, 0, &points[0]);
        let y = self.window(c, 1, &points[1]);
        let z = self.window(c, 2, &points[2]);
        let mut out = [0.0; N];
        for l in 0..N {
            let mut sum = [0.0; 4];
            for m in 0..4 {
                let start = x.start[l] as usize + z.node(m, l) * plane;
                let mut in_plane = [0.0; 4];
                for n in 0..4 {
                    let at = (start + y.node(n, l) * row).min(field.len() - 4);
                    let values = cut(field, at, 4);
                    let weight = y.weights[n][l];
                    for i in 0..4 {
                        in_plane[i] += weight * values[i];
                    }
                }
                for i in 0..4 {
                    sum[i] += z.weights[m][l] * in_plane[i];
                }
            }
            out[l] = (x.weights[0][l] * sum[0] + x.weights[1][l] * sum[1])
                + (x.weights[2][l] * sum[2] + x.weights[3][l] * sum[3]);
        }
        out
    }

    #[inline(always)]
    fn window<const N: usize>(&self, c: usize, d: usize, points: &[f32; N]) -> Window<N> {
        let first = i32::from(c == d && !self.wraps[d]);
        Window::new(first, self.layout.cells[d] as i32 + 1, self.along(c, d, points))
    }

    /// The padded indices below the points along axis `d`, and how far the points are beyond.
    #[inline(always)]
    fn along<const N: usize>(&self, c: usize, d: usize, points: &[f32; N]) -> ([i32; N], [f32; N]) {
        let (shift, last) = (if c == d { 1.0 } else { 0.5 }, self.layout.cells[d] as i32);
        let (mut below, mut share) = ([0; N], [0.0; N]);
        for l in 0..N {
            let padded = points[l] + shift;
            below[l] = (padded as i32).min(last);
            share[l] = padded - below[l] as f32;
        }
        (below, share)
    }

    /// Indices of the lowest of the eight values around each point, and the shares beyond.
    #[inline(always)]
    fn places<const N: usize>(&self, c: usize, points: &Points<N>) -> ([i32; N], [[f32; N]; 3]) {
        let [_, row, plane] = self.layout.strides();
        let (x, x_share) = self.along(c, 0, &points[0]);
        let (y, y_share) = self.along(c, 1, &points[1]);
        let (z, z_share) = self.along(c, 2, &points[2]);
        let mut index = [0; N];
        for l in 0..N {
            index[l] = x[l] + y[l] * row as i32 + z[l] * plane as i32;
        }
        (index, [x_share, y_share, z_share])
    }
}

/// An array as seen from each of the eight corners of a cell, x first.
struct Corners<'f>([&'f [f32]; 8], usize);

impl<'f> Corners<'f> {
    #[inline(always)]
    fn new(layout: &Layout, field: &'f [f32]) -> Self {
        let [_, row, plane] = layout.strides();
        let len = field.len() - (plane + row + 1);
        let corners = [
            cut(field, 0, len),
            cut(field, 1, len),
            cut(field, row, len),
            cut(field, row + 1, len),
            cut(field, plane, len),
            cut(field, plane + 1, len),
            cut(field, plane + row, len),
            cut(field, plane + row + 1, len),
        ];
        Self(corners, len)
    }

    /// The eight values; the minimum spares the checks of bounds.
    #[inline(always)]
    fn at(&self, index: i32) -> [f32; 8] {
        let (v, i) = (&self.0, (index as usize).min(self.1 - 1));
        [v[0][i], v[1][i], v[2][i], v[3][i], v[4][i], v[5][i], v[6][i], v[7][i]]
    }
}

/// The smaller; `f32::min` would be slower for the sake of NaN.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The four values along an axis that each point of a block lies between, and their weights.
struct Window<const N: usize> {
    start: [i32; N],
    last: i32,
    weights: [[f32; N]; 4],
}

impl<const N: usize> Window<N> {
    /// Among the values from `first` to `last`; if they are fewer than four, weights are linear.
    #[inline(always)]
    fn new(first: i32, last: i32, (below, share): ([i32; N], [f32; N])) -> Self {
        let mut window = Self { start: below, last, weights: [[0.0; N]; 4] };
        for l in 0..N {
            let (t, [a, b, c, d]) = (share[l], keys(share[l]));
            let weights = if last - first < 3 {
                [1.0 - t, t, 0.0, 0.0]
            } else if below[l] - 1 < first {
                [b + 3.0 * a, c - 3.0 * a, d + a, 0.0]
            } else if below[l] + 2 > last {
                [0.0, a + d, b - 3.0 * d, c + 3.0 * d]
            } else {
                [a, b, c, d]
            };
            for m in 0..4 {
                window.weights[m][l] = weights[m];
            }
            if last - first >= 3 {
                window.start[l] = (below[l] - 1).max(first).min(last - 3);
            }
        }
        window
    }

    /// The padded index of one of the four.
    #[inline(always)]
    fn node(&self, m: usize, l: usize) -> usize {
        (self.start[l] + m as i32).min(self.last) as usize
    }
}

/// Weights of the four values around a point at share `t` between the middle two.
#[inline(always)]
fn keys(t: f32) -> [f32; 4] {
    let rest = 1.0 - t;
    [
        -0.5 * t * rest * rest,
        1.0 + t * t * (1.5 * t - 2.5),
        1.0 + rest * rest * (1.5 * rest - 2.5),
        -0.5 * rest * t * t,
    ]
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::solver::{
        Side, Sides,
        flow::{faces::cells, field::BLOCK, ghosts::Ghosts, trace::face_in_cells},
    };

    const CELLS: [usize; 3] = [9, 5, 4];

    /// A block of points all over the grid, up to its sides and beyond.
    fn points() -> Points<BLOCK> {
        [0.37, 0.71, 0.53]
            .map(|step| std::array::from_fn(|l| ((l as f32 * step * 7.0) % 11.0) - 1.0))
    }

    /// A component with `value` at its faces, ghosts and all.
    fn sampled(layout: &Layout, c: usize, value: impl Fn(Vec3) -> f32) -> Vec<f32> {
        let mut field = vec![0.0; layout.zeros().len()];
        for (i, j, k) in cells(layout.cells.map(|n| n + 2)) {
            let at = layout.index(0, 0, 0) + i + j * layout.row + k * layout.plane
                - layout.strides().iter().sum::<usize>();
            field[at] = value(face_in_cells(c, i, j, k) - 1.0);
        }
        field
    }

    #[test]
    fn cubic_interpolation_is_exact_for_parabolas_up_to_the_sides() {
        let layout = Layout::new(CELLS);
        let ghosts = Ghosts::new(&layout, &Sides::all(Side::FreeSlip));
        let tracer = Tracer::new(&layout, &ghosts);
        let bent = |p: Vec3| 0.3 * p.x * p.x - p.x * p.y + 0.5 * p.z * p.z - 0.2 * p.y * p.y + p.z;
        let points = tracer.held(points());
        for c in 0..3 {
            let field = sampled(&layout, c, bent);
            let found = tracer.cubic(c, &field, &points);
            for l in 0..BLOCK {
                let exact = bent(Vec3::new(points[0][l], points[1][l], points[2][l]));
                assert!((found[l] - exact).abs() < 2e-5, "{c} {l}: {} {exact}", found[l]);
            }
        }
    }

    #[test]
    fn linear_interpolation_is_within_its_range_and_exact_for_planes() {
        let layout = Layout::new(CELLS);
        let ghosts = Ghosts::new(&layout, &Sides::all(Side::FreeSlip));
        let tracer = Tracer::new(&layout, &ghosts);
        let plane = |p: Vec3| p.x - 2.0 * p.y + 0.5 * p.z;
        let points = tracer.held(points());
        let field = sampled(&layout, 1, plane);
        let (found, [low, high]) =
            (tracer.linear(1, &field, &points), tracer.range(1, &field, &points));
        for l in 0..BLOCK {
            let exact = plane(Vec3::new(points[0][l], points[1][l], points[2][l]));
            assert!((found[l] - exact).abs() < 1e-5);
            assert!(low[l] - 1e-5 <= exact && exact <= high[l] + 1e-5 && high[l] - low[l] < 4.0);
        }
    }
}
