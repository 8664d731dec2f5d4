//! The one format of everything measured: a JSON object per line.

use std::collections::BTreeMap;

use serde::Serialize;

/// One measured value. What does not apply is `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The group of benchmarks.
    pub group: &'static str,
    /// What was computed.
    pub case: String,
    /// With what: a name of an index.
    pub method: String,
    /// Cells along an edge.
    pub n: Option<usize>,
    /// What else was varied, or describes the run.
    pub params: BTreeMap<&'static str, f64>,
    /// What was measured.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit; 1 for a ratio.
    pub unit: &'static str,
    /// What it is not to exceed; none for methods that are only compared with.
    pub target: Option<f64>,
    /// Whether it keeps to the target.
    pub pass: Option<bool>,
    /// CPU time of one step, of all threads, in milliseconds.
    pub ms: Option<f64>,
    /// That time per cell over the founding solver's at the same n in the same run: below 1 is
    /// faster.
    pub ratio_to_founding: Option<f64>,
    /// The vector width it ran at.
    pub simd: Option<&'static str>,
    /// The threads it ran on.
    pub threads: Option<usize>,
}

impl Row {
    /// Sets the target, and whether the value keeps to it.
    #[must_use]
    pub fn with_target(mut self, target: Option<f64>) -> Self {
        self.target = target;
        self.pass = target.map(|target| self.value <= target);
        self
    }
}
