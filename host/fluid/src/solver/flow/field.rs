//! Arrays over the grid, padded so that a kernel needs no test at a wall.

use std::{
    ops::{Deref, DerefMut, Range},
    sync::atomic::{AtomicUsize, Ordering},
};

/// Values per block: kernels run over whole blocks, and rows start at one.
pub const BLOCK: usize = 16;

/// How padded arrays lie in memory: x fastest, and one ghost at both ends of every axis.
///
/// Velocity component c of index (i, j, k) is on the **lower** face along c of cell (i, j, k);
/// the upper face of the last cell is where a cell's ghost would be. A kernel runs over the
/// rows of a plane at once, ghosts and all, and never tests for a wall: what it leaves in the
/// ghosts is set right afterwards (see [`super::ghosts`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Cells along each axis.
    pub cells: [usize; 3],
    /// Values from one row to the next.
    pub row: usize,
    /// Values from one plane to the next; whole blocks, and room to round a run up to them.
    pub plane: usize,
}

/// What a kernel runs over: part of one plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Index of its first value.
    pub at: usize,
    /// The same within the plane, as a pool's body sees it.
    pub to: usize,
    /// Number of values: whole blocks.
    pub len: usize,
}

impl Layout {
    /// The layout of a grid of `cells`.
    pub fn new(cells: [usize; 3]) -> Self {
        let row = cells[0] + 2;
        let mut plane = (row * (cells[1] + 2) + BLOCK).next_multiple_of(BLOCK);
        // Neighbouring planes a multiple of 4 KiB apart would share the same sets of the cache.
        if plane % 1024 < BLOCK {
            plane += 2 * BLOCK;
        }
        Self { cells, row, plane }
    }

    /// The run over `rows` of plane `k`.
    pub fn run(&self, rows: Range<usize>, k: usize) -> Run {
        let len = (rows.len() * self.row).next_multiple_of(BLOCK);
        Run { at: self.index(0, rows.start, k), to: self.index_in_plane(0, rows.start), len }
    }

    /// Index of cell (i, j, k), or of its lower faces.
    pub fn index(&self, i: usize, j: usize, k: usize) -> usize {
        (k + 1) * self.plane + self.index_in_plane(i, j)
    }

    /// Index of cell (i, j, k) within its own plane, as a pool's body sees it.
    pub fn index_in_plane(&self, i: usize, j: usize) -> usize {
        (j + 1) * self.row + i + 1
    }

    /// The cell at an index: the inverse of [`Layout::index`], for cells within the sides.
    pub fn cell_of(&self, at: usize) -> [usize; 3] {
        let in_plane = at % self.plane;
        [in_plane % self.row - 1, in_plane / self.row - 1, at / self.plane - 1]
    }

    /// Distance in memory between neighbours along x, y and z.
    pub fn strides(&self) -> [usize; 3] {
        [1, self.row, self.plane]
    }

    /// Where each row of a plane begins, in the plane.
    pub fn rows_in_plane(&self) -> impl Iterator<Item = usize> {
        let first = self.index_in_plane(0, 0);
        (0..self.cells[1]).map(move |j| first + j * self.row)
    }

    /// Number of values that a side across `axis` has for each component.
    pub fn points_of_side(&self, axis: usize) -> usize {
        let [nx, ny, nz] = self.cells.map(|n| n + 2);
        [ny * nz, nx * nz, self.plane][axis]
    }

    /// Place among these of a face, counted from the one beyond the lower sides.
    pub fn place_on_side(&self, axis: usize, [i, j, k]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.cells.map(|n| n + 2);
        [j + ny * k, i + nx * k, i + self.row * j][axis]
    }

    /// A field of zeros. The first cell of every plane begins a cache line: a run over whole
    /// planes, and its neighbours along z, then cross none.
    pub fn zeros(&self) -> Field {
        Field::aligned_at(self.index(0, 0, 0), self.plane * (self.cells[2] + 2))
    }

    /// A vector field of zeros.
    pub fn zero_vector(&self) -> Vector {
        [self.zeros(), self.zeros(), self.zeros()]
    }

    /// The planes of a padded array that hold cells, for a pool to deal out.
    pub fn planes<'a>(&self, field: &'a mut [f32]) -> &'a mut [f32] {
        &mut field[self.plane..self.plane * (self.cells[2] + 1)]
    }
}

/// Memory that three fields take.
pub fn vector_bytes(vector: &[Field; 3]) -> usize {
    vector.iter().map(Field::bytes).sum()
}

/// Values in memory, placed by the lines of the cache.
#[derive(Debug)]
pub struct Field {
    store: Vec<f32>,
    start: usize,
    len: usize,
}

/// Arrays start at this many different distances from a page, this far apart: large ones would
/// all start at the same one otherwise, and a kernel that runs over a dozen of them would find
/// them all in the same few sets of the cache.
const STAGGERS: usize = 16;
const STAGGER: usize = 5 * BLOCK;

