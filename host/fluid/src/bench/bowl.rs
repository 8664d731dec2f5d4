//! A bowl: what a wall that is not the grid's costs, and how tight it is.

use std::f32::consts::TAU;

use glam::Vec3;

use super::{
    Options, Session,
    case::{divergent, manufactured},
    measure::{Baseline, Outcome, Spent, Tally, cube, measure},
    row::Param,
};
use crate::{
    solver::{Setup, SetupError, Side, Sides, Solver, SolverRow},
    vessel::Vessel,
};

const NAME: &str = "bowl";
const CENTRE_IN_WORLD_M: Vec3 = Vec3::new(0.5, 0.6, 0.5);
const RADIUS_M: f32 = 0.45;

const STEPS: usize = 20;
const CFL: f64 = 0.5;

/// Runs it. Time is that of a step and counts per cell of the grid, full or empty.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for n in session.sizes(NAME) {
        session.tell(&format!("{NAME} n={n}"));
        let mut baseline = Baseline::steps(n, session.options)?;
        let solve = |row: &SolverRow| run_bowl(row, n, session.options);
        let measured = measure(session.options, n, &mut baseline, |_| true, solve)?;
        session.keep(measured, NAME, n);
    }
    Ok(())
}

/// The bowl of the cases, filled to the brim.
pub fn bowl(n: usize, viscosity_m2_s: f64, options: &Options) -> Setup {
    let vessel = Vessel::Bowl { centre_in_world_m: CENTRE_IN_WORLD_M, radius_m: RADIUS_M };
    Setup { vessel, ..cube(n, viscosity_m2_s, Sides::all(Side::FreeSlip), options) }
}

/// Projects a divergent field, then stirs.
fn run_bowl(row: &SolverRow, n: usize, options: &Options) -> Result<Outcome, SetupError> {
    let setup = bowl(n, 0.01, options);
    let mut solver = (row.make)(&setup)?;
    solver.set_velocity(&divergent)?;
    let before = solver.divergence_l2_per_s();
    solver.project();
    let left = solver.divergence_l2_per_s() / before;
    solver.set_velocity(&manufactured)?;
    solver.project();
    let (mut spent, mut tally) = (Spent::default(), Tally::new());
    let mut iterations = 0;
    for _ in 0..STEPS {
        let report = spent.on(|| solver.step(CFL / (2.0 * n as f64)))?;
        iterations += report.pressure_iterations;
        tally.count(report);
    }
    let mut params = tally.params();
    params.extend([
        ("cfl", Param::Number(CFL)),
        ("steps", Param::Number(STEPS as f64)),
        ("pressure_iterations", Param::Number(f64::from(iterations) / STEPS as f64)),
    ]);
    let values = vec![("after_over_before", left), ("flux_through_wall", leak(&*solver))];
    Ok(Outcome { values, spent, steps: STEPS, cells: setup.grid.len(), params })
}

/// Mean |u . n| over mean |u| at the wall, evenly over what of the sphere is in the box, as
/// velocities are interpolated there.
fn leak(solver: &dyn Solver) -> f64 {
    const POINTS: u16 = 4000;
    let golden = TAU * 0.618_034;
    let (mut through, mut speed) = (0.0, 0.0);
    for number in 0..POINTS {
        let height = 2.0 * (f32::from(number) + 0.5) / f32::from(POINTS) - 1.0;
        let (sine, cosine) = (golden * f32::from(number)).sin_cos();
        let across = (1.0 - height * height).sqrt();
        let normal = Vec3::new(across * cosine, height, across * sine);
        let point = CENTRE_IN_WORLD_M + RADIUS_M * normal;
        if point.y < 1.0 {
            let u = solver.velocity_at(point);
            through += f64::from(u.dot(normal).abs());
            speed += f64::from(u.length());
        }
    }
    through / speed
}
