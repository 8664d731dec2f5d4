//! Whether the volume stays while the surface is touched and pressed anywhere.

use glam::Vec3;
use oorandom::Rand64;

use super::{
    FOUNDING, Session, WAVE,
    sheet::{self, EDGE_M, WATER_M2_S},
};
use crate::{grid::Grid, simd::SimdClass, solver::SetupError, surface::Surface, vessel::Vessel};

/// Nodes along the edge.
const N: usize = 32;

/// Steps that are taken.
const STEPS: usize = 10_000;

/// Runs it, for each model over what it knows.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    if !session.wants("volume") {
        return Ok(());
    }
    let middle = 0.5 * EDGE_M as f32;
    let centre_in_world_m = Vec3::new(middle, middle, middle);
    let pot = Vessel::Pot { centre_in_world_m, radius_m: 0.97 * middle };
    let all = [
        (WAVE, "box", Vessel::Box),
        (FOUNDING, "box", Vessel::Box),
        (WAVE, "pot", pot.clone()),
        (FOUNDING, "pot", pot),
    ];
    for (model, name, vessel) in all {
        session.tell(&format!("volume {model} {name}"));
        let value = match drift(model, &vessel, STEPS, session.options.simd) {
            Err(SetupError::Unsupported(_)) => continue,
            measured => measured?,
        };
        let mut row = session.row(["volume", model], N, "drift", value);
        row.params = [("of", name.into()), ("steps", (STEPS as f64).into())].into();
        session.keep(row);
    }
    Ok(())
}

/// The largest volume gained or lost, as a part of what is displaced at that moment: the sum of
/// all heights over the sum of their magnitudes.
pub fn drift(
    model: &'static str,
    vessel: &Vessel,
    steps: usize,
    simd: SimdClass,
) -> Result<f64, SetupError> {
    let grid = Grid {
        cells: [N, N / 2, N],
        spacing_m: sheet::spacing_m(N) as f32,
        origin_in_world_m: Vec3::ZERO,
    };
    let mut surface = sheet::over(sheet::of_model(model), &grid, vessel, WATER_M2_S, simd)?;
    let mut draws = Rand64::new(1);
    let mut worst: f64 = 0.0;
    for step in 0..steps {
        molest(&mut surface, &mut draws, step);
        surface.step(5e-3);
        let sum = |value: fn(f64) -> f64| -> f64 {
            surface.height_m().iter().map(|y| value(f64::from(*y))).sum()
        };
        let displaced = sum(f64::abs);
        let share = if displaced > 0.0 { sum(|y| y).abs() / displaced } else { 0.0 };
        worst = super::standing::largest([worst, share].into_iter());
    }
    Ok(worst)
}

/// Touches somewhere, and presses every seventh time.
fn molest(surface: &mut Surface, draws: &mut Rand64, step: usize) {
    let mut draw = |most: f32| most * draws.rand_float() as f32;
    let at = Vec3::new(draw(EDGE_M as f32), 0.0, draw(EDGE_M as f32));
    surface.touch(at, 0.005 + draw(0.03), draw(0.4) - 0.2, draw(2.0));
    if step.is_multiple_of(7) {
        let slope = [draw(400.0) - 200.0, draw(400.0) - 200.0];
        surface.press(|at| slope[0] * at.x + slope[1] * at.z);
    }
}
