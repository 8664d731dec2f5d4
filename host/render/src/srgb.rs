//! The one pair of transfer functions between linear light and sRGB (IEC 61966-2-1).

use glam::Vec3;

use crate::unit;

/// sRGB value (0 to 1) of a linear one; out of range is clamped and NaN becomes 0.
#[must_use]
pub fn encode(linear: f32) -> f32 {
    let linear = unit(linear);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Linear value (0 to 1) of an sRGB one; out of range is clamped and NaN becomes 0.
#[must_use]
pub fn decode(encoded: f32) -> f32 {
    let encoded = unit(encoded);
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// A linear colour as the nearest 8-bit sRGB one.
#[must_use]
pub fn to_bytes(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|channel| (255.0 * encode(channel) + 0.5) as u8)
}

/// An 8-bit sRGB colour in linear light.
#[must_use]
pub fn from_bytes(encoded: [u8; 3]) -> Vec3 {
    Vec3::from_array(encoded.map(|channel| decode(f32::from(channel) / 255.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_round_trip() {
        for byte in 0..=255 {
            assert_eq!(to_bytes(from_bytes([byte; 3])), [byte; 3]);
        }
    }

    #[test]
    fn what_no_screen_shows_is_clamped() {
        assert_eq!(to_bytes(Vec3::new(f32::NAN, -1.0, f32::INFINITY)), [0, 0, 255]);
    }
}
