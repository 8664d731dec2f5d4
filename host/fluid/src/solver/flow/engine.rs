//! Where the arithmetic runs, and over what.

use crate::{
    pool::Pool,
    simd::SimdClass,
    solver::flow::{
        faces::Faces,
        field::{Lanes, Layout, Run},
    },
};

/// Threads, vector width, and the liquid to work on.
#[derive(Clone, Copy)]
pub struct Engine<'a> {
    /// The threads.
    pub pool: &'a Pool,
    /// The vector width.
    pub simd: SimdClass,
    /// The liquid.
    pub faces: &'a Faces,
}

impl Engine<'_> {
    /// The rows of plane `k` that hold liquid; `None` if none does.
    pub fn live_run(&self, layout: &Layout, k: usize) -> Option<Run> {
        let rows = self.faces.live_rows[k].clone();
        (!rows.is_empty()).then(|| layout.run(rows, k))
    }

    /// Runs `kernel(run, sums)` for the rows of plane `k` that hold liquid, at the vector width;
    /// returns the sums. The closure is to be `#[inline(always)]`.
    #[inline(always)]
    pub fn run(
        &self,
        layout: &Layout,
        k: usize,
        kernel: impl FnOnce(Run, &mut [Lanes; 2]),
    ) -> [f64; 4] {
        let Some(run) = self.live_run(layout, k) else { return [0.0; 4] };
        self.simd.vectorize(
            #[inline(always)]
            || {
                let mut sums = [Lanes::default(); 2];
                kernel(run, &mut sums);
                [sums[0].sum(), sums[1].sum(), 0.0, 0.0]
            },
        )
    }

    /// Runs `kernel(run, sums)` for the cells of each row of plane `k` that holds liquid, and
    /// for nothing beyond the sides.
    #[inline(always)]
    pub fn rows(
        &self,
        layout: &Layout,
        k: usize,
        mut kernel: impl FnMut(Run, &mut [Lanes; 2]),
    ) -> [f64; 4] {
        let rows = self.faces.live_rows[k].clone();
        self.simd.vectorize(
            #[inline(always)]
            || {
                let mut sums = [Lanes::default(); 2];
                for j in rows {
                    let (at, to) = (layout.index(0, j, k), layout.index_in_plane(0, j));
                    kernel(Run { at, to, len: layout.cells[0] }, &mut sums);
                }
                [sums[0].sum(), sums[1].sum(), 0.0, 0.0]
            },
        )
    }
}
