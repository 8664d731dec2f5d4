//! Substances that were poured into the liquid and are carried with it.
//!
//! ```text
//! d phi/dt = -div(u phi) + kappa lap phi
//! ```
//! for the volume fraction phi of each, by finite volumes on the cells of the flow: what leaves
//! one cell enters the next, so no mass is lost. Face values are third-order upwind with the
//! limiter of Koren (1993), time is two-stage Runge-Kutta (Shu, Osher 1988), both cut into parts
//! in which no cell loses more than half of what it holds: fractions stay within 0 and 1.

mod transport;

use glam::Vec3;

pub use self::transport::{Carrying, TransportReport};
use self::transport::{Plan, Transport, largest_outflow, plan};

use crate::{
    grid::Grid,
    mask::Mask,
    solver::{
        Refused, Setup,
        flow::{
            Flow,
            faces::cells,
            field::{Field, Layout, cut},
        },
        within,
    },
};

/// What is poured reaches at least this many cells around.
const MIN_POUR_CELLS: f32 = 1.5;

/// Volume fractions of several substances in the cells of a [`Flow`].
pub struct Substances {
    grid: Grid,
    layout: Layout,
    mask: Mask,
    all: Vec<Substance>,
    transport: Transport,
}

struct Substance {
    fraction: Field,
    diffusivity_m2_s: f64,
    /// False until any was poured: an absent substance costs nothing.
    is_present: bool,
}

impl Substances {
    /// As many substances as there are diffusivities (in m^2/s; negative or non-finite ones
    /// count as 0), all absent, in the vessel of `setup`.
    #[must_use]
    pub fn new(setup: &Setup, diffusivities_m2_s: &[f32]) -> Self {
        let layout = Layout::new(setup.grid.cells);
        let substance = |diffusivity: &f32| Substance {
            fraction: layout.zeros(),
            diffusivity_m2_s: f64::from(*diffusivity).clamp(0.0, 1e6).max(0.0),
            is_present: false,
        };
        Self {
            grid: setup.grid,
            mask: Mask::new(&setup.grid, &setup.vessel),
            all: diffusivities_m2_s.iter().map(substance).collect(),
            transport: Transport::new(&layout),
            layout,
        }
    }

    /// Number of substances.
    #[must_use]
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// True if there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Carries all substances with `flow` for `dt_s`. The flow must be on the grid and in the
    /// vessel of these substances: otherwise nothing is carried.
    ///
    /// # Errors
    /// [`Refused`] if `dt_s` is negative, not finite, or above 1000 s.
    pub fn step(&mut self, flow: &Flow, dt_s: f64) -> Result<TransportReport, Refused> {
        within("dt_s", if dt_s < 0.0 { f64::NAN } else { dt_s }, 1e3)
            .map_err(|refused| Refused { value: dt_s, ..refused })?;
        let (layout, velocity) = flow.face_velocities();
        let mut report = TransportReport { substeps: 0, carrying: Carrying::Nothing };
        if *layout != self.layout || self.all.iter().all(|substance| !substance.is_present) {
            return Ok(report);
        }
        let (on, spacing_m) = (flow.engine(), f64::from(self.grid.spacing_m));
        let courant = largest_outflow(on, layout, velocity) * dt_s / spacing_m;
        for substance in self.all.iter_mut().filter(|substance| substance.is_present) {
            let spread = substance.diffusivity_m2_s * dt_s / (spacing_m * spacing_m);
            let plan: Plan = plan(courant, spread);
            self.transport.carry(on, &mut substance.fraction, velocity, plan, dt_s / spacing_m);
            report.substeps = report.substeps.max(plan.parts);
            report.carrying = report.carrying.max(plan.carrying);
        }
        Ok(report)
    }

