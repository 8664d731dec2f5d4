//! The tridiagonal systems along z, one for each pair of modes.
//!
//! ```text
//! (l_x + l_y) psi_k + (A_z psi)_k = rhs_k
//! ```
//! is solved by elimination without pivoting (Thomas 1949) with tabled inverse pivots g:
//! ```text
//! y_k = (rhs_k + y_(k-1)) g_k   upwards,   psi_k = y_k + g_k psi_(k+1)   downwards
//! ```
//! Where both ends are alike, even and odd parts of psi about the middle solve systems of half
//! the length each, from the end to the middle. That makes a periodic axis as easy as any (to
//! an even psi its end is closed, to an odd one the neighbour beyond is the negative), and both
//! have the same pivots but the last where the ends are walls, which halves the table.
//!
//! The constant mode of a closed box is singular: its last pivot is 0 and counts as infinite,
//! which makes its even part 0 in the middle.

use crate::{
    lanes::{add, multiply_add, subtract, times},
    pool::Column,
    simd::SimdClass,
    solver::flow::field::Field,
    spectral::basis::{End, Ends},
};

/// Values of a plane that lie together in a column.
pub const WIDTH: usize = 64;

/// Values of a block.
const LANES: usize = 16;

/// Blocks that are worked on at once, so that one hides the latency of the others; their
/// running values stay in registers.
const BLOCKS: usize = 2;

type Blocks = [[f32; LANES]; BLOCKS];

/// The systems of one grid.
pub struct Columns {
    planes: usize,
    ends: Ends,
    is_folded: bool,
    /// Number of pivots, from the end, that even and odd part share.
    shared: usize,
    /// Inverse pivots by column, row and value. Rows are those shared, then the rest of the
    /// even part, then the rest of the odd one.
    inverse_pivots: Field,
}

impl Columns {
    /// `count` systems, which are to be set; as many as fill whole columns.
    pub fn new(count: usize, planes: usize, ends: Ends) -> Self {
        let is_folded = ends.are_alike();
        let shared = match ends {
            Ends::Periodic => 0,
            Ends::Between(_) if is_folded => (planes - 1) / 2,
            Ends::Between(_) => planes,
        };
        let rows = planes - if is_folded { shared } else { 0 };
        Self { planes, ends, is_folded, shared, inverse_pivots: Field::zeros(count * rows) }
    }

    /// Sets the value of l_x + l_y of system `at`.
    pub fn set(&mut self, at: usize, eigenvalue: f64) {
        let rows = self.planes - if self.is_folded { self.shared } else { 0 };
        let start = at / WIDTH * rows * WIDTH + at % WIDTH;
        if !self.is_folded {
            for (k, pivot) in pivots(eigenvalue, self.planes, self.ends).enumerate() {
                self.inverse_pivots[start + k * WIDTH] = pivot as f32;
            }
            return;
        }
        for is_odd in [false, true] {
            let pivots = half_pivots(eigenvalue, self.planes, self.ends, is_odd);
            for (k, pivot) in pivots.enumerate() {
                let row = self.row(k, is_odd);
                self.inverse_pivots[start + row * WIDTH] = pivot as f32;
            }
        }
    }

    /// Memory that the pivots take.
    pub fn bytes(&self) -> usize {
        self.inverse_pivots.bytes()
    }

    /// Factor to scale the right-hand side by.
    pub fn scale(&self) -> f32 {
        if self.is_folded { 0.5 } else { 1.0 }
    }

    fn row(&self, k: usize, is_odd: bool) -> usize {
        let rest_of_even = self.planes.div_ceil(2) - self.shared;
        if is_odd && k >= self.shared { k + rest_of_even } else { k }
    }

    /// Solves the systems of column `c`.
    #[inline(always)]
    pub fn solve(&self, class: SimdClass, c: usize, column: &mut Column<'_>) {
        let rows = self.planes - if self.is_folded { self.shared } else { 0 };
        let pivots = &self.inverse_pivots[c * rows * WIDTH..][..rows * WIDTH];
        for at in (0..WIDTH).step_by(BLOCKS * LANES) {
            if self.is_folded {
                self.solve_halves(class, pivots, column, at);
            } else {
                self.solve_whole(class, pivots, column, at);
            }
        }
    }

