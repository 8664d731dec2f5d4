//! What bodies do to the surface.

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
