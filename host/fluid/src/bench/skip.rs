//! What a scene lacks costs nothing: rest against stirring, a plume against a full vessel, and
//! each feature against a plain step.

use glam::Vec3;

use super::{
    Options, Session,
    bowl::bowl,
    case::manufactured,
    measure::{Spent, bare_row, cube, median},
    row::{Param, Params, Row},
    target::OURS,
};
use crate::solver::{
    Refused, Setup, SetupError, Side, Sides, Solver,
    flow::{Flow, Looks, Medium},
};
use crate::substance::{Properties, Substances};

const N: usize = 64;
const VISCOSITY_M2_S: f64 = 1e-3;
/// Half a cell at the speed of the manufactured flow.
const DT_S: f64 = 0.25 / N as f64;
const STEPS: usize = 12;

/// Runs both shares, and in the full run the table of features.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for (name, run) in [("at-rest", at_rest as fn(&Options) -> _), ("plume", plume)] {
        if session.wants(name) {
            session.tell(&format!("{name} n={N}"));
            let (value, ms, params): (f64, f64, Params) = run(session.options)?;
            let row = bare_row(session.options, name, OURS, N, "time_share", value);
            session.rows.push(Row { ms: Some(ms), params, ..row });
        }
    }
    if session.wants("features") && !session.options.is_quick {
        features(session)?;
    }
    Ok(())
}

/// Median CPU time in milliseconds of what `step` does.
fn median_ms(mut step: impl FnMut() -> Result<(), Refused>) -> Result<f64, Refused> {
    // The first step starts the scheme, and the memory.
    step()?;
    let mut all = Vec::new();
    for _ in 0..STEPS {
        let mut spent = Spent::default();
        spent.on(&mut step)?;
        all.push(spent.cpu.as_secs_f64() * 1e3);
    }
    Ok(median(all))
}

fn stirred(setup: &Setup) -> Result<Flow, SetupError> {
    let mut flow = Flow::new(setup)?;
    flow.set_velocity(&manufactured)?;
    Ok(flow)
}

/// One dye, with `fraction` of it.
fn dyed(setup: &Setup, fraction: impl Fn(Vec3) -> f32) -> Result<Substances, SetupError> {
    let mut substances = Substances::new(setup, &[Properties::of_liquid(setup)]);
    substances.set_fraction(0, fraction)?;
    Ok(substances)
}

fn at_rest(options: &Options) -> Result<(f64, f64, Params), SetupError> {
    let setup = cube(N, VISCOSITY_M2_S, Sides::all(Side::NoSlip), options);
    let ms = |mut flow: Flow| -> Result<f64, SetupError> {
        let mut substances = dyed(&setup, |p| 0.5 * p.x)?;
        // As many steps as the clock can tell.
        let once = || {
            for _ in 0..10 {
                flow.step(DT_S)?;
                substances.step(&flow, DT_S)?;
            }
            Ok(())
        };
        Ok(median_ms(once)? / 10.0)
    };
    let (moving_ms, resting_ms) = (ms(stirred(&setup)?)?, ms(Flow::new(&setup)?)?);
    let params = Params::from([("stirred_ms", Param::Number(moving_ms))]);
    Ok((resting_ms / moving_ms, resting_ms, params))
}

/// A column of a tenth of the box, against a substance that fills it.
fn plume(options: &Options) -> Result<(f64, f64, Params), SetupError> {
    let setup = cube(N, VISCOSITY_M2_S, Sides::all(Side::FreeSlip), options);
    let mut flow = stirred(&setup)?;
    flow.project();
    let cost = |half_width_m: f32| -> Result<(f64, u64), SetupError> {
        let is_inside = |x: f32| (x - 0.5).abs() < half_width_m;
        let mut cells = 0;
        let mut substances =
            dyed(&setup, |p| if is_inside(p.x) && is_inside(p.z) { 0.8 } else { 0.0 })?;
        let ms = median_ms(|| {
            cells += substances.step(&flow, DT_S)?.cells_computed;
            Ok(())
        })?;
        Ok((ms, cells))
    };
    let ((plume_ms, cells), (whole_ms, all)) = (cost(0.158)?, cost(1.0)?);
    let params = Params::from([("cells_share", Param::Number(cells as f64 / all as f64))]);
    Ok((plume_ms / whole_ms, plume_ms, params))
}