impl Field {
    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.store.as_slice())
    }

    /// `len` zeros.
    pub fn zeros(len: usize) -> Self {
        Self::aligned_at(0, len)
    }

    /// `len` zeros, of which that at index `aligned` begins a cache line.
    fn aligned_at(aligned: usize, len: usize) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let stagger = COUNT.fetch_add(1, Ordering::Relaxed) % STAGGERS * STAGGER;
        let store = vec![0.0; len + stagger + BLOCK];
        // The heap block of a vector that never grows stays where it is.
        let line = store.as_ptr().align_offset(64).min(BLOCK);
        let start = (line + BLOCK - aligned % BLOCK) % BLOCK + stagger;
        Self { store, start, len }
    }
}

impl Deref for Field {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.store[self.start..self.start + self.len]
    }
}

impl DerefMut for Field {
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.store[self.start..self.start + self.len]
    }
}

/// The three components of a vector field.
pub type Vector = [Field; 3];

/// Borrows the components of a vector field.
pub fn components(vector: &Vector) -> [&[f32]; 3] {
    vector.each_ref().map(|field| &**field)
}

/// `len` values from index `at`.
///
/// A kernel cuts all its arrays to one and the same `len` and runs over `0..len`: then no
/// bounds check is left in its loop, and the optimiser makes vector code of it.
#[inline(always)]
pub fn cut(field: &[f32], at: usize, len: usize) -> &[f32] {
    &field[at..][..len]
}

/// As [`cut`], to write to.
#[inline(always)]
pub fn cut_mut(field: &mut [f32], at: usize, len: usize) -> &mut [f32] {
    &mut field[at..][..len]
}

/// Values that a kernel may take into registers as one.
pub type Block = [f32; BLOCK];

/// As [`cut`], in whole blocks.
#[inline(always)]
pub fn blocks(field: &[f32], at: usize, len: usize) -> &[Block] {
    cut(field, at, len).as_chunks().0
}

/// As [`blocks`], to write to.
#[inline(always)]
pub fn blocks_mut(field: &mut [f32], at: usize, len: usize) -> &mut [Block] {
    cut_mut(field, at, len).as_chunks_mut().0
}

/// A run of a padded array with its six neighbours, by value or by block.
#[derive(Clone, Copy)]
pub struct Star<'a, T = f32> {
    /// The run itself.
    pub here: &'a [T],
    /// One back and one on along x.
    pub x: (&'a [T], &'a [T]),
    /// One back and one on along y.
    pub y: (&'a [T], &'a [T]),
    /// One back and one on along z.
    pub z: (&'a [T], &'a [T]),
}

impl<'a> Star<'a> {
    /// `len` values of `field` from index `at`.
    #[inline(always)]
    pub fn new(layout: &Layout, field: &'a [f32], at: usize, len: usize) -> Self {
        let [_, sy, sz] = layout.strides();
        Self {
            here: cut(field, at, len),
            x: (cut(field, at - 1, len), cut(field, at + 1, len)),
            y: (cut(field, at - sy, len), cut(field, at + sy, len)),
            z: (cut(field, at - sz, len), cut(field, at + sz, len)),
        }
    }

    /// Sum of the six neighbours of value `i`.
    #[inline(always)]
    pub fn around(&self, i: usize) -> f32 {
        let Self { x, y, z, .. } = self;
        (x.0[i] + x.1[i]) + (y.0[i] + y.1[i]) + (z.0[i] + z.1[i])
    }

    /// The same in whole blocks. A loop over values is made wide by the optimiser, with tests of
    /// what overlaps and a rest to do one by one: for a row of planes this short, half of the time.
    #[inline(always)]
    pub fn blocks(self) -> Star<'a, Block> {
        let all = |values: &'a [f32]| values.as_chunks().0;
        let both = |(low, high): (&'a [f32], &'a [f32])| (all(low), all(high));
        Star { here: all(self.here), x: both(self.x), y: both(self.y), z: both(self.z) }
    }
}

/// The velocities on both faces of a run of cells, along each axis.
#[derive(Clone, Copy)]
pub struct FaceRuns<'a> {
    /// Lower and upper face along x.
    pub x: (&'a [f32], &'a [f32]),
    /// Lower and upper face along y.
    pub y: (&'a [f32], &'a [f32]),
    /// Lower and upper face along z.
    pub z: (&'a [f32], &'a [f32]),
}

