//! Weight and buoyancy of the probe: what lets it float when the hand lets go.
//!
//! They travel as the field's bias: they act in the air, at the surface and below it alike, and
//! what they do to the hand is done to no liquid, since still water is not set in motion by what
//! floats in it. The surface's own spring is that of its tension, on top of them.

use super::cap_volume_m3;
use crate::scenes::{GRAVITY_M_S2, Scene};

/// A sphere with a weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floating {
    radius_m: f64,
    weight_n: f64,
    /// rho g of the liquid; 0 without.
    buoyant_n_m3: f64,
}

impl Floating {
    /// The probe of a scene, if it has a density. What is poured in changes nothing: it weighs
    /// about as much as the liquid.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        let radius_m = f64::from(scene.probe.radius_m);
        let gravity_m_s2 = f64::from(scene.liquid.map_or(GRAVITY_M_S2, |l| l.gravity_m_s2));
        let density_kg_m3 = f64::from(scene.probe.density_kg_m3?);
        let liquid_kg_m3 = scene.liquid.map_or(0.0, |l| f64::from(l.density_kg_m3));
        Some(Self {
            radius_m,
            weight_n: density_kg_m3 * gravity_m_s2 * cap_volume_m3(radius_m, 2.0 * radius_m),
            buoyant_n_m3: liquid_kg_m3 * gravity_m_s2,
        })
    }

    /// The upward force on a sphere whose centre is `depth_m` below the surface: the weight of the
    /// cap that is under it, rho g pi c^2 (3 a - c) / 3 with c = a + depth, less the sphere's own.
    #[must_use]
    pub fn force_n(&self, depth_m: f64) -> f64 {
        self.buoyant_n_m3 * cap_volume_m3(self.radius_m, self.radius_m + depth_m) - self.weight_n
    }

    /// Change of the force with depth where the sphere is half under: rho g pi a^2. At a depth y it
    /// is that times 1 - (y/a)^2.
    #[must_use]
    pub fn stiffness_n_per_m(&self) -> f64 {
        self.buoyant_n_m3 * std::f64::consts::PI * self.radius_m * self.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{INDEX, Probe};

    fn ball(density_kg_m3: f32) -> Floating {
        let probe = Probe { radius_m: 0.02, density_kg_m3: Some(density_kg_m3) };
        Floating::of(&Scene { probe, ..(INDEX[0].make)() }).unwrap()
    }

    #[test]
    fn half_as_heavy_as_water_it_floats_half_under() {
        let (half, whole_n) = (ball(500.0), ball(1000.0).weight_n);
        assert!(half.force_n(0.0).abs() < 1e-9 * whole_n);
        assert!((half.force_n(0.02) / (0.5 * whole_n) - 1.0).abs() < 1e-9, "and is buoyant below");
        assert!((half.force_n(-0.5) / (-0.5 * whole_n) - 1.0).abs() < 1e-9, "heavy in the air");
        assert_eq!(half.force_n(f64::INFINITY), half.force_n(0.02));
        let slope = (half.force_n(1e-5) - half.force_n(-1e-5)) / 2e-5;
        assert!((slope / half.stiffness_n_per_m() - 1.0).abs() < 1e-6, "{slope}");
    }

    #[test]
    fn as_heavy_as_water_it_hangs_and_heavier_it_sinks() {
        assert!(ball(1000.0).force_n(0.1).abs() < 1e-12);
        assert!(ball(7800.0).force_n(0.1) < -2.0);
        assert_eq!(Floating::of(&(INDEX[0].make)()), None);
    }
}
