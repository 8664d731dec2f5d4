//! Drag of a sphere in a liquid, in the two-term form that the device evaluates.

use std::f64::consts::PI;

/// F = (c1 + c2 |w|) w, w the velocity of the liquid relative to the probe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drag {
    /// c1 in N s/m.
    pub linear_n_s_per_m: f64,
    /// c2 in N s^2/m^2.
    pub quadratic_n_s2_per_m2: f64,
}

/// Drag of a sphere of radius a at a speed w: 6 pi mu a w (1 + 0.15 Re^0.687),
/// Re = 2 a w / nu (Schiller & Naumann 1935, for Re < 800); zero in a liquid without viscosity.
#[must_use]
pub fn sphere_drag_n(
    radius_m: f64,
    density_kg_m3: f64,
    viscosity_m2_s: f64,
    speed_m_s: f64,
) -> f64 {
    if viscosity_m2_s <= 0.0 {
        return 0.0;
    }
    let stokes_n = 6.0 * PI * density_kg_m3 * viscosity_m2_s * radius_m * speed_m_s;
    let reynolds = 2.0 * radius_m * speed_m_s / viscosity_m2_s;
    stokes_n * (1.0 + 0.15 * reynolds.powf(0.687))
}

impl Drag {
    /// Speed up to which the fit is made: a brisk stir.
    pub const FITTED_TO_M_S: f64 = 0.6;

    /// The two terms that come nearest to [`sphere_drag_n`] up to [`Self::FITTED_TO_M_S`], by
    /// least squares of the relative error over 60 speeds, neither of them negative.
    #[must_use]
    pub fn of_sphere(radius_m: f64, density_kg_m3: f64, viscosity_m2_s: f64) -> Self {
        // With g(w) = F(w) / w known, minimise the sum of ((c1 + c2 w) / g - 1)^2.
        let mut normal = [[0.0; 2]; 2];
        let mut right = [0.0; 2];
        for i in 1..=60 {
            let w = Self::FITTED_TO_M_S * f64::from(i) / 60.0;
            let g = sphere_drag_n(radius_m, density_kg_m3, viscosity_m2_s, w) / w;
            if g <= 0.0 {
                return Self::default();
            }
            let terms = [1.0 / g, w / g];
            for (row, a) in terms.iter().enumerate() {
                right[row] += a;
                for (column, b) in terms.iter().enumerate() {
                    normal[row][column] += a * b;
                }
            }
        }
        let determinant = normal[0][0] * normal[1][1] - normal[0][1] * normal[1][0];
        Self {
            linear_n_s_per_m: ((right[0] * normal[1][1] - right[1] * normal[0][1]) / determinant)
                .max(0.0),
            quadratic_n_s2_per_m2: ((right[1] * normal[0][0] - right[0] * normal[1][0])
                / determinant)
                .max(0.0),
        }
    }

    /// Force at a relative speed.
    #[must_use]
    pub fn force_n(&self, speed_m_s: f64) -> f64 {
        (self.linear_n_s_per_m + self.quadratic_n_s2_per_m2 * speed_m_s) * speed_m_s
    }

    /// The drag with both terms times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            linear_n_s_per_m: self.linear_n_s_per_m * factor,
            quadratic_n_s2_per_m2: self.quadratic_n_s2_per_m2 * factor,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published figures for a sphere of 10 mm radius at 0.2 m/s: glycerol 72 mN, honey 415 mN.
    #[test]
    fn the_law_gives_known_forces() {
        let glycerol = sphere_drag_n(0.01, 1260.0, 1.412 / 1260.0, 0.2);
        assert!((glycerol - 0.072).abs() < 0.004, "{glycerol}");
        let honey = sphere_drag_n(0.01, 1420.0, 10.0 / 1420.0, 0.2);
        assert!((honey - 0.415).abs() < 0.02, "{honey}");
    }

    #[test]
    fn the_two_terms_stay_within_a_tenth_of_the_law() {
        for viscosity in [1e-4, 3e-4, 1e-3, 1e-2] {
            let drag = Drag::of_sphere(0.012, 1000.0, viscosity);
            for i in 3..=60 {
                let w = f64::from(i) * 0.01;
                let ratio = drag.force_n(w) / sphere_drag_n(0.012, 1000.0, viscosity, w);
                assert!((ratio - 1.0).abs() < 0.15, "nu {viscosity} w {w}: {ratio}");
            }
        }
    }

    #[test]
    fn no_viscosity_no_drag() {
        assert_eq!(Drag::of_sphere(0.01, 1000.0, 0.0), Drag::default());
    }
}
