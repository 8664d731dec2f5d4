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

/// What is stirred.
struct Stirred {
    name: &'static str,
    make: fn(usize, f64, &Options) -> Setup,
    /// Viscosity and density of the second substance, per those of the liquid.
    thicker: f32,
    denser: f32,
}

const BOX: Stirred = Stirred {
    name: "frame-box",
    make: |n, viscosity_m2_s, options| cube(n, viscosity_m2_s, Sides::all(Side::FreeSlip), options),
    thicker: 1.0,
    denser: 1.0,
};

const FRAMES: [Stirred; 4] = [
    BOX,
    Stirred { name: "frame-bowl", make: bowl, ..BOX },
    Stirred { name: "frame-thick", thicker: 100.0, ..BOX },
    Stirred { name: "frame-dense", denser: 3.0, ..BOX },
];

const VISCOSITY_M2_S: f64 = 1e-3;
const CFL: f64 = 0.5;
const STEPS: usize = 24;

/// Runs the box and the bowl of like liquids, and the box of one that a substance makes thicker
/// from place to place, and of one that it makes denser.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    let sizes: &[usize] = if session.options.is_quick { &[64] } else { &[64, 128] };
    let options = Options { pool: Arc::new(Pool::new(2, true)), ..session.options.clone() };
    for stirred in &FRAMES {
        let name = stirred.name;
        for n in sizes.iter().copied().filter(|_| session.options.wants(name)) {
            session.tell(&format!("{name} n={n} on two threads"));
            let row = frames(stirred, n, &options)?;
            session.rows.push(row);
        }
    }
    Ok(())
}

fn frames(stirred: &Stirred, n: usize, options: &Options) -> Result<Row, SetupError> {
    let setup = &(stirred.make)(n, VISCOSITY_M2_S, options);
    let mut flow = Flow::new(setup)?;
    flow.set_velocity(&manufactured)?;
    let like = Properties::of_liquid(setup);
    let other = Properties {
        density_kg_m3: stirred.denser * like.density_kg_m3,
        viscosity_m2_s: stirred.thicker * like.viscosity_m2_s,
        ..like
    };
    let mut substances = Substances::new(setup, &[like, other]);
    let wavy = |p: Vec3| 0.2 + 0.1 * (9.0 * p.x).sin() * (7.0 * p.y).cos() * (8.0 * p.z).cos();
    substances.set_fraction(0, wavy)?;
    substances.set_fraction(1, |p| wavy(Vec3::new(p.z, p.x, p.y)))?;
    let dt_s = CFL / (2.0 * n as f64);
    let (mut wall_ms, mut cpu_ms, mut tally) = (Vec::new(), Vec::new(), Tally::new());
    // The first step starts the scheme, and the memory.
    for step in 0..=STEPS {
        let mut spent = Spent::default();
        let report = spent.on(|| {
            flow.set_mixture(&substances);
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
        ("thicker", Param::Number(f64::from(stirred.thicker))),
        ("denser", Param::Number(f64::from(stirred.denser))),
    ]);
    let row = bare_row(options, stirred.name, OURS, n, "step_ms_wall", median(wall_ms));
    Ok(Row { params, unit: "ms", ms: Some(median(cpu_ms)), ..row })
}
