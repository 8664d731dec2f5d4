//! A blob of a substance, carried once around the middle of a turning box.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::{
    Options, Session,
    measure::{Baseline, Outcome, Spent, is_ours, measure},
    row::{Param, Params},
};
use crate::{
    grid::Grid,
    solver::{Setup, SetupError, Solver, flow::Flow},
    substance::{Properties, Substances},
    vessel::Vessel,
};

const NAME: &str = "blob";

/// Cells that the fastest point of a middle line crosses in a step.
const CFL: f64 = 0.9;

/// Runs it, where the target is even if the ladder ends below.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    let mut sizes = session.sizes(NAME);
    if !sizes.is_empty() && !sizes.contains(&64) {
        sizes.push(64);
    }
    for n in sizes {
        session.tell(&format!("{NAME} n={n}"));
        let mut baseline = Baseline::steps(n, session.options)?;
        let turn = |_: &_| run_blob(n, session.options);
        let measured = measure(session.options, n, &mut baseline, is_ours, turn)?;
        session.keep(measured, NAME, n);
    }
    Ok(())
}

/// (1 + cos(pi r / .15)) / 2 within r = .15 of a point a quarter of the box from its axis.
fn blob(point: Vec3) -> f32 {
    let r = point.distance(Vec3::new(0.5, 0.75, 0.25)) / 0.15;
    if r < 1.0 { 0.5 * (1.0 + (std::f32::consts::PI * r).cos()) } else { 0.0 }
}

/// One turn in 1 s; the flow is prescribed, and as deep as the blob needs it.
pub fn run_blob(n: usize, options: &Options) -> Result<Outcome, SetupError> {
    let setup = Setup {
        pool: options.pool.clone(),
        simd: options.simd,
        ..Setup::new(Grid { cells: [n, n, n / 2], ..Grid::unit_cube(n) }, Vessel::Box)
    };
    let mut flow = Flow::new(&setup)?;
    flow.set_velocity(&|p| TAU * DVec3::new(0.5 - p.y, p.x - 0.5, 0.0))?;
    let mut substances = Substances::new(&setup, &[Properties::of_liquid(&setup)]);
    substances.set_fraction(0, blob)?;
    let [mut start, mut end] = [(); 2].map(|()| vec![0.0; setup.grid.len()]);
    substances.copy_fraction(0, &mut start);
    let volume_m3 = substances.volume_m3(0);
    let steps = (0.5 * TAU * n as f64 / CFL).ceil() as usize;
    let (mut spent, mut substeps) = (Spent::default(), 0);
    for _ in 0..steps {
        substeps = spent.on(|| substances.step(&flow, 1.0 / steps as f64))?.substeps;
    }
    substances.copy_fraction(0, &mut end);
    let values = vec![
        ("rel_l2", relative_difference(&start, &end)),
        ("mass_change", (substances.volume_m3(0) / volume_m3 - 1.0).abs()),
    ];
    let params = Params::from([
        ("cfl", Param::Number(CFL)),
        ("steps", Param::Number(steps as f64)),
        ("substeps", Param::Number(f64::from(substeps))),
    ]);
    Ok(Outcome { values, spent, steps, cells: setup.grid.len(), params })
}

fn relative_difference(start: &[f32], end: &[f32]) -> f64 {
    let squares = |(error, norm): (f64, f64), (a, b): (&f32, &f32)| {
        (error + f64::from(a - b).powi(2), norm + f64::from(*a).powi(2))
    };
    let (error, norm) = start.iter().zip(end).fold((0.0, 0.0), squares);
    (error / norm).sqrt()
}
