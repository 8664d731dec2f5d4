//! `bench fluid`: every solver of the index against exact solutions, and against the founding
//! solver's time.
//!
//! All solvers are given the same steps, interleaved, several times over; the median counts.
//! The time is CPU time of the whole process, so of all threads, and of [`Solver::step`] or
//! [`Solver::project`] alone: forces and exact solutions are evaluated outside of it.

pub mod case;
mod row;

use std::{collections::BTreeMap, sync::Arc, time::Duration};

use cpu_time::ProcessTime;

use self::case::{CASES, Case, divergent};
pub use self::row::Row;
use crate::{
    grid::Grid,
    pool::Pool,
    simd::SimdClass,
    solver::{INDEX, Setup, SetupError, Solver, SolverRow, StepReport},
    vessel::Vessel,
};

/// Projections that are timed together, as one alone is too short.
const PROJECTIONS: usize = 8;

/// What our solver may leave of a divergence at n = 32.
const DIVERGENCE_TARGET_AT_32: f64 = 1e-4;

/// How to run the benchmarks.
#[derive(Clone)]
pub struct Options {
    /// Cells along an edge, one run for each.
    pub sizes: Vec<usize>,
    /// Times that everything is repeated.
    pub repetitions: usize,
    /// Only the case of this name, if given.
    pub case: Option<String>,
    /// The threads to work with.
    pub pool: Arc<Pool>,
    /// The vector width to work at.
    pub simd: SimdClass,
}

impl Default for Options {
    /// The quick run: 16 and 32 cells, three times, on one thread.
    fn default() -> Self {
        Self {
            sizes: vec![16, 32],
            repetitions: 3,
            case: None,
            pool: Arc::new(Pool::inline()),
            simd: SimdClass::detect(),
        }
    }
}

/// One run of one solver.
struct Outcome {
    value: f64,
    time: Duration,
    params: BTreeMap<&'static str, f64>,
}

/// Runs the group. `progress` is told what comes next.
///
/// # Errors
/// [`SetupError`] if a solver refuses an input, which none does for these cases.
pub fn run(options: &Options, progress: &mut dyn FnMut(&str)) -> Result<Vec<Row>, SetupError> {
    let mut rows = Vec::new();
    let is_wanted = |name: &str| options.case.as_deref().is_none_or(|wanted| wanted == name);
    for &n in &options.sizes {
        for case in CASES.iter().filter(|case| is_wanted(case.name)) {
            progress(&format!("{} n={n}", case.name));
            let outcomes = interleave(options, |solver| run_case(case, solver, n, options))?;
            let target = (n == 32).then_some(case.target_at_32);
            rows.extend(rows_of(options, n, (case.name, "rel_l2"), target, &outcomes));
        }
        if is_wanted("divergence") {
            progress(&format!("divergence n={n}"));
            let outcomes = interleave(options, |solver| run_divergence(solver, n, options))?;
            let target = (n == 32).then_some(DIVERGENCE_TARGET_AT_32);
            let name = ("divergence", "after_over_before");
            rows.extend(rows_of(options, n, name, target, &outcomes));
        }
    }
    Ok(rows)
}

/// Solver A, B, ..., A, B, ...: the outcomes of each solver, in the order of the index.
fn interleave(
    options: &Options,
    mut run: impl FnMut(&SolverRow) -> Result<Outcome, SetupError>,
) -> Result<Vec<Vec<Outcome>>, SetupError> {
    let mut outcomes: Vec<_> = INDEX.iter().map(|_| Vec::new()).collect();
    for _ in 0..options.repetitions.max(1) {
        for (solver, outcomes) in INDEX.iter().zip(&mut outcomes) {
            outcomes.push(run(solver)?);
        }
    }
    Ok(outcomes)
}

fn make(
    solver: &SolverRow,
    n: usize,
    viscosity_m2_s: f64,
    options: &Options,
) -> Result<Box<dyn Solver>, SetupError> {
    (solver.make)(&Setup {
        viscosity_m2_s: viscosity_m2_s as f32,
        pool: Arc::clone(&options.pool),
        simd: options.simd,
        ..Setup::new(Grid::unit_cube(n), Vessel::Box)
    })
}

fn run_case(
    case: &Case,
    row: &SolverRow,
    n: usize,
    options: &Options,
) -> Result<Outcome, SetupError> {
    let mut solver = make(row, n, case.viscosity_m2_s, options)?;
    solver.set_velocity(&case.velocity_m_s)?;
    if let Some(force) = case.force_m_s2 {
        solver.set_force(&force)?;
    }
    let steps = case.steps(n);
    let dt_s = case.end_s / steps as f64;
    let (mut time, mut report, mut guard_actions) = (Duration::ZERO, StepReport::at_rest(), 0);
    for step in 0..steps {
        let [start, end] = [step, step + 1].map(|end| case.force_scale(end as f64 * dt_s));
        solver.scale_force(start, end)?;
        let from = ProcessTime::now();
        report = solver.step(dt_s)?;
        time += from.elapsed();
        guard_actions += report.guard_actions;
    }
    let params = BTreeMap::from([
        ("viscosity_m2_s", case.viscosity_m2_s),
        ("end_s", case.end_s),
        ("steps", steps as f64),
        ("substeps", f64::from(report.substeps)),
        ("guard_actions", f64::from(guard_actions)),
    ]);
    Ok(Outcome { value: relative_error(case, &*solver), time: time / steps as u32, params })
}

