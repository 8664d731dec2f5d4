//! How the error of one mode depends on the length of the step.

use std::f64::consts::PI;

use super::{
    FOUNDING, Session, WAVE, law,
    law::Root,
    sheet::{self, EDGE_M, WATER_M2_S},
};
use crate::{simd::SimdClass, solver::SetupError, surface::SurfaceParams};

/// Four nodes a wave.
const N: usize = 32;

/// Of springs: radians of the mode in a step. Twice this is within one step of RK4, half of it
/// leaves errors a thousand times above rounding.
const RADIANS: f64 = 0.2;

/// Of waves: time after which errors are compared.
const LASTS_S: f64 = 2.0;

/// Runs it.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    if !session.wants("order") {
        return Ok(());
    }
    session.tell("order");
    let simd = session.options.simd;
    let order = of_springs(simd)?;
    for (quantity, value) in [("order", order), ("order_less_4", (order - 4.0).abs())] {
        let row = session.row(["order", FOUNDING], N, quantity, value);
        session.keep(row);
    }
    let [long, short] = [50e-3, 1e-3].map(|dt_s| of_wave(dt_s, simd));
    let (long, short) = (long?, short?);
    for (quantity, value) in
        [("error_50ms", long), ("error_1ms", short), ("error_50ms_over_1ms", long / short)]
    {
        let row = session.row(["order", WAVE], N, quantity, value);
        session.keep(row);
    }
    Ok(())
}

/// log2 of the ratio of errors with twice the step and with it.
pub fn of_springs(simd: SimdClass) -> Result<f64, SetupError> {
    let params = sheet::of_model(FOUNDING);
    let root = law::of_strip(&params, wavenumber_per_m(), N);
    let dt_s = RADIANS / root.y;
    let long = error(params, root, [N, 2], 2.0 * dt_s, 40, simd)?;
    Ok((long / error(params, root, [N, 2], dt_s, 80, simd)?).log2())
}

fn of_wave(dt_s: f64, simd: SimdClass) -> Result<f64, SetupError> {
    let params = sheet::of_model(WAVE);
    let root = law::of_water(&params, wavenumber_per_m(), WATER_M2_S);
    error(params, root, [N, N], dt_s, (LASTS_S / dt_s).round() as usize, simd)
}

fn wavenumber_per_m() -> f64 {
    PI * (N / 2) as f64 / EDGE_M
}

/// How far amplitude and speed are off after some steps, as a part of the first amplitude. Not a
/// number if a step was taken in parts.
fn error(
    params: SurfaceParams,
    root: Root,
    nodes: [usize; 2],
    dt_s: f64,
    steps: usize,
    simd: SimdClass,
) -> Result<f64, SetupError> {
    let mut surface = sheet::over_box(params, N, nodes, WATER_M2_S, simd)?;
    let height_m = 1e-3;
    let shape = |x: f32| (wavenumber_per_m() * f64::from(x)).cos();
    surface.set(|x, _| (height_m * shape(x)) as f32, |_, _| 0.0);
    let dt_s = dt_s as f32;
    let parts: u32 = (0..steps).map(|_| surface.step(dt_s).substeps).sum();
    if parts as usize != steps {
        return Ok(f64::NAN);
    }
    let first = f64::from(surface.lattice().origin_in_world_m.x);
    let crest = height_m * shape(first as f32);
    let [a, w] = law::let_go(root, f64::from(dt_s) * steps as f64);
    let (height_m, speed_m_s) = (surface.height_m()[0], surface.speed_m_s()[0]);
    let off = f64::from(height_m) / crest - a;
    Ok(off.hypot((f64::from(speed_m_s) / crest - w) / root.y))
}
