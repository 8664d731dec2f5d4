//! Fractions that together are more than a cell has room for.
//!
//! Limiters bound each substance, not their sum; a velocity that is not free of divergence brings
//! in more than it takes away; a remap puts what came together in one cell. The excess goes
//! where the same substance already is and room is left, in proportion to both; only if that is not
//! enough, to all room there is. Nothing is lost: what f32 has rounded away in a step, or
//! added, is entered in the same book, and given or taken back once it counts.

use super::{
    Substance,
    cells::{Cells, Extent, STORED},
};
use crate::solver::flow::{
    engine::Engine,
    field::{BLOCK, Largest, Layout, cut},
};

/// A sum of fractions this far above 1 is left alone: rounding.
const TOLERANCE: f32 = 1e-6;

/// Rounds in which the excess is given to where the substance is.
const ROUNDS: usize = 8;

/// What is given has to count in f32, or it would be lost in rounding: the least it may add in a
/// round, of what is there. Less than that is owed until it is more.
const LEAST_SHARE: f64 = 1e-6;

/// Makes the fractions of `all` fit in their cells; `sum` is overwritten.
pub fn fit(on: Engine<'_>, layout: &Layout, all: &mut [Substance], sum: &mut [f32]) {
    let mut books_close = !all.iter().any(is_owed);
    for _ in 0..ROUNDS {
        if set_sum(on, layout, all, sum) <= f64::from(1.0 + TOLERANCE) && books_close {
            return;
        }
        let mut is_done = true;
        for substance in all.iter_mut().filter(|substance| substance.highest > 0.0) {
            let room = take_excess(on, layout, substance, sum);
            if substance.owed_cells < -LEAST_SHARE * substance.held_cells {
                take_back(on, layout, substance);
                continue;
            }
            let share = substance.owed_cells / room.max(f64::MIN_POSITIVE);
            if share >= LEAST_SHARE {
                give(on, layout, substance, sum, [share.min(1.0) as f32, 0.0]);
            }
            is_done &= share <= 1.0;
        }
        if is_done {
            return;
        }
        books_close = false;
    }
    // From here on all room counts, also where none of them is.
    for substance in all.iter_mut().filter(|substance| substance.owed_cells > 0.0) {
        substance.cells.spread(layout);
    }
    set_sum(on, layout, all, sum);
    let room = on.pool.sum(layout.cells[2], |k| {
        rows_of(layout, Extent::whole(layout), k).map(|at| room_in(on, sum, at)).sum()
    });
    for substance in all.iter_mut().filter(|substance| substance.owed_cells > 0.0) {
        let share = substance.owed_cells / room.max(f64::MIN_POSITIVE);
        give(on, layout, substance, sum, [0.0, share.min(1.0) as f32]);
    }
}

/// True if more of it waits, or is too much, than rounding alone may leave.
pub fn is_owed(substance: &Substance) -> bool {
    substance.owed_cells.abs() > LEAST_SHARE * substance.held_cells
}

/// Indices and numbers of the cells of the rows of `extent` in plane `k`.
fn rows_of(
    layout: &Layout,
    extent: Extent,
    k: usize,
) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (layout, len) = (*layout, extent.columns().len());
    extent.rows().map(move |j| (layout.index(extent.x[0], j, k), len))
}

fn room_in(on: Engine<'_>, sum: &[f32], (at, len): (usize, usize)) -> f64 {
    let cells = cut(sum, at, len).iter().zip(cut(&on.faces.liquid, at, len));
    cells.map(|(sum, liquid)| f64::from((liquid - sum).max(0.0))).sum()
}

/// Sets the sum of all fractions where any is; returns the largest.
fn set_sum(on: Engine<'_>, layout: &Layout, all: &[Substance], sum: &mut [f32]) -> f64 {
    let body = |k: usize, [plane]: [&mut [f32]; 1]| {
        let found = || all.iter().filter(|substance| substance.highest > 0.0);
        found().fold(Extent::default(), |all, s| all.with(s.cells.extent(k))).clear(layout, plane);
        let mut largest = Largest::default();
        on.simd.vectorize(
            #[inline(always)]
            || {
                for substance in found() {
                    for (at, len) in rows_of(layout, substance.cells.extent(k), k) {
                        let sum = &mut plane[at - (k + 1) * layout.plane..][..len];
                        let fraction = cut(&substance.cells.fraction, at, len);
                        for i in 0..len {
                            sum[i] += fraction[i];
                        }
                        largest.raise(
                            len,
                            #[inline(always)]
                            |i| sum[i],
                        );
                    }
                }
            },
        );
        [largest.get(), 0.0, 0.0, 0.0]
    };
    let larger = |a: [f64; 4], b: [f64; 4]| [a[0].max(b[0]), 0.0, 0.0, 0.0];
    on.pool.fold(None, [layout.planes(sum)], [layout.plane], body, larger)[0]
}

