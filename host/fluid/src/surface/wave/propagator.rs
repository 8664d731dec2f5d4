//! The exact step of all modes.
//!
//! With m^2 = gamma^2 - Omega^2 (swinging where that is negative), c = exp(-gamma t) cosh m t and
//! s = exp(-gamma t) sinh(m t) / m,
//!
//! ```text
//! a1 = (c + gamma s) a + s w + K f S,   w1 = (c - gamma s) w - Omega^2 s a + K f s
//! ```
//! where S, the integral of s, is (1 - c - gamma s) / Omega^2.

use super::damping::Damping;
use crate::simd::SimdClass;

/// Every matrix is made smaller by this part, more than f32 rounds: so no mode gains by rounding.
const SHRINK: f64 = 2e-7;

/// The matrices of all modes for steps of one length.
#[derive(Clone, Debug, Default)]
pub struct Propagator {
    dt_s: f64,
    /// From amplitude and speed to the next amplitude.
    to_amplitude: [Vec<f32>; 2],
    /// The same to the next speed.
    to_speed: [Vec<f32>; 2],
    /// From the force to amplitude and speed.
    by_force: [Vec<f32>; 2],
}

impl Propagator {
    pub fn bytes(&self) -> usize {
        6 * size_of_val(self.by_force[0].as_slice())
    }

    /// True if the matrices are those of a step of `dt_s`.
    pub fn is_of(&self, dt_s: f64) -> bool {
        self.dt_s == dt_s && !self.by_force[0].is_empty()
    }

    /// Makes the matrices those of a step of `dt_s`.
    pub fn set_step(&mut self, modes: &[Damping], dt_s: f64) {
        if self.is_of(dt_s) {
            return;
        }
        self.dt_s = dt_s;
        let tables = [&mut self.to_amplitude, &mut self.to_speed, &mut self.by_force];
        for table in tables.into_iter().flatten() {
            table.resize(modes.len(), 0.0);
        }
        for (j, mode) in modes.iter().enumerate() {
            let [[p, q], [r, s], [u, v]] = matrix(mode, dt_s);
            [self.to_amplitude[0][j], self.to_amplitude[1][j]] = [p, q].map(|x| x as f32);
            [self.to_speed[0][j], self.to_speed[1][j]] = [r, s].map(|x| x as f32);
            [self.by_force[0][j], self.by_force[1][j]] = [u, v].map(|x| x as f32);
        }
    }

    /// One step, by a force per density on each mode if there is any.
    pub fn step(&self, simd: SimdClass, [a, w]: [&mut [f32]; 2], force: Option<&[f32]>) {
        let len = a.len();
        let w = &mut w[..len];
        let [aa, aw] = [&self.to_amplitude[0][..len], &self.to_amplitude[1][..len]];
        let [wa, ww] = [&self.to_speed[0][..len], &self.to_speed[1][..len]];
        simd.vectorize(
            #[inline(always)]
            || {
                for j in 0..len {
                    let (amplitude, speed) = (a[j], w[j]);
                    a[j] = aa[j] * amplitude + aw[j] * speed;
                    w[j] = wa[j] * amplitude + ww[j] * speed;
                }
            },
        );
        let Some(force) = force.map(|force| &force[..len]) else { return };
        let [af, wf] = [&self.by_force[0][..len], &self.by_force[1][..len]];
        simd.vectorize(
            #[inline(always)]
            || {
                for j in 0..len {
                    a[j] += af[j] * force[j];
                    w[j] += wf[j] * force[j];
                }
            },
        );
    }
}