/// What a scene may have, at `n` cells.
type Feature = fn(usize, &Options) -> Result<(Flow, Option<Substances>), SetupError>;

const FEATURES: [(&str, Feature); 10] = [
    ("inviscid", |n, options| plain(n, 0.0, options)),
    ("viscosity", |n, options| plain(n, VISCOSITY_M2_S, options)),
    ("thick", |n, options| {
        let (mut flow, _) = plain(n, 1.0, options)?;
        flow.set_force(&|p| 20.0 * manufactured(p))?;
        Ok((flow, None))
    }),
    ("walls", |n, options| Ok((stirred(&bowl(n, VISCOSITY_M2_S, options))?, None))),
    ("body-force", |n, options| {
        let (mut flow, _) = plain(n, 0.0, options)?;
        flow.set_force(&manufactured)?;
        Ok((flow, None))
    }),
    ("substance", |n, options| {
        let setup = cube(n, 0.0, Sides::all(Side::FreeSlip), options);
        let substances = dyed(&setup, |p| 0.2 + 0.1 * (9.0 * p.x).sin() * (7.0 * p.y).cos())?;
        Ok((stirred(&setup)?, Some(substances)))
    }),
    ("looks", |n, options| {
        let (mut flow, _) = plain(n, 0.0, options)?;
        flow.set_looks(Looks { confinement_per_s: 1.0, smagorinsky: 0.1 })?;
        Ok((flow, None))
    }),
    ("buoyancy", |n, options| made_of(n, options, |x| (1000.0 + 50.0 * x, VISCOSITY_M2_S))),
    ("unlike-viscosities", |n, options| made_of(n, options, |x| (1000.0, 1e-3 * 1e3f64.powf(x)))),
    ("unlike-weights", |n, options| made_of(n, options, |x| (1000.0 * 10f64.powf(x), 1e-3))),
];

fn plain(
    n: usize,
    viscosity_m2_s: f64,
    options: &Options,
) -> Result<(Flow, Option<Substances>), SetupError> {
    Ok((stirred(&cube(n, viscosity_m2_s, Sides::all(Side::FreeSlip), options))?, None))
}

/// Liquid whose density and viscosity follow x.
fn made_of(
    n: usize,
    options: &Options,
    medium: fn(f64) -> (f64, f64),
) -> Result<(Flow, Option<Substances>), SetupError> {
    let setup = Setup {
        gravity_m_s2: Vec3::NEG_Y,
        ..cube(n, VISCOSITY_M2_S, Sides::all(Side::FreeSlip), options)
    };
    let mut flow = stirred(&setup)?;
    flow.set_medium(&|p| {
        let (density_kg_m3, viscosity_m2_s) = medium(p.x);
        Medium { density_kg_m3, viscosity_m2_s }
    })?;
    Ok((flow, None))
}

fn features(session: &mut Session<'_>) -> Result<(), SetupError> {
    for n in [32, 64] {
        let mut plain_ms = None;
        for (name, make) in FEATURES {
            session.tell(&format!("features n={n} {name}"));
            let (mut flow, mut substances) = make(n, session.options)?;
            let dt_s = 0.25 / n as f64;
            let mut parts = 0;
            let ms = median_ms(|| {
                parts = flow.step(dt_s)?.substeps;
                substances.as_mut().map_or(Ok(()), |all| all.step(&flow, dt_s).map(|_| ()))
            })?;
            let plain_ms = *plain_ms.get_or_insert(ms);
            let row =
                bare_row(session.options, "features", OURS, n, "times_a_plain_step", ms / plain_ms);
            let params = Params::from([
                ("feature", Param::Word(name.to_owned())),
                ("substeps", Param::Number(f64::from(parts))),
            ]);
            session.rows.push(Row { ms: Some(ms), params, ..row });
        }
    }
    Ok(())
}
