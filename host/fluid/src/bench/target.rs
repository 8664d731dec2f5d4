//! What rows are not to exceed: a table for each group, here that of `bench fluid`.

use super::{
    GROUPS,
    row::{Param, Row},
};
use crate::simd::SimdClass;

/// The method that the targets of `bench fluid` are for.
pub const OURS: &str = "auto";

/// What one row, or each of several, is not to exceed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Benchmark case.
    pub case: &'static str,
    /// Whom it is for.
    pub method: &'static str,
    /// What is measured.
    pub quantity: &'static str,
    /// Cells along an edge; any if `None`.
    pub n: Option<usize>,
    /// Cells crossed in a step; any if `None`.
    pub cfl: Option<f64>,
    /// The value is to be no more than this ...
    pub at_most: f64,
    /// ... and with AVX-512 the time of a step no more than founding's divided by this.
    pub speedup: Option<f64>,
}

const fn target(case: &'static str, quantity: &'static str, n: usize, at_most: f64) -> Target {
    Target { case, method: OURS, quantity, n: Some(n), cfl: None, at_most, speedup: None }
}

/// All targets of `bench fluid`; where two fit a row, the first counts.
pub const TARGETS: &[Target] = &[
    // The gate: precision and speed together, in one row.
    Target { cfl: Some(0.2), speedup: Some(145.0), ..target("mms", "rel_l2", 32, 1.95e-3) },
    target("mms", "rel_l2", 32, 1.95e-3),
    // A quarter of the error at twice the cells: second order.
    Target { cfl: Some(0.2), speedup: Some(115.0), ..target("mms", "rel_l2", 64, 4.9e-4) },
    target("mms", "wall_ratio_to_founding", 64, 1.0 / 185.0),
    target("taylor-green", "rel_l2", 32, 1.6e-4),
    // Second-order central fluxes have 1.16e-2 (and 4.6e-2 at 16): a fifth more.
    target("taylor-green-drift", "rel_l2", 32, 1.4e-2),
    target("divergence", "after_over_before", 16, 1e-5),
    Target { speedup: Some(40.0), ..target("divergence", "after_over_before", 32, 1e-5) },
    target("divergence", "after_over_before", 64, 4e-5),
    target("cavity-100", "rms", 32, 0.003),
    target("cavity-400", "rms", 32, 0.015),
    Target { speedup: Some(40.0), ..target("cavity-1000", "rms", 32, 0.030) },
    target("blob", "rel_l2", 64, 0.06),
    Target { n: None, ..target("blob", "mass_change", 0, 1e-5) },
    // Finite, and 80 to 100 % of the energy.
    target("cfl-16", "energy_lost", 32, 0.2),
    target("cfl-16", "energy_gained", 32, 1e-3),
    // What the energy guard tolerates: below, it has nothing to do.
    target("energy-drift", "energy_change", 32, 1e-3),
    Target { speedup: Some(16.0), ..target("bowl", "after_over_before", 32, 1e-4) },
    Target { n: None, ..target("equal-error", "time_ratio", 0, 1.0 / 100.0) },
    Target { n: None, ..target("equal-time", "error_ratio", 0, 1.0 / 200.0) },
    // 120 and 20 frames a second.
    target("frame-box", "step_ms_wall", 64, 1e3 / 120.0),
    target("frame-box", "step_ms_wall", 128, 1e3 / 20.0),
    // What rests, and what is not there.
    target("at-rest", "time_share", 64, 0.01),
    target("plume", "time_share", 64, 0.25),
];

impl Target {
    /// The target that a row is for, if there is one.
    #[must_use]
    pub fn of(row: &Row) -> Option<&'static Self> {
        let is_cfl = |cfl: f64| row.number("cfl") == Some(cfl);
        let group = GROUPS.into_iter().find(|group| group.name == row.group)?;
        let fits = |target: &&Self| {
            (target.case, target.method, target.quantity)
                == (row.case.as_str(), row.method.as_str(), row.quantity)
                && target.n.is_none_or(|n| row.n == Some(n))
                && target.cfl.is_none_or(is_cfl)
        };
        group.targets.iter().find(fits)
    }

    /// What the ratio to the founding solver's time is not to exceed: with AVX2 by as much more
    /// as the gate allows (1/90 for 1/145), and anything where there are no wide vectors.
    #[must_use]
    pub fn ratio(&self, simd: SimdClass) -> Option<f64> {
        let ratio = 1.0 / self.speedup?;
        match simd {
            SimdClass::Avx512 => Some(ratio),
            SimdClass::Avx2 => Some(ratio * 145.0 / 90.0),
            SimdClass::Portable => None,
        }
    }
}

/// Sets target and verdict of a row.
#[must_use]
pub fn judged(mut row: Row, simd: SimdClass) -> Row {
    let Some(target) = Target::of(&row) else { return row };
    let ratio_target = target.ratio(simd);
    if let Some(ratio) = ratio_target {
        row.params.insert("ratio_target", Param::Number(ratio));
    }
    // A ratio that was not measured cannot be missed, but a NaN is.
    let is_fast = match (ratio_target, row.ratio_to_founding) {
        (Some(target), Some(ratio)) => ratio <= target,
        _ => true,
    };
    row.target = Some(target.at_most);
    row.pass = Some(row.value <= target.at_most && is_fast);
    row
}

/// What became of a target.
pub struct Verdict<'a> {
    /// The target.
    pub target: &'static Target,
    /// The row that came closest to missing it; `None` if this run has none.
    pub row: Option<&'a Row>,
}

/// One verdict for each target of a group.
#[must_use]
pub fn verdicts<'a>(targets: &'static [Target], rows: &'a [Row]) -> Vec<Verdict<'a>> {
    // How much of what it may be its value or its time is.
    let share = |row: &Row| {
        let ratio = row.ratio_to_founding.zip(row.number("ratio_target"));
        let of_time = ratio.map_or(0.0, |(ratio, target)| ratio / target);
        let of_value = row.target.map_or(0.0, |target| row.value / target);
        // What is not a number is the worst.
        if of_value.is_nan() { f64::INFINITY } else { of_time.max(of_value) }
    };
    let worst = |target: &'static Target| {
        let rows = rows.iter().filter(|row| Target::of(row) == Some(target));
        rows.max_by(|a, b| share(a).total_cmp(&share(b)))
    };
    targets.iter().map(|target| Verdict { target, row: worst(target) }).collect()
}
