//! How fast a surface that is left alone has to come to rest.
//!
//! A mode with s^2 + 2 gamma s + omega^2 = 0 decays at gamma, or where nothing swings at more than
//! omega^2 / 2 gamma. Of springs gamma = b / 2m, and omega^2 >= k_g / m; of waves gamma is at least
//! nu k^2 and what drag adds, on the way between Lamb's limits 2 nu k^2 of thin liquids and
//! omega^2 / 2 nu k^2 of thick ones.
//!
//! In what is round of radius R no wave has a smaller k than 1.841 / R (Rayleigh's quotient; that
//! of an upright cylinder). The more room there is below, the larger is lambda: so that of a pot as
//! deep as it is wide is at least that of the cone of 45 degrees in it, 1/R for the slowest, whose
//! potential is x y above its tip; and so at least half of k tanh(k h).

use std::f64::consts::PI;

use super::{case::Case, world::World};
use crate::{torture::ledger::Ledger, vessel::Vessel};

/// A step of RK4 at the end of its range leaves e^-.43 of what should be e^-2.5, and Lamb's limits
/// are apart between.
const SHARE_OF_RATE: f64 = 0.15;

/// Critically damped motion may be this much above its exponential for a while.
const ABOVE: f64 = 20.0;

/// Longest step.
const LONGEST_STEP_S: f64 = 1e3;

/// Radians of the fastest spring in a step: 64 sub-steps of 2.5 are what RK4 takes at most.
const MOST_RADIANS: f64 = 100.0;

/// Steps that it is waited for, and of how many nodes together.
const MOST_STEPS: usize = 200;
const MOST_NODES: usize = 1 << 21;

/// How a surface comes to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay {
    /// Slowest decay of an amplitude.
    pub rate_per_s: f64,
    /// Length of the steps it is given.
    pub dt_s: f64,
    /// Their number.
    pub steps: usize,
}

impl Decay {
    /// How the surface of a case comes to rest; `None` if nothing damps it, or it breaks.
    pub fn of(case: &Case) -> Option<Self> {
        if case.splashes {
            return None;
        }
        let (rate_per_s, longest_s) = match case.params.model {
            "spring" => of_springs(case),
            _ => (of_waves(case), LONGEST_STEP_S),
        };
        let rate_per_s = SHARE_OF_RATE * rate_per_s;
        let dt_s = (1.0 / rate_per_s).min(longest_s);
        let nodes: usize = case.nodes().into_iter().product();
        let steps = (MOST_NODES / nodes).clamp(16, MOST_STEPS);
        (rate_per_s > 0.0 && dt_s > 1e-5).then_some(Self { rate_per_s, dt_s, steps })
    }

    /// Leaves the surface alone and looks at what is left.
    pub fn ask(&self, world: &mut World<'_>, ledger: &mut Ledger) {
        let from_j = world.surface.energy_j();
        for _ in 0..self.steps {
            world.surface.step(self.dt_s as f32);
        }
        let left_j = world.surface.energy_j();
        let left = (left_j / from_j.max(f64::MIN_POSITIVE)).sqrt();
        let lasts_s = self.dt_s * self.steps as f64;
        let allowed = ABOVE * (-self.rate_per_s * lasts_s).exp();
        ledger.most("rest_steps", self.steps as f64);
        ledger.check("left_at_rest", left, allowed, world.case.steps + self.steps);
    }
}

/// The slower of both ways to decay.
fn slower(gamma_per_s: f64, omega2_per_s2: f64) -> f64 {
    if gamma_per_s > 0.0 { gamma_per_s.min(0.5 * omega2_per_s2 / gamma_per_s) } else { 0.0 }
}

/// Slowest decay of springs, and the longest step that RK4 takes with them.
fn of_springs(case: &Case) -> (f64, f64) {
    let p = &case.params;
    let [mass, gravity, tension, bend, drag] =
        [p.areal_mass_kg_m2, p.gravity_n_per_m3, p.tension_n_per_m, p.bend, p.drag_n_s_per_m3]
            .map(f64::from);
    let springs = 8.0 * tension * (5.0 / 6.0 + bend) / case.spacing_m().powi(2);
    let fastest = ((gravity + springs) / mass).sqrt().max(drag / mass);
    (slower(0.5 * drag / mass, gravity / mass), MOST_RADIANS / fastest)
}

/// Slowest decay of waves: of the longest or of the shortest.
fn of_waves(case: &Case) -> f64 {
    let [density, viscosity, gravity] =
        [case.density_kg_m3, case.viscosity_m2_s, case.gravity_m_s2].map(f64::from);
    let [tension, drag] = [case.params.tension_n_per_m, case.params.drag_n_s_per_m3].map(f64::from);
    let most = case.nodes().into_iter().max().unwrap_or(1) as f64;
    let (longest, share) = match &case.vessel {
        Vessel::Pot { radius_m, .. } => (1.841 / f64::from(*radius_m), 0.5),
        _ => (PI / (most * case.spacing_m()), 1.0),
    };
    let rate = |k: f64| {
        let lambda = share * k * (k * case.depth_m()).tanh();
        let omega2 = lambda * (gravity + tension / density * k * k);
        slower(viscosity * k * k + 0.5 * drag * lambda / density, 0.5 * omega2)
    };
    // Between them the rate rises or falls, or has its least where it is omega^2 / 2 gamma.
    let waves = (0..64).map(|n| longest * (1.5 * most).powf(f64::from(n) / 63.0));
    waves.map(rate).fold(f64::MAX, f64::min)
}
