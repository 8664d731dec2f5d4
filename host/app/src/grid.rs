//! How finely a scene is cut into cells.

use std::{str::FromStr, time::Instant};

use cauldron_fluid::{Pot, scenes::Scene};
use glam::DVec3;
use serde::Serialize;

use crate::{Failure, world::Options};

/// Finest and coarsest grid that is accepted.
const CELLS: std::ops::RangeInclusive<usize> = 8..=128;

/// The grids that are tried where the program is to choose.
const LADDER: [usize; 7] = [16, 24, 32, 48, 64, 96, 128];

/// Share of a step's length that its liquid may take; the rest is for fields and pictures.
const SHARE: f64 = 0.5;

/// Steps that warm a grid up, and steps that are timed.
const STEPS: [usize; 2] = [3, 5];

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridChoice {
    /// As fine as the machine keeps up with.
    Auto,
    /// Cells along the longest edge of the box.
    Cells(usize),
}

impl FromStr for GridChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        match text.parse() {
            Ok(n) if CELLS.contains(&n) => Ok(Self::Cells(n)),
            _ => Err(format!("it is {} to {}, or auto", CELLS.start(), CELLS.end())),
        }
    }
}

/// A grid that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// Cells along the longest edge.
    pub n: usize,
    /// Median of what a stirred step took.
    pub step_ms: f64,
}

/// Cuts `scene` as `choice` says. Returns what was tried, if the program was to choose: it takes
/// the finest grid whose steps take less than half of what they simulate, or the coarsest.
///
/// # Errors
/// [`Failure::Input`] if the scene makes no sense on that grid.
pub fn cut(
    scene: &mut Scene,
    choice: GridChoice,
    options: &Options,
) -> Result<Option<Vec<Tried>>, Failure> {
    let (n, tried) = match choice {
        GridChoice::Cells(n) => (n, None),
        GridChoice::Auto => {
            let budget_ms = SHARE * 1e3 * f64::from(scene.step_s);
            let (n, tried) = choose(scene, options, &LADDER, budget_ms)?;
            eprintln!("{}: {n} cells along the longest edge, by measurement", scene.name);
            (n, Some(tried))
        }
    };
    regrid(scene, n)?;
    Ok(tried)
}

fn regrid(scene: &mut Scene, n: usize) -> Result<(), Failure> {
    scene.regrid(n);
    scene.check().map_err(|wrong| Failure::Input(format!("--grid {n}: {wrong}")))
}

fn choose(
    scene: &Scene,
    options: &Options,
    ladder: &[usize],
    budget_ms: f64,
) -> Result<(usize, Vec<Tried>), Failure> {
    let mut tried = Vec::new();
    for &n in ladder {
        let mut scene = scene.clone();
        regrid(&mut scene, n)?;
        let step_ms = step_ms(&scene, options)?;
        tried.push(Tried { n, step_ms });
        if step_ms > budget_ms {
            break;
        }
    }
    let kept_up = tried.iter().rev().find(|tried| tried.step_ms <= budget_ms);
    Ok((kept_up.unwrap_or(&tried[0]).n, tried))
}

/// Median of what a step of the stirred pot takes.
fn step_ms(scene: &Scene, options: &Options) -> Result<f64, Failure> {
    let mut pot = Pot::new(scene, options.pool.clone(), options.simd)
        .map_err(|wrong| Failure::Input(wrong.to_string()))?;
    let dt_s = scene.step_s;
    let mut took_ms = Vec::new();
    for step in 0..STEPS[0] + STEPS[1] {
        // A newton, turning as a hand does that stirs.
        let (sin, cos) = (0.3 * step as f64).sin_cos();
        pot.place_probe(scene.story.start_m);
        pot.take(DVec3::new(cos, 0.0, sin) * f64::from(dt_s), 0.0, dt_s);
        pot.pour(1, dt_s);
        let start = Instant::now();
        pot.step(dt_s);
        took_ms.push(1e3 * start.elapsed().as_secs_f64());
    }
    let timed = &mut took_ms[STEPS[0]..];
    timed.sort_by(f64::total_cmp);
    Ok(timed[timed.len() / 2])
}

#[cfg(test)]
mod tests {
    use cauldron_fluid::scenes;

    use super::*;

    #[test]
    fn the_finest_grid_that_keeps_up_is_taken() {
        let scene = scenes::find("taylor-green").expect("it ships");
        let options = Options::new(1);
        // No machine needs an hour for a step, and none does it in no time.
        for (budget_ms, finest) in [(3.6e6, true), (0.0, false)] {
            let ladder = &LADDER[..2];
            let (n, tried) = choose(&scene, &options, ladder, budget_ms).expect("it makes sense");
            assert_eq!(n, if finest { LADDER[1] } else { LADDER[0] });
            assert_eq!(tried.len(), if finest { 2 } else { 1 });
            assert!(tried.iter().all(|tried| tried.step_ms > 0.0));
        }
    }

    #[test]
    fn a_grid_is_a_number_of_cells_or_auto() {
        assert_eq!("auto".parse(), Ok(GridChoice::Auto));
        assert_eq!("32".parse(), Ok(GridChoice::Cells(32)));
        for wrong in ["", "7", "129", "-1", "many"] {
            assert!(wrong.parse::<GridChoice>().is_err_and(|why| why.contains("auto")), "{wrong}");
        }
    }
}
