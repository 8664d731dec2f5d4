//! Carrying one volume fraction with the flow: see the module above.

use super::{
    cells::{Cells, Extent, SLAB, STORED},
    sweep::{LineRoom, RowRoom, Rows, Sweep},
};
use crate::solver::flow::{
    engine::Engine,
    field::{BLOCK, FaceRuns, Largest, Layout, components},
};

/// Sweeps of a part, alternating with the reverse order: what one order does to a profile the
/// other undoes (Strang 1968). The one that starts across planes is a single pass.
const ACROSS_FIRST: [usize; 3] = [2, 0, 1];
const ACROSS_LAST: [usize; 3] = [1, 0, 2];

/// One part of a step of one substance.
#[derive(Clone, Copy)]
pub struct Part<'a> {
    /// How the arrays lie.
    pub layout: &'a Layout,
    /// On the faces.
    pub velocity: [&'a [f32]; 3],
    /// dt / h of the part.
    pub dt_per_spacing_s_m: f32,
    /// No fraction exceeds this.
    pub highest: f32,
    /// Only the planes' extents are computed; off only to prove that it changes no bits.
    pub may_skip: bool,
}

/// Share of a cell's content that leaves it within a second and a metre of spacing, at most: the
/// largest, over cells and sweeps of either order, of outflow and of volume lost, so that times
/// dt / h it must not exceed 1. In m/s. Cells further than `reach` from all extents of plane `k`
/// that `extent(k)` tells are left out.
pub fn largest_loss_m_s(
    on: Engine<'_>,
    layout: &Layout,
    velocity: [&[f32]; 3],
    extent: impl Fn(usize) -> Extent + Sync,
    reach: usize,
) -> f64 {
    on.pool.max(layout.cells[2], |k| {
        let nearby = k.saturating_sub(reach)..(k + reach + 1).min(layout.cells[2]);
        let near = nearby.fold(Extent::default(), |near, k| near.with(extent(k)));
        let near = near.grown(layout, reach);
        // Whole blocks cost less than what is left of one: some cells beside are looked at, too.
        let len = near.columns().len().next_multiple_of(BLOCK);
        let mut largest = Largest::default();
        on.simd.vectorize(
            #[inline(always)]
            || {
                for j in near.rows() {
                    let at = layout.index(near.x[0], j, k);
                    let FaceRuns { x, y, z } = FaceRuns::new(layout, velocity, at, len);
                    largest.raise(
                        len,
                        #[inline(always)]
                        |i| {
                            let [x, y, z] = [(x.0[i], x.1[i]), (y.0[i], y.1[i]), (z.0[i], z.1[i])];
                            larger(worst_of(z, x, y), worst_of(y, x, z))
                        },
                    );
                }
            },
        );
        largest.get()
    })
}

/// Worst loss of a cell that is swept along a, b and c; each is velocity below and above.
#[inline(always)]
fn worst_of(a: (f32, f32), b: (f32, f32), c: (f32, f32)) -> f32 {
    /// A cell is to keep at least a twentieth of its volume.
    const RESERVE: f32 = 20.0 / 19.0;
    let (shrinks, shrinks_more) = (a.1 - a.0, (a.1 - a.0) + (b.1 - b.0));
    let leaves = larger(leaving(a), larger(leaving(b) + shrinks, leaving(c) + shrinks_more));
    larger(leaves, RESERVE * larger(shrinks, shrinks_more))
}