    /// Raises the fraction of one substance around a point towards 1, at `fraction_per_s` in
    /// the middle and smoothly less up to `radius_m` (at least 1.5 cells). Only the room that
    /// all substances together leave is filled. An unknown substance is ignored.
    ///
    /// # Errors
    /// [`Refused`] if an argument is not finite, or a rate or time negative.
    pub fn pour(
        &mut self,
        substance: usize,
        centre_in_world_m: Vec3,
        radius_m: f32,
        fraction_per_s: f32,
        dt_s: f64,
    ) -> Result<(), Refused> {
        within("centre_in_world_m", f64::from(centre_in_world_m.dot(Vec3::ONE)), f64::MAX)?;
        within("radius_m", f64::from(radius_m), f64::MAX)?;
        let amount = within("fraction_per_s x dt_s", f64::from(fraction_per_s) * dt_s, f64::MAX)?;
        let radius_m = radius_m.max(MIN_POUR_CELLS * self.grid.spacing_m);
        if substance >= self.all.len() || amount <= 0.0 {
            return Ok(());
        }
        self.all[substance].is_present = true;
        for (i, j, k) in cells(self.layout.cells) {
            let from_centre = self.grid.centre_in_world_m(i, j, k) - centre_in_world_m;
            let inside = 1.0 - from_centre.length_squared() / (radius_m * radius_m);
            if inside > 0.0 && self.mask.is_liquid([i as isize, j as isize, k as isize]) {
                let at = self.layout.index(i, j, k);
                let filled: f32 = self.all.iter().map(|other| other.fraction[at]).sum();
                let share = -(-amount * f64::from(inside * inside)).exp_m1();
                self.all[substance].fraction[at] += (1.0 - filled).max(0.0) * share as f32;
            }
        }
        Ok(())
    }

    /// Sets the fraction of one substance in every liquid cell from the centre of the cell.
    /// An unknown substance is ignored.
    ///
    /// # Errors
    /// [`Refused`] if a value is not within 0 and 1; the cells before it are set then.
    pub fn set_fraction(
        &mut self,
        substance: usize,
        fraction: impl Fn(Vec3) -> f32,
    ) -> Result<(), Refused> {
        if substance >= self.all.len() {
            return Ok(());
        }
        for (i, j, k) in cells(self.layout.cells) {
            if !self.mask.is_liquid([i as isize, j as isize, k as isize]) {
                continue;
            }
            let value = fraction(self.grid.centre_in_world_m(i, j, k));
            if !(0.0..=1.0).contains(&value) {
                return Err(Refused { what: "fraction", value: f64::from(value) });
            }
            self.all[substance].fraction[self.layout.index(i, j, k)] = value;
            self.all[substance].is_present |= value > 0.0;
        }
        Ok(())
    }

    /// Takes all substances away.
    pub fn clear(&mut self) {
        for substance in &mut self.all {
            substance.fraction.fill(0.0);
            substance.is_present = false;
        }
    }

    /// Copies the fractions of one substance to a flat cell array, laid out as [`Grid::cell`]
    /// says; cells that hold no liquid are 0. An unknown substance is 0 everywhere.
    pub fn copy_fraction(&self, substance: usize, out: &mut [f32]) {
        out.fill(0.0);
        let Some(substance) = self.all.get(substance) else { return };
        let nx = self.layout.cells[0];
        let [_, ny, nz] = self.layout.cells;
        let rows = (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k)));
        for ((j, k), out) in rows.zip(out.chunks_exact_mut(nx)) {
            out.copy_from_slice(cut(&substance.fraction, self.layout.index(0, j, k), nx));
        }
    }

    /// Fraction of one substance in the cell that contains a point; 0 outside of the liquid.
    #[must_use]
    pub fn fraction_at(&self, substance: usize, point_in_world_m: Vec3) -> f32 {
        if !self.mask.holds(&self.grid, point_in_world_m) {
            return 0.0;
        }
        let cell = (point_in_world_m - self.grid.origin_in_world_m) / self.grid.spacing_m;
        let [i, j, k] = cell.to_array().map(|c| c as usize);
        self.all.get(substance).map_or(0.0, |found| found.fraction[self.layout.index(i, j, k)])
    }

    /// Volume of one substance.
    #[must_use]
    pub fn volume_m3(&self, substance: usize) -> f64 {
        let sum = self
            .all
            .get(substance)
            .map_or(0.0, |found| found.fraction.iter().fold(0.0, |sum, f| sum + f64::from(*f)));
        sum * f64::from(self.grid.cell_volume_m3())
    }
}
