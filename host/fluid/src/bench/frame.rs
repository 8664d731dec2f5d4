//! Whole frames: a step of the flow and of two substances that fill the vessel, on two cores.

use std::sync::Arc;

use glam::Vec3;

use super::{
    Options, Session,
    bowl::bowl,
    case::manufactured,
    measure::{Spent, Tally, bare_row, cube, median},
    row::{Param, Row},
    target::OURS,
};
use crate::{
    pool::Pool,
    solver::{Setup, SetupError, Side, Sides, Solver, flow::Flow},
    substance::{Properties, Substances},
};

/// Makes what is stirred.
type Make = fn(usize, f64, &Options) -> Setup;

const FRAMES: [(&str, Make); 2] = [
    ("frame-box", |n, viscosity_m2_s, options| {
        cube(n, viscosity_m2_s, Sides::all(Side::FreeSlip), options)
    }),
    ("frame-bowl", bowl),
];

const VISCOSITY_M2_S: f64 = 1e-3;
const CFL: f64 = 0.5;
const STEPS: usize = 24;

/// Runs the box, and the bowl in the full run.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    let sizes: &[usize] = if session.options.is_quick { &[64] } else { &[64, 128] };
    let options = Options { pool: Arc::new(Pool::new(2, true)), ..session.options.clone() };
    for (name, make) in FRAMES {
        for n in sizes.iter().copied().filter(|_| session.options.wants(name)) {
            session.tell(&format!("{name} n={n} on two threads"));
            let row = frames(name, &make(n, VISCOSITY_M2_S, &options), n, &options)?;
            session.rows.push(row);
        }
    }
    Ok(())
}

fn frames(name: &str, setup: &Setup, n: usize, options: &Options) -> Result<Row, SetupError> {
    let mut flow = Flow::new(setup)?;
    flow.set_velocity(&manufactured)?;
    let mut substances = Substances::new(setup, &[Properties::of_liquid(setup); 2]);
    let wavy = |p: Vec3| 0.2 + 0.1 * (9.0 * p.x).sin() * (7.0 * p.y).cos() * (8.0 * p.z).cos();
    substances.set_fraction(0, wavy)?;
    substances.set_fraction(1, |p| wavy(Vec3::new(p.z, p.x, p.y)))?;
    let dt_s = CFL / (2.0 * n as f64);
    let (mut wall_ms, mut cpu_ms, mut tally) = (Vec::new(), Vec::new(), Tally::new());
    // The first step starts the scheme, and the memory.
    for step in 0..=STEPS {
        let mut spent = Spent::default();
        let report = spent.on(|| {
            let report = flow.step(dt_s)?;
            substances.step(&flow, dt_s).map(|_| report)
        })?;
        if step > 0 {
            tally.count(report);
            wall_ms.push(spent.wall.as_secs_f64() * 1e3);
            cpu_ms.push(spent.cpu.as_secs_f64() * 1e3);
        }
    }
    let mut params = tally.params();
    params.extend([
        ("cfl", Param::Number(CFL)),
        ("steps", Param::Number(STEPS as f64)),
        ("substances", Param::Number(substances.len() as f64)),
        ("viscosity_m2_s", Param::Number(VISCOSITY_M2_S)),
    ]);
    let row = bare_row(options, name, OURS, n, "step_ms_wall", median(wall_ms));
    Ok(Row { params, unit: "ms", ms: Some(median(cpu_ms)), ..row })
}
