//! The light of the room: one lamp above the player's left shoulder, and a dim sky.

use glam::Vec3;

use crate::unit;

/// Unit direction towards the lamp.
pub(crate) const TO_LAMP: Vec3 = Vec3::new(-4.0 / 9.0, 7.0 / 9.0, 4.0 / 9.0);

/// Colour of what clear sheets mirror: that of daylight, so that liquid looks wet and not dusty.
pub(crate) const TINT: Vec3 = Vec3::new(0.78, 0.92, 1.0);

/// Matt light on something with unit normal `normal`, 0 to about 1.
pub(crate) fn matt(normal: Vec3) -> f32 {
    0.16 + 0.16 * (1.0 + normal.y) + 0.55 * normal.dot(TO_LAMP).max(0.0)
}

/// Soft highlight of the lamp, 0 to 1, for a ray along `direction`.
pub(crate) fn gloss(normal: Vec3, direction: Vec3, sharpness: i32) -> f32 {
    mirrored(direction, normal).dot(TO_LAMP).max(0.0).powi(sharpness)
}

/// `direction` after a mirror.
pub(crate) fn mirrored(direction: Vec3, normal: Vec3) -> Vec3 {
    direction - 2.0 * direction.dot(normal) * normal
}

/// Radiance of the room in `direction`: dark walls, and a wide bright window high up behind the
/// pot, which is what makes every ripple show.
pub(crate) fn room(direction: Vec3) -> f32 {
    let window = (1.0 - (direction.y - 0.80).abs() / 0.30).max(0.0);
    0.12 + 0.20 * direction.y.max(0.0) + 1.1 * window * window * (3.0 - 2.0 * window)
}

/// The part that a clear sheet mirrors at a ray along `direction`: Schlick's approximation,
/// 5 times stronger than water's 0.02, so that the sheet is seen from above too.
pub(crate) fn fresnel(normal: Vec3, direction: Vec3) -> f32 {
    let grazing = 1.0 - normal.dot(direction).abs().min(1.0);
    0.11 + 0.89 * grazing.powi(5)
}

/// What lies behind everything: a calm grey, lighter towards the bottom of the picture.
pub(crate) fn background(direction: Vec3) -> Vec3 {
    let down = unit(0.5 - 0.7 * direction.y);
    Vec3::new(0.010, 0.0105, 0.012).lerp(Vec3::new(0.030, 0.031, 0.034), down)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lamp_has_a_unit_direction() {
        assert!((TO_LAMP.length() - 1.0).abs() < 1e-6);
    }
}
