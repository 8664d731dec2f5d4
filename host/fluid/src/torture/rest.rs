//! When a liquid that is left alone has to be at rest.
//!
//! Between closed walls a velocity component is zero at both ends of its own axis, so that
//! no flow decays slower than
//! ```text
//! u ~ exp(-lambda t),   lambda = nu pi^2 / L^2
//! ```
//! with the longest edge L along which there is any (Poincare's inequality; advection and
//! pressure do no work). A periodic axis has no ends: the uniform stream along it decays only
//! where a side of another axis holds it, as nu (pi / 2 D)^2 at least, and waves as nu (2 pi /
//! L)^2 or as between walls; so do the uniform stream and waves between open sides, from
//! beyond which nothing comes. Of mixtures nu is the least viscosity over the greatest density;
//! those are held by stresses, which liquid that turns like a solid knows nothing of: in a round
//! vessel that it slides along it may go on for ever.

use std::f64::consts::PI;

use super::draw::Case;
use crate::{
    solver::{Side, Walls},
    vessel::Vessel,
};

/// Speed below which the solver takes liquid for resting.
const REST_M_S: f64 = 1e-6;

/// The discrete flow may decay this much slower: (2 / pi)^2 for the coarsest grid, rounded.
const SHARE_OF_RATE: f64 = 0.4;

/// Longest step that a solver accepts.
const LONGEST_STEP_S: f64 = 1e3;

/// Steps after which a liquid that is too thin to have come to rest is no longer waited for ...
const MOST_STEPS: usize = 200;

/// ... and of how many cells together, or the largest grid would take most of the time.
const MOST_CELLS: usize = 40_000_000;

/// How a liquid comes to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay {
    /// Length of the steps it is given.
    pub dt_s: f64,
    /// What a step leaves of a velocity, at most.
    pub kept: f64,
    /// Number of steps that it is waited for.
    pub most_steps: usize,
}

impl Decay {
    /// How the liquid of a case comes to rest; `None` if it does not, as it is inviscid, driven
    /// by a side, streams through periodic sides that nothing holds, or turns like a solid.
    #[must_use]
    pub fn of(case: &Case) -> Option<Self> {
        if case.vessel != Vessel::Box && case.walls == Walls::FreeSlip && is_mixed(case) {
            return None;
        }
        let wave_per_m = slowest_wave_per_m(case).filter(|_| !case.sides.drive())?;
        let rate_per_s = SHARE_OF_RATE * least_viscosity_m2_s(case) * wave_per_m.powi(2);
        let dt_s = (1.0 / rate_per_s).min(LONGEST_STEP_S);
        // The implicit Euler step is what damps least of all that are stable.
        let most_steps = MOST_STEPS.min(MOST_CELLS / case.grid.len().max(1));
        let kept = 1.0 / (1.0 + rate_per_s * dt_s);
        (rate_per_s > 0.0).then_some(Self { dt_s, kept, most_steps })
    }

    /// Steps until nothing is faster than the speed of rest, if the fastest has all of
    /// `energy_j` and a cell weighs `cell_mass_kg`; and whether that is the end, or it is not
    /// waited for so long.
    #[must_use]
    pub fn steps(&self, energy_j: f64, cell_mass_kg: f64) -> (usize, bool) {
        let fastest_m_s = (2.0 * energy_j / cell_mass_kg).sqrt();
        let needed = 1.0 + (REST_M_S / 3.0 / fastest_m_s).ln() / self.kept.ln();
        let most = self.most_steps as f64;
        (needed.clamp(1.0, most).ceil() as usize, needed <= most)
    }
}

/// True if something may be in the liquid that is not like it.
fn is_mixed(case: &Case) -> bool {
    let own = [case.density_kg_m3, case.viscosity_m2_s];
    let mut all = case.substances.iter().map(|s| s.properties);
    all.any(|p| [p.density_kg_m3, p.viscosity_m2_s] != own)
}

/// The least dynamic viscosity over the greatest density: what mixtures are at least.
fn least_viscosity_m2_s(case: &Case) -> f64 {
    if case.viscosity_m2_s == 0.0 {
        return 0.0;
    }
    let liquid = (case.density_kg_m3, case.viscosity_m2_s);
    let substances = case.substances.iter().map(|s| s.properties);
    let all = substances.map(|p| (p.density_kg_m3, p.viscosity_m2_s)).chain([liquid]);
    let (least_pa_s, most_kg_m3) = all.fold((f64::MAX, 0f64), |(least, most), (density, nu)| {
        let density = f64::from(density);
        (least.min(density * f64::from(nu)), most.max(density))
    });
    least_pa_s / most_kg_m3
}

/// The slowest wave number that every flow of the case decays with.
fn slowest_wave_per_m(case: &Case) -> Option<f64> {
    let extent_m = case.grid.extent_m().as_dvec3();
    let is_stuck = |axis: usize| case.sides.0[axis].contains(&Side::NoSlip);
    let of_axis = |axis: usize| {
        let is_open = case.sides.0[axis].contains(&Side::Outflow);
        if !case.sides.is_periodic(axis) && !is_open {
            return Some(PI / extent_m[axis]);
        }
        let others = (0..3).filter(|other| *other != axis && is_stuck(*other));
        let narrowest = others.map(|other| extent_m[other]).reduce(f64::min)?;
        Some(PI / 2.0 / narrowest)
    };
    let of_axes = [of_axis(0)?, of_axis(1)?, of_axis(2)?];
    of_axes.into_iter().reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Sides, Walls};

    fn case() -> Case {
        let sides = Sides::of_vessel(Walls::NoSlip);
        let substances = Vec::new();
        let mut case = Case { sides, viscosity_m2_s: 0.01, substances, ..Case::of_seed(8) };
        case.grid.spacing_m = 0.1;
        case.set_cells([10, 10, 20], false);
        case
    }

    #[test]
    fn it_takes_longest_along_the_longest_edge() {
        let decay = Decay::of(&case()).expect("thick and closed");
        let rate_per_s = SHARE_OF_RATE * 0.01 * (PI / 2.0).powi(2);
        assert!((decay.dt_s * rate_per_s - 1.0).abs() < 1e-6 && (decay.kept - 0.5).abs() < 1e-6);
        // 1 m/s down to a third of 1e-6 m/s by halves.
        assert_eq!(decay.steps(0.5, 1.0), (23, true));
        assert_eq!(decay.steps(0.0, 1.0).0, 1);
        let thin = Case { viscosity_m2_s: 1e-7, ..case() };
        assert_eq!(Decay::of(&thin).expect("thick").steps(0.5, 1.0), (MOST_STEPS, false));
    }

    #[test]
    fn what_is_driven_or_streams_freely_never_rests() {
        let with = |axis, side| Case { sides: case().sides.with(axis, [side; 2]), ..case() };
        assert!(Decay::of(&with(0, Side::Moving(glam::Vec3::Y))).is_none());
        assert!(Decay::of(&Case { viscosity_m2_s: 0.0, ..case() }).is_none());
        let mut streams = with(0, Side::Periodic);
        assert!(Decay::of(&streams).is_some());
        for through in [Side::Periodic, Side::Outflow] {
            streams.sides = Sides::all(Side::FreeSlip).with(0, [through; 2]);
            assert!(Decay::of(&streams).is_none());
        }
    }
}