/// |u - exact| / |exact| over the solver's own points.
fn relative_error(case: &Case, solver: &dyn Solver) -> f64 {
    let (mut error, mut norm) = (0.0, 0.0);
    solver.visit(&mut |point, component, value| {
        let exact = case.exact(point, case.end_s)[component];
        error += (value - exact).powi(2);
        norm += exact.powi(2);
    });
    (error / norm).sqrt()
}

fn run_divergence(row: &SolverRow, n: usize, options: &Options) -> Result<Outcome, SetupError> {
    let mut solver = make(row, n, 0.0, options)?;
    let (mut time, mut value) = (Duration::ZERO, 0.0);
    for _ in 0..PROJECTIONS {
        solver.set_velocity(&divergent)?;
        let before = solver.divergence_l2_per_s();
        let from = ProcessTime::now();
        solver.project();
        time += from.elapsed();
        value = solver.divergence_l2_per_s() / before;
    }
    Ok(Outcome { value, time: time / PROJECTIONS as u32, params: BTreeMap::new() })
}

fn rows_of(
    options: &Options,
    n: usize,
    (case, quantity): (&str, &'static str),
    target: Option<f64>,
    outcomes: &[Vec<Outcome>],
) -> Vec<Row> {
    let ms: Vec<_> = outcomes.iter().map(|outcomes| median_ms(outcomes)).collect();
    let founding = INDEX.iter().position(|row| row.name == "founding").map(|at| ms[at]);
    let rows = INDEX.iter().zip(outcomes).zip(ms).filter_map(|((solver, outcomes), ms)| {
        let last = outcomes.last()?;
        let row = Row {
            group: "fluid",
            case: case.to_owned(),
            method: solver.name.to_owned(),
            n: Some(n),
            params: last.params.clone(),
            quantity,
            value: last.value,
            unit: "1",
            target: None,
            pass: None,
            ms: Some(ms),
            ratio_to_founding: founding.map(|founding| ms / founding),
            simd: Some(options.simd.name()),
            threads: Some(options.pool.threads()),
        };
        Some(row.with_target(target.filter(|_| solver.known_misses.is_empty())))
    });
    rows.collect()
}

fn median_ms(outcomes: &[Outcome]) -> f64 {
    let mut times: Vec<_> = outcomes.iter().map(|outcome| outcome.time).collect();
    times.sort_unstable();
    times.get(times.len() / 2).map_or(0.0, |time| time.as_secs_f64() * 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_complete_and_only_ours_have_targets() {
        let options = Options { sizes: vec![8], repetitions: 1, ..Options::default() };
        let mut told = 0;
        let rows = run(&options, &mut |_| told += 1).expect("no input is refused");
        assert_eq!((rows.len(), told), (3 * INDEX.len(), 3));
        for row in &rows {
            assert!(row.value.is_finite() && row.ms.is_some_and(|ms| ms > 0.0), "{row:?}");
            assert_eq!((row.target, row.pass), (None, None), "there are targets at 32 only");
            assert_eq!(row.ratio_to_founding == Some(1.0), row.method == "founding");
        }
    }

    #[test]
    fn every_known_miss_is_within_its_brackets() {
        for solver in INDEX {
            for miss in solver.known_misses {
                let options = Options { repetitions: 1, ..Options::default() };
                let outcome = match CASES.iter().find(|case| case.name == miss.case) {
                    Some(case) => run_case(case, solver, miss.n, &options),
                    None => run_divergence(solver, miss.n, &options),
                };
                let value = outcome.expect("no input is refused").value;
                assert!((miss.at_least..=miss.at_most).contains(&value), "{miss:?}: {value}");
            }
        }
    }

    #[test]
    fn our_solver_keeps_to_its_targets_without_the_guard() {
        let options = Options { sizes: vec![32], repetitions: 1, ..Options::default() };
        let ours = &INDEX[0];
        for case in CASES {
            let outcome = run_case(case, ours, 32, &options).expect("no input is refused");
            assert!(outcome.value <= case.target_at_32, "{}: {}", case.name, outcome.value);
            assert_eq!(outcome.params["guard_actions"], 0.0, "{}", case.name);
        }
        let left = run_divergence(ours, 32, &options).expect("no input is refused").value;
        assert!(left <= DIVERGENCE_TARGET_AT_32, "{left}");
    }
}
