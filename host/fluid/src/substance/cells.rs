//! The cells of one substance, and where in them it is.

use std::ops::Range;

use crate::solver::flow::field::{Field, Layout};

/// Planes that are dealt out together, so that what passes between them is computed once.
pub const SLAB: usize = 8;

/// Columns and rows of one plane that hold a substance; nothing is outside of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// First column and the one after the last; the same if nothing is in the plane.
    pub x: [usize; 2],
    /// First row and the one after the last.
    pub y: [usize; 2],
}

impl Extent {
    /// A whole plane of `layout`.
    pub fn whole(layout: &Layout) -> Self {
        Self { x: [0, layout.cells[0]], y: [0, layout.cells[1]] }
    }

    /// True if nothing is in the plane.
    pub fn is_empty(self) -> bool {
        self.x[0] >= self.x[1] || self.y[0] >= self.y[1]
    }

    /// The least that contains both.
    pub fn with(self, other: Self) -> Self {
        let join = |a: [usize; 2], b: [usize; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => Self { x: join(self.x, other.x), y: join(self.y, other.y) },
        }
    }

    /// With a column more on both sides, if there is one.
    pub fn wider(self, layout: &Layout) -> Self {
        Self { x: [self.x[0].saturating_sub(1), (self.x[1] + 1).min(layout.cells[0])], ..self }
    }

    /// With a row more on both sides, if there is one.
    pub fn taller(self, layout: &Layout) -> Self {
        Self { y: [self.y[0].saturating_sub(1), (self.y[1] + 1).min(layout.cells[1])], ..self }
    }

    /// With so many columns and rows more on every side, if there are; nothing stays nothing.
    pub fn grown(self, layout: &Layout, by: usize) -> Self {
        let grow = |[a, b]: [usize; 2], axis: usize| {
            [a.saturating_sub(by), (b + by).min(layout.cells[axis])]
        };
        if self.is_empty() { self } else { Self { x: grow(self.x, 0), y: grow(self.y, 1) } }
    }

    /// Its columns.
    pub fn columns(self) -> Range<usize> {
        self.x[0]..self.x[1]
    }

    /// Its rows.
    pub fn rows(self) -> Range<usize> {
        self.y[0]..self.y[1]
    }

    /// Empties it in `plane`, as a pool's body sees it.
    pub fn clear(self, layout: &Layout, plane: &mut [f32]) {
        for j in self.rows() {
            let len = self.columns().len();
            plane[layout.index_in_plane(self.x[0], j)..][..len].fill(0.0);
        }
    }

    /// Number of cells.
    pub fn cells(self) -> usize {
        self.columns().len() * self.rows().len()
    }

    /// Without the empty rows and columns at its edges; `plane` is as a pool's body sees it.
    pub fn shrunk(mut self, layout: &Layout, plane: &[f32]) -> Self {
        let is_full = |i: usize, j: usize| plane[layout.index_in_plane(i, j)] > 0.0;
        while !self.is_empty() && !self.columns().any(|i| is_full(i, self.y[0])) {
            self.y[0] += 1;
        }
        while !self.is_empty() && !self.columns().any(|i| is_full(i, self.y[1] - 1)) {
            self.y[1] -= 1;
        }
        while !self.is_empty() && !self.rows().any(|j| is_full(self.x[0], j)) {
            self.x[0] += 1;
        }
        while !self.is_empty() && !self.rows().any(|j| is_full(self.x[1] - 1, j)) {
            self.x[1] -= 1;
        }
        if self.is_empty() { Self::default() } else { self }
    }

    /// As a pool deals it out: extents are written by whoever writes the plane.
    pub fn store(self, stored: &mut [f32]) {
        let values = [self.x[0], self.x[1], self.y[0], self.y[1]];
        stored.iter_mut().zip(values).for_each(|(stored, value)| *stored = value as f32);
    }

