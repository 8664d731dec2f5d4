//! What came of a seed, of a run, and of the shards of one together.

use std::{
    collections::BTreeSet,
    panic::{AssertUnwindSafe, catch_unwind},
};

use cpu_time::ProcessTime;
use serde::{Deserialize, Serialize};

use super::{Group, ledger::Ledger};
use crate::{
    bench::{Params, Row},
    simd::SimdClass,
};

/// What came of one seed: a row of figures with the number of failures as its value, and what
/// does not fit into numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// The row; `pass` is null if the solver cannot do the case.
    #[serde(flatten)]
    pub row: Row,
    /// The seed.
    pub seed: u64,
    /// What failed, in words.
    pub failures: Vec<String>,
    /// Why the solver cannot do the case, if so.
    pub unsupported: Option<String>,
    /// What was drawn and the solver has no API for yet.
    pub not_taken: Vec<&'static str>,
    /// Checks that do not apply to the case, and why.
    pub not_asked: Vec<&'static str>,
    /// The command that does it again.
    pub replay: String,
}

impl Verdict {
    /// The verdict on a seed that has not run.
    #[must_use]
    pub fn new(group: &str, seed: u64, (simd, threads): (SimdClass, usize)) -> Self {
        let row = Row {
            group: "torture",
            case: String::new(),
            method: "auto".to_owned(),
            n: None,
            params: Params::new(),
            quantity: "failures",
            value: 0.0,
            unit: "1",
            target: Some(0.0),
            pass: None,
            ms: None,
            ratio_to_founding: None,
            simd: Some(simd.name()),
            threads: Some(threads),
        };
        Self {
            row,
            seed,
            failures: Vec::new(),
            unsupported: None,
            not_taken: Vec::new(),
            not_asked: Vec::new(),
            replay: format!("cauldron torture {group} --seed {seed}"),
        }
    }

    /// Enters what came of a torture of so many steps, also a panic. An error says why it cannot
    /// be done.
    #[must_use]
    pub fn judged(
        mut self,
        steps: usize,
        torture: impl FnOnce() -> Result<Ledger, String>,
    ) -> Self {
        let from = ProcessTime::now();
        let failures = match catch_unwind(AssertUnwindSafe(torture)) {
            Ok(Ok(ledger)) => {
                let worst = ledger.worst.into_iter().map(|(name, value)| (name, value.into()));
                self.row.params.extend(worst);
                ledger.failures.into_values().collect()
            }
            Ok(Err(refused)) => {
                self.unsupported = Some(refused);
                return self;
            }
            Err(_) => vec!["it panicked".to_owned()],
        };
        self.row.ms = Some(from.elapsed().as_secs_f64() * 1e3 / steps as f64);
        self.with_failures(failures)
    }

    /// Enters what failed.
    #[must_use]
    pub fn with_failures(mut self, failures: Vec<String>) -> Self {
        self.row.value = failures.len() as f64;
        self.row.pass = Some(failures.is_empty());
        self.failures = failures;
        self
    }
}

/// What came of a run: all seeds, or one shard of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the group.
    pub group: String,
    /// Seeds of the whole run, over all shards: 0 to this, without it.
    pub seeds: u64,
    /// Seeds that ran.
    pub ran: BTreeSet<u64>,
    /// Those that failed.
    pub failed: BTreeSet<u64>,
    /// Those that the solver cannot do.
    pub unsupported: BTreeSet<u64>,
    /// What some seeds drew and the solver has no API for yet.
    pub not_taken: BTreeSet<String>,
    /// CPU time of all threads.
    pub cpu_s: f64,
    /// Longest that one part of it ran by the wall's clock.
    pub wall_s: f64,
}

impl Summary {
    /// The summary of nothing yet, of a run of so many seeds.
    #[must_use]
    pub fn of(group: &str, seeds: u64) -> Self {
        Self { group: group.to_owned(), seeds, ..Self::default() }
    }

    /// Enters a verdict.
    pub fn add(&mut self, verdict: &Verdict) {
        let ran = match verdict.unsupported {
            Some(_) => &mut self.unsupported,
            None => &mut self.ran,
        };
        ran.insert(verdict.seed);
        if !verdict.failures.is_empty() {
            self.failed.insert(verdict.seed);
        }
        self.not_taken.extend(verdict.not_taken.iter().map(|what| (*what).to_owned()));
    }

