//! Properties of a liquid in which substances are dissolved.
//!
//! All fractions are by volume, of the pure substances; what they leave of a cell is liquid.
//!
//! - Density: the mean weighted by volume; volumes add.
//! - Viscosity: ln mu = sum x_i ln mu_i of the dynamic viscosities (Grunberg, Nissan 1949; the
//!   rule of Arrhenius 1887), the interaction parameters being 0, and the x_i volume fractions, not
//!   mole fractions: the molar masses of what a scene calls honey are not known.

use std::sync::atomic::{AtomicU64, Ordering};

use super::{Properties, Substance, Substances};
use crate::solver::flow::field::{Layout, cut};

/// A number that was not given before.
pub(super) fn next_stamp() -> u64 {
    static COUNT: AtomicU64 = AtomicU64::new(1);
    COUNT.fetch_add(1, Ordering::Relaxed)
}

impl Properties {
    fn differ_from(&self, liquid: &Self) -> bool {
        self.density_kg_m3 != liquid.density_kg_m3 || self.viscosity_m2_s != liquid.viscosity_m2_s
    }
}

impl Substances {
    /// True if some substance that is there is denser, lighter, thicker or thinner than `liquid`.
    pub(crate) fn differ_from(&self, liquid: &Properties) -> bool {
        self.all.iter().any(|s| s.highest > 0.0 && s.properties.differ_from(liquid))
    }

    /// The same of all that may be poured.
    pub(crate) fn may_differ_from(&self, liquid: &Properties) -> bool {
        self.all.iter().any(|s| s.properties.differ_from(liquid))
    }

    /// The densities of all that may be poured.
    pub(crate) fn densities(&self) -> impl Iterator<Item = f32> {
        self.all.iter().map(|s| s.properties.density_kg_m3)
    }

    /// The viscosities of all that may be poured.
    pub(crate) fn viscosities(&self) -> impl Iterator<Item = f32> {
        self.all.iter().map(|s| s.properties.viscosity_m2_s)
    }

    /// Differs from that of any other state of any substances.
    pub(crate) fn stamp(&self) -> u64 {
        self.stamp
    }

    /// True if they are on a grid of this layout.
    pub(crate) fn are_on(&self, layout: &Layout) -> bool {
        self.layout == *layout
    }

    /// Fills `out`, a padded cell array of the flow's layout, with the kinematic viscosity of the
    /// mixture in each cell; where there is no substance it is that of `liquid`. Substances
    /// without viscosity or density thin the mixture as the thinnest liquid that f32 can tell.
    pub(crate) fn mixture_viscosity_m2_s(&self, liquid: &Properties, out: &mut [f32]) {
        let dynamic = |p: &Properties| (p.density_kg_m3 * p.viscosity_m2_s).max(f32::MIN_POSITIVE);
        let of_liquid = dynamic(liquid);
        self.fill(out, |p| (dynamic(p) / of_liquid).ln());
        // The logarithms become viscosities row by row, while the densities are at hand.
        let excess = |at: usize| {
            let part = |s: &Substance| {
                s.cells.fraction[at] * (s.properties.density_kg_m3 - liquid.density_kg_m3)
            };
            self.all.iter().map(part).sum::<f32>()
        };
        for (at, out) in out.iter_mut().enumerate() {
            let density = (liquid.density_kg_m3 + excess(at)).max(f32::MIN_POSITIVE);
            *out = of_liquid * exp(*out) / density;
        }
    }

    /// Fills `out`, a padded cell array of the flow's layout, with the density of the mixture in
    /// each cell; where there is no substance it is that of `liquid`.
    pub(crate) fn mixture_density_kg_m3(&self, liquid: &Properties, out: &mut [f32]) {
        self.fill(out, |p| p.density_kg_m3 - liquid.density_kg_m3);
        out.iter_mut().for_each(|out| *out += liquid.density_kg_m3);
    }

    /// Sum over the substances of fraction times value; fractions are at most 1 together.
    fn fill(&self, out: &mut [f32], value: impl Fn(&Properties) -> f32) {
        out.fill(0.0);
        for substance in self.all.iter().filter(|substance| substance.highest > 0.0) {
            let value = value(&substance.properties);
            let fraction = cut(&substance.cells.fraction, 0, out.len());
            out.iter_mut().zip(fraction).for_each(|(out, fraction)| *out += value * fraction);
        }
    }
}

/// Density of a mixture, from fraction and density of each substance and the density of the
/// liquid. Fractions that sum to more than 1 are taken in proportion.
#[must_use]
pub fn density_kg_m3(liquid_kg_m3: f32, parts: &[(f32, f32)]) -> f32 {
    weighted(liquid_kg_m3, parts)
}

