//! The one format of everything measured: a JSON object per line.

use std::collections::BTreeMap;

use serde::Serialize;

/// What was varied, or describes a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Param {
    /// In the unit that its name says.
    Number(f64),
    /// For instance a scheme.
    Word(String),
}

impl From<f64> for Param {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<&str> for Param {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

/// Names and values, as `params` of a [`Row`].
pub type Params = BTreeMap<&'static str, Param>;

/// One measured value. What does not apply is `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The group of benchmarks.
    pub group: &'static str,
    /// What was computed.
    pub case: String,
    /// With what: a name of an index.
    pub method: String,
    /// Cells along an edge, or nodes of a surface.
    pub n: Option<usize>,
    /// What else was varied, or describes the run.
    pub params: Params,
    /// What was measured.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit; 1 for a ratio.
    pub unit: &'static str,
    /// What it is not to exceed; none for methods that are only compared with. Where
    /// `ratio_target` stands in `params`, `ratio_to_founding` is not to exceed that either.
    pub target: Option<f64>,
    /// Whether it keeps to the target.
    pub pass: Option<bool>,
    /// CPU time of one step, of all threads, in milliseconds.
    pub ms: Option<f64>,
    /// That time per cell or node over that of the founding solver, or of the founding sheet of
    /// springs, at the same n in the same run: below 1 is faster.
    pub ratio_to_founding: Option<f64>,
    /// The vector width it ran at.
    pub simd: Option<&'static str>,
    /// The threads it ran on.
    pub threads: Option<usize>,
}

impl Row {
    /// The parameter of that name, if it is a number.
    #[must_use]
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.params.get(name)? {
            Param::Number(value) => Some(*value),
            Param::Word(_) => None,
        }
    }

    /// CPU time of the whole run in milliseconds: of its only step if it does not say how many
    /// it had.
    #[must_use]
    pub fn total_ms(&self) -> Option<f64> {
        Some(self.ms? * self.number("steps").unwrap_or(1.0))
    }
}
