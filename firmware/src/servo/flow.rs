//! Flow: currents carry the hand.

use crate::vector::Vec3;

/// F = c u.
pub fn force_n(drag_n_s_per_m: f32, flow_m_s: Vec3) -> Vec3 {
    flow_m_s * drag_n_s_per_m
}
