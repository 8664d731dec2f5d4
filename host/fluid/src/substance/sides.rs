//! What passes the sides of the box.
//!
//! No sweep lets a substance through a side, though liquid passes there. What goes out with it, the
//! share c of the cell behind that the liquid is going to leave by, is taken out before the sweeps:
//! they then fill the cell again, and an even field stays even. Around a periodic axis it is
//! exchanged afterwards, when the cell holds what should have gone on top: of that the share
//! c / (1 + c) goes in on the other side. Both are of first order, at the side alone. All else that
//! comes in is clear.

use super::cells::Cells;
use crate::{
    solver::flow::field::Layout,
    vessel::cut::{CellBox, each},
};

/// The sides that something may pass, and how.
#[derive(Clone, Copy)]
pub struct Sides<'a> {
    /// How the arrays lie.
    pub layout: &'a Layout,
    /// On the faces.
    pub velocity: [&'a [f32]; 3],
    /// dt / h.
    pub dt_per_spacing_s_m: f32,
    /// Axes whose sides are the same.
    pub is_periodic: [bool; 3],
}

/// Where liquid goes out: the cell behind, that at the opposite side, and the volume, in cells.
struct Out {
    at: usize,
    opposite: [usize; 3],
    passed: f32,
}

impl Sides<'_> {
    /// Takes out what is about to leave the box; returns how much that is, in cells.
    pub fn let_out(&self, cells: &mut Cells) -> f64 {
        let mut left = 0.0;
        for axis in (0..3).filter(|axis| !self.is_periodic[*axis]) {
            self.outs(axis, |Out { at, passed, .. }| {
                let held = cells.fraction[at];
                let kept = held * (1.0 - passed).max(0.0);
                cells.fraction[at] = kept;
                left += f64::from(held) - f64::from(kept);
            });
        }
        left
    }

    /// Exchanges what has left periodic sides.
    pub fn bring_round(&self, cells: &mut Cells) {
        let several = |axis: &usize| self.is_periodic[*axis] && self.layout.cells[*axis] > 1;
        for axis in (0..3).filter(several) {
            self.outs(axis, |Out { at, opposite: [i, j, k], passed }| {
                let held = cells.fraction[at];
                if held > 0.0 {
                    let kept = held / (1.0 + passed);
                    cells.fraction[at] = kept;
                    cells.fraction[self.layout.index(i, j, k)] += held - kept;
                    cells.include(i, j, k);
                }
            });
        }
    }

    /// Calls `act` where liquid goes out through a side of `axis`.
    fn outs(&self, axis: usize, mut act: impl FnMut(Out)) {
        let layout = self.layout;
        let (n, stride) = (layout.cells[axis], layout.strides()[axis]);
        let mut side: CellBox = layout.cells.map(|n| 0..n);
        side[axis] = 0..1;
        each(&side, |first| {
            let (low, mut last) = (layout.index(first[0], first[1], first[2]), first);
            let high = low + (n - 1) * stride;
            last[axis] = n - 1;
            let (below, above) = (-self.velocity[axis][low], self.velocity[axis][high + stride]);
            for (at, opposite, velocity_m_s) in [(low, last, below), (high, first, above)] {
                let passed = self.dt_per_spacing_s_m * velocity_m_s;
                if passed > 0.0 {
                    act(Out { at, opposite, passed });
                }
            }
        });
    }
}
