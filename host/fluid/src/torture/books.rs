//! What a liquid may have: the account of its energy and of its substances.

use glam::DVec3;

use super::{ledger::Ledger, world::World};
use crate::solver::Solver;

/// Energy above the account, as a part of it, that is rounding and the solver's own slack: its
/// guard acts at half of this.
pub const ENERGY_SLACK: f64 = 2e-3;

/// Mass of a substance that may be lost or made, as a part of what was poured.
pub const MASS_SLACK: f64 = 1e-5;

/// How far rounding, and what a projection leaves of divergence, may carry a fraction out of 0
/// to 1.
pub const FRACTION_SLACK: f64 = 1e-5;

/// No velocity may be above this: what the crate says it never keeps, and its rounding.
pub const SPEED_CAP_M_S: f64 = 1e4 * (1.0 + 1e-6);

/// Mean speed of all liquid that an obstacle may bring about in a step, over its own: more than 1,
/// as it squeezes out what is between it and a wall.
const WALL_SPEEDS: f64 = 4.0;

/// A grid of at most this many cells is inspected value by value at every step ...
const SMALL_CELLS: usize = 1 << 15;

/// ... a larger one at each of so many.
const INSPECT_EVERY: usize = 20;

/// The account of one run.
pub struct Books {
    /// Its figures, and what failed.
    pub ledger: Ledger,
    /// Energy that came from nowhere so far.
    excess_j: f64,
    /// Half the mass-weighted sum of the squared acceleration: what it gives from rest in 1 s.
    force_j_s2: f64,
    /// The same of gravity, where densities differ.
    gravity_j_s2: f64,
    fractions: Vec<f32>,
}

impl Books {
    /// Opens the account of a world.
    pub fn open(world: &World<'_>) -> Self {
        let mut squares = 0.0;
        world.flow.visit(&mut |point: DVec3, c, _| {
            squares += world.acceleration_m_s2(point)[c].powi(2);
        });
        Self {
            ledger: Ledger::default(),
            excess_j: 0.0,
            force_j_s2: 0.5 * squares * world.heaviest_cell_kg(),
            gravity_j_s2: world.gravity_j_s2(),
            fractions: vec![0.0; world.case.grid.len()],
        }
    }

    /// Enters the energy around a step in which the force had at most this scale. What forces
    /// gave is at most what Cauchy and Schwarz allow for:
    /// sqrt(E) grows by dt sqrt(sum rho h^3 f^2 / 2). Gains of several steps add up, so that
    /// none is too small to be seen. An obstacle of that speed sets the liquid in motion at once,
    /// in sum no faster than [`WALL_SPEEDS`] times itself. Sides that drive give what they like,
    /// those that are open nothing.
    pub fn energy(
        &mut self,
        world: &World<'_>,
        [before, after]: [f64; 2],
        [push_s, dt_s, wall_m_s]: [f64; 3],
        at: usize,
    ) {
        if !after.is_finite() {
            self.ledger.check("not_finite", f64::NAN, 0.0, at);
        }
        if world.case.sides.drive() {
            return;
        }
        let all_kg = world.case.grid.len() as f64 * world.heaviest_cell_kg();
        let wall_j = 0.5 * all_kg * (WALL_SPEEDS * wall_m_s).powi(2);
        let given = push_s * self.force_j_s2.sqrt() + dt_s * self.gravity_j_s2.sqrt();
        let allowed = (before.sqrt() + given + wall_j.sqrt()).powi(2);
        self.excess_j = (self.excess_j + after - allowed).max(0.0);
        let share = if self.excess_j == 0.0 { 0.0 } else { self.excess_j / allowed };
        self.ledger.check("energy_excess", share, ENERGY_SLACK, at);
    }

