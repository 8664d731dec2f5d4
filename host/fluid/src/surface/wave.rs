//! Linear waves of gravity and tension, exact for each mode and any step.
//!
//! The surface is a sum of modes psi_j of the vessel, the integral of psi_j^2 being 1. Of each the
//! amplitude a and its speed w are kept; per density of the liquid
//!
//! ```text
//! a' = w,   w' = K f - 2 gamma w - K G a
//! G = g + sigma k^2 / rho,    K = lambda R,    lambda = k tanh(k h) in a box
//! ```
//! with f the force on the mode. Viscosity is that of Lamb (1932, art. 349) on deep liquid, whose
//! two roots give gamma and R ([`damping`]): 2 nu k^2 and 1 for waves, and an honest creep where
//! nothing swings. The solution over a step with a force that is held is a matrix for each mode,
//! computed once for a step's length.

mod basis;
mod cosines;
mod damping;
mod orbits;
mod propagator;

use self::{basis::Basis, damping::Damping, orbits::Orbits, propagator::Propagator};
use super::{Act, Answer, Basin, Fading, Lattice, Load, Model, ModelRow, SurfaceParams};
use crate::{simd::SimdClass, solver::SetupError};

pub(super) const ROW: ModelRow = ModelRow {
    name: "wave",
    about: "linear waves of gravity and tension, exact in time",
    fits: basis::fits,
    make: |params, lattice, basin| Ok(Box::new(Waves::new(params, lattice, basin)?)),
};

/// Modes whose answers are summed side by side; arrays of modes are padded to whole ones.
const LANES: usize = 8;

/// One mode of a vessel.
#[derive(Default, Clone, Copy, Debug, PartialEq)]
pub(super) struct Mode {
    /// Vertical speed over potential at the surface.
    pub lambda_per_m: f64,
    /// Root of the integral of the squared gradient.
    pub wavenumber_per_m: f64,
    /// As if walls were upright: k tanh(k depth) is lambda.
    pub wavenumber_below_per_m: f64,
}

/// What all modes have in common.
#[derive(Clone, Copy, Debug)]
struct Liquid {
    density_kg_m3: f64,
    gravity_m_s2: f64,
    viscosity_m2_s: f64,
    tension_n_per_m: f64,
    drag_n_s_per_m3: f64,
}

/// The waves.
struct Waves {
    basis: Basis,
    simd: SimdClass,
    density_kg_m3: f64,
    modes: Vec<Mode>,
    damping: Vec<Damping>,
    orbits: Orbits,
    /// Of each mode, as [`Damping::answer_per_m`].
    answer_per_m: Vec<f32>,
    /// Of each mode: its decay; and potential, and its slope, by vertical speed.
    fading_per_s: Vec<f32>,
    potential_m: Vec<f32>,
    slope: Vec<f32>,
    /// What no mode is above anywhere.
    peak_per_m: f32,
    amplitude: Vec<f32>,
    speed: Vec<f32>,
    /// For two lengths of steps: as they come, and as they are looked ahead by.
    propagators: [Propagator; 2],
    /// Force on each mode, and what one touch adds to it; empty until needed.
    force: Vec<f32>,
    under: Vec<f32>,
    /// Values at the nodes on their way to the modes.
    nodal: Vec<f32>,
}

impl Waves {
    fn new(
        params: &SurfaceParams,
        lattice: &Lattice,
        basin: &Basin<'_>,
    ) -> Result<Self, SetupError> {
        let (basis, depth_m) = Basis::new(lattice, basin)?;
        let liquid = Liquid {
            density_kg_m3: f64::from(basin.density_kg_m3),
            gravity_m_s2: f64::from(basin.gravity_m_s2),
            viscosity_m2_s: f64::from(basin.viscosity_m2_s),
            tension_n_per_m: f64::from(params.tension_n_per_m),
            drag_n_s_per_m3: f64::from(params.drag_n_s_per_m3),
        };
        let mut modes = basis.modes(depth_m);
        modes.resize(modes.len().next_multiple_of(LANES), Mode::default());
        let damping: Vec<_> = modes.iter().map(|mode| Damping::of(*mode, &liquid)).collect();
        let zeros = || vec![0.0; modes.len()];
        let of_waves = |value: fn(&Mode, &Damping) -> f64| -> Vec<f32> {
            let pairs = modes.iter().zip(&damping);
            let of = |(mode, damping): (&Mode, &Damping)| {
                if damping.answer_per_m > 0.0 { value(mode, damping) as f32 } else { 0.0 }
            };
            pairs.map(of).collect()
        };
        Ok(Self {
            fading_per_s: of_waves(|_, damping| damping.gamma_per_s),
            potential_m: of_waves(|mode, _| 1.0 / mode.lambda_per_m),
            slope: of_waves(|mode, _| mode.wavenumber_per_m / mode.lambda_per_m),
            peak_per_m: basis.peak_per_m(),
            simd: basin.simd,
            answer_per_m: damping.iter().map(|mode| mode.answer_per_m as f32).collect(),
            density_kg_m3: liquid.density_kg_m3,
            amplitude: zeros(),
            speed: zeros(),
            propagators: Default::default(),
            orbits: Orbits::new(depth_m, f64::from(basin.grid.spacing_m)),
            force: Vec::new(),
            under: Vec::new(),
            nodal: vec![0.0; lattice.len()],
            basis,
            modes,
            damping,
        })
    }

