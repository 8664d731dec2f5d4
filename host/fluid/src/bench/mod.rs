//! Run time against error, by groups: `bench fluid` ([`FLUID`]) of every solver of the index, and
//! what ours is to reach ([`target::TARGETS`]); `bench surface` ([`surface`]).
//!
//! Every case is written against what the crate offers to anybody. Where solvers are compared
//! they are given the same steps, one after the other, several times over, and the founding
//! solver is timed on some steps before each; medians count. Time is CPU time of the whole
//! process, so of all threads, and of [`Solver::step`](crate::solver::Solver::step) or `project`
//! alone: forces and exact solutions are evaluated outside of it. A solver that cannot do a case
//! has no row there.

mod blob;
mod bowl;
pub mod case;
mod cavity;
mod energy;
mod equal;
mod exact;
mod frame;
mod measure;
mod pipe;
mod projection;
mod row;
mod skip;
mod sphere;
pub mod surface;
pub mod target;

use std::sync::Arc;

use self::measure::Measured;
pub use self::row::{Param, Params, Row};
use self::target::Target;
use crate::{pool::Pool, simd::SimdClass, solver::SetupError};

/// A group of benchmarks: what `bench` takes the name of.
pub struct Group {
    /// Its name, which stands in its rows.
    pub name: &'static str,
    /// Names of its cases, as `--case` takes them.
    pub cases: &'static [&'static str],
    /// What its rows are not to exceed.
    pub targets: &'static [Target],
    /// The parameter that tells steps apart, and what people call it.
    pub step: [&'static str; 2],
    /// The parameter in words that describes a run.
    pub word: &'static str,
    /// How it is run: quickly, or in full.
    pub options: fn(is_quick: bool) -> Options,
    /// Runs it, and tells what comes next.
    pub run: Run,
}

/// Runs a group; [`SetupError`] if an input is refused, which none is in these cases.
pub type Run = fn(&Options, &mut dyn FnMut(&str)) -> Result<Vec<Row>, SetupError>;

/// All groups.
pub const GROUPS: [&Group; 2] = [&FLUID, &surface::SURFACE];

/// Flow solvers.
pub const FLUID: Group = Group {
    name: "fluid",
    cases: NAMES,
    targets: target::TARGETS,
    step: ["cfl", "CFL"],
    word: "scheme",
    options: |is_quick| if is_quick { Options::quick() } else { Options::full() },
    run,
};

/// Names of all cases of flow solvers.
pub const NAMES: &[&str] = &[
    "taylor-green",
    "taylor-green-drift",
    "mms",
    "divergence",
    "cavity-100",
    "cavity-400",
    "cavity-1000",
    "cfl-16",
    "energy-drift",
    "blob",
    "bowl",
    "pipe",
    "sphere",
    "equal-error",
    "equal-time",
    "frame-box",
    "frame-bowl",
    "frame-thick",
    "frame-dense",
    "at-rest",
    "plume",
    "features",
];

/// Solvers of the quick run.
const QUICK: &[&str] = &[target::OURS, "founding"];

/// How to run the benchmarks.
#[derive(Clone)]
pub struct Options {
    /// No more than the targets need.
    pub is_quick: bool,
    /// Names of the solvers; all of the index if `None`.
    pub methods: Option<&'static [&'static str]>,
    /// Cells along an edge, or nodes, one run for each.
    pub sizes: Vec<usize>,
    /// Times that what is short is repeated.
    pub repetitions: usize,
    /// Only the case of this name, if given.
    pub case: Option<String>,
    /// The threads to work with, but for rows that say otherwise.
    pub pool: Arc<Pool>,
    /// The vector width to work at.
    pub simd: SimdClass,
}

impl Options {
    /// Ours and the founding solver, 16 and 32 cells, on one thread.
    #[must_use]
    pub fn quick() -> Self {
        Self {
            is_quick: true,
            methods: Some(QUICK),
            sizes: vec![16, 32],
            repetitions: 3,
            case: None,
            pool: Arc::new(Pool::inline()),
            simd: SimdClass::detect(),
        }
    }

    /// Every solver, and up to 64 cells.
    #[must_use]
    pub fn full() -> Self {
        Self {
            is_quick: false,
            methods: None,
            sizes: vec![16, 32, 48, 64],
            repetitions: 5,
            ..Self::quick()
        }
    }

    fn wants(&self, case: &str) -> bool {
        self.case.as_deref().is_none_or(|wanted| wanted == case)
    }

    fn has_method(&self, method: &str) -> bool {
        self.methods.is_none_or(|methods| methods.contains(&method))
    }
}

/// A run of the group: how, what came of it so far, and whom to tell.
struct Session<'a> {
    options: &'a Options,
    rows: Vec<Row>,
    progress: &'a mut dyn FnMut(&str),
}

impl Session<'_> {
    fn tell(&mut self, what: &str) {
        (self.progress)(what);
    }

    fn wants(&self, case: &str) -> bool {
        self.options.wants(case)
    }

    /// The ladder of a case; empty if it is not wanted.
    fn sizes(&self, case: &str) -> Vec<usize> {
        if self.wants(case) { self.options.sizes.clone() } else { Vec::new() }
    }

    fn keep(&mut self, measured: Vec<Measured>, case: &str, n: usize) {
        let rows = measured.iter().flat_map(|measured| measured.rows(self.options, case, n));
        self.rows.extend(rows);
    }
}

/// Runs the flow solvers. `progress` is told what comes next.
///
/// # Errors
/// [`SetupError`] if a solver refuses an input, which none does for these cases.
pub fn run(options: &Options, progress: &mut dyn FnMut(&str)) -> Result<Vec<Row>, SetupError> {
    let mut session = Session { options, rows: Vec::new(), progress };
    exact::run(&mut session)?;
    projection::run(&mut session)?;
    cavity::run(&mut session)?;
    energy::run(&mut session)?;
    blob::run(&mut session)?;
    bowl::run(&mut session)?;
    if !options.is_quick || options.case.is_some() {
        // They have no target.
        pipe::run(&mut session)?;
        sphere::run(&mut session)?;
    }
    equal::run(&mut session)?;
    frame::run(&mut session)?;
    skip::run(&mut session)?;
    Ok(session.rows.into_iter().map(|row| target::judged(row, options.simd)).collect())
}

#[cfg(test)]
mod tests;
