//! Substances that were poured into the liquid and are carried with it.
//!
//! ```text
//! d phi/dt = -div(u phi) + kappa lap phi
//! ```
//! for the volume fraction phi of each, by finite volumes on the cells of the flow: what leaves
//! one cell enters the next, so no mass is lost. A part of a step is three sweeps, one along each
//! axis, in alternating order (Strang 1968), with the fluxes that `face.rs` describes. Fractions
//! stay between 0 and the highest that was brought in, and sums within 1. A substance is
//! computed only in the planes' extents that hold it.

mod cells;
mod diffuse;
mod face;
mod fit;
pub mod mixture;
mod remap;
mod schedule;
mod scoop;
mod sides;
mod source;
mod sweep;
mod transport;

use glam::Vec3;

pub use self::schedule::{Carrying, Spreading, TransportReport};
use self::{
    cells::{Cells, Extent},
    remap::Remap,
    schedule::{carrying, spreading},
    sides::Sides,
    transport::{Part, largest_loss_m_s},
};

use crate::{
    grid::Grid,
    mask::Mask,
    plan::Item,
    solver::{
        Refused, Setup,
        flow::{
            Flow,
            engine::Engine,
            faces::cells,
            field::{Field, Layout, Vector, cut},
        },
        within,
    },
};

/// What a substance is like. Its colour is the scene's business.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties {
    /// Density of the pure substance.
    pub density_kg_m3: f32,
    /// Kinematic viscosity of the pure substance.
    pub viscosity_m2_s: f32,
    /// Molecular diffusivity in the liquid.
    pub diffusivity_m2_s: f32,
}

impl Properties {
    /// Those of the liquid of `setup`, and no diffusion: a dye.
    #[must_use]
    pub fn of_liquid(setup: &Setup) -> Self {
        let Setup { density_kg_m3, viscosity_m2_s, .. } = *setup;
        Self { density_kg_m3, viscosity_m2_s, diffusivity_m2_s: 0.0 }
    }

    /// With what is negative or not finite replaced by the liquid's, or no diffusion.
    fn sound(self, liquid: &Self) -> Self {
        let or = |value: f32, other: f32| if (0.0..=1e6).contains(&value) { value } else { other };
        Self {
            density_kg_m3: or(self.density_kg_m3, liquid.density_kg_m3),
            viscosity_m2_s: or(self.viscosity_m2_s, liquid.viscosity_m2_s),
            diffusivity_m2_s: or(self.diffusivity_m2_s, 0.0),
        }
    }
}

/// Volume fractions of several substances in the cells of a [`Flow`].
pub struct Substances {
    grid: Grid,
    layout: Layout,
    mask: Mask,
    all: Vec<Substance>,
    work: Cells,
    spare: Field,
    /// What passes the faces, where walls cut through them.
    fluxes: Option<Vector>,
    /// Differs from that of any other state of any substances, so that no mixture is computed
    /// twice.
    stamp: u64,
    /// Whether the next part sweeps in reverse.
    reverse: bool,
    /// Off only to prove that skipping changes no bits.
    may_skip: bool,
}

struct Substance {
    cells: Cells,
    properties: Properties,
    /// No fraction was brought in above this; 0 until any was: an absent substance costs nothing.
    highest: f32,
    /// What waits for room, and what f32 has rounded away, in cells (see [`fit`]).
    owed_cells: f64,
    /// What its cells hold, by the books: only what is carried is counted again.
    held_cells: f64,
    poured_cells: f64,
    drained_cells: f64,
}

impl Substances {
    /// As many substances as there are properties, all absent, in the vessel of `setup`.
    /// Diffusivities that are negative, not finite or above 10^6 count as 0, other such
    /// properties as the liquid's.
    #[must_use]
    pub fn new(setup: &Setup, properties: &[Properties]) -> Self {
        let layout = Layout::new(setup.grid.cells);
        let substance = |properties: &Properties| Substance {
            cells: Cells::new(&layout),
            properties: properties.sound(&Properties::of_liquid(setup)),
            highest: 0.0,
            owed_cells: 0.0,
            held_cells: 0.0,
            poured_cells: 0.0,
            drained_cells: 0.0,
        };
        Self {
            grid: setup.grid,
            mask: Mask::new(&setup.grid, &setup.vessel),
            all: properties.iter().map(substance).collect(),
            work: Cells::new(&layout),
            spare: layout.zeros(),
            fluxes: None,
            stamp: mixture::next_stamp(),
            reverse: false,
            may_skip: true,
            layout,
        }
    }

