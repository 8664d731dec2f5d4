//! The correction of a box, a plane at a time.

use super::{Telling, rested};
use crate::{
    lanes::{each, subtract},
    pool::Partial,
    simd::SimdClass,
    solver::flow::{
        engine::Engine,
        faces::Faces,
        field::{Block, Layout, Run, blocks, blocks_mut, cut, cut_mut},
        survey::survey_blocks,
    },
};

/// A run of a cell field, and the values before it along each axis.
#[derive(Clone, Copy)]
pub struct Levels<'a> {
    /// The run itself.
    pub here: &'a [f32],
    /// Before it along x, y and z.
    pub before: [&'a [f32]; 3],
}

impl<'a> Levels<'a> {
    /// Of a whole field.
    pub fn new(layout: &Layout, field: &'a [f32], Run { at, len, .. }: Run) -> Self {
        let before = layout.strides().map(|stride| cut(field, at - stride, len));
        Self { here: cut(field, at, len), before }
    }

    /// Of the plane and the one below.
    pub fn in_planes(
        layout: &Layout,
        [below, here]: [&'a [f32]; 2],
        Run { to, len, .. }: Run,
    ) -> Self {
        let [x, y] = [1, layout.row].map(|stride| cut(here, to - stride, len));
        Self { here: cut(here, to, len), before: [x, y, cut(below, to, len)] }
    }
}

impl Engine<'_> {
    /// Corrects a plane of a box, and surveys it if it is to tell.
    pub fn correct_plane(
        &self,
        layout: &Layout,
        run: Run,
        k: usize,
        psi: Levels<'_>,
        [x, y, z]: [&mut [f32]; 3],
        telling: Telling<'_>,
    ) -> Partial {
        self.simd.vectorize_as(
            #[inline(always)]
            |class| {
                let Telling::All(force) = telling else {
                    for (u, before) in [x, y, z].into_iter().zip(psi.before) {
                        correct(cut_mut(u, run.to, run.len), psi.here, before);
                    }
                    return [0.0; 4];
                };
                let force = force.map(|force| force.map(|f| &f[(k + 1) * layout.plane..]));
                let masks = masks(layout, self.faces, run, k);
                correct_and_survey(class, masks, run, psi, [x, y, z], force)
            },
        )
    }
}

#[inline(always)]
fn correct(u: &mut [f32], above: &[f32], below: &[f32]) {
    // Cut once more: what comes out of an array has lost its length.
    let (above, below) = (cut(above, 0, u.len()), cut(below, 0, u.len()));
    for i in 0..u.len() {
        u[i] = rested(u[i] - (above[i] - below[i]));
    }
}

/// What is liquid and what is open in plane `k` of a box. All planes but the lowest are alike:
/// those of one stay in the nearest cache.
#[inline(always)]
fn masks<'a>(
    layout: &Layout,
    faces: &'a Faces,
    Run { at, len, .. }: Run,
    k: usize,
) -> (&'a [Block], [&'a [Block]; 3]) {
    let at = at - (k - k.min(1)) * layout.plane;
    let [x, y, z] = &faces.open;
    (blocks(&faces.liquid, at, len), [blocks(x, at, len), blocks(y, at, len), blocks(z, at, len)])
}

/// Corrects what is open and surveys it while it is in registers. What is not open is as it was:
/// faces of the sides have their velocity already.
#[inline(always)]
fn correct_and_survey(
    class: SimdClass,
    (is_inside, [open_x, open_y, open_z]): (&[Block], [&[Block]; 3]),
    Run { to, len, .. }: Run,
    psi: Levels<'_>,
    [u, v, w]: [&mut [f32]; 3],
    force: Option<[&[f32]; 3]>,
) -> [f64; 4] {
    let (u, v, w) = (blocks_mut(u, to, len), blocks_mut(v, to, len), blocks_mut(w, to, len));
    let (here, [x, y, z]) = (blocks(psi.here, 0, len), psi.before.map(|psi| blocks(psi, 0, len)));
    let force = force.map(|force| force.map(|f| blocks(f, to, len)));
    survey_blocks(
        class,
        is_inside,
        force,
        #[inline(always)]
        |b| {
            let next_u = corrected(u[b], open_x[b], subtract(here[b], x[b]));
            let next_v = corrected(v[b], open_y[b], subtract(here[b], y[b]));
            let next_w = corrected(w[b], open_z[b], subtract(here[b], z[b]));
            (u[b], v[b], w[b]) = (next_u, next_v, next_w);
            [next_u, next_v, next_w]
        },
    )
}

#[inline(always)]
fn corrected(u: Block, open: Block, rise: Block) -> Block {
    each(
        #[inline(always)]
        |i| rested(u[i] - open[i] * rise[i]),
    )
}
