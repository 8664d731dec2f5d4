//! Which scheme a step takes, and in how many parts.

use crate::solver::Scheme;

/// Sum over axes of |u| dt / h that one explicit part may cross. Three-stage Runge-Kutta is
/// stable on the imaginary axis to sqrt(3); the rest is room for the speed to grow on the way.
const CENTRAL_CFL: f64 = 1.4;

/// 12 nu dt / h^2 of one explicit part: the scheme is stable on the real axis to 2.51.
const EXPLICIT_VISCOUS: f64 = 2.4;

/// Parts up to which viscosity is explicit although the speed would allow for fewer.
const EXPLICIT_PARTS: f64 = 2.0;

/// Beyond this number of parts the flow is traced back instead.
const MAX_PARTS: f64 = 16.0;

/// How to compute a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The scheme.
    pub scheme: Scheme,
    /// Number of equal parts.
    pub parts: u32,
}

/// Plans a step that crosses `cfl` cells and has diffusion number `viscous` = 12 nu dt / h^2.
pub fn plan(cfl: f64, viscous: f64) -> Plan {
    let parts = (cfl / CENTRAL_CFL).ceil().max(1.0);
    let parts_if_explicit = parts.max((viscous / EXPLICIT_VISCOUS).ceil());
    if parts > MAX_PARTS {
        return Plan { scheme: Scheme::Traced, parts: 1 };
    }
    if parts_if_explicit <= parts.max(EXPLICIT_PARTS) {
        return Plan { scheme: Scheme::Central, parts: parts_if_explicit as u32 };
    }
    Plan { scheme: Scheme::CentralImplicit, parts: parts as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn slow_thin_flow_takes_one_part_and_a_jerk_is_traced() {
        assert_eq!(plan(0.0, 0.0), Plan { scheme: Scheme::Central, parts: 1 });
        assert_eq!(plan(1.5, 0.0), Plan { scheme: Scheme::Central, parts: 2 });
        assert_eq!(plan(0.5, 4.0), Plan { scheme: Scheme::Central, parts: 2 });
        assert_eq!(plan(0.5, 40.0), Plan { scheme: Scheme::CentralImplicit, parts: 1 });
        assert_eq!(plan(1000.0, 1e9), Plan { scheme: Scheme::Traced, parts: 1 });
    }

    proptest! {
        #[test]
        fn explicit_parts_are_within_their_bounds(cfl in 0.0..1e6f64, viscous in 0.0..1e6f64) {
            let plan = plan(cfl, viscous);
            let parts = f64::from(plan.parts);
            prop_assert!((1.0..=MAX_PARTS).contains(&parts));
            prop_assert!(plan.scheme == Scheme::Traced || cfl / parts <= CENTRAL_CFL);
            prop_assert!(plan.scheme != Scheme::Central || viscous / parts <= EXPLICIT_VISCOUS);
        }
    }
}