/// Dynamic viscosity of a mixture, from fraction and dynamic viscosity of each substance and the
/// dynamic viscosity of the liquid, all above 0.
#[must_use]
pub fn viscosity_pa_s(liquid_pa_s: f32, parts: &[(f32, f32)]) -> f32 {
    let sum: f32 = parts.iter().map(|(fraction, _)| fraction).sum();
    let logs = parts.iter().map(|(fraction, viscosity)| fraction * (viscosity / liquid_pa_s).ln());
    liquid_pa_s * (logs.sum::<f32>() / sum.max(1.0)).exp()
}

fn weighted(liquid: f32, parts: &[(f32, f32)]) -> f32 {
    let sum: f32 = parts.iter().map(|(fraction, _)| fraction).sum();
    let excess: f32 = parts.iter().map(|(fraction, value)| fraction * (value - liquid)).sum();
    liquid + excess / sum.max(1.0)
}

/// e^x for |x| <= 87, to 3e-7 of itself; beyond as at the ends. 2^n times the Taylor polynomial of
/// degree 7 in what is left, which is at most ln 2 / 2: vector code, where the library's is not.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    /// ln 2 in two parts, the first with trailing zeros, so that n times it is exact
    /// (Cody, Waite 1980).
    const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];
    /// 1.5 * 2^23: added and taken away again it rounds to the nearest integer.
    const TO_INTEGER: f32 = 12_582_912.0;
    let x = if x > 87.0 { 87.0 } else { x };
    let x = if x < -87.0 { -87.0 } else { x };
    let shifted = x * std::f32::consts::LOG2_E + TO_INTEGER;
    let n = shifted - TO_INTEGER;
    let r = (x - n * LN_2[0]) - n * LN_2[1];
    let series =
        1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0))));
    let series = 1.0 + r * (1.0 + r * (0.5 + r * series));
    // The integer is in the low bits of `shifted`: 127 more, in the place of an exponent.
    let power = f32::from_bits(shifted.to_bits().wrapping_add(127) << 23);
    series * power
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, Vessel, solver::Setup};
    use proptest::prelude::*;

    #[test]
    fn pure_liquids_and_even_mixtures_are_known() {
        assert_eq!(density_kg_m3(1000.0, &[]), 1000.0);
        assert_eq!(density_kg_m3(1000.0, &[(1.0, 1400.0)]), 1400.0);
        assert_eq!(density_kg_m3(1000.0, &[(0.25, 1400.0), (0.25, 800.0)]), 1050.0);
        assert!((viscosity_pa_s(1e-3, &[(1.0, 10.0)]) / 10.0 - 1.0).abs() < 1e-5);
        let geometric_mean = viscosity_pa_s(1e-3, &[(0.5, 10.0)]);
        assert!((geometric_mean / 0.1 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn cells_are_filled_by_the_same_rules() {
        let setup = Setup::new(Grid::unit_cube(4), Vessel::Box);
        let liquid = Properties { viscosity_m2_s: 1e-6, ..Properties::of_liquid(&setup) };
        let honey = Properties { density_kg_m3: 1400.0, viscosity_m2_s: 7e-3, ..liquid };
        let mut substances = Substances::new(&setup, &[honey]);
        substances.set_fraction(0, |p| p.x).unwrap();
        let layout = Layout::new(setup.grid.cells);
        let (mut viscosity, mut density) = (layout.zeros(), layout.zeros());
        substances.mixture_viscosity_m2_s(&liquid, &mut viscosity);
        substances.mixture_density_kg_m3(&liquid, &mut density);
        for i in 0..4 {
            let (at, x) = (layout.index(i, 1, 2), (i as f32 + 0.5) / 4.0);
            let kg_m3 = density_kg_m3(1000.0, &[(x, 1400.0)]);
            let pa_s = viscosity_pa_s(1e-3, &[(x, 9.8)]);
            assert!((density[at] / kg_m3 - 1.0).abs() < 1e-5);
            assert!((viscosity[at] / (pa_s / kg_m3) - 1.0).abs() < 1e-5);
        }
    }

    proptest! {
        #[test]
        fn mixtures_are_between_their_parts(
            a in 0f32..0.6, b in 0f32..0.6,
            mu in proptest::array::uniform3(1e-6f32..1e4),
        ) {
            let of = viscosity_pa_s(mu[0], &[(a, mu[1]), (b, mu[2])]);
            let (low, high) = mu.iter().fold((f32::MAX, 0f32), |(l, h), m| (l.min(*m), h.max(*m)));
            prop_assert!(of >= low * 0.9999 && of <= high * 1.0001);
            let of = density_kg_m3(mu[0], &[(a, mu[1]), (b, mu[2])]);
            prop_assert!(of >= low - 1e-3 * high && of <= high * 1.0001);
        }

        #[test]
        fn the_exponential_is_right_to_its_bound(x in -87f32..87.0) {
            let exact = f64::from(x).exp();
            prop_assert!((f64::from(exp(x)) / exact - 1.0).abs() < 3e-7, "{x}");
        }
    }
}
