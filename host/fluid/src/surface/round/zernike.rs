//! Polynomials on the unit disc (Zernike 1934).
//!
//! Z_j(x) cos(m theta), Z_j = sqrt(2 (2 j + m + 1)) x^m P_j(2 x^2 - 1) with Jacobi's P of beta =
//! m, are smooth where the radius x is 0, resolve waves of any direction alike, and the integral
//! of Z_i Z_j x dx from 0 to 1 is 1 or 0.

use super::{
    dense::Square,
    jacobi::{gauss, polynomials},
};

/// Z_j and x Z_j' at a radius, for j = 0, 1, ... `count` - 1 and m `waves_around`.
pub fn values(waves_around: u32, count: usize, x: f64) -> Vec<[f64; 2]> {
    let m = f64::from(waves_around);
    let power = x.powi(waves_around as i32);
    let mut all = polynomials(count, m, 2.0 * x * x - 1.0);
    for (j, z) in all.iter_mut().enumerate() {
        let scale = (2.0 * (2.0 * j as f64 + m + 1.0)).sqrt() * power;
        *z = [scale * z[0], scale * (m * z[0] + 4.0 * x * x * z[1])];
    }
    all
}

/// Integrals over the disc, each by x dx from 0 to 1.
pub struct Products {
    /// Z_i' Z_j' + m^2 Z_i Z_j / x^2: of the squared gradient.
    pub gradient: Square,
    /// Z_i x Z_j'.
    pub stretch: Square,
    /// Z_j x Z_i'.
    pub stretch_back: Square,
    /// x Z_i' x Z_j'.
    pub stretched: Square,
}

impl Products {
    /// The integrals of `count` functions, but for rounding.
    pub fn new(waves_around: u32, count: usize) -> Self {
        let m2 = f64::from(waves_around * waves_around);
        let [mut gradient, mut stretch, mut stretched] = [(); 3].map(|()| Square::zeros(count));
        // Polynomials of x^2 of degree m + 2 count: dx^2 = 2 x dx, on half of Gauss's length.
        for [u, w] in gauss(count + waves_around as usize / 2 + 1) {
            let (x2, w) = (0.5 * (1.0 + u), 0.25 * w);
            let z = values(waves_around, count, x2.sqrt());
            for (at, (i, j)) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))).enumerate()
            {
                let ([z_i, slope_i], [z_j, slope_j]) = (z[i], z[j]);
                gradient.values[at] += w * (slope_i * slope_j + m2 * z_i * z_j) / x2;
                stretch.values[at] += w * z_i * slope_j;
                stretched.values[at] += w * slope_i * slope_j;
            }
        }
        Self { gradient, stretch_back: stretch.transposed(), stretch, stretched }
    }
}
