//! Stability torture: seeds stand for liquids that are treated as badly as can be, and none may
//! break what physics and the crate promise.
//!
//! ```text
//! seed -> case -> world: jerk, force, pour, drain, jump, step ... then left alone -> verdict
//!                 books: energy, mass, every value in its range
//! ```
//! Nothing but the public API is used. What is asked of each seed:
//! - every velocity is finite, and none above the crate's cap;
//! - kinetic energy is never above what it was plus what pushes, forces, gravity and moving
//!   obstacles gave (unless a side drives: open ones do not);
//! - the mass of each substance is what was poured and neither drained nor carried out, to 1e-5 of
//!   what was poured, and every fraction is from 0 to 1;
//! - where viscosity acts and nothing drives, the liquid comes to rest (or decays as it has to,
//!   if that would take too long);
//! - an input that is not finite is refused by its name and changes no bit.

mod books;
mod corners;
mod draw;
mod ledger;
mod refusals;
mod rest;
pub mod surface;
mod verdict;
mod world;

use std::sync::Arc;

use self::{books::Books, rest::Decay, world::World};
pub use self::{
    corners::COUNT as CORNERS,
    draw::Case,
    verdict::{Summary, Verdict},
};
use crate::{
    bench::Params,
    pool::Pool,
    simd::SimdClass,
    solver::{Refused, Solver},
};

/// Seeds of shard `index` of `count`, both counted from 1: dealt round.
pub fn seeds_of_shard(seeds: u64, index: u64, count: u64) -> impl Iterator<Item = u64> {
    (index.saturating_sub(1)..seeds).step_by(count.max(1) as usize)
}

/// What is tortured: what `torture` takes the name of.
pub struct Group {
    /// Its name, which stands in its rows.
    pub name: &'static str,
    /// Names of the corners, which are the first seeds.
    pub corners: fn(seed: u64) -> Option<&'static str>,
    /// Parameters of a row that say how large it is.
    pub size: &'static [&'static str],
    /// Checks by name, as they stand in a row's parameters, and their short names.
    pub checks: &'static [(&'static str, &'static str)],
    /// Tortures it with what a seed stands for.
    pub run: fn(seed: u64, &Arc<Pool>, SimdClass) -> Verdict,
}

/// The flow solver.
pub const FLUID: Group = Group {
    name: "fluid",
    corners: corners::name,
    size: &["cells_x", "cells_y", "cells_z"],
    checks: &[
        ("energy_excess", "energy"),
        ("mass_error", "mass"),
        ("fraction_outside", "fraction"),
        ("speed_m_s", "fastest"),
        ("left_at_rest", "rest"),
        ("guard_actions", "guard"),
    ],
    run: |seed, pool, simd| run(&Case::of_seed(seed), pool, simd),
};

/// Tortures the solver with one case. Whatever happens ends up in the verdict: also a panic.
#[must_use]
pub fn run(case: &Case, pool: &Arc<Pool>, simd: SimdClass) -> Verdict {
    let mut verdict = Verdict::new(FLUID.name, case.seed, (simd, pool.threads()));
    verdict.row.case = case.corner.unwrap_or("drawn").to_owned();
    verdict.row.n = case.grid.cells.into_iter().max();
    verdict.row.params = params(case.params());
    let drawn = world::NOT_TAKEN.iter().filter(|(_, is_drawn)| is_drawn(case));
    verdict.not_taken = drawn.map(|(what, _)| *what).collect();
    verdict.not_asked = not_asked(case);
    verdict.judged(case.steps, || torture(case, pool, simd).map(|books| books.ledger))
}

/// Names and numbers as parameters of a row.
fn params(all: impl IntoIterator<Item = (&'static str, f64)>) -> Params {
    all.into_iter().map(|(name, value)| (name, value.into())).collect()
}

fn not_asked(case: &Case) -> Vec<&'static str> {
    let asked = [
        (case.sides.drive(), "energy: a side drives"),
        (case.substances.is_empty(), "mass: nothing is poured"),
        (Decay::of(case).is_none(), "rest: inviscid, driven, or streams or turns freely"),
    ];
    asked.into_iter().filter_map(|(is_not, what)| is_not.then_some(what)).collect()
}