    /// Number of substances.
    #[must_use]
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// What is computed in each step that holds any of them, and what has been made for it.
    #[must_use]
    pub fn plan(&self) -> Vec<Item> {
        let held = self.all.iter().map(|substance| substance.cells.bytes()).sum::<usize>();
        let fluxes = self.fluxes.iter().flatten().map(Field::bytes).sum::<usize>();
        let work = self.work.bytes() + self.spare.bytes() + self.mask.bytes() + fluxes;
        let spreads = self.all.iter().any(|s| s.properties.diffusivity_m2_s > 0.0);
        let how = format!("{}: fifth order, conservative, where they are", self.len());
        vec![
            Item::if_any("substances", (!self.is_empty()).then_some((how, held + work))),
            Item::if_any("diffusion", spreads.then_some(("explicit or implicit by step", 0))),
        ]
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
        let layout = flow.layout();
        let mut report = TransportReport::nothing();
        let moves = |s: &Substance| {
            s.highest > 0.0 && !(flow.is_at_rest() && s.properties.diffusivity_m2_s == 0.0)
        };
        // What waits for room is given it, even if nothing moves.
        let waits = self.all.iter().any(fit::is_owed);
        if *layout != self.layout || !(waits || self.all.iter().any(moves)) {
            return Ok(report);
        }
        let mut room = self.fluxes.take();
        let velocity = flow.fluxes(&mut room);
        let on = flow.carrier();
        let sides = flow.periodic_if_open();
        let comes_round = sides.is_some_and(|is_periodic| is_periodic.contains(&true));
        let loss = self.reached_loss(on, velocity, dt_s, comes_round);
        (report.carrying, report.substeps) = carrying(loss);
        for place in 0..self.all.len() {
            let Substance { highest, properties, .. } = &self.all[place];
            if *highest == 0.0 || (loss == 0.0 && properties.diffusivity_m2_s == 0.0) {
                continue;
            }
            let left;
            // In alternating order, as the sweeps.
            if self.reverse {
                self.diffuse(flow.engine(), place, dt_s, &mut report);
                left = self.carry((on, sides), place, velocity, dt_s, &mut report);
            } else {
                left = self.carry((on, sides), place, velocity, dt_s, &mut report);
                self.diffuse(flow.engine(), place, dt_s, &mut report);
            }
            let substance = &mut self.all[place];
            let before = substance.held_cells;
            substance.held_cells = fit::content(on, layout, &substance.cells);
            substance.drained_cells += left;
            substance.owed_cells += before - left - substance.held_cells;
        }
        self.reverse ^= report.substeps % 2 == 1;
        if report.cells_computed > 0 || waits {
            self.stamp = mixture::next_stamp();
            fit::fit(on, layout, &mut self.all, &mut self.spare);
        }
        self.fluxes = room;
        Ok(report)
    }

    /// Share of its content that a cell would lose in a step, at most, of those that a substance
    /// can come to within it: each part, and diffusion, takes it a cell further.
    fn reached_loss(
        &self,
        on: Engine<'_>,
        velocity: [&[f32]; 3],
        dt_s: f64,
        comes_round: bool,
    ) -> f64 {
        let (layout, all) = (&self.layout, &self.all);
        let extent = |k: usize| {
            all.iter().fold(Extent::default(), |extent, s| extent.with(s.cells.extent(k)))
        };
        let is_far = |s: &Substance| spreading(self.spread(s, dt_s)) == Spreading::Implicit;
        let is_anywhere = comes_round || all.iter().any(is_far);
        let mut reach = if is_anywhere { layout.cells.iter().sum() } else { 2 };
        loop {
            let loss_m_s = largest_loss_m_s(on, layout, velocity, extent, reach);
            let loss = loss_m_s * dt_s / f64::from(self.grid.spacing_m);
            let (carrying, parts) = carrying(loss);
            let reached = parts as usize + 1;
            if reached <= reach || carrying == Carrying::Remapped {
                return loss;
            }
            reach = reached;
        }
    }

    /// Diffusion number of a step.
    fn spread(&self, substance: &Substance, dt_s: f64) -> f64 {
        let spacing_m = f64::from(self.grid.spacing_m);
        f64::from(substance.properties.diffusivity_m2_s) * dt_s / (spacing_m * spacing_m)
    }

