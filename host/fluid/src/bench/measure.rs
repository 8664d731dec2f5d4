//! Times: all contenders in turn, and the founding solver before each.

use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

use super::{
    Options,
    case::{Case, MMS},
    row::{Param, Params, Row},
    target::OURS,
};
use crate::{
    grid::Grid,
    solver::{INDEX, Setup, SetupError, Sides, Solver, SolverRow, StepReport, founding::Founding},
    vessel::Vessel,
};

/// A contender is not started again once its runs took this long together.
const ENOUGH_S: f64 = 1.5;

/// Cells that the founding solver computes to be timed, in steps of n^3.
const BASELINE_CELLS: usize = 1 << 17;

/// CPU time, of all threads, and the wall's.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spent {
    pub cpu: Duration,
    pub wall: Duration,
}

impl Spent {
    /// Adds what `work` takes.
    pub fn on<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (cpu, wall) = (ProcessTime::now(), Instant::now());
        let done = work();
        self.cpu += cpu.elapsed();
        self.wall += wall.elapsed();
        done
    }
}

/// One run of one solver.
pub struct Outcome {
    /// Each quantity and its value, the first the one that times belong to.
    pub values: Vec<(&'static str, f64)>,
    /// On all steps together.
    pub spent: Spent,
    pub steps: usize,
    pub cells: usize,
    pub params: Params,
}

/// What is told of the steps of a run.
#[derive(Clone, Copy)]
pub struct Tally {
    report: StepReport,
    most_substeps: u32,
    guard_actions: u32,
}

impl Tally {
    pub fn new() -> Self {
        Self { report: StepReport::at_rest(), most_substeps: 0, guard_actions: 0 }
    }

    pub fn count(&mut self, report: StepReport) {
        self.most_substeps = self.most_substeps.max(report.substeps);
        self.guard_actions += report.guard_actions;
        self.report = report;
    }

    /// Scheme of the last step, most parts of any, actions of the guard in all.
    pub fn params(&self) -> Params {
        Params::from([
            ("scheme", Param::Word(format!("{:?}", self.report.scheme).to_lowercase())),
            ("substeps", Param::Number(f64::from(self.most_substeps))),
            ("guard_actions", Param::Number(f64::from(self.guard_actions))),
        ])
    }
}

/// The unit cube of a case for a solver.
pub fn cube(n: usize, viscosity_m2_s: f64, sides: Sides, options: &Options) -> Setup {
    Setup {
        viscosity_m2_s: viscosity_m2_s as f32,
        sides,
        pool: options.pool.clone(),
        simd: options.simd,
        ..Setup::new(Grid::unit_cube(n), Vessel::Box)
    }
}

/// What times are compared with: steps or projections of the founding solver.
pub struct Baseline {
    case: &'static Case,
    solver: Founding,
    n: usize,
    is_projection: bool,
}

impl Baseline {
    /// Its steps on the manufactured flow, for what it cannot do itself; forces prepared.
    pub fn steps(n: usize, options: &Options) -> Result<Self, SetupError> {
        let case = &MMS;
        let mut solver = Founding::new(&cube(n, case.viscosity_m2_s, case.sides, options))?;
        if let Some(force) = case.force_m_s2 {
            solver.set_force(&force)?;
        }
        Ok(Self { case, solver, n, is_projection: false })
    }

    /// Its projections.
    pub fn projections(n: usize, options: &Options) -> Result<Self, SetupError> {
        Ok(Self { is_projection: true, ..Self::steps(n, options)? })
    }

    /// CPU time of one in milliseconds, after one that warms the caches.
    fn ms(&mut self) -> Result<f64, SetupError> {
        let times = (BASELINE_CELLS / self.n.pow(3)).clamp(1, 64);
        self.solver.set_velocity(&|point| (self.case.flow_m_s)(point, 0.0))?;
        self.once()?;
        let mut spent = Spent::default();
        for _ in 0..times {
            spent.on(|| self.once())?;
        }
        Ok(spent.cpu.as_secs_f64() * 1e3 / times as f64)
    }