impl<'a> FaceRuns<'a> {
    /// The faces of `len` cells from index `at`.
    #[inline(always)]
    pub fn new(layout: &Layout, velocity: [&'a [f32]; 3], at: usize, len: usize) -> Self {
        let ([x, y, z], [_, sy, sz]) = (velocity, layout.strides());
        Self {
            x: (cut(x, at, len), cut(x, at + 1, len)),
            y: (cut(y, at, len), cut(y, at + sy, len)),
            z: (cut(z, at, len), cut(z, at + sz, len)),
        }
    }

    /// What flows out of cell `i`, in units of face area: h div u.
    #[inline(always)]
    pub fn outflow(&self, i: usize) -> f32 {
        let Self { x, y, z } = self;
        (x.1[i] - x.0[i]) + (y.1[i] - y.0[i]) + (z.1[i] - z.0[i])
    }

    /// The same of faces that are open in part.
    #[inline(always)]
    pub fn outflow_through(&self, area: &Self, i: usize) -> f32 {
        let (Self { x, y, z }, a) = (self, area);
        (a.x.1[i] * x.1[i] - a.x.0[i] * x.0[i])
            + (a.y.1[i] * y.1[i] - a.y.0[i] * y.0[i])
            + (a.z.1[i] * z.1[i] - a.z.0[i] * z.0[i])
    }

    /// Adds the squares on the lower faces to `sum`.
    #[inline(always)]
    pub fn add_squares(&self, sum: &mut Lanes) {
        sum.add_product(self.x.0, self.x.0);
        sum.add_product(self.y.0, self.y.0);
        sum.add_product(self.z.0, self.z.0);
    }
}

/// A sum in as many parts as a block has values: its order does not depend on the vector width.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lanes([f32; BLOCK]);

impl Lanes {
    /// Adds all `a[i] * b[i]`; both are of one length.
    #[inline(always)]
    pub fn add_product(&mut self, a: &[f32], b: &[f32]) {
        let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<BLOCK>(), b.as_chunks::<BLOCK>());
        for (a, b) in a.iter().zip(b) {
            for lane in 0..BLOCK {
                self.0[lane] += a[lane] * b[lane];
            }
        }
        for (lane, (a, b)) in self.0.iter_mut().zip(a_rest.iter().zip(b_rest)) {
            *lane += a * b;
        }
    }

    /// Adds `value(i)` for i in `0..len`.
    #[inline(always)]
    pub fn add(&mut self, len: usize, value: impl Fn(usize) -> f32) {
        for start in (0..len).step_by(BLOCK) {
            for lane in 0..BLOCK.min(len - start) {
                self.0[lane] += value(start + lane);
            }
        }
    }

    /// Adds all `weight[i] * a[i] * b[i]`; all are of one length.
    #[inline(always)]
    pub fn add_weighted(&mut self, weight: &[f32], a: &[f32], b: &[f32]) {
        let len = a.len();
        for start in (0..len).step_by(BLOCK) {
            let count = BLOCK.min(len - start);
            let part = (cut(weight, start, count), cut(a, start, count), cut(b, start, count));
            for lane in 0..count {
                self.0[lane] += part.0[lane] * (part.1[lane] * part.2[lane]);
            }
        }
    }

    /// The sum of the parts.
    #[inline(always)]
    pub fn sum(&self) -> f64 {
        self.0.iter().fold(0.0, |sum, lane| sum + f64::from(*lane))
    }
}

/// The largest of many magnitudes. Kept as bits: those of positive floats are in their order,
/// and the optimiser makes vector code of a maximum of integers only.
#[derive(Clone, Copy, Debug, Default)]
pub struct Largest(u32);

impl Largest {
    /// Raises it to the largest |value(i)| for i in `0..len`.
    #[inline(always)]
    pub fn raise(&mut self, len: usize, value: impl Fn(usize) -> f32) {
        for i in 0..len {
            self.0 = self.0.max(value(i).abs().to_bits());
        }
    }

    /// What it is; 0 if there was nothing.
    #[inline(always)]
    pub fn get(self) -> f64 {
        f64::from(f32::from_bits(self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_neighbour_of_every_run_is_in_memory_and_runs_keep_to_their_plane() {
        for cells in [[1, 1, 1], [2, 2, 2], [31, 2, 3], [32, 5, 4], [33, 1, 1], [1, 8, 8]] {
            let layout = Layout::new(cells);
            let (len, [_, ny, nz]) = (layout.zeros().len(), cells);
            let [sx, sy, sz] = layout.strides();
            let (first, last) = (layout.run(0..ny, 0), layout.run(0..ny, nz - 1));
            assert!(first.at >= sz && first.at + sy >= 2 * sy && first.at >= sx + sy);
            assert!(last.at + last.len + sz + sx <= len && last.to + last.len + sy <= layout.plane);
            assert!(last.len % BLOCK == 0 && last.len >= ny * layout.row);
        }
    }

    #[test]
    fn fields_and_the_cells_of_a_plane_start_at_a_cache_line() {
        assert_eq!(Field::zeros(100).as_ptr().align_offset(64), 0);
        assert_eq!(Field::zeros(100).len(), 100);
        let layout = Layout::new([9, 5, 3]);
        let field = layout.zeros();
        for k in 0..3 {
            assert_eq!(field[layout.index(0, 0, k)..].as_ptr().align_offset(64), 0);
        }
    }

    #[test]
    fn lanes_sum_products_and_find_the_largest() {
        let a: Vec<f32> = (0..32).map(|i| i as f32).collect();
        let (mut sum, mut largest) = (Lanes::default(), Largest::default());
        sum.add_product(&a, &a);
        largest.raise(32, |i| -a[31 - i]);
        assert_eq!(sum.sum(), 31.0 * 32.0 * 63.0 / 6.0);
        assert_eq!(largest.get(), 31.0);
    }
}
