//! How waves swing and die, in f64 and from first principles: roots s of amplitudes exp(s t).
//!
//! Waves on liquid of depth h have omega^2 = (g k + sigma k^3 / rho) tanh(k h) (Lamb 1932, art.
//! 267), and with viscosity nu, a = nu k^2, the root of Lamb's art. 349
//!
//! ```text
//! (s + 2 a)^2 + omega^2 = 4 a^2 sqrt(1 + s / a)
//! ```
//! found here by Newton's method in complex numbers. Springs between nodes at h, with wave number
//! k along x, have
//!
//! ```text
//! m omega^2 = k_g + (k_st + k_sh) (2 - 2 cos(k h)),    gamma = b / 2 m
//! ```
//! exactly on a strip that is two nodes wide: at a free end a cosine whose crest is half a spacing
//! beyond the last node is its own mirror image, as each node has one structural spring along each
//! way of x, and one shear spring, to the other row, which moves alike. k_sh is 1/6 of the
//! tension, k_st 2/3. A wide sheet has two shear springs each way but at its edges: for fine
//! nodes m omega^2 = k_g + tension k^2 by area.

use glam::DVec2;

use super::sheet::{DENSITY_KG_M3, DEPTH_M, GRAVITY_M_S2, spacing_m};
use crate::surface::SurfaceParams;

/// A complex root: its real part, below 0, is the decay in 1/s, its imaginary one the frequency.
pub type Root = DVec2;

/// The root of waves on the liquid.
pub fn of_water(params: &SurfaceParams, k: f64, viscosity_m2_s: f64) -> Root {
    let tension = f64::from(params.tension_n_per_m) / DENSITY_KG_M3;
    let omega2 = (GRAVITY_M_S2 * k + tension * k.powi(3)) * (k * DEPTH_M).tanh();
    let a = viscosity_m2_s * k * k;
    let mut s = DVec2::new(-2.0 * a, omega2.sqrt());
    if a == 0.0 {
        return s;
    }
    for _ in 0..50 {
        let (from, root) = (s + 2.0 * a * DVec2::X, sqrt(DVec2::X + s / a));
        let value = times(from, from) + omega2 * DVec2::X - 4.0 * a * a * root;
        let slope = 2.0 * from - 2.0 * a * over(DVec2::X, root);
        let step = over(value, slope);
        s -= step;
        if step.length() <= 1e-15 * s.length() {
            break;
        }
    }
    s
}

/// The root of springs on a strip of n nodes to the edge.
pub fn of_strip(params: &SurfaceParams, k: f64, n: usize) -> Root {
    let h = spacing_m(n);
    let springs = 5.0 / 6.0 * f64::from(params.tension_n_per_m) * (2.0 - 2.0 * (k * h).cos());
    damped(params, springs / (h * h))
}

/// The root of the sheet that infinitely many springs are.
pub fn of_sheet(params: &SurfaceParams, k: f64) -> Root {
    damped(params, f64::from(params.tension_n_per_m) * k * k)
}

fn damped(params: &SurfaceParams, springs_n_per_m3: f64) -> Root {
    let mass = f64::from(params.areal_mass_kg_m2);
    let omega2 = (f64::from(params.gravity_n_per_m3) + springs_n_per_m3) / mass;
    let gamma = 0.5 * f64::from(params.drag_n_s_per_m3) / mass;
    DVec2::new(-gamma, (omega2 - gamma * gamma).sqrt())
}

/// Amplitude and speed after `time_s` of what starts with amplitude 1 and at rest.
pub fn let_go(root: Root, time_s: f64) -> [f64; 2] {
    let (gamma, omega) = (-root.x, root.y);
    let (sin, cos) = (omega * time_s).sin_cos();
    let left = (-gamma * time_s).exp();
    let speed = -left * (gamma * gamma + omega * omega) / omega * sin;
    [left * (cos + gamma / omega * sin), speed]
}

/// Product of complex numbers.
pub fn times(a: DVec2, b: DVec2) -> DVec2 {
    DVec2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

/// Quotient of complex numbers.
pub fn over(a: DVec2, b: DVec2) -> DVec2 {
    times(a, DVec2::new(b.x, -b.y)) / b.length_squared()
}

/// The root with a real part above 0.
fn sqrt(a: DVec2) -> DVec2 {
    let real = (0.5 * (a.length() + a.x)).max(0.0).sqrt();
    if real > 0.0 { DVec2::new(real, 0.5 * a.y / real) } else { DVec2::new(0.0, (-a.x).sqrt()) }
}
