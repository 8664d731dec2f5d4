//! Arithmetic on blocks of values that fit registers.
//!
//! Each operation makes a new block from whole ones: written so, the optimiser keeps blocks in
//! registers and makes vector code of them, where it gets lost in loops over larger arrays.

use crate::simd::SimdClass;

/// `f(i)` for each value of a block.
#[inline(always)]
pub fn each<const L: usize>(f: impl Fn(usize) -> f32) -> [f32; L] {
    let mut out = [0.0; L];
    for (i, out) in out.iter_mut().enumerate() {
        *out = f(i);
    }
    out
}

/// a + b.
#[inline(always)]
pub fn add<const L: usize>(a: [f32; L], b: [f32; L]) -> [f32; L] {
    each(
        #[inline(always)]
        |i| a[i] + b[i],
    )
}

/// a - b.
#[inline(always)]
pub fn subtract<const L: usize>(a: [f32; L], b: [f32; L]) -> [f32; L] {
    each(
        #[inline(always)]
        |i| a[i] - b[i],
    )
}

/// a b, value by value.
#[inline(always)]
pub fn times<const L: usize>(a: [f32; L], b: [f32; L]) -> [f32; L] {
    each(
        #[inline(always)]
        |i| a[i] * b[i],
    )
}

/// a b + c, value by value.
#[inline(always)]
pub fn multiply_add<const L: usize>(
    class: SimdClass,
    a: [f32; L],
    b: [f32; L],
    c: [f32; L],
) -> [f32; L] {
    each(
        #[inline(always)]
        |i| class.multiply_add(a[i], b[i], c[i]),
    )
}

/// The block from the other end.
#[inline(always)]
pub fn reversed<const L: usize>(a: [f32; L]) -> [f32; L] {
    each(
        #[inline(always)]
        |i| a[L - 1 - i],
    )
}
