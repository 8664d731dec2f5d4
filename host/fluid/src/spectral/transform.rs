//! The transform to the modes of one axis, as dense matrix products of folded values.
//!
//! Up to a few hundred points nothing but multiply and add on whole vectors beats the fast
//! transform; and as most bases are even or odd about the middle, folding the values there,
//! ```text
//! s_k = a_k + a_(n-1-k),   d_k = a_k - a_(n-1-k)   (k < n/2),
//! ```
//! halves the work: even modes see only s, odd ones only d. Where the modes of a half are even
//! or odd about its own middle they fold again (the even cosines of 2n points are the cosines
//! of n points), as long as that leaves whole tiles.
//!
//! Folds work in place: s stays in the lower half, d comes into the upper one, from the middle
//! outwards.

use std::ops::Range;

use super::basis::{Ends, Mode, modes};
use crate::lanes::{add, reversed, subtract};

/// Values that are folded together.
const BLOCK: usize = 8;

/// Halves of a half have at least this many values, so that a tile of the product is filled
/// where they are its columns ...
const MIN_COLUMNS: usize = 16;

/// ... and where they are its rows, as they are if parts are not padded.
const MIN_ROWS: usize = 8;

/// Tables for one axis.
pub struct Transform {
    /// What is left after all folds.
    pub parts: Vec<Part>,
    /// Length of a row of modes.
    pub len: usize,
    /// Eigenvalues in the order of a row of modes; pads have 1.
    pub eigenvalues: Vec<f64>,
    points: usize,
    /// Ranges to fold, in this order.
    folds: Vec<Range<usize>>,
}

/// Modes of one parity.
pub struct Part {
    /// Number of modes, and of folded values.
    pub count: usize,
    /// The same, padded.
    pub padded: usize,
    /// Where the part starts among the folded values.
    pub from: usize,
    /// Where it starts among the modes.
    pub start: usize,
    /// Mode m of folded value k at `[m * padded + k]`.
    pub by_mode: Vec<f32>,
    /// The same at `[k * padded + m]`.
    pub by_value: Vec<f32>,
}

impl Transform {
    /// The transform of `points` values, with parts padded to a multiple of `pad` modes.
    pub fn new(points: usize, ends: Ends, pad: usize) -> Self {
        let mut transform =
            Self { parts: vec![], len: 0, eigenvalues: vec![], points, folds: vec![] };
        transform.add(&modes(points, ends), 0, pad);
        transform.len = transform.len.next_multiple_of(2 * pad);
        transform.eigenvalues.resize(transform.len, 1.0);
        transform
    }

    /// Adds the parts of `modes`, whose folded values start at `from`.
    fn add(&mut self, modes: &[Mode], from: usize, pad: usize) {
        let points = modes.len();
        let [even, odd] = [false, true]
            .map(|is_odd| modes.iter().filter_map(|m| m.fold(is_odd)).collect::<Vec<_>>());
        let least = if pad > 1 { MIN_COLUMNS } else { MIN_ROWS };
        let is_whole = points.is_multiple_of(2 * BLOCK) && points >= 2 * least;
        let may_fold = points > 1 && (self.folds.is_empty() || is_whole);
        if may_fold && even.len() + odd.len() == points {
            self.folds.push(from..from + points);
            self.add(&even, from, pad);
            self.add(&odd, from + even.len(), pad);
            return;
        }
        let part = Part::new(modes, from, self.len, pad);
        self.len += part.padded;
        self.eigenvalues.extend(modes.iter().map(|mode| mode.eigenvalue));
        self.eigenvalues.resize(self.len, 1.0);
        self.parts.push(part);
    }

    /// True for the modes in a row of them, false for pads.
    pub fn is_mode(&self, at: usize) -> bool {
        self.parts.iter().any(|part| (part.start..part.start + part.count).contains(&at))
    }

    /// Scales what the transform gives by `factor`.
    pub fn scale(&mut self, factor: f32) {
        let tables = self.parts.iter_mut().flat_map(|part| &mut part.by_value);
        tables.for_each(|value| *value *= factor);
    }

    /// Folds one row of values.
    #[inline(always)]
    pub fn fold(&self, values: &[f32], folded: &mut [f32]) {
        let (values, folded) = (&values[..self.points], &mut folded[..self.points]);
        let Some((_, inner)) = self.folds.split_first() else {
            folded.copy_from_slice(values);
            return;
        };
        let half = self.points / 2;
        let (low, high) = folded.split_at_mut(self.points - half);
        low[half..].iter_mut().for_each(|middle| *middle = values[half]);
        butterfly([&values[..half], &values[self.points - half..]], [&mut low[..half], high]);
        for range in inner {
            butterfly_in_place(&mut folded[range.clone()]);
        }
    }

