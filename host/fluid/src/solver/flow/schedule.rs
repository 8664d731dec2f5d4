//! Which scheme a step takes, and in how many parts.

use crate::solver::Scheme;

/// Sum over axes of |u| dt / h up to which one step of Adams and Bashforth does: one evaluation
/// of the fluxes instead of three.
const MULTISTEP_CFL: f64 = 0.35;

/// 12 nu dt / h^2 up to which it does; it is stable on the real axis to 1.
const MULTISTEP_VISCOUS: f64 = 0.8;

/// On the imaginary axis it is not: a wave grows by (w dt)^4 / 4 in a step. This much is left to
/// the energy guard, more has to be outdone by viscosity, which damps the same wave by 2 nu dt /
/// h^2 at least.
const MULTISTEP_GROWTH: f64 = 1e-7;

/// Sum over axes of |u| dt / h that one explicit part may cross. Three-stage Runge-Kutta is
/// stable on the imaginary axis to sqrt(3), with the pressure predicted to about 1.2 (measured
/// on inviscid vortices).
const CENTRAL_CFL: f64 = 1.1;

/// Up to this the trend of the pressure is extrapolated fully; beyond, ever less, as that is
/// explicit in time and would feed the finest ripples (measured likewise).
const TREND_CFL: f64 = 0.5;

/// 12 nu dt / h^2 of one explicit part: the scheme is stable on the real axis to 2.51, and the
/// ghosts of a side that sticks add a few per cent to the largest eigenvalue.
const EXPLICIT_VISCOUS: f64 = 2.2;

/// Sum over axes of |u| dt / h of one multistep part whose viscosity is implicit: that is thick
/// enough to damp what would grow.
const IMPLICIT_CFL: f64 = 0.5;

/// What one explicit part of three stages costs in the time of one implicit multistep part.
const EXPLICIT_COST: f64 = 0.8;

/// Beyond this number of parts the flow is traced back instead.
const MAX_PARTS: f64 = 16.0;

/// The same of implicit parts where friction differs from place to place: there each takes a
/// solve of hundreds of iterations.
const MAX_PARTS_OF_STRESS: f64 = 4.0;

/// A scheme that is forced may take this many parts: more would not end in a lifetime.
const MAX_FORCED_PARTS: f64 = 1e4;

/// How to compute a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The scheme.
    pub scheme: Scheme,
    /// Number of equal parts.
    pub parts: u32,
    /// Share of the pressure's trend that is extrapolated from part to part.
    pub trend_share: f32,
}

impl Plan {
    fn new(scheme: Scheme, parts: f64, cfl: f64) -> Self {
        let trend_share = match scheme {
            Scheme::Central => (TREND_CFL * parts / cfl.max(TREND_CFL)).min(1.0).powi(2) as f32,
            _ => 0.0,
        };
        Self { scheme, parts: parts as u32, trend_share }
    }
}

/// Plans a step that crosses `cfl` cells and has diffusion number `viscous` = 12 nu dt / h^2, by
/// the forced scheme if there is one and [`MAX_FORCED_PARTS`] are enough for it.
pub fn plan(cfl: f64, viscous: f64, forced: Option<Scheme>) -> Plan {
    plan_of(cfl, viscous, forced, MAX_PARTS)
}

/// The same for friction that differs from place to place.
pub fn plan_stress(cfl: f64, viscous: f64, forced: Option<Scheme>) -> Plan {
    plan_of(cfl, viscous, forced, MAX_PARTS_OF_STRESS)
}

fn plan_of(cfl: f64, viscous: f64, forced: Option<Scheme>, most_implicit: f64) -> Plan {
    let forced = forced.and_then(|scheme| plan_forced(cfl, viscous, scheme));
    forced.unwrap_or_else(|| plan_freely(cfl, viscous, most_implicit))
}

/// As many parts as keep the scheme within its bounds. What Adams and Bashforth's waves grow by
/// is left to the energy guard.
fn plan_forced(cfl: f64, viscous: f64, scheme: Scheme) -> Option<Plan> {
    let parts = match scheme {
        Scheme::Multistep => (cfl / MULTISTEP_CFL).max(viscous / MULTISTEP_VISCOUS),
        Scheme::Central => (cfl / CENTRAL_CFL).max(viscous / EXPLICIT_VISCOUS),
        Scheme::MultistepImplicit => cfl / IMPLICIT_CFL,
        Scheme::Rest | Scheme::Traced | Scheme::Founding => 1.0,
    };
    let parts = parts.ceil().max(1.0);
    (parts <= MAX_FORCED_PARTS).then(|| Plan::new(scheme, parts, cfl))
}