    /// Compares what the cells hold of each substance with what was poured, drained, and let out.
    pub fn mass(&mut self, world: &World<'_>, at: usize) {
        let cell_m3 = f64::from(world.case.grid.cell_volume_m3());
        for index in 0..world.substances.len() {
            // Not the volume that the crate tells: that counts what no cell holds.
            world.substances.copy_fraction(index, &mut self.fractions);
            let held_m3 = cell_m3 * self.fractions.iter().map(|f| f64::from(*f)).sum::<f64>();
            let poured_m3 = world.substances.poured_m3(index);
            let gained_m3 = held_m3 + world.substances.drained_m3(index) - poured_m3;
            let error = gained_m3.abs() / poured_m3.max(f64::MIN_POSITIVE);
            self.ledger.check("mass_error", error, MASS_SLACK, at);
        }
    }

    /// Looks at every value that is stored: in each step of a small grid, in some of a large
    /// one.
    pub fn inspect(&mut self, world: &World<'_>, at: usize) {
        let is_small = world.case.grid.len() <= SMALL_CELLS;
        let is_due = at.is_multiple_of(INSPECT_EVERY) || at + 1 >= world.case.steps;
        if !is_small && !is_due {
            return;
        }
        let (mut fastest, mut strange) = (0f64, 0);
        world.flow.visit(&mut |_, _, value| {
            fastest = fastest.max(value.abs());
            strange += usize::from(!value.is_finite());
        });
        self.ledger.check("not_finite", strange as f64, 0.0, at);
        self.ledger.check("speed_m_s", fastest, SPEED_CAP_M_S, at);
        for index in 0..world.substances.len() {
            world.substances.copy_fraction(index, &mut self.fractions);
            let outside = |f: &f32| f64::from((f - 1.0).max(-f));
            let strange = self.fractions.iter().filter(|f| !f.is_finite()).count();
            let furthest = self.fractions.iter().map(outside).fold(0.0, f64::max);
            self.ledger.check("not_finite", strange as f64, 0.0, at);
            self.ledger.check("fraction_outside", furthest, FRACTION_SLACK, at);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{pool::Pool, simd::SimdClass, torture::draw::Case};

    #[test]
    fn what_is_made_from_nothing_is_found() {
        let mut case = Case::of_seed(2);
        case.set_cells([5, 4, 6], false);
        let mut world =
            World::new(&case, &Arc::new(Pool::inline()), SimdClass::detect()).expect("a world");
        let mut books = Books::open(&world);
        books.energy(&world, [1.0, 1.001], [0.0; 3], 0);
        books.energy(&world, [1.001, 1.001], [0.0; 3], 1);
        assert!(books.ledger.failures.is_empty());
        books.energy(&world, [1.001, 1.0025], [0.0; 3], 2);
        assert!(
            books.ledger.failures["energy_excess"].contains("in step 2"),
            "{:?}",
            books.ledger.failures
        );
        // What is poured beside the books was made from nothing.
        world.substances.set_fraction(0, |_| 0.5).expect("in range");
        books.mass(&world, 3);
        assert!(books.ledger.failures.contains_key("mass_error"));
        books.energy(&world, [1.0, f64::NAN], [0.0; 3], 4);
        assert!(books.ledger.failures.contains_key("not_finite"));
        books.ledger.check("speed_m_s", f64::NAN, SPEED_CAP_M_S, 5);
        assert!(
            books.ledger.failures.contains_key("speed_m_s")
                && books.ledger.worst["speed_m_s"].is_nan()
        );
    }

    #[test]
    fn a_force_may_give_what_it_gives_from_rest_and_no_more() {
        let mut case = Case::of_seed(2);
        case.set_cells([5, 4, 6], false);
        let world =
            World::new(&case, &Arc::new(Pool::inline()), SimdClass::detect()).expect("a world");
        let mut books = Books::open(&world);
        let from_rest_j = books.force_j_s2 * 0.01;
        books.energy(&world, [0.0, from_rest_j], [0.1, 0.0, 0.0], 0);
        assert!(books.ledger.failures.is_empty() && from_rest_j > 0.0);
        books.energy(&world, [0.0, 1.01 * from_rest_j], [0.1, 0.0, 0.0], 1);
        assert!(books.ledger.failures.contains_key("energy_excess"));
    }
}
