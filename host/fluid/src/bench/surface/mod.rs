//! `bench surface`: how exactly the models of the surface swing and die, keep their volume, and
//! what a step takes; and what they are to reach ([`TARGETS`]).
//!
//! "Founding" is the sheet of springs (Mora 2008, RK4): times of waves are compared with its own,
//! at the same n, one after the other, several times over; medians count. Times are CPU times of
//! steps alone.

mod beside;
mod cost;
mod law;
mod order;
mod poke;
mod sheet;
mod standing;
mod swing;
#[cfg(test)]
mod tests;
mod volume;

use super::{
    Group, Options, Row,
    measure::bare_row,
    row::Params,
    target::{self, Target},
};
use crate::solver::SetupError;

/// The model that times are compared with.
const FOUNDING: &str = "spring";

/// The model that is exact in time.
const WAVE: &str = "wave";

/// The group.
pub const SURFACE: Group = Group {
    name: "surface",
    cases: NAMES,
    targets: TARGETS,
    step: ["dt_ms", "dt/ms"],
    word: "of",
    options,
    run,
};

/// Names of all cases.
pub const NAMES: &[&str] =
    &["frequency", "decay", "order", "volume", "step", "beside", "splash", "poke", "poke-water"];

const fn target(
    case: &'static str,
    method: &'static str,
    quantity: &'static str,
    at_most: f64,
) -> Target {
    Target { case, method, quantity, n: None, cfl: None, at_most, speedup: None }
}

/// All targets.
pub const TARGETS: &[Target] = &[
    target("frequency", WAVE, "worst_rel", 1e-3),
    target("frequency", FOUNDING, "worst_rel", 2e-2),
    target("decay", WAVE, "worst_rel", 1e-2),
    target("decay", FOUNDING, "worst_rel", 1e-2),
    target("order", FOUNDING, "order_less_4", 0.2),
    // Steps of 50 ms come as close as those of 1 ms.
    target("order", WAVE, "error_50ms_over_1ms", 1.0),
    target("volume", WAVE, "drift", 1e-6),
    target("volume", FOUNDING, "drift", 1e-6),
    Target { n: Some(128), ..target("step", WAVE, "step_ms", 0.3) },
    Target { n: Some(256), ..target("step", WAVE, "step_ms", 1.0) },
    // A look at two numbers.
    target("splash", WAVE, "with_over_without", 1.01),
    target("splash", FOUNDING, "with_over_without", 1.01),
];

fn options(is_quick: bool) -> Options {
    let sizes: &[usize] = if is_quick { &[16, 64] } else { &[16, 32, 64, 128, 256] };
    let given = if is_quick { Options::quick() } else { Options::full() };
    Options { methods: None, sizes: sizes.to_vec(), ..given }
}

/// A run of the group: how, and what came of it so far.
struct Session<'a> {
    options: &'a Options,
    rows: Vec<Row>,
    progress: &'a mut dyn FnMut(&str),
}

impl Session<'_> {
    fn wants(&self, case: &str) -> bool {
        self.options.wants(case)
    }

    /// The ladder of a case; empty if it is not wanted.
    fn sizes(&self, case: &str) -> Vec<usize> {
        if self.wants(case) { self.options.sizes.clone() } else { Vec::new() }
    }

    fn tell(&mut self, what: &str) {
        (self.progress)(what);
    }

    fn keep(&mut self, row: Row) {
        self.rows.push(target::judged(row, self.options.simd));
    }

    /// A row without times.
    fn row(&self, at: [&str; 2], n: usize, quantity: &'static str, value: f64) -> Row {
        let [case, method] = at;
        let row = bare_row(self.options, case, method, n, quantity, value);
        // No model of the surface has threads.
        Row { group: SURFACE.name, threads: Some(1), ..row }
    }
}

/// Parameters of a row of steps of this length.
fn steps_of(dt_s: f64) -> Params {
    // Rounded, as 1e3 times .001 is not 1.
    Params::from([("dt_ms", ((dt_s * 1e9).round() / 1e6).into())])
}

/// Runs the group. `progress` is told what comes next.
///
/// # Errors
/// [`SetupError`] if a model refuses an input, which none does for these cases.
pub fn run(options: &Options, progress: &mut dyn FnMut(&str)) -> Result<Vec<Row>, SetupError> {
    let mut session = Session { options, rows: Vec::new(), progress };
    standing::run(&mut session)?;
    order::run(&mut session)?;
    volume::run(&mut session)?;
    cost::run(&mut session)?;
    beside::run(&mut session)?;
    poke::run(&mut session)?;
    Ok(session.rows)
}