/// Takes from each overfull cell the substance's part of the excess; returns the sum, over all
/// cells, of its fraction times the room.
fn take_excess(on: Engine<'_>, layout: &Layout, substance: &mut Substance, sum: &[f32]) -> f64 {
    let body = |k: usize, [plane, stored]: [&mut [f32]; 2]| {
        let (mut taken, mut weight) = (0.0, 0.0);
        for (at, len) in rows_of(layout, Extent::load(stored), k) {
            let fraction = &mut plane[at - (k + 1) * layout.plane..][..len];
            let cells =
                fraction.iter_mut().zip(cut(sum, at, len)).zip(cut(&on.faces.liquid, at, len));
            for ((fraction, sum), liquid) in cells {
                if *sum > 1.0 + TOLERANCE {
                    let kept = *fraction / *sum;
                    taken += f64::from(*fraction) - f64::from(kept);
                    *fraction = kept;
                }
                weight += f64::from(*fraction * (liquid - sum).max(0.0));
            }
        }
        [taken, weight, 0.0, 0.0]
    };
    let add = |a: [f64; 4], b: [f64; 4]| [a[0] + b[0], a[1] + b[1], 0.0, 0.0];
    let outs = substance.cells.slabs(layout);
    let [taken, weight, ..] = on.pool.fold(None, outs, [layout.plane, STORED], body, add);
    substance.owed_cells += taken;
    substance.held_cells -= taken;
    weight
}

/// What `cells` hold.
pub fn content(on: Engine<'_>, layout: &Layout, cells: &Cells) -> f64 {
    on.pool.sum(layout.cells[2], |k| {
        // Two kinds of sums: one that is added to by values and by blocks would wait at each
        // change.
        let (mut lanes, mut rests) = ([0f64; BLOCK], 0.0);
        on.simd.vectorize(
            #[inline(always)]
            || {
                for (at, len) in rows_of(layout, cells.extent(k), k) {
                    let (blocks, rest) = cut(&cells.fraction, at, len).as_chunks::<BLOCK>();
                    for block in blocks {
                        for i in 0..BLOCK {
                            lanes[i] += f64::from(block[i]);
                        }
                    }
                    rests += rest.iter().fold(0.0, |sum, f| sum + f64::from(*f));
                }
            },
        );
        lanes.iter().sum::<f64>() + rests
    })
}

/// Takes back what rounding gave too much, in proportion.
fn take_back(on: Engine<'_>, layout: &Layout, substance: &mut Substance) {
    let share = (substance.owed_cells / substance.held_cells.max(f64::MIN_POSITIVE)).max(-1.0);
    let body = |k: usize, [plane, stored]: [&mut [f32]; 2]| {
        let mut given = 0.0;
        for (at, len) in rows_of(layout, Extent::load(stored), k) {
            for fraction in &mut plane[at - (k + 1) * layout.plane..][..len] {
                let next = (f64::from(*fraction) * (1.0 + share)) as f32;
                given += f64::from(next) - f64::from(*fraction);
                *fraction = next;
            }
        }
        given
    };
    let outs = substance.cells.slabs(layout);
    let given = on.pool.planes_sum(outs, [layout.plane, STORED], body);
    substance.owed_cells -= given;
    substance.held_cells += given;
}

/// Gives of what is owed room times (`shares[0]` times the fraction plus `shares[1]`).
fn give(on: Engine<'_>, layout: &Layout, substance: &mut Substance, sum: &[f32], shares: [f32; 2]) {
    let body = |k: usize, [plane, stored]: [&mut [f32]; 2]| {
        let mut given = 0.0;
        for (at, len) in rows_of(layout, Extent::load(stored), k) {
            let fraction = &mut plane[at - (k + 1) * layout.plane..][..len];
            let cells =
                fraction.iter_mut().zip(cut(sum, at, len)).zip(cut(&on.faces.liquid, at, len));
            for ((fraction, sum), liquid) in cells {
                let room = (liquid - sum).max(0.0);
                let next = *fraction + room * (shares[0] * *fraction + shares[1]);
                given += f64::from(next) - f64::from(*fraction);
                *fraction = next;
            }
        }
        given
    };
    // What is given may come to rest above what was ever brought in.
    substance.highest = 1.0;
    let outs = substance.cells.slabs(layout);
    let given = on.pool.planes_sum(outs, [layout.plane, STORED], body);
    substance.owed_cells -= given;
    substance.held_cells += given;
}