/// The error says why the solver cannot do the case.
fn torture(case: &Case, pool: &Arc<Pool>, simd: SimdClass) -> Result<Books, String> {
    let mut world = World::new(case, pool, simd).map_err(|refused| refused.to_string())?;
    let mut books = Books::open(&world);
    let bad_at = world.draw(case.steps);
    for step in 0..case.steps {
        if step == bad_at
            && let Err(what) = refusals::offer_one(&mut world)
        {
            books.ledger.failures.insert("refusal", what);
        }
        if let Err(refused) = mistreat(&mut world, &mut books, step) {
            books.ledger.failures.insert("finite input", format!("in step {step}, {refused}"));
            return Ok(books);
        }
    }
    if let (Some(decay), true) = (Decay::of(case), books.ledger.failures.is_empty())
        && let Err(refused) = come_to_rest(&mut world, &mut books, decay)
    {
        books.ledger.failures.insert("finite input", format!("at rest, {refused}"));
    }
    Ok(books)
}

/// One step, and all that is done to the liquid before it.
fn mistreat(world: &mut World<'_>, books: &mut Books, step: usize) -> Result<(), Refused> {
    world.jerk(step)?;
    let push_s = world.force(step)? * world.case.dt_s;
    world.pour_or_drain(step)?;
    let wall_m_s = world.jump_obstacle(step)?;
    let before_j = world.flow.kinetic_energy_j();
    let (report, carried) = world.step(world.case.dt_s)?;
    let energy_j = [before_j, world.flow.kinetic_energy_j()];
    books.energy(world, energy_j, [push_s, world.case.dt_s, wall_m_s], step);
    books.mass(world, step);
    books.inspect(world, step);
    books.ledger.count("guard_actions", f64::from(report.guard_actions));
    books.ledger.most("substeps", f64::from(report.substeps));
    books.ledger.most("transport_substeps", f64::from(carried.substeps));
    Ok(())
}

/// Leaves the liquid alone for as long as its decay takes.
fn come_to_rest(world: &mut World<'_>, books: &mut Books, decay: Decay) -> Result<(), Refused> {
    world.leave_alone()?;
    let from_j = world.flow.kinetic_energy_j();
    let (steps, is_end) = decay.steps(from_j, world.flow.cell_mass_kg());
    let mut before_j = from_j;
    for step in world.case.steps..world.case.steps + steps {
        world.step(decay.dt_s)?;
        let after_j = world.flow.kinetic_energy_j();
        books.energy(world, [before_j, after_j], [0.0; 3], step);
        books.mass(world, step);
        before_j = after_j;
    }
    books.inspect(world, world.case.steps - 1 + steps);
    let left = (before_j / from_j.max(f64::MIN_POSITIVE)).sqrt();
    let allowed = if is_end { 0.0 } else { decay.kept.powi(steps as i32) };
    books.ledger.most("rest_steps", steps as f64);
    books.ledger.check("left_at_rest", left, allowed, world.case.steps + steps);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corner or a draw, small enough for a debug build.
    fn small(seed: u64) -> Case {
        let mut case = Case::of_seed(seed);
        let cells = case.grid.cells.map(|n| n.min(8));
        let is_pot = case.vessel != crate::Vessel::Box;
        case.set_cells(cells, is_pot);
        case
    }

    #[test]
    fn corners_and_draws_hold_when_small() {
        let pool = Arc::new(Pool::inline());
        let mut found = Vec::new();
        for seed in (0..CORNERS).chain([11, 12, 14, 17]) {
            let verdict = run(&small(seed), &pool, SimdClass::detect());
            assert!(verdict.row.pass.is_some(), "{verdict:?}");
            assert_eq!(verdict.replay, format!("cauldron torture fluid --seed {seed}"));
            // A failure starts with the name of its check.
            found.extend(verdict.failures.into_iter().map(|failure| (seed, failure)));
        }
        assert!(found.is_empty(), "{found:?}");
    }

    #[test]
    fn the_same_seed_does_the_same_for_any_number_of_threads() {
        let figures = |threads| {
            let pool = Arc::new(Pool::new(threads, false));
            run(&small(1), &pool, SimdClass::detect()).row.params
        };
        assert_eq!(figures(1), figures(2));
    }

    #[test]
    fn shards_deal_every_seed_once() {
        let mut dealt: Vec<_> = (1..=3).flat_map(|index| seeds_of_shard(20, index, 3)).collect();
        dealt.sort_unstable();
        assert_eq!(dealt, (0..20).collect::<Vec<_>>());
        assert_eq!(seeds_of_shard(8, 2, 4).collect::<Vec<_>>(), [1, 5]);
    }
}
