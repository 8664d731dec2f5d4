//! The figures of one run, and what failed in it.

use std::collections::BTreeMap;

/// The worst of each figure is kept; a check that failed says when it first did.
#[derive(Default)]
pub struct Ledger {
    /// Worst figures by name.
    pub worst: BTreeMap<&'static str, f64>,
    /// What failed, once each.
    pub failures: BTreeMap<&'static str, String>,
}

impl Ledger {
    /// Enters a figure of which at most `limit` is allowed. Whatever is not a number fails.
    pub fn check(&mut self, what: &'static str, value: f64, limit: f64, step: usize) {
        let worst = self.worst.entry(what).or_insert(value);
        *worst = if value > *worst || value.is_nan() { value } else { *worst };
        if value > limit || value.is_nan() {
            let told = || format!("{what} = {value:.3e} in step {step}, at most {limit:.0e}");
            self.failures.entry(what).or_insert_with(told);
        }
    }

    /// Keeps the sum of a figure that is not checked.
    pub fn count(&mut self, what: &'static str, value: f64) {
        *self.worst.entry(what).or_insert(0.0) += value;
    }

    /// Keeps the largest of a figure that is not checked.
    pub fn most(&mut self, what: &'static str, value: f64) {
        self.check(what, value, f64::MAX, 0);
    }
}