    /// Carries one substance; returns what has left through the sides, in cells.
    fn carry(
        &mut self,
        (on, is_periodic): (Engine<'_>, Option<[bool; 3]>),
        place: usize,
        velocity: [&[f32]; 3],
        dt_s: f64,
        report: &mut TransportReport,
    ) -> f64 {
        let Self { layout, all, work, spare, .. } = self;
        let substance = &mut all[place];
        let parts = report.substeps;
        let dt_per_spacing_s_m = dt_s / f64::from(self.grid.spacing_m) / f64::from(parts.max(1));
        let sides = is_periodic.map(|is_periodic| {
            let dt_per_spacing_s_m = dt_per_spacing_s_m as f32;
            Sides { layout, velocity, dt_per_spacing_s_m, is_periodic }
        });
        let mut left = 0.0;
        for part in 0..parts {
            let reverse = self.reverse ^ (part % 2 == 1);
            left += sides.map_or(0.0, |sides| sides.let_out(&mut substance.cells));
            if report.carrying == Carrying::Remapped {
                let remap = Remap { layout, velocity, dt_per_spacing_s_m };
                let fraction = &mut substance.cells.fraction;
                remap.carry(on, [fraction, &mut work.fraction, spare], reverse);
                work.clear();
                substance.cells.spread(layout);
                substance.highest = 1.0;
                report.cells_computed += self.mask.liquid_cells() as u64;
                sides.iter().for_each(|sides| sides.bring_round(&mut substance.cells));
                continue;
            }
            if !self.may_skip {
                substance.cells.spread(layout);
            }
            let part = Part {
                layout,
                velocity,
                dt_per_spacing_s_m: dt_per_spacing_s_m as f32,
                highest: substance.highest,
                may_skip: self.may_skip,
            };
            report.cells_computed += part.carry(on, &mut substance.cells, work, reverse) as u64;
            sides.iter().for_each(|sides| sides.bring_round(&mut substance.cells));
            if !self.may_skip {
                substance.cells.shrink(layout);
            }
        }
        left
    }

    fn diffuse(&mut self, on: Engine<'_>, place: usize, dt_s: f64, report: &mut TransportReport) {
        let spread = self.spread(&self.all[place], dt_s);
        let Self { layout, all, work, spare, .. } = self;
        let cells = &mut all[place].cells;
        let scheme = spreading(spread);
        report.spreading = report.spreading.max(scheme);
        match scheme {
            Spreading::Nothing => {}
            Spreading::Explicit => {
                let computed = diffuse::explicit(on, layout, cells, work, spread as f32);
                report.cells_computed += computed as u64;
            }
            Spreading::Implicit => {
                diffuse::implicit(on, layout, cells, [&mut work.fraction, spare], spread);
                work.clear();
                report.cells_computed += self.mask.liquid_cells() as u64;
            }
        }
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
        self.stamp = mixture::next_stamp();
        for (i, j, k) in cells(self.layout.cells) {
            if !self.mask.is_liquid([i as isize, j as isize, k as isize]) {
                continue;
            }
            let value = fraction(self.grid.centre_in_world_m(i, j, k));
            if !(0.0..=1.0).contains(&value) {
                return Err(Refused { what: "fraction", value: f64::from(value) });
            }
            let s = &mut self.all[substance];
            let fraction = &mut s.cells.fraction[self.layout.index(i, j, k)];
            s.held_cells += f64::from(value) - f64::from(*fraction);
            *fraction = value;
            s.highest = s.highest.max(value);
            if value > 0.0 {
                s.cells.include(i, j, k);
            }
        }
        Ok(())
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
            out.copy_from_slice(cut(&substance.cells.fraction, self.layout.index(0, j, k), nx));
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
        self.all
            .get(substance)
            .map_or(0.0, |found| found.cells.fraction[self.layout.index(i, j, k)])
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{solver::Solver, vessel::Vessel};

    /// What is owed of a substance that rests beside one that spreads is a part of what there is.
    #[test]
    fn rounding_never_takes_back_what_was_poured_at_rest() {
        let setup = Setup::new(Grid::unit_cube(4), Vessel::Box);
        let dye = Properties::of_liquid(&setup);
        let spreading = Properties { diffusivity_m2_s: 1e-3, ..dye };
        let mut substances = Substances::new(&setup, &[dye, spreading]);
        let flow = Flow::new(&setup).expect("a flow");
        for substance in 0..2 {
            substances.pour(substance, Vec3::splat(0.4), 0.5, 0.1, 1.0).expect("finite");
        }
        substances.all[0].owed_cells = -1e-9;
        let before = substances.volume_m3(0);
        substances.step(&flow, 0.01).expect("in range");
        let held: f32 = substances.all[0].cells.fraction.iter().sum();
        assert!((substances.volume_m3(0) - before).abs() < 1e-6 * before);
        assert!(f64::from(held) > 0.99 * before * 64.0, "{held} {before}");
    }

    #[test]
    fn skipping_what_holds_no_substance_changes_no_bits() {
        let pot = Vessel::Pot { centre_in_world_m: Vec3::new(0.5, 0.6, 0.5), radius_m: 0.45 };
        for (vessel, diffusivity_m2_s) in [(Vessel::Box, 0.0), (pot, 0.0), (Vessel::Box, 1e-4)] {
            let setup = Setup::new(Grid { cells: [21, 18, 19], ..Grid::unit_cube(20) }, vessel);
            let mut flow = Flow::new(&setup).expect("a flow");
            let wave =
                |p: DVec3| DVec3::new((5.0 * p.y).sin(), (4.0 * p.z).cos(), (3.0 * p.x).sin());
            flow.set_velocity(&wave).expect("finite");
            flow.project();
            let properties = Properties { diffusivity_m2_s, ..Properties::of_liquid(&setup) };
            let run = |may_skip| {
                let mut substances = Substances::new(&setup, &[properties]);
                substances.may_skip = may_skip;
                substances.pour(0, Vec3::new(0.3, 0.5, 0.6), 0.1, 9.0, 0.1).expect("finite");
                let computed: u64 = (0..9)
                    .map(|_| substances.step(&flow, 0.03).expect("in range").cells_computed)
                    .sum();
                let mut fraction = vec![0.0; setup.grid.len()];
                substances.copy_fraction(0, &mut fraction);
                (computed, fraction.iter().map(|f| f.to_bits()).collect::<Vec<_>>())
            };
            let ((some, skipping), (all, whole)) = (run(true), run(false));
            assert!(some < all, "{some} {all}");
            assert_eq!(skipping, whole);
        }
    }
}
