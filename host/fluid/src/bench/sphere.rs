//! The drag on a fixed obstacle: a ball in a periodic box, that is a cubic array of balls, in a
//! slow stream (Re = 2 a U / nu of some 0.05), against the series of Hasimoto (J. Fluid Mech. 5,
//! 1959):
//! ```text
//! F = 6 pi mu a U / (1 - 1.7601 c^(1/3) + c - 1.5593 c^2),   c = 4 pi a^3 / (3 L^3)
//! ```
//! U being the mean over the whole box. At c = 0.0335 what the series leaves out is about 1e-3 of
//! it.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::{
    Options, Session,
    measure::{Baseline, Outcome, Spent, Tally, cube, is_ours, measure},
    row::Param,
};
use crate::solver::{Obstacle, Setup, SetupError, Side, Sides, Solver, Walls, flow::Flow};

const NAME: &str = "sphere";
const RADIUS_M: f32 = 0.2;

/// Off the symmetry of the grid: no luck in how it is cut.
const CENTRE_IN_WORLD_M: Vec3 = Vec3::new(0.47, 0.52, 0.51);

const VISCOSITY_M2_S: f64 = 1.0;
const ACCELERATION_M_S2: f64 = 1.0;

/// Until nothing changes any more: what is left falls by e in some 0.11 s.
const STEPS: usize = 50;
const STEP_S: f64 = 0.02;

/// Runs it.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for n in session.sizes(NAME) {
        session.tell(&format!("{NAME} n={n}"));
        let mut baseline = Baseline::steps(n, session.options)?;
        let solve = |_: &_| run_sphere(n, session.options);
        let measured = measure(session.options, n, &mut baseline, is_ours, solve)?;
        session.keep(measured, NAME, n);
    }
    Ok(())
}

/// From rest; the error is that of the measured force, which has what the acceleration pulls of the
/// ball's own volume added to it, over what the series says for the measured mean velocity.
pub fn run_sphere(n: usize, options: &Options) -> Result<Outcome, SetupError> {
    let sides = Sides::all(Side::Periodic);
    let setup = Setup { walls: Walls::NoSlip, ..cube(n, VISCOSITY_M2_S, sides, options) };
    let mut flow = Flow::new(&setup)?;
    let ball = flow.add_obstacle(Obstacle::sphere(CENTRE_IN_WORLD_M, RADIUS_M))?;
    flow.set_force(&|_| ACCELERATION_M_S2 * DVec3::X)?;
    let (mut spent, mut tally) = (Spent::default(), Tally::new());
    for _ in 0..STEPS {
        tally.count(spent.on(|| flow.step(STEP_S))?);
    }
    let (density_kg_m3, radius_m) = (f64::from(setup.density_kg_m3), f64::from(RADIUS_M));
    let mean_m_s = flow.momentum_n_s().x / density_kg_m3;
    let share = 4.0 / 3.0 * PI * radius_m.powi(3);
    let stokes_n = 6.0 * PI * density_kg_m3 * VISCOSITY_M2_S * radius_m * mean_m_s;
    let exact_n = stokes_n / (1.0 - 1.7601 * share.cbrt() + share - 1.5593 * share * share);
    let drag_n = flow.force_on_n(ball)?.x + density_kg_m3 * ACCELERATION_M_S2 * share;
    let mut params = tally.params();
    params.extend([
        ("steps", Param::Number(STEPS as f64)),
        ("radius_cells", Param::Number(radius_m * n as f64)),
        ("reynolds", Param::Number(2.0 * radius_m * mean_m_s / VISCOSITY_M2_S)),
    ]);
    let values = vec![("drag_error", (drag_n / exact_n - 1.0).abs())];
    Ok(Outcome { values, spent, steps: STEPS, cells: setup.grid.len(), params })
}