    /// Several parts of one run together.
    ///
    /// # Errors
    /// In words, if there is none, or they are of different groups or numbers of seeds.
    pub fn merge(parts: &[Self]) -> Result<Self, String> {
        let first = parts.first().ok_or("there is nothing to merge")?;
        let mut whole = Self::of(&first.group, first.seeds);
        for part in parts {
            if part.group != whole.group {
                return Err(format!("they are of {} and of {}", whole.group, part.group));
            }
            if part.seeds != whole.seeds {
                let (one, other) = (whole.seeds, part.seeds);
                return Err(format!("they are of runs of {one} and of {other} seeds"));
            }
            whole.ran.extend(&part.ran);
            whole.failed.extend(&part.failed);
            whole.unsupported.extend(&part.unsupported);
            whole.not_taken.extend(part.not_taken.iter().cloned());
            whole.cpu_s += part.cpu_s;
            whole.wall_s = whole.wall_s.max(part.wall_s);
        }
        Ok(whole)
    }

    /// Corners of its group that did not run.
    #[must_use]
    pub fn corners_left_out(&self, group: &Group) -> Vec<&'static str> {
        let corners = (0..).map_while(|seed| Some((seed, (group.corners)(seed)?)));
        let left_out = corners.filter(|(seed, _)| !self.ran.contains(seed));
        left_out.map(|(_, name)| name).collect()
    }

    /// Seeds that neither ran nor are beyond the solver.
    #[must_use]
    pub fn seeds_left_out(&self) -> Vec<u64> {
        let is_known = |seed: &u64| self.ran.contains(seed) || self.unsupported.contains(seed);
        (0..self.seeds).filter(|seed| !is_known(seed)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{super::FLUID, *};

    fn verdict(seed: u64) -> Verdict {
        Verdict::new(FLUID.name, seed, (SimdClass::Portable, 1))
    }

    fn part(seeds: u64, ran: impl IntoIterator<Item = u64>) -> Summary {
        Summary {
            ran: ran.into_iter().collect(),
            wall_s: 1.0,
            cpu_s: 2.0,
            ..Summary::of(FLUID.name, seeds)
        }
    }

    #[test]
    fn shards_together_are_the_whole_run_and_a_lost_one_is_missed() {
        let [even, odd] = [0, 1].map(|first| part(20, (first..20).step_by(2)));
        let whole = Summary::merge(&[even.clone(), odd.clone()]).expect("one run");
        assert_eq!(whole.ran.len(), 20);
        assert!(whole.corners_left_out(&FLUID).is_empty() && whole.seeds_left_out().is_empty());
        assert_eq!((whole.cpu_s, whole.wall_s), (4.0, 1.0));
        assert_eq!(odd.corners_left_out(&FLUID).len(), 4);
        assert_eq!(odd.seeds_left_out(), (0..20).step_by(2).collect::<Vec<_>>());
        let other = Summary { group: "surface".to_owned(), ..even.clone() };
        assert!(Summary::merge(&[even.clone(), other]).is_err());
        assert!(Summary::merge(&[even, part(30, [])]).is_err());
        assert!(Summary::merge(&[]).is_err());
    }

    #[test]
    fn a_corner_that_the_solver_cannot_do_is_left_out() {
        let mut verdict = verdict(4);
        verdict.unsupported = Some("too small".to_owned());
        let mut summary = part(8, (0..8).filter(|seed| *seed != 4));
        summary.add(&verdict);
        assert_eq!(summary.corners_left_out(&FLUID), ["2^3"]);
        assert!(summary.seeds_left_out().is_empty());
    }

    #[test]
    fn a_failure_is_counted_and_can_be_done_again() {
        let verdict = verdict(11).with_failures(vec!["NaN".to_owned()]);
        assert_eq!((verdict.row.value, verdict.row.pass), (1.0, Some(false)));
        assert_eq!(verdict.replay, "cauldron torture fluid --seed 11");
        let mut summary = Summary::of(FLUID.name, 8);
        summary.add(&verdict);
        assert!(summary.failed.contains(&11));
    }
}
