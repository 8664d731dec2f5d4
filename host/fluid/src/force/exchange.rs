//! The exchange of momentum between probe and liquid, and its books.

use glam::{DVec3, Vec3};

use crate::solver::{Refused, flow::Flow};

/// Impulse given, and how exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exchange {
    /// What rounding kept back, given with the next exchange.
    carried_n_s: DVec3,
    given_n_s: f64,
    error_n_s: f64,
    untaken_n_s: f64,
}

impl Exchange {
    /// Gives `impulse_n_s` to the liquid around a point. The change of the liquid's momentum is
    /// measured from the grid in f64, before and after; what is missing is carried over.
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite; nothing is changed.
    pub fn give(
        &mut self,
        flow: &mut Flow,
        centre_in_world_m: Vec3,
        radius_m: f32,
        impulse_n_s: DVec3,
    ) -> Result<(), Refused> {
        let owed_n_s = impulse_n_s + self.carried_n_s;
        if owed_n_s == DVec3::ZERO {
            return Ok(());
        }
        if !flow.effective_mass_kg(centre_in_world_m, radius_m).is_finite() {
            self.untaken_n_s += impulse_n_s.length();
            return Ok(()); // no liquid is in reach to take it
        }
        let before = flow.momentum_n_s();
        flow.push(centre_in_world_m, radius_m, owed_n_s)?;
        let change = flow.momentum_n_s() - before;
        self.carried_n_s = owed_n_s - change;
        self.given_n_s += owed_n_s.length();
        self.error_n_s += self.carried_n_s.length();
        Ok(())
    }

    /// Sum of |J| over all exchanges.
    #[must_use]
    pub fn given_n_s(&self) -> f64 {
        self.given_n_s
    }

    /// Sum of |J| that no liquid was there to take: of a probe beside the pot.
    #[must_use]
    pub fn untaken_n_s(&self) -> f64 {
        self.untaken_n_s
    }

    /// Sum over all exchanges of |change of the liquid's momentum - J|, over the sum of |J|;
    /// 0 before the first.
    #[must_use]
    pub fn residual_rel(&self) -> f64 {
        if self.given_n_s > 0.0 { self.error_n_s / self.given_n_s } else { 0.0 }
    }
}
