//! The cosine transform along one axis as dense matrix products.
//!
//! ```text
//! a^_m = sum_k C_mk a_k,   C_mk = sqrt((2 - [m = 0]) / n) cos(pi m (k + 1/2) / n)
//! ```
//! diagonalises the second difference between closed ends, -a_(k-1) + 2 a_k - a_(k+1), to
//! 2 - 2 cos(pi m / n) (Strang 1999, DCT-II). Up to some 64 points a dense product beats the
//! fast transform, as it is nothing but multiply and add on whole vectors; and as cosines are
//! even or odd about the middle, folding the input there halves the work:
//! even m see only a_k + a_(n-1-k), odd m only a_k - a_(n-1-k).
//!
//! Folded values and modes lie as [even half | odd half], each half padded to whole tiles, the
//! odd half of folded values from the middle outwards (so that a fold works in place).

use std::f64::consts::PI;

/// Halves are padded to a multiple of this.
const PAD: usize = 8;

/// Tables for one axis.
pub struct Transform {
    /// The even half, then the odd one.
    pub halves: [Half; 2],
    /// Padded length of both halves.
    pub len: usize,
    points: usize,
}

/// Modes of one parity.
pub struct Half {
    /// Number of modes, and of folded values.
    pub count: usize,
    /// The same, padded.
    pub padded: usize,
    /// Where the half starts among folded values and modes.
    pub start: usize,
    /// Mode m of folded value k at `[m * padded + k]`.
    pub by_mode: Vec<f32>,
    /// The same at `[k * padded + m]`.
    pub by_value: Vec<f32>,
}

impl Transform {
    /// The transform of `points` values.
    pub fn new(points: usize) -> Self {
        let even = Half::new(points, 0, 0);
        let odd = Half::new(points, 1, even.padded);
        Self { len: even.padded + odd.padded, halves: [even, odd], points }
    }

    /// Eigenvalue of the second difference for each mode in the order of the tables; pads give 1.
    pub fn eigenvalues(&self) -> Vec<f64> {
        let mut eigenvalues = vec![1.0; self.len];
        for (parity, half) in self.halves.iter().enumerate() {
            for m in 0..half.count {
                let angle = PI * (2 * m + parity) as f64 / self.points as f64;
                eigenvalues[half.start + m] = 2.0 - 2.0 * angle.cos();
            }
        }
        eigenvalues
    }

    /// Folds one row of values.
    #[inline(always)]
    pub fn fold(&self, values: &[f32], folded: &mut [f32]) {
        let [even, odd] = &self.halves;
        let (low, high) = values[..self.points].split_at(even.count);
        let (sums, differences) = folded.split_at_mut(odd.start);
        sums[..even.count].copy_from_slice(low);
        butterfly(&mut sums[..odd.count], &mut differences[..odd.count], high);
    }

    /// The inverse of [`Transform::fold`] but for a factor of 2: even and odd part to values.
    #[inline(always)]
    pub fn unfold(&self, folded: &[f32], values: &mut [f32]) {
        let [even, odd] = &self.halves;
        let (sums, differences) = folded.split_at(odd.start);
        let (low, high) = values[..self.points].split_at_mut(even.count);
        low.copy_from_slice(&sums[..even.count]);
        butterfly(&mut low[..odd.count], high, &differences[..odd.count]);
    }

    /// Folds whole rows of `row` values in place: n rows become sums, then differences.
    #[inline(always)]
    pub fn fold_rows(&self, rows: &mut [f32], row: usize) {
        let (low, high) = rows[..self.points * row].split_at_mut(self.halves[0].count * row);
        let mirrored = low[..self.halves[1].count * row].chunks_exact_mut(row).rev();
        for (low, high) in mirrored.zip(high.chunks_exact_mut(row)) {
            for (low, high) in low.iter_mut().zip(high) {
                (*low, *high) = (*low + *high, *low - *high);
            }
        }
    }
}

impl Half {
    fn new(points: usize, parity: usize, start: usize) -> Self {
        let count = (points + 1 - parity) / 2;
        let padded = count.next_multiple_of(PAD);
        let mut half = Self {
            count,
            padded,
            start,
            by_mode: vec![0.0; padded * padded],
            by_value: vec![0.0; padded * padded],
        };
        for m in 0..count {
            for k in 0..count {
                let point = if parity == 0 { k } else { count - 1 - k };
                let value = cosine(points, 2 * m + parity, point) as f32;
                half.by_mode[m * padded + k] = value;
                half.by_value[k * padded + m] = value;
            }
        }
        half
    }
}

fn cosine(points: usize, mode: usize, point: usize) -> f64 {
    let n = points as f64;
    let norm = if mode == 0 { 1.0 } else { 2.0 };
    (norm / n).sqrt() * (PI * mode as f64 * (point as f64 + 0.5) / n).cos()
}

/// With the low half mirrored: low and high become low + other and low - other.
#[inline(always)]
fn butterfly(low: &mut [f32], high: &mut [f32], other: &[f32]) {
    let blocks = low.as_rchunks_mut::<PAD>().1.iter_mut().rev();
    let whole = blocks.len() * PAD;
    for ((low, high), other) in
        blocks.zip(high.as_chunks_mut::<PAD>().0).zip(other.as_chunks::<PAD>().0)
    {
        let (from, mut mirrored) = (*low, [0.0; PAD]);
        for i in 0..PAD {
            low[i] = from[i] + other[PAD - 1 - i];
            mirrored[i] = from[PAD - 1 - i] - other[i];
        }
        *high = mirrored;
    }
    let rest = low.len() - whole;
    for i in 0..rest {
        let (low, other) = (&mut low[rest - 1 - i], other[whole + i]);
        high[whole + i] = *low - other;
        *low += other;
    }
}