    /// The inverse of [`Transform::fold`] but for factors of 2, as the transform needs it: even
    /// and odd part to values. Uses `folded` up.
    #[inline(always)]
    pub fn unfold(&self, folded: &mut [f32], values: &mut [f32]) {
        let (values, folded) = (&mut values[..self.points], &mut folded[..self.points]);
        let Some((_, inner)) = self.folds.split_first() else {
            values.copy_from_slice(folded);
            return;
        };
        for range in inner.iter().rev() {
            butterfly_in_place(&mut folded[range.clone()]);
        }
        let half = self.points / 2;
        let (low, high) = values.split_at_mut(self.points - half);
        low[half..].iter_mut().for_each(|middle| *middle = folded[half]);
        butterfly([&folded[..half], &folded[self.points - half..]], [&mut low[..half], high]);
    }

    /// Folds whole rows of `row` values in place.
    #[inline(always)]
    pub fn fold_rows(&self, rows: &mut [f32], row: usize) {
        for range in &self.folds {
            butterfly_rows(rows, range, row);
        }
    }

    /// The inverse of [`Transform::fold_rows`], as [`Transform::unfold`] is that of a fold.
    #[inline(always)]
    pub fn unfold_rows(&self, rows: &mut [f32], row: usize) {
        for range in self.folds.iter().rev() {
            butterfly_rows(rows, range, row);
        }
    }
}

impl Part {
    fn new(modes: &[Mode], from: usize, start: usize, pad: usize) -> Self {
        let count = modes.len();
        let padded = count.next_multiple_of(pad);
        let mut by_mode = vec![0.0; count * padded];
        let mut by_value = by_mode.clone();
        for (m, mode) in modes.iter().enumerate() {
            for (k, value) in mode.values.iter().enumerate() {
                by_mode[m * padded + k] = *value as f32;
                by_value[k * padded + m] = *value as f32;
            }
        }
        Self { count, padded, from, start, by_mode, by_value }
    }
}

/// Sums and differences of low and mirrored high values; the differences mirrored again.
#[inline(always)]
fn butterfly(from: [&[f32]; 2], to: [&mut [f32]; 2]) {
    let ([low, high], [sums, differences]) = (from, to);
    let half = low.len();
    if half == 16 {
        // That of 32 points, a whole block: where it is looked for takes longer than all else.
        butterfly_block::<16>([low, high], [sums, differences]);
        return;
    }
    let mut at = 0;
    while at < half {
        let (from, to) =
            ([&low[at..], &high[..half - at]], [&mut sums[at..], &mut differences[..half - at]]);
        at += match half - at {
            16.. => butterfly_block::<16>(from, to),
            8.. => butterfly_block::<8>(from, to),
            _ => butterfly_block::<1>(from, to),
        };
    }
}

/// The first `L` sums of a butterfly; returns `L`.
#[inline(always)]
fn butterfly_block<const L: usize>(
    [low, high]: [&[f32]; 2],
    [sums, differences]: [&mut [f32]; 2],
) -> usize {
    let end = high.len();
    let (low, high): ([f32; L], [f32; L]) = (block(low), block(&high[end - L..]));
    sums[..L].copy_from_slice(&add(low, reversed(high)));
    differences[end - L..].copy_from_slice(&subtract(reversed(low), high));
    L
}

/// As [`butterfly`], over what it reads; whole blocks of 8.
#[inline(always)]
fn butterfly_in_place(values: &mut [f32]) {
    let (lows, highs) = values.split_at_mut(values.len() / 2);
    let mut at = 0;
    while at + 8 <= lows.len() {
        let end = highs.len() - at;
        let (low, high): ([f32; 8], [f32; 8]) = (block(&lows[at..]), block(&highs[end - 8..]));
        lows[at..at + 8].copy_from_slice(&add(low, reversed(high)));
        highs[end - 8..end].copy_from_slice(&subtract(reversed(low), high));
        at += 8;
    }
}

#[inline(always)]
fn block<const L: usize>(values: &[f32]) -> [f32; L] {
    *values.first_chunk().expect("a whole block")
}

/// Sums and differences of rows within `range`, those of the upper half mirrored.
#[inline(always)]
fn butterfly_rows(rows: &mut [f32], range: &Range<usize>, row: usize) {
    let half = range.len() / 2;
    let (lows, highs) = rows[range.start * row..range.end * row].split_at_mut(half * row);
    for j in 0..half {
        let end = highs.len() - j * row;
        let (low, high) = (&mut lows[j * row..][..row], &mut highs[end - row..end]);
        let mut at = 0;
        while at + 16 <= row {
            let (a, b): ([f32; 16], [f32; 16]) = (block(&low[at..]), block(&high[at..]));
            low[at..at + 16].copy_from_slice(&add(a, b));
            high[at..at + 16].copy_from_slice(&subtract(a, b));
            at += 16;
        }
    }
}
