//! How one mode swings and dies.
//!
//! Lamb 1932, art. 349: waves exp(s t) on deep viscous liquid have, with a = nu k^2,
//!
//! ```text
//! (s + 2 a)^2 + omega^2 = 4 a^2 sqrt(1 + s / a)
//! ```
//! For z = sqrt(1 + s/a) and Q = (omega/a)^2 that is z^4 + 2 z^2 - 4 z + 1 + Q = 0. It has no z^3,
//! so it is (z^2 + b z + c)(z^2 - b z + d) with
//!
//! ```text
//! y = b^2 > 0,   y^3 + 4 y^2 - 4 Q y - 16 = 0,   c = 1 + y/2 + 2/b,   d = 1 + y/2 - 2/b
//! ```
//! and the roots that decay into the depth are those of the second factor. What two roots s make is
//! s^2 + 2 gamma s + Omega^2: with z^2 = b z - d, and as z = 1 turns the product of both factors
//! into Q,
//!
//! ```text
//! gamma = 2 a (1 - 1/b),   Omega^2 = omega^2 (1 + b + d) / (1 + b + c)
//! ```
//! At small viscosity these are 2 a and omega^2; at large one the slower root is -omega^2 / 2a, the
//! creep of honey.

use super::{Liquid, Mode};

/// A mode of one liquid: w' = answer (force - stiffness a) - 2 gamma w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping {
    /// Acceleration of the amplitude by a force per density; 0 for what keeps the volume.
    pub answer_per_m: f64,
    /// What gravity and tension give back for an amplitude, per density.
    pub stiffness_m_s2: f64,
    /// Decay of the amplitude.
    pub gamma_per_s: f64,
}

impl Damping {
    pub(super) fn of(mode: Mode, liquid: &Liquid) -> Self {
        let Mode { lambda_per_m, wavenumber_per_m, .. } = mode;
        let per_density = 1.0 / liquid.density_kg_m3;
        let squared = wavenumber_per_m * wavenumber_per_m;
        let stiffness_m_s2 = liquid.gravity_m_s2 + liquid.tension_n_per_m * per_density * squared;
        let omega2 = lambda_per_m * stiffness_m_s2;
        let (gamma_per_s, slowed) = viscous(liquid.viscosity_m2_s * squared, omega2);
        let answer_per_m = lambda_per_m * slowed;
        let drag_per_s = 0.5 * liquid.drag_n_s_per_m3 * per_density * answer_per_m;
        Self { answer_per_m, stiffness_m_s2, gamma_per_s: gamma_per_s + drag_per_s }
    }

    /// Square of the frequency that it would have undamped.
    pub fn omega2_per_s2(&self) -> f64 {
        self.answer_per_m * self.stiffness_m_s2
    }
}

/// gamma, and Omega^2 / omega^2, for a = nu k^2.
fn viscous(a_per_s: f64, omega2_per_s2: f64) -> (f64, f64) {
    if a_per_s == 0.0 {
        return (0.0, 1.0);
    }
    // Larger ones are as good as inviscid, and their powers would leave f64.
    let q = (omega2_per_s2 / (a_per_s * a_per_s)).min(1e60);
    // Newton from above: convex there. The root is below that of y^2 = 4 q plus that of q = 0.
    let mut y = 2.0 * q.sqrt() + 2.0;
    for _ in 0..60 {
        let value = ((y + 4.0) * y - 4.0 * q) * y - 16.0;
        let step = value / ((3.0 * y + 8.0) * y - 4.0 * q);
        y -= step;
        if step.abs() <= 1e-15 * y {
            break;
        }
    }
    let b = y.sqrt();
    let (c, d) = (1.0 + 0.5 * y + 2.0 / b, 1.0 + 0.5 * y - 2.0 / b);
    (2.0 * a_per_s * (1.0 - 1.0 / b), (1.0 + b + d) / (1.0 + b + c))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Roots of the quadratic that gamma and Omega^2 make, as (real, imaginary) parts.
    fn roots(a: f64, omega2: f64) -> [(f64, f64); 2] {
        let (gamma, slowed) = viscous(a, omega2);
        let inside = gamma * gamma - omega2 * slowed;
        let root = inside.abs().sqrt();
        if inside >= 0.0 {
            // The smaller one from the product, as the difference would lose it.
            [(-gamma - root, 0.0), (-omega2 * slowed / (gamma + root), 0.0)]
        } else {
            [(-gamma, root), (-gamma, -root)]
        }
    }

    /// |left - right| of the dispersion relation over the largest of its terms.
    fn residual(a: f64, omega2: f64, (re, im): (f64, f64)) -> f64 {
        let times = |x: (f64, f64), y: (f64, f64)| (x.0 * y.0 - x.1 * y.1, x.0 * y.1 + x.1 * y.0);
        let moved = (re + 2.0 * a, im);
        let square = times(moved, moved);
        let (p, q) = (1.0 + re / a, im / a);
        let size = p.hypot(q);
        // Of a negative number close to the axis the half of p below cancels.
        let real = ((size + p) / 2.0).max(0.0).sqrt();
        let root = (real, if real > 0.0 { q / (2.0 * real) } else { 0.0 });
        let right = (4.0 * a * a * root.0, 4.0 * a * a * root.1);
        let left = (square.0 + omega2, square.1);
        let scale = square.0.hypot(square.1).max(omega2).max(right.0.hypot(right.1));
        (left.0 - right.0).hypot(left.1 - right.1) / scale
    }

    #[test]
    fn the_roots_are_lambs() {
        for exponent in -8..9 {
            let (a, omega2) = (1.0, 10f64.powi(exponent));
            for root in roots(a, omega2) {
                assert!(root.0 < 0.0);
                let wrong = residual(a, omega2, root);
                assert!(wrong < 1e-9, "omega^2 = {omega2}, s = {root:?}: {wrong}");
            }
        }
    }

    #[test]
    fn waves_die_by_twice_nu_k_squared_and_honey_creeps() {
        let (gamma, slowed) = viscous(1e-4, 1.0);
        assert!((gamma / 2e-4 - 1.0).abs() < 0.01 && (slowed - 1.0).abs() < 1e-3);
        let (a, omega2) = (1e3, 1e-3);
        let [fast, slow] = roots(a, omega2);
        assert!((slow.0 / (-omega2 / (2.0 * a)) - 1.0).abs() < 1e-6, "{slow:?}");
        assert!((fast.0 / (-0.9126 * a) - 1.0).abs() < 1e-3, "{fast:?}: Lamb's other root");
        assert_eq!(viscous(0.0, 3.0), (0.0, 1.0));
    }

    #[test]
    fn nothing_finite_leaves_f64() {
        for (a, omega2) in [(1e-30, 1e30), (1e30, 1e-30), (1e12, 0.0), (1e-12, 1e20)] {
            let (gamma, slowed) = viscous(a, omega2);
            assert!(gamma.is_finite() && gamma >= 0.0, "{a} {omega2}: {gamma}");
            assert!(slowed > 0.0 && slowed <= 1.0 + 1e-12, "{a} {omega2}: {slowed}");
        }
    }
}
