//! A sphere at the surface of a liquid: what it takes to push it through, and to pull it out.
//!
//! The surface meets the sphere in a ring at the filling angle phi, counted from the sphere's
//! lowest point. At the ring the sphere's own slope is phi, so a liquid of contact angle theta
//! leaves it upwards at psi = phi + theta - pi, and pulls by its tension over the ring's length:
//!
//! ```text
//! F_capillary   = 2 pi a sigma sin(phi) sin(psi)
//! F_hydrostatic = rho g (V_cap + pi r^2 d)      r = a sin(phi), V_cap = pi c^2 (3 a - c) / 3,
//!                                               c = a (1 - cos(phi)), d the ring's depth
//! ```
//!
//! both upwards (Princen 1969; Chappuis 1982); together they weigh what the sphere and its dent
//! displace (Keller 1998). The first alone is greatest at phi = pi - theta/2 and least at
//! (pi - theta)/2, so a small sphere is held up by at most 2 pi a sigma sin^2(theta/2) and held
//! back by at most 2 pi a sigma cos^2(theta/2) (Scheludko & Nikolov 1975).
//!
//! The ring's depth joins three limits by the Bessel functions of the linear meniscus, with
//! l^2 = sigma / (rho g), x = (r/l) cos^2(psi/2) and q = K0(x)/K1(x):
//!
//! ```text
//! d = 2 l tan(psi/2) q cos(psi/2)^q
//! ```
//!
//! For r << l this is r sin(psi) (ln(4 l / (r (1 + cos psi))) - 0.5772) (Derjaguin 1946; James
//! 1974), for r >> l the straight wall's 2 l sin(psi/2), and for a shallow dent l psi K0/K1. Next
//! to the integrated equation of Young and Laplace it errs by at most 3 % for |psi| <= 45 deg, 9 %
//! up to 90 deg.

use std::f64::consts::PI;

use crate::scenes::{Bound, Wrong, number};

/// A sphere and the liquid that it meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meniscus {
    /// Radius of the sphere.
    pub radius_m: f64,
    /// Tension of the surface.
    pub tension_n_per_m: f64,
    /// Angle between sphere and surface, through the liquid: 0 wets, pi repels.
    pub contact_angle_rad: f64,
    /// Density of the liquid; that of the gas is nothing beside it.
    pub density_kg_m3: f64,
    /// Gravity.
    pub gravity_m_s2: f64,
}

/// How a surface resists a sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resistance {
    /// Most that it holds up: pressed harder, the sphere goes under.
    pub push_in_max_n: f64,
    /// Most that it holds back: pulled harder, the sphere comes off.
    pub pull_out_max_n: f64,
    /// Slope dF/dh of the dent, h the sinking of the sphere: the mean from where no force acts to
    /// where it goes under.
    pub dent_stiffness_n_per_m: f64,
}

/// What adds to the force.
#[derive(Clone, Copy, PartialEq)]
enum Parts {
    Capillary,
    Both,
}

impl Meniscus {
    /// The sphere and liquid of a scene: radius in m, tension in N/m, contact angle in degrees,
    /// density in kg/m^3, gravity in m/s^2.
    ///
    /// # Errors
    /// [`Wrong`], by its name in a scene file: a value that is not finite or beyond reason.
    pub fn new(
        radius_m: f32,
        tension_n_per_m: f32,
        contact_angle_deg: f32,
        density_kg_m3: f32,
        gravity_m_s2: f32,
    ) -> Result<Self, Wrong> {
        let tension = Bound::new(0.0, 100.0);
        number("probe.radius_m", radius_m, Bound::new(1e-9, 100.0))?;
        number("surface.capillary_tension_n_per_m", tension_n_per_m, tension)?;
        number("surface.contact_angle_deg", contact_angle_deg, Bound::new(0.0, 180.0))?;
        number("liquid.density_kg_m3", density_kg_m3, Bound::new(1e-3, 1e5))?;
        number("liquid.gravity_m_s2", gravity_m_s2, Bound::new(1e-3, 1e4))?;
        Ok(Self {
            radius_m: radius_m.into(),
            tension_n_per_m: tension_n_per_m.into(),
            contact_angle_rad: f64::from(contact_angle_deg).to_radians(),
            density_kg_m3: density_kg_m3.into(),
            gravity_m_s2: gravity_m_s2.into(),
        })
    }

    /// Bond number rho g a^2 / sigma: what gravity is beside tension.
    #[must_use]
    pub fn bond(&self) -> f64 {
        self.specific_weight_n_m3() * self.radius_m.powi(2) / self.tension_n_per_m
    }

    /// The upward force of the tension at a filling angle.
    #[must_use]
    pub fn capillary_n(&self, filling_rad: f64) -> f64 {
        let ring_n = 2.0 * PI * self.radius_m * self.tension_n_per_m;
        ring_n * filling_rad.sin() * self.slope_rad(filling_rad).sin()
    }

    /// The upward force of the liquid's pressure at a filling angle.
    #[must_use]
    pub fn hydrostatic_n(&self, filling_rad: f64) -> f64 {
        let ring_m = self.radius_m * filling_rad.sin();
        let cap_m3 = cap_volume_m3(self.radius_m, self.radius_m * (1.0 - filling_rad.cos()));
        let dent_m3 = PI * ring_m * ring_m * self.ring_depth_m(filling_rad);
        self.specific_weight_n_m3() * (cap_m3 + dent_m3)
    }

