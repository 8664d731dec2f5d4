//! What bodies do to the surface, and the liquid below it.

use glam::Vec3;

use super::{Lattice, Load};

/// What a body does to the surface under it during a step.
#[derive(Clone, Debug, Default)]
pub struct Touch {
    /// Nodes under it and their shares, which sum to 1.
    pub under: Vec<(usize, f32)>,
    /// Upward force, held over the step.
    pub force_n: f32,
    /// Resistance to the mean speed of what is under it.
    pub damping_n_s_per_m: f32,
    /// Energy that what is under it is to get at once: up if it is positive, down if not.
    pub kick_j: f32,
}

/// How a surface answers a touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Mean vertical speed of what is under the body.
    pub speed_m_s: f64,
    /// What a newton second, given there, changes that by.
    pub per_kg: f64,
}

/// What a touch comes to in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Act {
    /// Upward impulse at once.
    pub impulse_n_s: f64,
    /// Upward force, held over the step.
    pub force_n: f64,
}

impl Touch {
    /// True if a part of it acts at once.
    #[must_use]
    pub fn is_sudden(&self) -> bool {
        self.damping_n_s_per_m != 0.0 || self.kick_j != 0.0
    }

    /// What it comes to in a step.
    ///
    /// A kick of energy e solves e = J v + J^2 / 2m. A damper takes v (1 - exp(-x)) of the speed at
    /// once, x = c dt/m, and leaves (1 - exp(-x)) / x of the force: so a force that lasts ends in
    /// the speed F/c, and what the damper does never brings energy, however strong it is.
    #[must_use]
    pub fn act(&self, answer: Answer, dt_s: f32) -> Act {
        let Answer { speed_m_s, per_kg } = answer;
        let force_n = f64::from(self.force_n);
        if per_kg <= 0.0 || !per_kg.is_finite() {
            return Act { impulse_n_s: 0.0, force_n };
        }
        let kick_n_s = self.kick_n_s(answer);
        let x = f64::from(self.damping_n_s_per_m).max(0.0) * f64::from(dt_s) * per_kg;
        let taken = -(-x).exp_m1();
        let impulse_n_s = kick_n_s - taken * (speed_m_s / per_kg + kick_n_s);
        Act { impulse_n_s, force_n: if x > 0.0 { force_n * taken / x } else { force_n } }
    }

    fn kick_n_s(&self, Answer { speed_m_s, per_kg }: Answer) -> f64 {
        let kick_j = f64::from(self.kick_j);
        let towards = kick_j.signum() * speed_m_s;
        let root = (towards * towards + 2.0 * per_kg * kick_j.abs()).sqrt();
        match towards {
            _ if kick_j == 0.0 => 0.0,
            0.0.. => 2.0 * kick_j / (root + towards),
            _ => kick_j.signum() * (root - towards) / per_kg,
        }
    }
}

/// All that acts on a surface in a step. Its room is used again.
#[derive(Default)]
pub(super) struct Acting {
    touches: Vec<Touch>,
    touching: usize,
    /// True if the first of them is the probe that leans on the surface.
    leans: bool,
    /// Upward force on each node; empty until something presses.
    force_n: Vec<f32>,
    is_pressed: bool,
}

