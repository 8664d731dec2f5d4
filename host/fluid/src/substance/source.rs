//! Pouring substances in, letting them out, and the books of both.

use glam::Vec3;

use super::{Substance, Substances, mixture::next_stamp};
use crate::{
    grid::Grid,
    solver::{Refused, within},
};

/// What is poured or drained reaches at least this many cells around.
const MIN_RADIUS_CELLS: f32 = 1.5;

/// A place that substances enter or leave at.
struct Mouth {
    centre_in_world_m: Vec3,
    radius_m: f32,
    /// Rate times time in the middle.
    amount: f64,
}

impl Mouth {
    /// The cells of a box around it, as far as the grid has them.
    fn cells(&self, grid: &Grid) -> impl Iterator<Item = (usize, usize, usize)> + use<> {
        let centre = self.centre_in_world_m.as_dvec3() - grid.origin_in_world_m.as_dvec3();
        let [h, radius_m] = [grid.spacing_m, self.radius_m].map(f64::from);
        let [i, j, k] = [0, 1, 2].map(|axis| {
            // A cell more on both sides: centres are rounded. What is out of range saturates.
            let first = ((centre[axis] - radius_m) / h - 1.0) as usize;
            first..grid.cells[axis].min(((centre[axis] + radius_m) / h + 2.0) as usize)
        });
        k.flat_map(move |k| {
            let i = i.clone();
            j.clone().flat_map(move |j| i.clone().map(move |i| (i, j, k)))
        })
    }

    /// The share of what could pass at a point that does: 1 - e^-amount in the middle, smoothly
    /// less towards the radius.
    fn share_at(&self, point_in_world_m: Vec3) -> f32 {
        let from_centre = (point_in_world_m - self.centre_in_world_m) / self.radius_m;
        let inside = f64::from(1.0 - from_centre.length_squared()).max(0.0);
        -(-self.amount * inside * inside).exp_m1() as f32
    }
}

impl Substance {
    /// Takes a share of what a cell holds away, and returns it in cells.
    pub(super) fn draw_off(&mut self, at: usize, share: f32) -> f64 {
        let before = self.cells.fraction[at];
        let after = before * (1.0 - share);
        self.cells.fraction[at] = after;
        let drawn = f64::from(before) - f64::from(after);
        self.drained_cells += drawn;
        self.held_cells -= drawn;
        drawn
    }
}

impl Substances {
    /// Raises the fraction of one substance around a point towards 1, at `fraction_per_s` in
    /// the middle and smoothly less up to `radius_m` (at least 1.5 cells). Only the room that
    /// all substances together leave is filled. An unknown substance is ignored.
    ///
    /// # Errors
    /// [`Refused`] if an argument is not finite; nothing is poured then.
    pub fn pour(
        &mut self,
        substance: usize,
        centre_in_world_m: Vec3,
        radius_m: f32,
        fraction_per_s: f32,
        dt_s: f64,
    ) -> Result<(), Refused> {
        let mouth = self.mouth(
            centre_in_world_m,
            radius_m,
            ("fraction_per_s x dt_s", fraction_per_s, dt_s),
        )?;
        if substance >= self.all.len() || mouth.amount <= 0.0 {
            return Ok(());
        }
        self.stamp = next_stamp();
        for (i, j, k) in mouth.cells(&self.grid) {
            let share = mouth.share_at(self.grid.centre_in_world_m(i, j, k));
            if share > 0.0 && self.mask.is_liquid([i as isize, j as isize, k as isize]) {
                let at = self.layout.index(i, j, k);
                let filled: f32 = self.all.iter().map(|other| other.cells.fraction[at]).sum();
                let found = &mut self.all[substance];
                let before = found.cells.fraction[at];
                let after = before + (1.0 - filled).max(0.0) * share;
                found.cells.fraction[at] = after;
                found.cells.include(i, j, k);
                found.highest = found.highest.max(after);
                let poured = f64::from(after) - f64::from(before);
                found.poured_cells += poured;
                found.held_cells += poured;
            }
        }
        Ok(())
    }

    /// Takes all substances away around a point, as a drain that draws the mixture off and lets
    /// clear liquid in: `share_per_s` of what is there in the middle, smoothly less up to
    /// `radius_m` (at least 1.5 cells).
    ///
    /// # Errors
    /// [`Refused`] if an argument is not finite; nothing is drained then.
    pub fn drain(
        &mut self,
        centre_in_world_m: Vec3,
        radius_m: f32,
        share_per_s: f32,
        dt_s: f64,
    ) -> Result<(), Refused> {
        let mouth =
            self.mouth(centre_in_world_m, radius_m, ("share_per_s x dt_s", share_per_s, dt_s))?;
        if mouth.amount <= 0.0 {
            return Ok(());
        }
        self.stamp = next_stamp();
        for (i, j, k) in mouth.cells(&self.grid) {
            let share = mouth.share_at(self.grid.centre_in_world_m(i, j, k));
            let at = self.layout.index(i, j, k);
            for found in &mut self.all {
                found.draw_off(at, share);
            }
        }
        Ok(())
    }

    /// Volume of one substance that was poured so far; 0 if it is unknown. With
    /// [`Substances::drained_m3`] and what was set, it is what [`Substances::volume_m3`] comes to.
    #[must_use]
    pub fn poured_m3(&self, substance: usize) -> f64 {
        let cells = self.all.get(substance).map_or(0.0, |found| found.poured_cells);
        cells * f64::from(self.grid.cell_volume_m3())
    }

    /// Volume of one substance that was drained so far, or has left through sides that let out what
    /// comes; 0 if it is unknown.
    #[must_use]
    pub fn drained_m3(&self, substance: usize) -> f64 {
        let cells = self.all.get(substance).map_or(0.0, |found| found.drained_cells);
        cells * f64::from(self.grid.cell_volume_m3())
    }

    /// Volume of one substance, what waits for room in an overfull vessel included.
    #[must_use]
    pub fn volume_m3(&self, substance: usize) -> f64 {
        let cells = self.all.get(substance).map_or(0.0, |found| {
            found.cells.fraction.iter().fold(found.owed_cells, |sum, f| sum + f64::from(*f))
        });
        cells * f64::from(self.grid.cell_volume_m3())
    }

    /// Takes all substances away.
    pub fn clear(&mut self) {
        self.stamp = next_stamp();
        for substance in &mut self.all {
            substance.cells.clear();
            substance.highest = 0.0;
            substance.owed_cells = 0.0;
            substance.held_cells = 0.0;
        }
    }

    fn mouth(
        &self,
        centre_in_world_m: Vec3,
        radius_m: f32,
        (what, rate, dt_s): (&'static str, f32, f64),
    ) -> Result<Mouth, Refused> {
        for coordinate in centre_in_world_m.to_array() {
            within("centre_in_world_m", f64::from(coordinate), f64::MAX)?;
        }
        within("radius_m", f64::from(radius_m), f64::MAX)?;
        let amount = within(what, f64::from(rate) * dt_s, f64::MAX)?;
        let radius_m = radius_m.max(MIN_RADIUS_CELLS * self.grid.spacing_m);
        Ok(Mouth { centre_in_world_m, radius_m, amount })
    }
}
