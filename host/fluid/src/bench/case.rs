//! Flows whose exact solution is known.
//!
//! All are in the unit cube; s = sin(pi x) and c = cos(pi x) of each axis in turn.

use std::f64::consts::PI;

use glam::DVec3;

use crate::solver::{Side, Sides};

/// Kinematic viscosity of all cases.
const VISCOSITY_M2_S: f64 = 0.01;

/// A flow that is computed to its end and compared with the exact one.
pub struct Case {
    /// Name on the command line and in rows.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// Kinematic viscosity.
    pub viscosity_m2_s: f64,
    /// What is around the unit cube.
    pub sides: Sides,
    /// Time that is computed.
    pub end_s: f64,
    /// Largest component of the velocity, from which the number of steps follows.
    pub speed_m_s: f64,
    /// The exact velocity at a point and a time.
    pub flow_m_s: fn(DVec3, f64) -> DVec3,
    /// The acceleration at time 0, if it is driven.
    pub force_m_s2: Option<fn(DVec3) -> DVec3>,
    /// What the acceleration is multiplied with later.
    pub force_scale: fn(time_s: f64) -> f64,
}

impl Case {
    /// Steps in each of which the flow crosses at most `cfl` cells: the same for every solver.
    #[must_use]
    pub fn steps(&self, n: usize, cfl: f64) -> usize {
        (self.end_s * n as f64 * self.speed_m_s / cfl - 1e-9).ceil().max(1.0) as usize
    }
}

/// Decaying plane vortices.
pub const TAYLOR_GREEN: Case = Case {
    name: "taylor-green",
    about: "plane vortices that decay: the viscous term (Taylor, Green 1937)",
    viscosity_m2_s: VISCOSITY_M2_S,
    sides: SLIDING,
    end_s: 1.0,
    speed_m_s: 1.0,
    flow_m_s: |point, time_s| taylor_green(point) * decay(2.0, time_s),
    force_m_s2: None,
    force_scale: |_| 1.0,
};

/// The same on a uniform stream.
pub const TAYLOR_GREEN_DRIFT: Case = Case {
    name: "taylor-green-drift",
    about: "the same, carried through a periodic box: wrong without advection",
    viscosity_m2_s: VISCOSITY_M2_S,
    sides: Sides([[Side::Periodic; 2]; 3]),
    end_s: 1.0,
    speed_m_s: 2.0,
    flow_m_s: |point, time_s| {
        let drift_m_s = DVec3::new(1.0, 0.5, 0.25);
        let vortices = taylor_green(2.0 * (point - drift_m_s * time_s));
        drift_m_s + vortices * decay(8.0, time_s)
    },
    force_m_s2: None,
    force_scale: |_| 1.0,
};

/// The manufactured flow.
pub const MMS: Case = Case {
    name: "mms",
    about: "a manufactured flow in space, driven: every term of the equation",
    viscosity_m2_s: VISCOSITY_M2_S,
    sides: SLIDING,
    end_s: 1.0,
    speed_m_s: 2.0,
    flow_m_s: |point, time_s| manufactured(point) * decay(3.0, time_s),
    force_m_s2: Some(manufactured_force),
    force_scale: |time_s| decay(6.0, time_s),
};

/// All cases with an exact end.
pub const CASES: &[Case] = &[TAYLOR_GREEN, TAYLOR_GREEN_DRIFT, MMS];

const SLIDING: Sides = Sides([[Side::FreeSlip; 2]; 3]);

/// What viscosity leaves of waves whose squared wave numbers sum to `squares` pi^2.
fn decay(squares: f64, time_s: f64) -> f64 {
    (-squares * PI * PI * VISCOSITY_M2_S * time_s).exp()
}

/// (s c, -c s, 0).
#[must_use]
pub fn taylor_green(point: DVec3) -> DVec3 {
    let (s, c) = waves(point);
    DVec3::new(s.x * c.y, -c.x * s.y, 0.0)
}

/// (s c c, c s c, -2 c c s).
#[must_use]
pub fn manufactured(point: DVec3) -> DVec3 {
    let (s, c) = waves(point);
    DVec3::new(s.x * c.y * c.z, c.x * s.y * c.z, -2.0 * c.x * c.y * s.z)
}

/// u . grad u + grad(c c c) of the manufactured flow. The gradient drives nothing: it is there
/// for the projection to take out.
#[must_use]
pub fn manufactured_force(point: DVec3) -> DVec3 {
    let (s, c) = waves(point);
    let u = manufactured(point);
    let along_x = PI * DVec3::new(c.x * c.y * c.z, -s.x * s.y * c.z, 2.0 * s.x * c.y * s.z);
    let along_y = PI * DVec3::new(-s.x * s.y * c.z, c.x * c.y * c.z, 2.0 * c.x * s.y * s.z);
    let along_z = PI * DVec3::new(-s.x * c.y * s.z, -c.x * s.y * s.z, -2.0 * c.x * c.y * c.z);
    u.x * along_x + u.y * along_y + u.z * along_z + gradient(point)
}