/// A matrix in memory: the values, and the distance from one row to the next.
#[derive(Clone, Copy)]
pub struct Rows<'a>(pub &'a [f32], pub usize);

/// `out = a b` for `rows` x `inner` x `columns`; `columns` is a multiple of 8. Each value is
/// summed over `inner` in order, so that its bits do not depend on the shape of the tiles.
#[inline(always)]
pub fn multiply(
    [rows, inner, columns]: [usize; 3],
    a: Rows<'_>,
    b: Rows<'_>,
    out: &mut [f32],
    out_row: usize,
) {
    let mut r = 0;
    while r < rows {
        let a = Rows(&a.0[r * a.1..], a.1);
        let out = &mut out[r * out_row..];
        let step = if rows - r >= 8 { 8 } else { 1 };
        let mut c = 0;
        while c < columns {
            let b = Rows(&b.0[c..], b.1);
            let out = &mut out[c..];
            match (step, columns - c >= 16) {
                (8, true) => tile::<8, 16>(inner, a, b, out, out_row),
                (8, false) => tile::<8, 8>(inner, a, b, out, out_row),
                (_, true) => tile::<1, 16>(inner, a, b, out, out_row),
                (_, false) => tile::<1, 8>(inner, a, b, out, out_row),
            }
            c += if columns - c >= 16 { 16 } else { 8 };
        }
        r += step;
    }
}

/// `R` x `W` values of a product, kept in registers over the whole sum.
#[inline(always)]
fn tile<const R: usize, const W: usize>(
    inner: usize,
    a: Rows<'_>,
    b: Rows<'_>,
    out: &mut [f32],
    out_row: usize,
) {
    let mut sums = [[0f32; W]; R];
    for k in 0..inner {
        let Some(b) = b.0[k * b.1..].first_chunk::<W>() else { return };
        for (r, sums) in sums.iter_mut().enumerate() {
            let a = a.0[r * a.1 + k];
            for (sum, b) in sums.iter_mut().zip(b) {
                *sum += a * b;
            }
        }
    }
    for (r, sums) in sums.iter().enumerate() {
        out[r * out_row..][..W].copy_from_slice(sums);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forward(transform: &Transform, values: &[f32]) -> Vec<f32> {
        let (mut folded, mut modes) = (vec![0.0; transform.len], vec![0.0; transform.len]);
        transform.fold(values, &mut folded);
        for half in &transform.halves {
            let (size, table) = ([1, half.count, half.padded], Rows(&half.by_value, half.padded));
            multiply(size, Rows(&folded[half.start..], 0), table, &mut modes[half.start..], 0);
        }
        modes
    }

    fn inverse(transform: &Transform, modes: &[f32]) -> Vec<f32> {
        let mut folded = vec![0.0; transform.len];
        for half in &transform.halves {
            let (size, table) = ([1, half.count, half.padded], Rows(&half.by_mode, half.padded));
            multiply(size, Rows(&modes[half.start..], 0), table, &mut folded[half.start..], 0);
        }
        let mut values = vec![0.0; transform.points];
        transform.unfold(&folded, &mut values);
        values
    }

    #[test]
    fn a_cosine_is_one_mode_and_comes_back() {
        for n in [1usize, 2, 3, 8, 17, 30, 33] {
            let transform = Transform::new(n);
            for mode in 0..n {
                let values: Vec<f32> = (0..n).map(|k| cosine(n, mode, k) as f32).collect();
                let modes = forward(&transform, &values);
                let at = transform.halves[mode % 2].start + mode / 2;
                for (m, value) in modes.iter().enumerate() {
                    assert!((value - f32::from(m == at)).abs() < 1e-5, "{n} {mode} {m} {value}");
                }
                let angle = PI * mode as f64 / n as f64;
                assert_eq!(transform.eigenvalues()[at], 2.0 - 2.0 * angle.cos());
                for (back, value) in inverse(&transform, &modes).iter().zip(&values) {
                    assert!((back - value).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn folding_rows_is_folding_each_column() {
        let (n, row) = (7, 3);
        let transform = Transform::new(n);
        let mut rows: Vec<f32> = (0..n * row).map(|i| (i as f32).sin()).collect();
        let column: Vec<f32> = (0..n).map(|k| rows[k * row + 1]).collect();
        let mut folded = vec![0.0; transform.len];
        transform.fold(&column, &mut folded);
        transform.fold_rows(&mut rows, row);
        let [even, odd] = &transform.halves;
        for k in 0..n {
            let at = if k < even.count { k } else { odd.start + k - even.count };
            assert_eq!(rows[k * row + 1], folded[at]);
        }
    }

    #[test]
    fn products_of_all_tile_shapes_agree_with_the_plain_sum() {
        let (rows, inner, columns) = (11, 5, 40);
        let a: Vec<f32> = (0..rows * inner).map(|i| (i as f32 * 0.3).cos()).collect();
        let b: Vec<f32> = (0..inner * columns).map(|i| (i as f32 * 0.7).sin()).collect();
        let mut out = vec![9.0; rows * columns];
        multiply([rows, inner, columns], Rows(&a, inner), Rows(&b, columns), &mut out, columns);
        for (r, c) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
            let plain = (0..inner).fold(0.0, |s, k| s + a[r * inner + k] * b[k * columns + c]);
            assert_eq!(out[r * columns + c].to_bits(), plain.to_bits());
        }
    }
}
