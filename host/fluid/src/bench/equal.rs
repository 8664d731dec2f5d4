//! What speed and precision are worth in each other: ours against the repaired founding solver
//! on the manufactured flow at n = 32.

use super::{
    Options, Session,
    case::MMS,
    exact::run_case,
    measure::{bare_row, median},
    row::{Param, Row},
    target::OURS,
};
use crate::solver::{SetupError, find};

const REFERENCE: (&str, usize) = ("founding-repaired", 32);
const NAMES: [&str; 2] = ["equal-error", "equal-time"];

/// From coarse to fine.
const LADDER: [usize; 12] = [4, 5, 6, 8, 10, 12, 16, 24, 32, 48, 64, 96];

/// One run: its error and its whole CPU time.
struct Total {
    n: usize,
    error: f64,
    cpu_ms: f64,
}

/// Climbs the ladder in steps of half a cell until the reference's time is used up.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    if !NAMES.iter().any(|name| session.wants(name)) {
        return Ok(());
    }
    session.tell("mms at equal error and at equal time");
    let options = session.options;
    let reference = total(REFERENCE.0, REFERENCE.1, 1.0, options)?;
    let mut climbed = Vec::new();
    for n in LADDER {
        let step = total(OURS, n, 0.5, options)?;
        if step.cpu_ms > reference.cpu_ms {
            break;
        }
        climbed.push(step);
    }
    if let Some(ours) = climbed.iter().find(|total| total.error <= reference.error) {
        let ratio = ours.cpu_ms / reference.cpu_ms;
        session.rows.push(row(options, NAMES[0], "time_ratio", ratio, ours, &reference));
    }
    if let Some(ours) = climbed.last() {
        let ratio = ours.error / reference.error;
        session.rows.push(row(options, NAMES[1], "error_ratio", ratio, ours, &reference));
    }
    session.rows.retain(|row| !NAMES.contains(&row.case.as_str()) || options.wants(&row.case));
    Ok(())
}

fn total(method: &'static str, n: usize, cfl: f64, options: &Options) -> Result<Total, SetupError> {
    let row = find(method).ok_or(SetupError::Unsupported("the index lacks a solver"))?;
    let repetitions = if n < 32 { options.repetitions.max(1) } else { 1 };
    let runs = (0..repetitions).map(|_| run_case(&MMS, row, n, cfl, options));
    let runs = runs.collect::<Result<Vec<_>, _>>()?;
    let cpu_ms = median(runs.iter().map(|run| run.spent.cpu.as_secs_f64() * 1e3).collect());
    let error = runs.first().map_or(f64::NAN, |run| run.values[0].1);
    Ok(Total { n, error, cpu_ms })
}

fn row(
    options: &Options,
    case: &'static str,
    quantity: &'static str,
    value: f64,
    ours: &Total,
    reference: &Total,
) -> Row {
    let mut row = bare_row(options, case, OURS, ours.n, quantity, value);
    row.params.extend([
        ("rel_l2", Param::Number(ours.error)),
        ("total_ms", Param::Number(ours.cpu_ms)),
        ("reference", Param::Word(REFERENCE.0.to_owned())),
        ("reference_n", Param::Number(reference.n as f64)),
        ("reference_rel_l2", Param::Number(reference.error)),
        ("reference_total_ms", Param::Number(reference.cpu_ms)),
    ]);
    row
}
