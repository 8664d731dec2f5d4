//! The waves of a round vessel: the shapes in which its surface sloshes.
//!
//! The potential phi of the liquid is harmonic, without flux through the wall. On the surface at
//! rest, some of its shapes rise everywhere in proportion to themselves: d phi/dy = lambda phi,
//! phi = f(r) cos(m theta) or f(r) sin(m theta). Each is a wave by itself (Lamb 1932, art. 191),
//! of omega^2 = lambda (g + sigma k^2/rho), where k^2 is the mean square of the gradient of the
//! shape by that of the shape: exact for an upright cylinder, whose lambda = k tanh(k depth), and
//! of first order in the capillarity for others.
//!
//! They are found for each m by the method of Ritz: polynomials on the disc, and the liquid
//! below condensed away ([`mod@slice`]).

mod dense;
mod jacobi;
mod mirrors;
mod profile;
mod sample;
mod slice;
mod table;
mod zernike;

use std::f64::consts::PI;

pub(crate) use profile::Profile;
pub(crate) use table::Table;

use self::{dense::Square, slice::Slice, zernike::Products};
use crate::solver::Refused;

/// A mode whose last coefficient is this part of all is not resolved: its lambda may be off by a
/// hundredth of a percent.
const UNRESOLVED: f64 = 1e-3;

/// A shape of the surface, f(r) cos(m theta) and, for m > 0, f(r) sin(m theta).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RadialMode {
    /// m: waves along a circle about the axis.
    pub waves_around: u32,
    /// Slope upwards of the potential at the surface by the potential itself.
    pub lambda_per_m: f64,
    /// k: root of the mean square of the gradient by that of the shape.
    pub wavenumber_per_m: f64,
    radius_m: f64,
    /// By the polynomials of Zernike on the disc of that radius.
    coefficients_per_m: Vec<f64>,
}

impl RadialMode {
    /// f in 1/m at a distance from the axis: the integral over the disc of (f cos(m theta))^2 is
    /// 1, and f is positive at the wall.
    #[cfg(test)]
    pub fn shape_per_m(&self, r_m: f64) -> f64 {
        let count = self.coefficients_per_m.len();
        self.combined(&zernike::values(self.waves_around, count, r_m / self.radius_m))
    }

    /// f in 1/m where the polynomials of its m have the values `z`.
    fn combined(&self, z: &[[f64; 2]]) -> f64 {
        z.iter().zip(&self.coefficients_per_m).map(|([z, _], c)| z * c).sum()
    }

    /// From an eigenvector of length 1 and its eigenvalue, that of a stiffness in m.
    fn new(radius_m: f64, m: u32, eigenvalue_m: f64, gradient: &Square, unit: Vec<f64>) -> Self {
        let at_rim = zernike::values(m, unit.len(), 1.0);
        let rim: f64 = at_rim.iter().zip(&unit).map(|(z, c)| z[0] * c).sum();
        let angle = if m == 0 { 2.0 * PI } else { PI };
        let scale_per_m = rim.signum() / (radius_m * angle.sqrt());
        Self {
            waves_around: m,
            lambda_per_m: eigenvalue_m / (radius_m * radius_m),
            wavenumber_per_m: gradient.form(&unit).sqrt() / radius_m,
            radius_m,
            coefficients_per_m: unit.into_iter().map(|c| scale_per_m * c).collect(),
        }
    }

    /// k of the wave of the same lambda between upright walls: at depth d in a vessel that is
    /// `depth_m` deep the potential is about that at the surface times
    /// cosh k(depth - d) / cosh(k depth), which is exact for an upright cylinder.
    pub fn wavenumber_below_per_m(&self, depth_m: f64) -> f64 {
        // x tanh x = lambda depth by Newton's method, from above.
        let goal = self.lambda_per_m * depth_m;
        let mut x = goal + goal.sqrt();
        for _ in 0..20 {
            let tanh = x.tanh();
            x -= (x * tanh - goal) / (tanh + x * (1.0 - tanh * tanh));
        }
        x / depth_m
    }

    /// Shapes that it stands for: one, or that of the cosine and that of the sine.
    pub fn shapes(&self) -> usize {
        if self.waves_around == 0 { 1 } else { 2 }
    }
}

/// The modes of a vessel, the slowest first: those whose wavelength 2 pi/k is at least
/// `shortest_m`, and no more than stand for `most` shapes. None is constant.
///
/// # Errors
/// [`Refused`] if `shortest_m` is not positive.
pub(crate) fn modes(
    profile: &Profile,
    most: usize,
    shortest_m: f64,
) -> Result<Vec<RadialMode>, Refused> {
    if !(shortest_m > 0.0 && shortest_m.is_finite()) {
        return Err(Refused { what: "shortest wave in m", value: shortest_m });
    }
    // A disc has about (k R)^2/4 modes of wavenumbers up to k (Weyl 1911).
    let enough = 2.0 * (most as f64).sqrt() + 2.0;
    let waves = enough.min(2.0 * PI * profile.radius_m() / shortest_m);
    let mut found = modes_to_degree(profile, most, waves, (1.2 * waves + 10.0) as u32);
    found.retain(|mode| mode.wavenumber_per_m * shortest_m <= 2.0 * PI);
    found.sort_by(|a, b| a.lambda_per_m.total_cmp(&b.lambda_per_m));
    let mut shapes = 0;
    found.retain(|mode| {
        shapes += mode.shapes();
        shapes <= most
    });
    Ok(found)
}

/// Modes of wavenumbers up to `waves` by the radius, and others, in order of m: the `most`
/// slowest are among them, as far as polynomials up to `degree` resolve them.
fn modes_to_degree(profile: &Profile, most: usize, waves: f64, degree: u32) -> Vec<RadialMode> {
    let slices = slice::slices(profile, waves / profile.radius_m());
    let mut found: Vec<RadialMode> = Vec::new();
    for m in 0..=degree {
        let more = modes_around(profile, &slices, m, degree);
        let Some(slowest) = more.first() else { break };
        // The more waves around, the faster is the slowest.
        let slower = found.iter().filter(|mode| mode.lambda_per_m < slowest.lambda_per_m);
        if slower.map(RadialMode::shapes).sum::<usize>() >= most {
            break;
        }
        found.extend(more);
    }
    found
}

/// The modes of one m, the slowest first.
fn modes_around(profile: &Profile, slices: &[Slice], m: u32, degree: u32) -> Vec<RadialMode> {
    let count = ((degree - m) / 2 + 1) as usize;
    let disc = Products::new(m, count);
    let stiffness_m = slice::stiffness(slices, m, &disc);
    // Z_0 of m = 0 is the constant, which nothing moves: all others are free of it.
    let constants = usize::from(m == 0);
    let modes = stiffness_m.without_first(constants).eigenvectors();
    let resolved = modes.into_iter().filter(|(_, v)| v[v.len() - 1].abs() < UNRESOLVED);
    let mode = |(eigenvalue_m, vector): (f64, Vec<f64>)| {
        let coefficients = [vec![0.0; constants], vector].concat();
        RadialMode::new(profile.radius_m(), m, eigenvalue_m, &disc.gradient, coefficients)
    };
    resolved.map(mode).collect()
}

#[cfg(test)]
mod tests;
