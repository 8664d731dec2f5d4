//! Products of small dense matrices.

use crate::{lanes::multiply_add, simd::SimdClass};

/// A matrix in memory: the values, and the distance from one row to the next.
#[derive(Clone, Copy)]
pub struct Rows<'a>(pub &'a [f32], pub usize);

/// Terms of a sum that are added without a look at the loop.
const STEPS: usize = 2;

/// `out = a b` for `rows` x `inner` x `columns`; `columns` is a multiple of 8. Each value is
/// summed over `inner` in order, so that its bits do not depend on the shape of the tiles.
///
/// A tile keeps its sums in registers, and as many of them as hide the latency of a sum: the
/// larger it is the less it loads, the wider the better.
#[inline(always)]
pub fn multiply(
    class: SimdClass,
    [rows, inner, columns]: [usize; 3],
    a: Rows<'_>,
    b: Rows<'_>,
    out: &mut [f32],
    out_row: usize,
) {
    let mut c = 0;
    while c < columns {
        let (b, out, left) = (Rows(&b.0[c..], b.1), &mut out[c..], columns - c);
        let size = [rows, inner];
        c += match class {
            SimdClass::Avx512 if left >= 32 => band::<8, 2, 16>(class, size, a, b, out, out_row),
            SimdClass::Avx512 if left >= 16 => band::<8, 1, 16>(class, size, a, b, out, out_row),
            SimdClass::Avx2 if left >= 16 => band::<6, 1, 16>(class, size, a, b, out, out_row),
            SimdClass::Portable => band::<4, 2, 4>(class, size, a, b, out, out_row),
            _ => band::<6, 1, 8>(class, size, a, b, out, out_row),
        };
    }
}

/// `V` vectors of `L` columns of a product, `R` rows at a time; returns their number.
#[inline(always)]
fn band<const R: usize, const V: usize, const L: usize>(
    class: SimdClass,
    [rows, inner]: [usize; 2],
    a: Rows<'_>,
    b: Rows<'_>,
    out: &mut [f32],
    out_row: usize,
) -> usize {
    let mut r = 0;
    while r < rows {
        let (a, out) = (Rows(&a.0[r * a.1..], a.1), &mut out[r * out_row..]);
        r += match rows - r {
            left if left >= R => tile::<R, V, L>(class, inner, a, b, out, out_row),
            4.. => tile::<4, V, L>(class, inner, a, b, out, out_row),
            _ => tile::<1, V, L>(class, inner, a, b, out, out_row),
        };
    }
    V * L
}

/// `R` rows of a band; returns `R`.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "iterators keep the sums out of registers here")]
fn tile<const R: usize, const V: usize, const L: usize>(
    class: SimdClass,
    inner: usize,
    a: Rows<'_>,
    b: Rows<'_>,
    out: &mut [f32],
    out_row: usize,
) -> usize {
    let mut sums = [[[0f32; L]; V]; R];
    // Cut beforehand, rows need no check in the loop; and a few steps at a time they need one
    // address for all.
    let mut rows: [&[[f32; STEPS]]; R] = [&[]; R];
    let mut rests: [&[f32]; R] = [&[]; R];
    let whole = inner / STEPS;
    for r in 0..R {
        let (row, rest) = a.0[r * a.1..][..inner].split_at(whole * STEPS);
        (rows[r], rests[r]) = (&row.as_chunks().0[..whole], &rest[..inner - whole * STEPS]);
    }
    // One check for each row: an index would take several and a product.
    let mut rows_of_b = b.0.chunks(b.1);
    for k in 0..whole {
        for step in 0..STEPS {
            let Some(b) = rows_of_b.next().and_then(first_blocks) else { return R };
            for r in 0..R {
                add_row(class, rows[r][k][step], b, &mut sums[r]);
            }
        }
    }
    for k in 0..inner - whole * STEPS {
        let Some(b) = rows_of_b.next().and_then(first_blocks) else { return R };
        for r in 0..R {
            add_row(class, rests[r][k], b, &mut sums[r]);
        }
    }
    for (r, sums) in sums.iter().enumerate() {
        out[r * out_row..][..V * L].copy_from_slice(sums.as_flattened());
    }
    R
}

#[inline(always)]
fn first_blocks<const V: usize, const L: usize>(row: &[f32]) -> Option<&[[f32; L]; V]> {
    row.as_chunks().0.first_chunk()
}

/// sums += a b.
#[inline(always)]
fn add_row<const V: usize, const L: usize>(
    class: SimdClass,
    a: f32,
    b: &[[f32; L]; V],
    sums: &mut [[f32; L]; V],
) {
    for v in 0..V {
        sums[v] = multiply_add(class, [a; L], b[v], sums[v]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_all_tile_shapes_agree_with_the_plain_sum() {
        let (rows, inner, columns) = (15, 5, 56);
        let a: Vec<f32> = (0..rows * inner).map(|i| (i as f32 * 0.3).cos()).collect();
        let b: Vec<f32> = (0..inner * columns).map(|i| (i as f32 * 0.7).sin()).collect();
        for simd in SimdClass::ALL {
            let mut out = vec![9.0; rows * columns];
            let size = [rows, inner, columns];
            let class = simd.vectorize_as(
                #[inline(always)]
                |class| {
                    multiply(class, size, Rows(&a, inner), Rows(&b, columns), &mut out, columns);
                    class
                },
            );
            for (r, c) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
                let plain = (0..inner).fold(0.0, |sum, k| {
                    class.multiply_add(a[r * inner + k], b[k * columns + c], sum)
                });
                assert_eq!(out[r * columns + c].to_bits(), plain.to_bits());
            }
        }
    }
}
