//! Flows whose exact solution is known.
//!
//! All are in the unit cube between walls that the flow slides along, with s = sin(pi x) and
//! c = cos(pi x) of each axis in turn.

use std::f64::consts::PI;

use glam::DVec3;

/// A flow that is computed to its end and compared with the exact one.
pub struct Case {
    /// Name on the command line and in rows.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// Kinematic viscosity.
    pub viscosity_m2_s: f64,
    /// Time that is computed.
    pub end_s: f64,
    /// Largest speed, from which the number of steps follows.
    pub speed_m_s: f64,
    /// The velocity at time 0.
    pub velocity_m_s: fn(DVec3) -> DVec3,
    /// It decays as exp(-rate t).
    pub decay_per_s: fn(viscosity_m2_s: f64) -> f64,
    /// The acceleration at time 0, if it is driven; it decays twice as fast as the velocity.
    pub force_m_s2: Option<fn(DVec3) -> DVec3>,
    /// What our solver's relative error at n = 32 is not to exceed.
    pub target_at_32: f64,
}

impl Case {
    /// Steps at which no flow crosses more than a cell in one: the same for every solver.
    #[must_use]
    pub fn steps(&self, n: usize) -> usize {
        (self.end_s * n as f64 * self.speed_m_s - 1e-9).ceil().max(1.0) as usize
    }

    /// The exact velocity.
    #[must_use]
    pub fn exact(&self, point: DVec3, time_s: f64) -> DVec3 {
        let rate = (self.decay_per_s)(self.viscosity_m2_s);
        (self.velocity_m_s)(point) * (-rate * time_s).exp()
    }

    /// Scale of the force.
    #[must_use]
    pub fn force_scale(&self, time_s: f64) -> f64 {
        (-2.0 * (self.decay_per_s)(self.viscosity_m2_s) * time_s).exp()
    }
}

/// All cases with an exact end.
pub const CASES: &[Case] = &[
    Case {
        name: "taylor-green",
        about: "plane vortices that decay: the viscous term (Taylor, Green 1937)",
        viscosity_m2_s: 0.01,
        end_s: 1.0,
        speed_m_s: 1.0,
        velocity_m_s: taylor_green,
        decay_per_s: |viscosity| 2.0 * PI * PI * viscosity,
        force_m_s2: None,
        target_at_32: 1e-2,
    },
    Case {
        name: "mms",
        about: "a manufactured flow in space, driven: every term of the equation",
        viscosity_m2_s: 0.01,
        end_s: 1.0,
        speed_m_s: 2.0,
        velocity_m_s: manufactured,
        decay_per_s: |viscosity| 3.0 * PI * PI * viscosity,
        force_m_s2: Some(manufactured_force),
        target_at_32: 5e-2,
    },
];

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
    fn decay_is_what_viscosity_makes_of_the_flow() {
        let point = DVec3::new(0.31, 0.17, 0.66);
        for case in CASES {
            let second = |axis| {
                let u = |side: f64| (case.velocity_m_s)(point + side * 1e-3 * axis);
                (u(1.0) - 2.0 * u(0.0) + u(-1.0)) / 1e-6
            };
            let laplacian = DVec3::AXES.map(second).into_iter().sum::<DVec3>();
            let rate = (case.decay_per_s)(1.0);
            assert!(
                (laplacian + rate * (case.velocity_m_s)(point)).length() < 1e-3,
                "{}",
                case.name
            );
        }
    }
}