    /// Force on each mode, per density; kicks and dampers act at once. False if there is none.
    fn take(&mut self, dt_s: f32, load: Load<'_>) -> bool {
        let per_density = (1.0 / self.density_kg_m3) as f32;
        let len = self.modes.len();
        self.force.resize(len, 0.0);
        match load.force_n {
            Some(force_n) => {
                self.basis.analyse(force_n, &mut self.force);
                self.force.iter_mut().for_each(|force| *force *= per_density);
            }
            None if load.touches.is_empty() => return false,
            None => self.force.fill(0.0),
        }
        for touch in load.touches {
            self.under.resize(len, 0.0);
            self.basis.analyse_few(&touch.under, &mut self.under);
            let act = if touch.is_sudden() {
                touch.act(self.answer(), dt_s)
            } else {
                Act { impulse_n_s: 0.0, force_n: f64::from(touch.force_n) }
            };
            let [impulse, force] =
                [act.impulse_n_s, act.force_n].map(|n| (n / self.density_kg_m3) as f32);
            let Self { under, speed, force: forces, answer_per_m, .. } = self;
            let forces = forces.iter_mut().zip(speed).zip(under).zip(answer_per_m);
            for (((to, speed), under), answer) in forces {
                *speed += impulse * *answer * *under;
                *to += force * *under;
            }
        }
        true
    }

    /// How the modes answer what is `under`.
    fn answer(&self) -> Answer {
        let arrays =
            [&self.under, &self.speed, &self.answer_per_m].map(|a| a.as_chunks::<LANES>().0);
        let [mut speed, mut per_kg] = [[0.0; LANES]; 2];
        for ((under, w), answer) in arrays[0].iter().zip(arrays[1]).zip(arrays[2]) {
            for i in 0..LANES {
                let [under, w, answer] = [under[i], w[i], answer[i]].map(f64::from);
                speed[i] += under * w;
                per_kg[i] += under * under * answer;
            }
        }
        Answer {
            speed_m_s: speed.iter().sum(),
            per_kg: per_kg.iter().sum::<f64>() / self.density_kg_m3,
        }
    }
}

impl Model for Waves {
    fn step(&mut self, dt_s: f32, load: Load<'_>) -> u32 {
        let is_forced = self.take(dt_s, load);
        if !self.propagators[0].is_of(f64::from(dt_s)) {
            self.propagators.swap(0, 1);
            self.propagators[0].set_step(&self.damping, f64::from(dt_s));
        }
        let force = is_forced.then_some(&*self.force);
        self.propagators[0].step(self.simd, [&mut self.amplitude, &mut self.speed], force);
        1
    }

    fn read(&mut self, height_m: &mut [f32], speed_m_s: &mut [f32]) {
        self.basis.synthesise([&self.amplitude, &self.speed], [height_m, speed_m_s]);
    }

    fn state(&mut self) -> [&mut Vec<f32>; 2] {
        [&mut self.amplitude, &mut self.speed]
    }

    fn orbit(&mut self, layer: usize, potential: &mut [f32], rising_m_s: &mut [f32]) -> bool {
        let reach_per_m = self.orbits.reach_per_m(layer);
        let shares = self.orbits.layer(layer, &self.modes);
        self.under.resize(self.modes.len(), 0.0);
        for (shares, nodal) in shares.iter().zip([potential, rising_m_s]) {
            for ((to, share), speed) in self.under.iter_mut().zip(shares).zip(&self.speed) {
                *to = share * speed;
            }
            self.basis.synthesise_long([&self.under], [nodal], reach_per_m);
        }
        true
    }