    /// Depth of the ring below the surface far away.
    #[must_use]
    pub fn ring_depth_m(&self, filling_rad: f64) -> f64 {
        let length_m = (self.tension_n_per_m / self.specific_weight_n_m3()).sqrt();
        let half_rad = 0.5 * self.slope_rad(filling_rad);
        let level = half_rad.cos().abs();
        let ring = self.radius_m * filling_rad.sin() / length_m * level * level;
        if length_m <= 0.0 || ring < f64::MIN_POSITIVE {
            return 0.0; // no tension, or no ring
        }
        let share = bessel_ratio(ring);
        2.0 * length_m * half_rad.sin() * share * level.powf(share - 1.0)
    }

    /// Tension and pressure together: what a weightless sphere meets.
    #[must_use]
    pub fn resistance(&self) -> Resistance {
        self.resistance_of(Parts::Both)
    }

    /// The tension alone: for a sphere whose buoyancy is counted elsewhere.
    #[must_use]
    pub fn capillary_resistance(&self) -> Resistance {
        self.resistance_of(Parts::Capillary)
    }

    fn resistance_of(&self, parts: Parts) -> Resistance {
        let force_n = |filling_rad: f64| match parts {
            Parts::Capillary => self.capillary_n(filling_rad),
            Parts::Both => self.capillary_n(filling_rad) + self.hydrostatic_n(filling_rad),
        };
        let (under_rad, off_rad) = (argmax(force_n), argmax(|phi| -force_n(phi)));
        let push_in_max_n = force_n(under_rad).max(0.0);
        let free_rad = root_between(off_rad, under_rad, force_n);
        let sunk_m = self.centre_depth_m(under_rad) - self.centre_depth_m(free_rad);
        let stiffness = if sunk_m > 0.0 { push_in_max_n / sunk_m } else { 0.0 };
        Resistance {
            push_in_max_n,
            pull_out_max_n: (-force_n(off_rad)).max(0.0),
            dent_stiffness_n_per_m: stiffness,
        }
    }

    /// Depth of the sphere's centre below the surface far away.
    fn centre_depth_m(&self, filling_rad: f64) -> f64 {
        self.ring_depth_m(filling_rad) - self.radius_m * filling_rad.cos()
    }

    fn slope_rad(&self, filling_rad: f64) -> f64 {
        filling_rad + self.contact_angle_rad - PI
    }

    fn specific_weight_n_m3(&self) -> f64 {
        self.density_kg_m3 * self.gravity_m_s2
    }
}

/// Volume of the cap of height `height_m` of a sphere: pi h^2 (3 a - h) / 3, nothing above it and
/// all of it below.
#[must_use]
pub fn cap_volume_m3(radius_m: f64, height_m: f64) -> f64 {
    let height_m = height_m.clamp(0.0, 2.0 * radius_m);
    PI * height_m * height_m * (3.0 * radius_m - height_m) / 3.0
}

/// K0(x) / K1(x) for x > 0, by the integrals of exp(-x cosh t) cosh(n t), which the trapezoidal
/// rule gives to rounding (Trefethen & Weideman 2014).
fn bessel_ratio(x: f64) -> f64 {
    const POINTS: u32 = 64;
    const NEGLIGIBLE: f64 = 40.0; // exp(-40) is below rounding
    let step = (1.0 + NEGLIGIBLE / x).acosh() / f64::from(POINTS);
    let (mut zeroth, mut first) = (0.5, 0.5);
    for n in 1..=POINTS {
        // 2 sinh^2(t/2) for cosh t - 1: the difference would lose its digits.
        let above = 2.0 * (0.5 * step * f64::from(n)).sinh().powi(2);
        let weight = (-x * above).exp();
        zeroth += weight;
        first += weight * (1.0 + above);
    }
    zeroth / first
}

/// The filling angle of the greatest value: the best of a row of angles, then golden sections
/// (Kiefer 1953) between its neighbours.
fn argmax(value: impl Fn(f64) -> f64) -> f64 {
    const ANGLES: u32 = 256;
    const SECTIONS: u32 = 48;
    let angle = |n: u32| PI * f64::from(n) / f64::from(ANGLES);
    let best = (0..=ANGLES).max_by(|a, b| value(angle(*a)).total_cmp(&value(angle(*b))));
    let best = best.unwrap_or(0);
    let (mut low, mut high) = (angle(best.saturating_sub(1)), angle((best + 1).min(ANGLES)));
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..SECTIONS {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if value(left) < value(right) { low = left } else { high = right }
    }
    let within = 0.5 * (low + high);
    if value(within) > value(angle(best)) { within } else { angle(best) }
}

/// Where a force that is not positive at `low_rad` and not negative at `high_rad` changes sign.
fn root_between(mut low_rad: f64, mut high_rad: f64, force_n: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low_rad + high_rad);
        if force_n(middle) > 0.0 { high_rad = middle } else { low_rad = middle }
    }
    low_rad
}

#[cfg(test)]
mod tests;
