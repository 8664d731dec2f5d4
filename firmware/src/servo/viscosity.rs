//! Viscosity: thick is harder to stir. The medium at rest resists the hand's own velocity.

use crate::vector::Vec3;

/// F = -c v.
pub fn force_n(drag_n_s_per_m: f32, velocity_m_s: Vec3) -> Vec3 {
    -(velocity_m_s * drag_n_s_per_m)
}
