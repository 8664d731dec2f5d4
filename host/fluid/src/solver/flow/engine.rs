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
    /// Runs `kernel(run, sums)` for the rows of plane `k` that hold liquid, at the vector width;
    /// returns the sums. The closure is to be `#[inline(always)]`.
    #[inline(always)]
    pub fn run(
        &self,
        layout: &Layout,
        k: usize,
        kernel: impl FnOnce(Run, &mut [Lanes; 2]),
    ) -> [f64; 4] {
        let rows = self.faces.live_rows[k].clone();
        if rows.is_empty() {
            return [0.0; 4];
        }
        let run = layout.run(rows, k);
        self.simd.vectorize(
            #[inline(always)]
            || {
                let mut sums = [Lanes::default(); 2];
                kernel(run, &mut sums);
                [sums[0].sum(), sums[1].sum(), 0.0, 0.0]
            },
        )
    }
}