    #[inline(always)]
    fn solve_halves(&self, class: SimdClass, pivots: &[f32], column: &mut Column<'_>, at: usize) {
        let (last, half) = (self.planes - 1, self.planes / 2);
        let (mut even, mut odd) = ([[0.0; LANES]; BLOCKS], [[0.0; LANES]; BLOCKS]);
        for k in 0..half {
            let [low, high] =
                [*blocks_mut(column.plane(k), at), *blocks_mut(column.plane(last - k), at)];
            let g_even = blocks(pivots, self.row(k, false) * WIDTH + at);
            let g_odd = blocks(pivots, self.row(k, true) * WIDTH + at);
            for b in 0..BLOCKS {
                even[b] = times(add(add(low[b], high[b]), even[b]), g_even[b]);
                odd[b] = times(add(subtract(low[b], high[b]), odd[b]), g_odd[b]);
            }
            *blocks_mut(column.plane(k), at) = even;
            *blocks_mut(column.plane(last - k), at) = odd;
        }
        odd = [[0.0; LANES]; BLOCKS];
        if !self.planes.is_multiple_of(2) {
            let g = blocks(pivots, self.row(half, false) * WIDTH + at);
            let middle = blocks_mut(column.plane(half), at);
            for b in 0..BLOCKS {
                even[b] = times(add(middle[b], even[b]), g[b]);
            }
            *middle = even;
        } else {
            even = odd;
        }
        for k in (0..half).rev() {
            let [y_even, y_odd] =
                [*blocks_mut(column.plane(k), at), *blocks_mut(column.plane(last - k), at)];
            let g_even = blocks(pivots, self.row(k, false) * WIDTH + at);
            let g_odd = blocks(pivots, self.row(k, true) * WIDTH + at);
            let (mut low, mut high) = (even, odd);
            for b in 0..BLOCKS {
                even[b] = multiply_add(class, g_even[b], even[b], y_even[b]);
                odd[b] = multiply_add(class, g_odd[b], odd[b], y_odd[b]);
                (low[b], high[b]) = (add(even[b], odd[b]), subtract(even[b], odd[b]));
            }
            *blocks_mut(column.plane(k), at) = low;
            *blocks_mut(column.plane(last - k), at) = high;
        }
    }

    #[inline(always)]
    fn solve_whole(&self, class: SimdClass, pivots: &[f32], column: &mut Column<'_>, at: usize) {
        let mut value = [[0.0; LANES]; BLOCKS];
        for k in 0..self.planes {
            let (here, g) = (blocks_mut(column.plane(k), at), blocks(pivots, k * WIDTH + at));
            for b in 0..BLOCKS {
                value[b] = times(add(here[b], value[b]), g[b]);
            }
            *here = value;
        }
        value = [[0.0; LANES]; BLOCKS];
        for k in (0..self.planes).rev() {
            let (here, g) = (blocks_mut(column.plane(k), at), blocks(pivots, k * WIDTH + at));
            for b in 0..BLOCKS {
                value[b] = multiply_add(class, g[b], value[b], here[b]);
            }
            *here = value;
        }
    }
}

#[inline(always)]
fn blocks(values: &[f32], at: usize) -> &Blocks {
    values[at..].as_chunks().0.first_chunk().expect("whole blocks")
}

#[inline(always)]
fn blocks_mut(values: &mut [f32], at: usize) -> &mut Blocks {
    values[at..].as_chunks_mut().0.first_chunk_mut().expect("whole blocks")
}

/// Coupling of the first or last cell to what lies beyond.
fn beyond(end: End) -> f64 {
    match end {
        End::Closed => 0.0,
        End::Open => 1.0,
        End::Odd => 2.0,
    }
}

/// 1 / `pivot`, or 0 where a system without an eigenvalue is singular.
fn inverse(pivot: f64, eigenvalue: f64) -> f64 {
    if eigenvalue > 0.0 || pivot > 1e-9 { 1.0 / pivot } else { 0.0 }
}

/// Inverse pivots of the whole system.
fn pivots(eigenvalue: f64, planes: usize, ends: Ends) -> impl Iterator<Item = f64> {
    let [low, high] = match ends {
        Ends::Between(ends) => ends.map(beyond),
        Ends::Periodic => unreachable!("is folded"),
    };
    let mut below = 0.0;
    (0..planes).map(move |k| {
        let down = if k > 0 { 1.0 } else { low };
        let up = if k + 1 < planes { 1.0 } else { high };
        below = inverse(eigenvalue + down + up - below, eigenvalue);
        below
    })
}

/// Inverse pivots of the even or odd part, from the end to the middle. What stands alone in the
/// middle is counted whole where others are sums of two, hence its factors of 2.
fn half_pivots(
    eigenvalue: f64,
    planes: usize,
    ends: Ends,
    is_odd: bool,
) -> impl Iterator<Item = f64> {
    let outer = match ends {
        Ends::Between([end, _]) => beyond(end),
        Ends::Periodic => {
            if is_odd {
                2.0
            } else {
                0.0
            }
        }
    };
    let half = planes / 2;
    let middle = usize::from(!planes.is_multiple_of(2) && !is_odd);
    let mut below = 0.0;
    (0..half + middle).map(move |k| {
        let down = if k > 0 { 1.0 } else { outer };
        if k == half {
            return 2.0 * inverse(eigenvalue + 2.0 * down - 2.0 * below, eigenvalue);
        }
        let is_last = planes.is_multiple_of(2) && k + 1 == half;
        let up = match (is_last, is_odd) {
            (false, _) => 1.0,
            (true, false) => 0.0,
            (true, true) => 2.0,
        };
        below = inverse(eigenvalue + down + up - below, eigenvalue);
        below
    })
}