    fn once(&mut self) -> Result<(), SetupError> {
        if self.is_projection {
            self.solver.project();
        } else {
            self.solver.step(self.case.end_s / self.case.steps(self.n, 1.0) as f64)?;
        }
        Ok(())
    }
}

/// All runs of one solver.
pub struct Measured {
    pub method: &'static str,
    /// The last, as all have the same values.
    pub outcome: Outcome,
    /// Median CPU time of a step.
    pub ms: f64,
    /// Median of the ratios to the founding solver's time just before, per cell ...
    pub ratio: f64,
    /// ... and of the wall's time to that.
    pub wall_ratio: f64,
}

/// Solver A, B, ..., A, B, ..., the baseline before each: those of `methods` that can do it, in
/// the order of the index.
pub fn measure(
    options: &Options,
    n: usize,
    baseline: &mut Baseline,
    is_wanted: impl Fn(&SolverRow) -> bool,
    mut run: impl FnMut(&SolverRow) -> Result<Outcome, SetupError>,
) -> Result<Vec<Measured>, SetupError> {
    let wanted = INDEX.iter().filter(|row| options.has_method(row.name) && is_wanted(row));
    let mut all: Vec<(&SolverRow, Vec<(f64, Outcome)>)> =
        wanted.map(|row| (row, Vec::new())).collect();
    for _ in 0..options.repetitions.max(1) {
        for (row, runs) in &mut all {
            let spent: f64 = runs.iter().map(|(_, run)| run.spent.cpu.as_secs_f64()).sum();
            if spent > ENOUGH_S {
                continue;
            }
            let founding_ms = baseline.ms()?;
            match run(row) {
                Ok(outcome) => runs.push((founding_ms, outcome)),
                Err(SetupError::Unsupported(_)) => {}
                Err(refused) => return Err(refused),
            }
        }
        all.retain(|(_, runs)| !runs.is_empty());
    }
    Ok(all.into_iter().filter_map(|(row, runs)| summary(row.name, n, runs)).collect())
}

fn summary(method: &'static str, n: usize, mut runs: Vec<(f64, Outcome)>) -> Option<Measured> {
    let ms = |time: Duration, run: &Outcome| time.as_secs_f64() * 1e3 / run.steps.max(1) as f64;
    let of = |value: &dyn Fn(f64, &Outcome) -> f64| {
        median(runs.iter().map(|(founding_ms, run)| value(*founding_ms, run)).collect())
    };
    let per_cell =
        |founding_ms: f64, run: &Outcome| n.pow(3) as f64 / run.cells.max(1) as f64 / founding_ms;
    let cpu_ms = of(&|_, run| ms(run.spent.cpu, run));
    let ratio = of(&|founding_ms, run| ms(run.spent.cpu, run) * per_cell(founding_ms, run));
    let wall_ratio = of(&|founding_ms, run| ms(run.spent.wall, run) * per_cell(founding_ms, run));
    // It is its own measure.
    let ratio = if method == "founding" { 1.0 } else { ratio };
    let (_, outcome) = runs.pop()?;
    Some(Measured { method, outcome, ms: cpu_ms, ratio, wall_ratio })
}

/// The middle one, or the upper of the two in the middle; 0 of none.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

impl Measured {
    /// A row for each of its quantities; times stand in the first.
    pub fn rows(&self, options: &Options, case: &str, n: usize) -> Vec<Row> {
        let row = |(place, (quantity, value)): (usize, &(&'static str, f64))| Row {
            ms: (place == 0).then_some(self.ms),
            ratio_to_founding: (place == 0).then_some(self.ratio),
            params: self.outcome.params.clone(),
            ..bare_row(options, case, self.method, n, quantity, *value)
        };
        self.outcome.values.iter().enumerate().map(row).collect()
    }
}

/// A row without times.
pub fn bare_row(
    options: &Options,
    case: &str,
    method: &str,
    n: usize,
    quantity: &'static str,
    value: f64,
) -> Row {
    Row {
        group: "fluid",
        case: case.to_owned(),
        method: method.to_owned(),
        n: Some(n),
        params: Params::new(),
        quantity,
        value,
        unit: "1",
        target: None,
        pass: None,
        ms: None,
        ratio_to_founding: None,
        simd: Some(options.simd.name()),
        threads: Some(options.pool.threads()),
    }
}

/// The index row of our solver.
pub fn is_ours(row: &SolverRow) -> bool {
    row.name == OURS
}