impl Acting {
    /// What it is to a model.
    pub fn load(&self) -> Load<'_> {
        let force_n = self.is_pressed.then_some(&*self.force_n);
        Load { touches: &self.touches[..self.touching], force_n }
    }

    /// Nothing acts any more.
    pub fn clear(&mut self) {
        (self.touching, self.leans, self.is_pressed) = (0, false, false);
    }

    /// The push of the probe that leans on the surface, if one does.
    pub fn leaning(&self) -> Option<&Touch> {
        self.touches.first().filter(|_| self.leans)
    }

    /// What is sudden does not come again, and the probe that leans pushes no more.
    pub fn calm(&mut self) {
        self.touches.iter_mut().for_each(|touch| touch.kick_j = 0.0);
        if self.leans {
            self.touches[0].force_n = 0.0;
        }
    }

    /// Adds a touch of what is under a body; false if nothing is, or a number is not finite.
    pub fn put(&mut self, lattice: &Lattice, at_m: Vec3, radius_m: f32, touch: Touch) -> bool {
        if !at_m.is_finite() || !radius_m.is_finite() {
            return false;
        }
        if self.touches.len() == self.touching {
            self.touches.push(Touch::default());
        }
        let place = &mut self.touches[self.touching];
        let mut under = std::mem::take(&mut place.under);
        lattice.find_under(at_m, radius_m, &mut under);
        let is_there = !under.is_empty();
        self.touching += usize::from(is_there);
        *place = Touch { under, ..touch };
        is_there
    }

    /// Adds the touch of a probe that leans on the surface; as [`Acting::put`].
    pub fn lean(&mut self, lattice: &Lattice, at_m: Vec3, radius_m: f32, push: Touch) -> bool {
        let is_there = self.put(lattice, at_m, radius_m, push);
        if is_there {
            self.touches.swap(0, self.touching - 1);
            self.leans = true;
        }
        is_there
    }

    /// Presses by the pressure at each place, instead of what pressed. True if there is any.
    pub fn press(&mut self, lattice: &Lattice, pressure_pa: impl Fn(Vec3) -> f32) -> bool {
        self.force_n.resize(lattice.len(), 0.0);
        self.is_pressed = false;
        let Lattice { nodes: [nx, _], spacing_m, origin_in_world_m: first, .. } = *lattice;
        let rows = self.force_n.chunks_exact_mut(nx).zip(lattice.wet.chunks_exact(nx));
        for (k, (forces_n, wet)) in rows.enumerate() {
            for (i, (force_n, wet)) in forces_n.iter_mut().zip(wet).enumerate() {
                let at = first + spacing_m * Vec3::new(i as f32, 0.0, k as f32);
                let wanted = if *wet { lattice.node_m2() * pressure_pa(at) } else { 0.0 };
                *force_n = if wanted.is_finite() { wanted } else { 0.0 };
                self.is_pressed |= *force_n != 0.0;
            }
        }
        self.is_pressed
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.force_n.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANSWER: Answer = Answer { speed_m_s: 0.3, per_kg: 4.0 };

    #[test]
    fn a_kick_brings_its_energy_and_no_more() {
        for kick_j in [2.0_f32, -2.0, 1e-4, -1e-4, 0.0] {
            let j = Touch { kick_j, ..Touch::default() }.act(ANSWER, 0.01).impulse_n_s;
            let gained = j * ANSWER.speed_m_s + 0.5 * j * j * ANSWER.per_kg;
            assert!((gained - f64::from(kick_j.abs())).abs() < 1e-9, "{kick_j}: {gained}");
            assert!(j * f64::from(kick_j) >= 0.0);
        }
    }

    #[test]
    fn a_damper_slows_and_never_turns_round() {
        for damping in [0.0_f32, 1.0, 1e3, 3e38] {
            let touch = Touch { damping_n_s_per_m: damping, ..Touch::default() };
            let after = ANSWER.speed_m_s + ANSWER.per_kg * touch.act(ANSWER, 0.01).impulse_n_s;
            let exact = ANSWER.speed_m_s * (-f64::from(damping) * 0.01 * ANSWER.per_kg).exp();
            assert!((after - exact).abs() < 1e-7, "{damping}: {after} {exact}");
        }
    }

    #[test]
    fn a_force_that_lasts_ends_in_the_speed_that_the_damper_lets_it() {
        for damping in [0.1_f32, 10.0, 1e4] {
            let touch = Touch { damping_n_s_per_m: damping, force_n: 0.3, ..Touch::default() };
            let mut speed_m_s = 0.0;
            for _ in 0..20_000 {
                let act = touch.act(Answer { speed_m_s, ..ANSWER }, 0.01);
                speed_m_s += ANSWER.per_kg * (act.impulse_n_s + act.force_n * 0.01);
            }
            let exact = f64::from(touch.force_n) / f64::from(damping);
            assert!((speed_m_s / exact - 1.0).abs() < 1e-6, "{damping}: {speed_m_s} {exact}");
        }
    }

    #[test]
    fn a_body_over_nothing_gives_nothing() {
        let touch = Touch { kick_j: 1.0, damping_n_s_per_m: 1.0, ..Touch::default() };
        let act = touch.act(Answer { speed_m_s: 0.0, per_kg: 0.0 }, 0.01);
        assert_eq!(act.impulse_n_s, 0.0);
    }
}
