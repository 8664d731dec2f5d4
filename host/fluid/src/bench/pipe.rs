//! A pipe: what flows through cut cells under a body force, against Hagen and Poiseuille.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::{
    Options, Session,
    measure::{Baseline, Outcome, Spent, Tally, is_ours, measure},
    row::Param,
};
use crate::{
    grid::Grid,
    solver::{Setup, SetupError, Side, Sides, Solver, Walls, flow::Flow},
    vessel::Vessel,
};

const NAME: &str = "pipe";
const RADIUS_M: f32 = 0.4;

/// Off the symmetry of the grid: no luck in how it is cut.
const CENTRE_IN_WORLD_M: Vec3 = Vec3::new(0.513, 0.487, 0.0);

/// Two cells of its endless length.
const LENGTH: usize = 2;

const VISCOSITY_M2_S: f32 = 1.0;
const ACCELERATION_M_S2: f64 = 1.0;

/// Until nothing changes any more: e^-14 of the slowest mode is left, 5.8 nu / R^2 a second.
const STEPS: usize = 100;
const STEP_S: f64 = 0.004;

/// Runs it.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for n in session.sizes(NAME) {
        session.tell(&format!("{NAME} n={n}"));
        let mut baseline = Baseline::steps(n, session.options)?;
        let solve = |_: &_| run_pipe(n, session.options);
        let measured = measure(session.options, n, &mut baseline, is_ours, solve)?;
        session.keep(measured, NAME, n);
    }
    Ok(())
}

/// From rest; the error is that of the discharge, over pi R^4 g / (8 nu).
pub fn run_pipe(n: usize, options: &Options) -> Result<Outcome, SetupError> {
    let grid = Grid { cells: [n, n, LENGTH], ..Grid::unit_cube(n) };
    let (centre_in_world_m, axis, radius_m) = (CENTRE_IN_WORLD_M, Vec3::Z, RADIUS_M);
    let setup = Setup {
        viscosity_m2_s: VISCOSITY_M2_S,
        sides: Sides::all(Side::FreeSlip).with(2, [Side::Periodic; 2]),
        walls: Walls::NoSlip,
        pool: options.pool.clone(),
        simd: options.simd,
        ..Setup::new(grid, Vessel::Cylinder { centre_in_world_m, axis, radius_m })
    };
    let mut flow = Flow::new(&setup)?;
    flow.set_force(&|_| ACCELERATION_M_S2 * DVec3::Z)?;
    let (mut spent, mut tally) = (Spent::default(), Tally::new());
    for _ in 0..STEPS {
        tally.count(spent.on(|| flow.step(STEP_S))?);
    }
    let length_m = f64::from(grid.extent_m().z);
    let discharge_m3_s = flow.momentum_n_s().z / f64::from(setup.density_kg_m3) / length_m;
    let exact_m3_s =
        PI * f64::from(RADIUS_M).powi(4) * ACCELERATION_M_S2 / (8.0 * f64::from(VISCOSITY_M2_S));
    let mut params = tally.params();
    params.extend([
        ("steps", Param::Number(STEPS as f64)),
        ("radius_cells", Param::Number(f64::from(RADIUS_M) * n as f64)),
    ]);
    let values = vec![("discharge_error", (discharge_m3_s / exact_m3_s - 1.0).abs())];
    Ok(Outcome { values, spent, steps: STEPS, cells: grid.len(), params })
}
