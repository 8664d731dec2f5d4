//! The cases with an exact end, on a ladder of n and of steps.

use super::{
    Session,
    case::{CASES, Case, MMS},
    measure::{Baseline, Outcome, Spent, Tally, bare_row, cube, is_ours, measure},
    row::{Param, Row},
};
use crate::{
    pool::Pool,
    solver::{SetupError, Solver, SolverRow},
};

/// Cells crossed in a step. The founding solvers run at the first only: what they get wrong is
/// wrong in every step.
pub const CFLS: [f64; 3] = [1.0, 0.5, 0.2];

/// Runs them all.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for case in CASES {
        for n in session.sizes(case.name) {
            let mut baseline = Baseline::steps(n, session.options)?;
            for cfl in CFLS {
                session.tell(&format!("{} n={n} CFL {cfl}", case.name));
                let is_wanted = |row: &SolverRow| cfl == CFLS[0] || !is_founding(row);
                let solve = |row: &SolverRow| run_case(case, row, n, cfl, session.options);
                let measured = measure(session.options, n, &mut baseline, is_wanted, solve)?;
                session.keep(measured, case.name, n);
            }
        }
    }
    two_threads(session)
}

fn is_founding(row: &SolverRow) -> bool {
    row.name.starts_with("founding")
}

/// The wall's time of the largest on two cores, against the founding solver's on its one.
fn two_threads(session: &mut Session<'_>) -> Result<(), SetupError> {
    let (n, cfl) = (64, 0.2);
    if session.options.is_quick || !session.wants(MMS.name) {
        return Ok(());
    }
    session.tell("mms n=64 on two threads");
    let options = super::Options { pool: Pool::new(2, true).into(), ..session.options.clone() };
    let mut baseline = Baseline::steps(n, &options)?;
    let solve = |row: &SolverRow| run_case(&MMS, row, n, cfl, &options);
    for two in measure(&options, n, &mut baseline, is_ours, solve)? {
        let quantity = "wall_ratio_to_founding";
        let row = bare_row(&options, MMS.name, two.method, n, quantity, two.wall_ratio);
        session.rows.push(Row { ms: Some(two.ms), params: two.outcome.params, ..row });
    }
    Ok(())
}

/// From the exact start to the end; forces are prepared outside of the time.
pub fn run_case(
    case: &Case,
    row: &SolverRow,
    n: usize,
    cfl: f64,
    options: &super::Options,
) -> Result<Outcome, SetupError> {
    let setup = cube(n, case.viscosity_m2_s, case.sides, options);
    let mut solver = (row.make)(&setup)?;
    solver.set_velocity(&|point| (case.flow_m_s)(point, 0.0))?;
    if let Some(force) = case.force_m_s2 {
        solver.set_force(&force)?;
    }
    let steps = case.steps(n, cfl);
    let dt_s = case.end_s / steps as f64;
    let (mut spent, mut tally) = (Spent::default(), Tally::new());
    for step in 0..steps {
        let [start, end] = [step, step + 1].map(|end| (case.force_scale)(end as f64 * dt_s));
        solver.scale_force(start, end)?;
        tally.count(spent.on(|| solver.step(dt_s))?);
    }
    let mut params = tally.params();
    params.extend([
        ("cfl", Param::Number(cfl)),
        ("steps", Param::Number(steps as f64)),
        ("end_s", Param::Number(case.end_s)),
        ("viscosity_m2_s", Param::Number(case.viscosity_m2_s)),
    ]);
    let values = vec![("rel_l2", relative_error(case, &*solver))];
    Ok(Outcome { values, spent, steps, cells: setup.grid.len(), params })
}

/// |u - exact| / |exact| over the solver's own points.
fn relative_error(case: &Case, solver: &dyn Solver) -> f64 {
    let (mut error, mut norm) = (0.0, 0.0);
    solver.visit(&mut |point, component, value| {
        let exact = (case.flow_m_s)(point, case.end_s)[component];
        error += (value - exact).powi(2);
        norm += exact.powi(2);
    });
    (error / norm).sqrt()
}