#[inline(always)]
fn leaving((below, above): (f32, f32)) -> f32 {
    larger(above, 0.0) - if below < 0.0 { below } else { 0.0 }
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl<'a> Part<'a> {
    /// Carries `cells`; `work` is overwritten. Returns the number of cells computed.
    pub fn carry(&self, on: Engine<'_>, cells: &mut Cells, work: &mut Cells, reverse: bool) -> f64 {
        let layout = self.layout;
        let mut computed = 0.0;
        if reverse {
            let [fraction, extents] = cells.slabs(layout);
            let outs = [fraction, extents];
            computed += on.pool.planes_sum(outs, [layout.plane, STORED], |k, [plane, stored]| {
                on.simd.vectorize(
                    #[inline(always)]
                    || {
                        let extent = self.sweep_plane(on, k, plane, Extent::load(stored), true);
                        self.note(extent, plane, stored);
                        extent.cells() as f64
                    },
                )
            });
        }
        let from = &*cells;
        let outs = work.slabs(layout);
        computed += on.pool.planes_sum(outs, Cells::slab_len(layout), |slab, [out, stored]| {
            on.simd.vectorize(
                #[inline(always)]
                || self.sweep_slab(on, from, slab, out, stored, reverse),
            )
        });
        std::mem::swap(cells, work);
        computed / if reverse { 2.0 } else { 1.0 }
    }

    /// Stores what of `extent` is still needed.
    #[inline(always)]
    fn note(&self, extent: Extent, plane: &[f32], stored: &mut [f32]) {
        let kept = if self.may_skip { extent.shrunk(self.layout, plane) } else { extent };
        kept.store(stored);
    }

    #[inline(always)]
    fn sweep(&self, on: Engine<'a>, axis: usize, before: &'a [usize]) -> Sweep<'a> {
        let Self { layout, velocity, dt_per_spacing_s_m, highest, .. } = *self;
        let open = (!on.faces.is_box).then(|| components(&on.faces.open));
        Sweep { layout, velocity, open, dt_per_spacing_s_m, highest, axis, before }
    }

    /// Sweeps plane `k` along x and y in place; returns where it has changed.
    #[inline(always)]
    fn sweep_plane(
        &self,
        on: Engine<'a>,
        k: usize,
        plane: &mut [f32],
        extent: Extent,
        is_first: bool,
    ) -> Extent {
        if extent.is_empty() {
            return extent;
        }
        if is_first {
            let taller = extent.taller(self.layout);
            self.sweep_columns(on, k, plane, taller, &ACROSS_LAST[..0]);
            let wider = taller.wider(self.layout);
            self.sweep_rows(on, k, plane, wider, &ACROSS_LAST[..1]);
            wider
        } else {
            let wider = extent.wider(self.layout);
            self.sweep_rows(on, k, plane, wider, &ACROSS_FIRST[..1]);
            let taller = wider.taller(self.layout);
            self.sweep_columns(on, k, plane, taller, &ACROSS_FIRST[..2]);
            taller
        }
    }

    #[inline(always)]
    fn sweep_rows(
        &self,
        on: Engine<'a>,
        k: usize,
        plane: &mut [f32],
        extent: Extent,
        before: &'a [usize],
    ) {
        let (sweep, mut room) = (self.sweep(on, 0, before), RowRoom::new());
        for j in extent.rows() {
            let (to, at) = (self.layout.index_in_plane(0, j), self.layout.index(0, j, k));
            sweep.row(plane, to, at, extent.columns(), &mut room);
        }
    }

    #[inline(always)]
    fn sweep_columns(
        &self,
        on: Engine<'a>,
        k: usize,
        plane: &mut [f32],
        extent: Extent,
        before: &'a [usize],
    ) {
        let first = extent.x[0];
        let mut rows = Rows {
            from: None,
            to: plane,
            start: self.layout.index_in_plane(first, 0),
            first: 0,
            stride: self.layout.row,
        };
        let (at, columns) = (self.layout.index(first, 0, k), extent.columns().len());
        let sweep = self.sweep(on, 1, before);
        sweep.lines(&mut rows, at, columns, extent.rows(), &mut LineRoom::new());
    }

    /// Sweeps a slab of `from` across its planes into `out`, and before that or after it the
    /// planes in themselves.
    #[inline(always)]
    fn sweep_slab(
        &self,
        on: Engine<'a>,
        from: &Cells,
        slab: usize,
        out: &mut [f32],
        stored: &mut [f32],
        reverse: bool,
    ) -> f64 {
        let layout = self.layout;
        let slab = SLAB * slab..(SLAB * (slab + 1)).min(layout.cells[2]);
        clear(layout, out, stored);
        // What a plane holds afterwards came from itself or its neighbours.
        let near = |k: usize| {
            let nearby = k.saturating_sub(1)..k + 2;
            nearby.fold(Extent::default(), |near, k| near.with(from.extent(k)))
        };
        let mut full = slab.clone().filter(|k| !near(*k).is_empty());
        let Some(first) = full.next() else { return 0.0 };
        let planes = first..full.next_back().unwrap_or(first) + 1;
        let reach = planes.clone().fold(Extent::default(), |reach, k| reach.with(near(k)));
        let before = if reverse { &ACROSS_LAST[..2] } else { &ACROSS_FIRST[..0] };
        let (sweep, mut room) = (self.sweep(on, 2, before), LineRoom::new());
        for j in reach.rows() {
            let at = layout.index(reach.x[0], j, 0);
            let mut rows = Rows {
                from: Some((&from.fraction, at)),
                to: out,
                start: layout.index_in_plane(reach.x[0], j),
                first: slab.start,
                stride: layout.plane,
            };
            sweep.lines(&mut rows, at, reach.columns().len(), planes.clone(), &mut room);
        }
        let outs = out.chunks_exact_mut(layout.plane).zip(stored.chunks_exact_mut(STORED));
        let mut computed = 0.0;
        for (k, (plane, stored)) in slab.zip(outs).filter(|(k, _)| planes.contains(k)) {
            let near = near(k);
            let extent = if reverse { near } else { self.sweep_plane(on, k, plane, near, false) };
            self.note(extent, plane, stored);
            computed += reach.with(extent).cells() as f64;
        }
        computed
    }
}

/// Empties what a slab holds.
#[inline(always)]
fn clear(layout: &Layout, slab: &mut [f32], stored: &mut [f32]) {
    for (plane, stored) in slab.chunks_exact_mut(layout.plane).zip(stored.chunks_exact_mut(STORED))
    {
        Extent::load(stored).clear(layout, plane);
        Extent::default().store(stored);
    }
}
