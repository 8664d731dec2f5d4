//! Inviscid flows in a closed box, which keep their energy.

use glam::DVec3;

use super::{
    Options, Session,
    case::{TAYLOR_GREEN, smooth},
    measure::{Baseline, Outcome, Spent, Tally, cube, measure},
    row::Param,
};
use crate::solver::{SetupError, Side, Sides, SolverRow};

/// A flow that is left alone.
struct Left {
    name: &'static str,
    flow_m_s: fn(DVec3) -> DVec3,
    /// Largest component of the velocity.
    speed_m_s: f64,
    cfl: f64,
    end_s: f64,
    /// What is asked of the kept share of the energy.
    values: fn(kept: f64) -> Vec<(&'static str, f64)>,
}

const ALL: [Left; 2] = [
    Left {
        name: "cfl-16",
        flow_m_s: |point| (TAYLOR_GREEN.flow_m_s)(point, 0.0),
        speed_m_s: 1.0,
        cfl: 16.0,
        end_s: 2.0,
        // Where it is not a number, neither is below anything.
        values: |kept| {
            let lost = if kept > 1.0 { 0.0 } else { 1.0 - kept };
            let gained = if kept < 1.0 { 0.0 } else { kept - 1.0 };
            vec![("energy_lost", lost), ("energy_gained", gained)]
        },
    },
    Left {
        name: "energy-drift",
        flow_m_s: smooth,
        speed_m_s: 1.0,
        cfl: 0.5,
        end_s: 1.0,
        values: |kept| vec![("energy_change", (kept - 1.0).abs())],
    },
];

/// Runs them all.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for left in &ALL {
        for n in session.sizes(left.name) {
            session.tell(&format!("{} n={n}", left.name));
            let mut baseline = Baseline::steps(n, session.options)?;
            let solve = |row: &SolverRow| run_left(left, row, n, session.options);
            let measured = measure(session.options, n, &mut baseline, |_| true, solve)?;
            session.keep(measured, left.name, n);
        }
    }
    Ok(())
}

fn run_left(
    left: &Left,
    row: &SolverRow,
    n: usize,
    options: &Options,
) -> Result<Outcome, SetupError> {
    let setup = cube(n, 0.0, Sides::all(Side::FreeSlip), options);
    let mut solver = (row.make)(&setup)?;
    solver.set_velocity(&left.flow_m_s)?;
    solver.project();
    let before_j = solver.kinetic_energy_j();
    let steps = (left.end_s * left.speed_m_s * n as f64 / left.cfl).ceil().max(1.0) as usize;
    let (mut spent, mut tally) = (Spent::default(), Tally::new());
    for _ in 0..steps {
        tally.count(spent.on(|| solver.step(left.end_s / steps as f64))?);
    }
    let mut params = tally.params();
    params.extend([
        ("cfl", Param::Number(left.cfl)),
        ("steps", Param::Number(steps as f64)),
        ("end_s", Param::Number(left.end_s)),
    ]);
    let values = (left.values)(solver.kinetic_energy_j() / before_j);
    Ok(Outcome { values, spent, steps, cells: setup.grid.len(), params })
}