    /// What [`Extent::store`] has written.
    pub fn load(stored: &[f32]) -> Self {
        let at = |m: usize| stored[m] as usize;
        Self { x: [at(0), at(1)], y: [at(2), at(3)] }
    }
}

/// Values per stored extent.
pub const STORED: usize = 4;

/// A fraction in every cell, padded as [`Layout`] says, and its extent in every plane.
#[derive(Debug)]
pub struct Cells {
    /// The fraction: 0 outside of the extents.
    pub fraction: Field,
    extents: Vec<f32>,
}

impl Cells {
    /// Memory that they take.
    pub fn bytes(&self) -> usize {
        self.fraction.bytes() + size_of_val(&*self.extents)
    }

    /// Nothing anywhere. There are as many planes as whole slabs have.
    pub fn new(layout: &Layout) -> Self {
        let planes = layout.cells[2].next_multiple_of(SLAB);
        Self {
            fraction: Field::zeros(layout.plane * (planes + 2)),
            extents: vec![0.0; STORED * planes],
        }
    }

    /// Where it is in plane `k`; nowhere if there is no such plane.
    pub fn extent(&self, k: usize) -> Extent {
        self.extents.get(STORED * k..STORED * (k + 1)).map_or(Extent::default(), Extent::load)
    }

    /// Says that it may be in cell (i, j, k).
    pub fn include(&mut self, i: usize, j: usize, k: usize) {
        let extent = self.extent(k).with(Extent { x: [i, i + 1], y: [j, j + 1] });
        extent.store(&mut self.extents[STORED * k..]);
    }

    /// Says that it may be anywhere in the first `planes` planes.
    pub fn spread(&mut self, layout: &Layout) {
        let planes = &mut self.extents[..STORED * layout.cells[2]];
        planes.chunks_exact_mut(STORED).for_each(|e| Extent::whole(layout).store(e));
    }

    /// Finds out where it is, after [`Cells::spread`].
    pub fn shrink(&mut self, layout: &Layout) {
        let planes = layout.planes(&mut self.fraction).chunks_exact(layout.plane);
        for (plane, stored) in planes.zip(self.extents.chunks_exact_mut(STORED)) {
            Extent::load(stored).shrunk(layout, plane).store(stored);
        }
    }

    /// Takes everything away.
    pub fn clear(&mut self) {
        self.fraction.fill(0.0);
        self.extents.fill(0.0);
    }

    /// The slabs of the fraction and of the extents, for a pool to deal out.
    pub fn slabs(&mut self, layout: &Layout) -> [&mut [f32]; 2] {
        let end = self.fraction.len() - layout.plane;
        [&mut self.fraction[layout.plane..end], &mut self.extents]
    }

    /// Lengths of what [`Cells::slabs`] is to be cut into.
    pub fn slab_len(layout: &Layout) -> [usize; 2] {
        [SLAB * layout.plane, SLAB * STORED]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_grow_to_the_walls_join_and_shrink_to_what_is_there() {
        let layout = Layout::new([5, 4, 1]);
        let mut plane = vec![0.0; layout.plane];
        plane[layout.index_in_plane(1, 2)] = 0.5;
        plane[layout.index_in_plane(3, 0)] = 0.1;
        let found = Extent::whole(&layout).shrunk(&layout, &plane);
        assert_eq!(found, Extent { x: [1, 4], y: [0, 3] });
        assert_eq!(found.wider(&layout).taller(&layout), Extent { x: [0, 5], y: [0, 4] });
        assert_eq!(found.with(Extent::default()), found);
        assert_eq!(Extent::default().with(found), found);
        assert_eq!(found.with(Extent { x: [0, 1], y: [3, 4] }), Extent { x: [0, 4], y: [0, 4] });
        found.clear(&layout, &mut plane);
        assert!(found.shrunk(&layout, &plane).is_empty());
        let mut stored = [9.0; STORED];
        found.store(&mut stored);
        assert_eq!(Extent::load(&stored), found);
    }
}
