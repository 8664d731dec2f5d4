//! What a projection leaves of the divergence of a smooth field.

use super::{
    Options, Session,
    case::divergent,
    measure::{Baseline, Outcome, Spent, cube, measure},
    row::Params,
};
use crate::solver::{SetupError, Side, Sides, SolverRow};

/// Projections that are timed together, as one alone is too short.
const PROJECTIONS: usize = 8;

const NAME: &str = "divergence";

/// Runs it; a step is one projection, compared with one of the founding solver's.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for n in session.sizes(NAME) {
        session.tell(&format!("{NAME} n={n}"));
        let mut baseline = Baseline::projections(n, session.options)?;
        let solve = |row: &SolverRow| run_divergence(row, n, session.options);
        let measured = measure(session.options, n, &mut baseline, |_| true, solve)?;
        session.keep(measured, NAME, n);
    }
    Ok(())
}

/// Projects the same field several times over.
pub fn run_divergence(row: &SolverRow, n: usize, options: &Options) -> Result<Outcome, SetupError> {
    let setup = cube(n, 0.0, Sides::all(Side::FreeSlip), options);
    let mut solver = (row.make)(&setup)?;
    let (mut spent, mut value) = (Spent::default(), 0.0);
    for _ in 0..PROJECTIONS {
        solver.set_velocity(&divergent)?;
        let before = solver.divergence_l2_per_s();
        spent.on(|| solver.project());
        value = solver.divergence_l2_per_s() / before;
    }
    let values = vec![("after_over_before", value)];
    let (steps, cells) = (PROJECTIONS, setup.grid.len());
    Ok(Outcome { values, spent, steps, cells, params: Params::new() })
}