fn plan_freely(cfl: f64, viscous: f64, most_implicit: f64) -> Plan {
    let growth = cfl.powi(4) / 4.0;
    let is_damped = growth <= MULTISTEP_GROWTH.max(viscous / 12.0);
    if cfl <= MULTISTEP_CFL && viscous <= MULTISTEP_VISCOUS && is_damped {
        return Plan::new(Scheme::Multistep, 1.0, cfl);
    }
    let needed = |load: f64, bound: f64| (load / bound).ceil().max(1.0);
    let explicit = needed(cfl, CENTRAL_CFL).max(needed(viscous, EXPLICIT_VISCOUS));
    let implicit = needed(cfl, IMPLICIT_CFL);
    let (scheme, parts) = if explicit <= MAX_PARTS && EXPLICIT_COST * explicit <= implicit {
        (Scheme::Central, explicit)
    } else if implicit <= most_implicit && viscous > EXPLICIT_VISCOUS {
        (Scheme::MultistepImplicit, implicit)
    } else if explicit <= MAX_PARTS {
        (Scheme::Central, explicit)
    } else {
        (Scheme::Traced, 1.0)
    };
    Plan::new(scheme, parts, cfl)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn slow_thin_flow_takes_one_part_and_a_jerk_is_traced() {
        let of = |cfl, viscous| {
            let plan = plan(cfl, viscous, None);
            (plan.scheme, plan.parts)
        };
        assert_eq!(of(0.0, 0.0), (Scheme::Multistep, 1));
        assert_eq!(of(0.3, 0.1), (Scheme::Multistep, 1));
        assert_eq!(of(0.3, 0.0), (Scheme::Central, 1));
        assert_eq!(of(1.5, 0.0), (Scheme::Central, 2));
        assert_eq!(of(0.9, 4.0), (Scheme::Central, 2));
        assert_eq!(of(0.5, 40.0), (Scheme::MultistepImplicit, 1));
        assert_eq!(of(1000.0, 1e9), (Scheme::Traced, 1));
        assert_eq!(of(4.0, 1e9), (Scheme::MultistepImplicit, 8));
        assert_eq!(plan_stress(4.0, 1e9, None).scheme, Scheme::Traced);
    }

    #[test]
    fn a_forced_scheme_takes_the_parts_it_needs_unless_they_never_end() {
        let of = |cfl, viscous, scheme| {
            let plan = plan(cfl, viscous, Some(scheme));
            (plan.scheme, plan.parts)
        };
        assert_eq!(of(0.3, 0.0, Scheme::Multistep), (Scheme::Multistep, 1));
        assert_eq!(of(3.5, 0.0, Scheme::Multistep), (Scheme::Multistep, 10));
        assert_eq!(of(0.1, 8.0, Scheme::Multistep), (Scheme::Multistep, 10));
        assert_eq!(of(0.1, 22.0, Scheme::Central), (Scheme::Central, 10));
        assert_eq!(of(5.0, 1e9, Scheme::MultistepImplicit), (Scheme::MultistepImplicit, 10));
        assert_eq!(of(0.1, 0.0, Scheme::Traced), (Scheme::Traced, 1));
        assert_eq!(of(0.1, 1e9, Scheme::Central), (Scheme::MultistepImplicit, 1));
        assert_eq!(of(1e9, 0.0, Scheme::Multistep), (Scheme::Traced, 1));
    }

    #[test]
    fn the_trend_of_the_pressure_is_followed_in_small_steps_only() {
        assert_eq!(plan(0.1, 0.0, None).trend_share, 1.0);
        assert_eq!(plan(0.5, 0.0, None).trend_share, 1.0);
        assert_eq!(plan(1.0, 0.0, None).trend_share, 0.25);
        assert_eq!(plan(2.0, 0.0, None).trend_share, 0.25);
    }

    proptest! {
        #[test]
        fn explicit_parts_are_within_their_bounds(cfl in 0.0..1e6f64, viscous in 0.0..1e6f64) {
            let plan = plan(cfl, viscous, None);
            let parts = f64::from(plan.parts);
            prop_assert!((1.0..=MAX_PARTS).contains(&parts));
            prop_assert!(plan.scheme == Scheme::Traced || cfl / parts <= CENTRAL_CFL);
            prop_assert!(plan.scheme != Scheme::Central || viscous / parts <= EXPLICIT_VISCOUS);
        }
    }
}
