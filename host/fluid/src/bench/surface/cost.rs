//! What a step takes, and what looking for drops adds to it.

use glam::Vec3;

use super::{
    FOUNDING, Session, WAVE,
    sheet::{self, EDGE_M, WATER_M2_S},
    steps_of,
};
use crate::{
    bench::{
        Row,
        measure::{Spent, median},
    },
    grid::Grid,
    simd::SimdClass,
    solver::{Setup, SetupError, flow::Flow},
    splash::{Below, Splash},
    substance::Substances,
    surface::Surface,
    vessel::Vessel,
};

/// Length of the steps, two to a cycle of the fluid's own at 100 Hz.
pub const DT_S: f64 = 5e-3;

/// Nodes that are computed to be timed once.
const NODES: usize = 1 << 20;

/// Sizes that targets are for.
const ASKED: [usize; 2] = [128, 256];

/// What is done to a surface before a step.
pub type State = (&'static str, fn(&mut Surface));

/// The probe of 12 mm presses and damps.
pub const TOUCHED: State =
    ("touched", |surface| surface.touch(Vec3::new(0.13, 0.08, 0.17), 12e-3, -0.05, 1.0));

/// All that steps are timed in.
const STATES: [State; 3] = [("untouched", |_| ()), TOUCHED, ("asleep", |_| ())];

/// Runs it.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    let mut sizes = session.sizes("step");
    if !sizes.is_empty() {
        sizes.extend(ASKED.into_iter().filter(|n| !session.options.sizes.contains(n)));
    }
    for n in sizes {
        session.tell(&format!("step n={n}"));
        for (place, (state, _)) in STATES.iter().enumerate() {
            let [ms, ratios] = race(n, place, session)?;
            for (model, ms, ratio) in
                [(FOUNDING, &ms[0], None), (WAVE, &ms[1], Some(median(ratios[1].clone())))]
            {
                let ms = median(ms.clone());
                let mut params = steps_of(DT_S);
                params.insert("of", (*state).into());
                let row = session.row(["step", model], n, "step_ms", ms);
                let unit = "ms";
                session.keep(Row { params, unit, ms: Some(ms), ratio_to_founding: ratio, ..row });
            }
        }
    }
    if session.wants("splash") {
        session.tell("splash");
        for model in [WAVE, FOUNDING] {
            let n = NODES_PER_CELL * CELLS;
            let value = splash(model, session.options.repetitions, session.options.simd)?;
            let row = session.row(["splash", model], n, "with_over_without", value);
            session.keep(row);
        }
    }
    Ok(())
}

/// Milliseconds a step of springs and of waves, and their ratios to the springs' just before.
fn race(n: usize, state: usize, session: &Session<'_>) -> Result<[[Vec<f64>; 2]; 2], SetupError> {
    let (name, act) = STATES[state];
    let mut surfaces = Vec::new();
    for model in [FOUNDING, WAVE] {
        let params = sheet::of_model(model);
        let mut surface = sheet::over_box(params, n, [n; 2], WATER_M2_S, session.options.simd)?;
        if name != "asleep" {
            stir(&mut surface);
        }
        // The first step makes room.
        act(&mut surface);
        surface.step(DT_S as f32);
        surfaces.push(surface);
    }
    let steps = (NODES / (n * n)).clamp(8, 1000);
    let [mut all_ms, mut ratios] = [[Vec::new(), Vec::new()], [Vec::new(), Vec::new()]];
    for _ in 0..session.options.repetitions.max(1) {
        for (place, surface) in surfaces.iter_mut().enumerate() {
            let mut spent = Spent::default();
            spent.on(|| {
                for _ in 0..steps {
                    act(surface);
                    surface.step(DT_S as f32);
                }
            });
            let ms = spent.cpu.as_secs_f64() * 1e3 / steps as f64;
            all_ms[place].push(ms);
            let founding_ms = all_ms[0].last().copied().unwrap_or(f64::NAN);
            ratios[place].push(ms / founding_ms);
        }
    }
    Ok([all_ms, ratios])
}

/// Gentle waves of all directions, so that no number is 0.
pub fn stir(surface: &mut Surface) {
    let edge_m = EDGE_M as f32;
    surface.set(|x, z| 1e-3 * ((9.0 * x).sin() + (x * z / edge_m * 70.0).cos()), |_, _| 0.0);
}

/// Cells along the edge of the liquid below, which is not what is timed ...
const CELLS: usize = 16;

/// ... and nodes along each of them.
const NODES_PER_CELL: usize = 8;

/// Time of a step and a look for drops over that of the step alone, of a surface that does not
/// break.
pub fn splash(model: &'static str, repetitions: usize, simd: SimdClass) -> Result<f64, SetupError> {
    let grid = Grid {
        cells: [CELLS, CELLS / 4, CELLS],
        spacing_m: sheet::spacing_m(CELLS) as f32,
        origin_in_world_m: Vec3::ZERO,
    };
    let setup = Setup { simd, ..Setup::new(grid, Vessel::Box) };
    let (mut flow, mut substances) = (Flow::new(&setup)?, Substances::new(&setup, &[]));
    let mut splash = Splash::new(setup.density_kg_m3, 9.81);
    let params =
        crate::surface::SurfaceParams { nodes_per_cell: NODES_PER_CELL, ..sheet::of_model(model) };
    let mut surface = sheet::over(params, &grid, &Vessel::Box, WATER_M2_S, simd)?;
    surface.set(|x, _| 2e-4 * (40.0 * x).cos(), |_, _| 0.0);
    let mut shares = Vec::new();
    for _ in 0..repetitions.max(1) {
        let [mut steps, mut looks] = [Spent::default(); 2];
        for _ in 0..64 {
            steps.on(|| surface.step(DT_S as f32));
        }
        looks.on(|| {
            for _ in 0..64 {
                let (surface, flow) = (&mut surface, &mut flow);
                splash.step(Below { surface, flow, substances: &mut substances }, DT_S as f32);
            }
        });
        shares.push(1.0 + looks.cpu.as_secs_f64() / steps.cpu.as_secs_f64());
    }
    // Were a drop torn, it would not be the cost of nothing.
    Ok(if splash.books().drops == 0 { median(shares) } else { f64::NAN })
}