/// Taylor-Green plus the gradient of c c c / pi: a smooth field with divergence.
#[must_use]
pub fn divergent(point: DVec3) -> DVec3 {
    taylor_green(point) + gradient(point) / PI
}

/// A dozen free waves of seeded strength, none shorter than half the box, together nowhere
/// faster than 1 m/s along an axis. Their divergence is for a projection to take out.
#[must_use]
pub fn smooth(point: DVec3) -> DVec3 {
    let mut seed = 1u32;
    let mut draw = || {
        // Numerical Recipes' congruence (Press et al. 1992).
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1u32 << 24)
    };
    (0..12).fold(DVec3::ZERO, |sum, _| {
        let waves = DVec3::new(draw(), draw(), draw()).map(|share| (4.0 * share).floor() + 1.0);
        let strength = 0.47 * (DVec3::new(draw(), draw(), draw()) - 0.5);
        let (s, c) = ((PI * waves * point).map(f64::sin), (PI * waves * point).map(f64::cos));
        sum + strength * DVec3::new(s.x * c.y * c.z, c.x * s.y * c.z, c.x * c.y * s.z)
    })
}

/// grad(c c c).
fn gradient(point: DVec3) -> DVec3 {
    let (s, c) = waves(point);
    -PI * DVec3::new(s.x * c.y * c.z, c.x * s.y * c.z, c.x * c.y * s.z)
}

fn waves(point: DVec3) -> (DVec3, DVec3) {
    ((PI * point).map(f64::sin), (PI * point).map(f64::cos))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 1e-5;

    fn derivative(field: fn(DVec3) -> DVec3, point: DVec3, axis: DVec3) -> DVec3 {
        (field(point + STEP * axis) - field(point - STEP * axis)) / (2.0 * STEP)
    }

    #[test]
    fn flows_are_free_of_divergence_and_the_divergent_one_is_not() {
        let point = DVec3::new(0.31, 0.17, 0.66);
        let divergence = |field| {
            let [x, y, z] = DVec3::AXES.map(|axis| derivative(field, point, axis).dot(axis));
            x + y + z
        };
        assert!(divergence(taylor_green).abs() < 1e-8);
        assert!(divergence(manufactured).abs() < 1e-8);
        assert!(divergence(divergent).abs() > 0.1);
    }

    #[test]
    fn the_force_is_advection_plus_a_gradient() {
        let point = DVec3::new(0.31, 0.17, 0.66);
        let u = manufactured(point);
        let [x, y, z] = DVec3::AXES.map(|axis| derivative(manufactured, point, axis));
        let advection = u.x * x + u.y * y + u.z * z;
        let rest = manufactured_force(point) - advection;
        assert!((rest - gradient(point)).length() < 1e-8);
    }

    #[test]
    fn every_case_is_a_solution_but_for_a_gradient() {
        let (point, time_s, step) = (DVec3::new(0.31, 0.17, 0.66), 0.4, 1e-3);
        for case in CASES {
            // du/dt + u . grad u - nu lap u - f, by central differences.
            let rest = |at: DVec3| {
                let u =
                    |offset: DVec3, later_s: f64| (case.flow_m_s)(at + offset, time_s + later_s);
                let here = u(DVec3::ZERO, 0.0);
                let mut rest = (u(DVec3::ZERO, step) - u(DVec3::ZERO, -step)) / (2.0 * step);
                for axis in DVec3::AXES {
                    let [up, down] = [u(step * axis, 0.0), u(-step * axis, 0.0)];
                    rest += here.dot(axis) * (up - down) / (2.0 * step);
                    rest -= case.viscosity_m2_s * (up - 2.0 * here + down) / (step * step);
                }
                let force = case.force_m_s2.map_or(DVec3::ZERO, |force| force(at));
                rest - (case.force_scale)(time_s) * force
            };
            // A gradient is what has no curl.
            let slope = |axis: DVec3| {
                (rest(point + step * axis) - rest(point - step * axis)) / (2.0 * step)
            };
            let [x, y, z] = DVec3::AXES.map(slope);
            let curl = DVec3::new(y.z - z.y, z.x - x.z, x.y - y.x);
            assert!(curl.length() < 2e-3, "{}: {curl}", case.name);
        }
    }
}