    fn fade(&mut self, fading: &mut Fading) -> bool {
        self.under.resize(self.modes.len(), 0.0);
        let powers = self.speed.iter().zip(self.damping.iter());
        let powers =
            powers.filter(|(_, damping)| damping.answer_per_m > 0.0).map(|(w, damping)| {
                2.0 * damping.gamma_per_s * f64::from(*w).powi(2) / damping.answer_per_m
            });
        fading.power_w = self.density_kg_m3 * powers.sum::<f64>();
        let Self { under, amplitude, speed, fading_per_s, potential_m, basis, .. } = self;
        let mut write = |value: &dyn Fn(usize) -> f32, nodal: &mut [f32]| {
            under.iter_mut().enumerate().for_each(|(j, to)| *to = value(j));
            basis.synthesise([under], [nodal]);
        };
        write(&|j| fading_per_s[j] * amplitude[j], &mut fading.height_m_s);
        write(&|j| potential_m[j] * speed[j], &mut fading.potential);
        write(&|j| fading_per_s[j] * potential_m[j] * speed[j], &mut fading.potential_per_s);
        true
    }

    fn most_drift_m2_s2(&self, highest_m: f32) -> f32 {
        let Self { amplitude, speed, fading_per_s, slope, .. } = self;
        let [amplitude, speed, fading_per_s, slope] =
            [amplitude, speed, fading_per_s, slope].map(|a| a.as_chunks::<LANES>().0);
        // Of a sum of modes none is above that of their magnitudes at their peaks.
        let sums = self.simd.vectorize(
            #[inline(always)]
            || {
                let mut sums = [[0.0; LANES]; 3];
                let [fading, steep, fading_steep] = &mut sums;
                for j in 0..amplitude.len() {
                    for i in 0..LANES {
                        let gamma = fading_per_s[j][i];
                        let slope = slope[j][i] * speed[j][i].abs();
                        fading[i] += gamma * amplitude[j][i].abs();
                        steep[i] += slope;
                        fading_steep[i] += gamma * slope;
                    }
                }
                sums
            },
        );
        let [fading, steep, fading_steep] =
            sums.map(|lanes| self.peak_per_m * lanes.iter().sum::<f32>());
        fading * steep + highest_m * fading_steep
    }

    fn add(&mut self, height_m: &[f32], speed_m_s: &[f32]) {
        self.under.resize(self.modes.len(), 0.0);
        let own = [&mut self.amplitude, &mut self.speed];
        for (own, more) in own.into_iter().zip([height_m, speed_m_s]) {
            self.basis.weigh(more, &mut self.nodal);
            self.basis.analyse(&self.nodal, &mut self.under);
            for ((own, more), answer) in own.iter_mut().zip(&self.under).zip(&self.answer_per_m) {
                // The constant mode is the volume, which is kept.
                *own += if *answer > 0.0 { *more } else { 0.0 };
            }
        }
    }

    fn raise(&mut self, height_m: &[f32]) {
        self.under.resize(self.modes.len(), 0.0);
        self.basis.weigh(height_m, &mut self.nodal);
        self.basis.analyse(&self.nodal, &mut self.under);
        let pairs = self.under.iter().zip(&self.answer_per_m);
        for (own, (more, answer)) in self.amplitude.iter_mut().zip(pairs) {
            // The constant mode is the volume, which is kept.
            *own += if *answer > 0.0 { *more } else { 0.0 };
        }
    }

    fn strike(&mut self, impulse_n_s: &[f32], times: f32) {
        self.under.resize(self.modes.len(), 0.0);
        self.basis.analyse(impulse_n_s, &mut self.under);
        let per_density = times / self.density_kg_m3 as f32;
        let pairs = self.under.iter().zip(&self.answer_per_m);
        for (own, (impulse, answer)) in self.speed.iter_mut().zip(pairs) {
            *own += per_density * *answer * *impulse;
        }
    }

    fn energy_j(&self) -> f64 {
        let pairs = self.amplitude.iter().zip(&self.speed).zip(&self.damping);
        let energy = pairs.filter(|(_, mode)| mode.answer_per_m > 0.0).map(|((a, w), mode)| {
            let [a, w] = [a, w].map(|v| f64::from(*v));
            w * w / mode.answer_per_m + mode.stiffness_m_s2 * a * a
        });
        0.5 * self.density_kg_m3 * energy.sum::<f64>()
    }

    fn bytes(&self) -> usize {
        let arrays = [&self.amplitude, &self.speed, &self.force, &self.under, &self.nodal];
        arrays.map(|a| size_of_val(a.as_slice())).iter().sum::<usize>()
            + size_of_val(self.modes.as_slice())
            + size_of_val(self.damping.as_slice())
            + self.orbits.bytes()
            + self.propagators.iter().map(Propagator::bytes).sum::<usize>()
            + self.basis.bytes()
    }
}

#[cfg(test)]
mod tests;