/// Rows to the amplitude, to the speed, and by the force.
fn matrix(mode: &Damping, t: f64) -> [[f64; 2]; 3] {
    if mode.answer_per_m <= 0.0 {
        return [[0.0; 2]; 3]; // the constant mode: volume is kept
    }
    let (gamma, omega2) = (mode.gamma_per_s, mode.omega2_per_s2());
    let m2 = gamma * gamma - omega2;
    let m = m2.abs().sqrt();
    let (c, s) = if m * t < 1e-6 {
        let decay = (-gamma * t).exp();
        (decay, t * decay)
    } else if m2 < 0.0 {
        let (sin, cos) = (m * t).sin_cos();
        let decay = (-gamma * t).exp();
        (decay * cos, decay * sin / m)
    } else {
        // exp of the sum of both roots' exponents: each is at most 0.
        let slow = (-omega2 / (gamma + m) * t).exp();
        let fast = (-(gamma + m) * t).exp();
        (0.5 * (slow + fast), 0.5 * (slow - fast) / m)
    };
    let [aa, ww] = [c + gamma * s, c - gamma * s];
    let integral = if omega2 * t * t > 1e-6 {
        (1.0 - aa) / omega2
    } else if gamma * t > 1e-6 {
        // Without a force that brings it back: by drag alone.
        (t - (-(-2.0 * gamma * t).exp_m1()) / (2.0 * gamma)) / (2.0 * gamma)
    } else {
        0.5 * t * t
    };
    let keep = 1.0 - SHRINK;
    let by_force = [integral, s].map(|part| part * mode.answer_per_m);
    [[keep * aa, keep * s], [-keep * omega2 * s, keep * ww], by_force]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(answer_per_m: f64, stiffness_m_s2: f64, gamma_per_s: f64) -> Damping {
        Damping { answer_per_m, stiffness_m_s2, gamma_per_s }
    }

    /// Swinging, critical, overdamped, without a spring, without anything.
    const ALL: [(f64, f64, f64); 7] = [
        (30.0, 9.81, 0.0),
        (30.0, 9.81, 3.0),
        (10.0, 10.0, 10.0),
        (10.0, 9.81, 400.0),
        (10.0, 0.0, 5.0),
        (10.0, 0.0, 0.0),
        (1e4, 1e4, 1e-3),
    ];

    #[test]
    fn a_step_is_what_many_short_ones_are() {
        for (answer, stiffness, gamma) in ALL {
            let mode = mode(answer, stiffness, gamma);
            let exact = |[a, w]: [f64; 2], f: f64, t: f64| {
                let [[aa, aw], [wa, ww], [af, wf]] = matrix(&mode, t);
                [aa * a + aw * w + af * f, wa * a + ww * w + wf * f]
            };
            // Runge and Kutta on the equation itself.
            let slope = |[a, w]: [f64; 2]| [w, answer * (0.7 - stiffness * a) - 2.0 * gamma * w];
            let (t, steps) = (0.02, 20_000);
            let h = t / f64::from(steps);
            let mut state = [1e-3, -2e-2];
            let start = state;
            for _ in 0..steps {
                let at = |k: [f64; 2], h: f64| [state[0] + h * k[0], state[1] + h * k[1]];
                let k1 = slope(state);
                let k2 = slope(at(k1, 0.5 * h));
                let k3 = slope(at(k2, 0.5 * h));
                let k4 = slope(at(k3, h));
                state = [0, 1]
                    .map(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            }
            let once = exact(start, 0.7, t);
            for i in [0, 1] {
                let scale = state[i].abs().max(1e-3);
                assert!((once[i] - state[i]).abs() < 2e-6 * scale, "{mode:?}: {once:?} {state:?}");
            }
        }
    }

    #[test]
    fn a_force_that_lasts_holds_it_where_it_rests() {
        for (answer, stiffness, gamma) in
            ALL.into_iter().filter(|(_, stiffness, _)| *stiffness > 0.0)
        {
            let [[aa, _], [wa, _], [af, wf]] = matrix(&mode(answer, stiffness, gamma), 0.03);
            let rest = 2.0 / stiffness;
            assert!((aa * rest + af * 2.0 - rest).abs() < 1e-6 * rest, "{answer} {stiffness}");
            assert!((wa * rest + wf * 2.0).abs() < 1e-5 * (answer * stiffness).sqrt() * rest);
        }
    }

    #[test]
    fn no_step_brings_energy() {
        for (answer, stiffness, gamma) in ALL {
            let mode = mode(answer, stiffness, gamma);
            let energy = |a: f64, w: f64| w * w / answer + stiffness * a * a;
            for t in [1e-9, 1e-3, 0.1, 1.0, 1e3] {
                let rounded = |x: f64| f64::from(x as f32);
                let [[aa, aw], [wa, ww], _] = matrix(&mode, t).map(|row| row.map(rounded));
                for angle in 0..32 {
                    let (sin, cos) = (f64::from(angle) * 0.2).sin_cos();
                    let [a, w] = [cos / stiffness.max(1.0).sqrt(), sin * answer.sqrt()];
                    let after = energy(aa * a + aw * w, wa * a + ww * w);
                    assert!(after <= energy(a, w), "{mode:?} t = {t}: {after}");
                }
            }
        }
    }
}
