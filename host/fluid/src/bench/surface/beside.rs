//! What a surface that is awake costs a pot beside its own step: the pressure of the liquid below,
//! the drift of what fades, and looks ahead and below; as parts of a touched step.

use glam::{DVec3, Vec3};

use super::{
    Session, WAVE,
    cost::{DT_S, TOUCHED, stir},
    sheet::{self, DEPTH_M, WATER_M2_S},
};
use crate::{
    bench::{
        Options, Row,
        measure::{Spent, median},
    },
    grid::Grid,
    solver::{Setup, SetupError, Solver, flow::Flow},
    surface::{Surface, SurfaceParams},
    vessel::Vessel,
};

/// Cells along the edge of the liquid below.
const CELLS: usize = 32;

/// Nodes along the edge: whole numbers for each cell.
const SIZES: &[usize] = &[64, 128, 256];

/// How far is looked ahead: what it takes to compute a field, and to send it.
const AHEAD_S: f32 = 16e-3;

/// Nodes that are computed to be timed once.
const NODES: usize = 1 << 18;

/// A touched surface on a liquid that moves.
struct World {
    surface: Surface,
    flow: Flow,
}

/// What is done beside a step.
type Act = (&'static str, fn(&mut World));

const ACTS: &[Act] = &[
    ("press", |world| world.surface.press(|at| world.flow.lid_pressure_pa(at))),
    ("drift", |world| {
        world.surface.find_drift(0.0);
    }),
    // Of more than there is: a look whether it may matter.
    ("drift-left-out", |world| {
        world.surface.find_drift(f32::MAX);
    }),
    ("ahead", |world| world.surface.look_ahead(AHEAD_S)),
    ("below", |world| world.surface.look_below(BELOW)),
    ("asleep", |world| {
        world.surface.step(DT_S as f32);
    }),
];

/// A place 3 cm below the surface.
const BELOW: Vec3 = Vec3::new(0.13, (DEPTH_M - 0.03) as f32, 0.17);

/// Runs it.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    if !session.wants("beside") {
        return Ok(());
    }
    let is_quick = !session.options.sizes.contains(&256);
    for n in SIZES.iter().take(if is_quick { 1 } else { SIZES.len() }) {
        session.tell(&format!("beside n={n}"));
        for (what, act) in ACTS {
            let (ms, part) = measure(*n, session.options, (what, *act))?;
            keep(session, *n, what, ms, part);
        }
        let (ms, part) = measure_anew(*n, session.options)?;
        keep(session, *n, "below-anew", ms, part);
    }
    Ok(())
}

fn keep(session: &mut Session<'_>, n: usize, what: &'static str, ms: f64, part: f64) {
    let mut row = session.row(["beside", WAVE], n, "of_a_step", part);
    row.params.insert("of", what.into());
    session.keep(Row { ms: Some(ms), ..row });
}

/// Milliseconds that something takes, and its part of a step just before: medians.
fn measure(n: usize, options: &Options, (what, act): Act) -> Result<(f64, f64), SetupError> {
    let mut world = world(n, options)?;
    act(&mut world);
    if what == "asleep" {
        world.surface.set(|_, _| 0.0, |_, _| 0.0);
    }
    let mut step_of = self::world(n, options)?;
    let times = (NODES / (n * n)).max(2);
    let all = (0..options.repetitions.max(1)).map(|_| {
        let [mut steps, mut spent] = [Spent::default(); 2];
        steps.on(|| (0..times).for_each(|_| touched_step(&mut step_of.surface)));
        spent.on(|| (0..times).for_each(|_| act(&mut world)));
        let [step_ms, ms] = [steps, spent].map(|spent| spent.cpu.as_secs_f64() * 1e3);
        [ms / times as f64, ms / step_ms]
    });
    let all: Vec<[f64; 2]> = all.collect();
    let [ms, part] = [0, 1].map(|i| median(all.iter().map(|values| values[i]).collect()));
    Ok((ms, part))
}

/// The same of a look below where none was before, room and all.
fn measure_anew(n: usize, options: &Options) -> Result<(f64, f64), SetupError> {
    let [mut all_ms, mut parts] = [Vec::new(), Vec::new()];
    for _ in 0..options.repetitions.clamp(1, 3) {
        let World { mut surface, .. } = world(n, options)?;
        let [mut step, mut look] = [Spent::default(); 2];
        step.on(|| touched_step(&mut surface));
        look.on(|| surface.look_below(BELOW));
        let [step_ms, ms] = [step, look].map(|spent| spent.cpu.as_secs_f64() * 1e3);
        all_ms.push(ms);
        parts.push(ms / step_ms);
    }
    Ok((median(all_ms), median(parts)))
}

fn touched_step(surface: &mut Surface) {
    TOUCHED.1(surface);
    surface.step(DT_S as f32);
}

fn world(n: usize, options: &Options) -> Result<World, SetupError> {
    let spacing_m = sheet::spacing_m(CELLS);
    let grid = Grid {
        cells: [CELLS, (DEPTH_M / spacing_m).round() as usize, CELLS],
        spacing_m: spacing_m as f32,
        origin_in_world_m: Vec3::ZERO,
    };
    let mut flow = Flow::new(&Setup { simd: options.simd, ..Setup::new(grid, Vessel::Box) })?;
    flow.watch_lid();
    flow.push(BELOW, 0.02, DVec3::new(0.01, 0.02, 0.0))?;
    flow.step(DT_S)?;
    let params = SurfaceParams { nodes_per_cell: n / CELLS, ..sheet::of_model(WAVE) };
    let mut surface = sheet::over(params, &grid, &Vessel::Box, WATER_M2_S, options.simd)?;
    stir(&mut surface);
    // The first steps make room.
    (0..2).for_each(|_| touched_step(&mut surface));
    Ok(World { surface, flow })
}
