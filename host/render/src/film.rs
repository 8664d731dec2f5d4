//! What has gathered along a ray, from the eye outward.

use glam::{Vec3, Vec4, Vec4Swizzles};

/// Light gathered so far, and the part of what lies behind that still comes through.
///
/// Colours are premultiplied: front to back, C += T c and T *= 1 - a.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Film {
    pub(crate) colour: Vec3,
    pub(crate) transmittance: f32,
}

/// Below this, nobody sees what lies behind.
const OPAQUE: f32 = 1.0 / 128.0;

impl Film {
    /// Nothing gathered yet.
    pub(crate) const CLEAR: Self = Self { colour: Vec3::ZERO, transmittance: 1.0 };

    /// A thin sheet: `colour` is what it adds, `cover` the part of what lies behind that it hides.
    pub(crate) fn sheet(&mut self, colour: Vec3, cover: f32) {
        self.colour += self.transmittance * colour;
        self.transmittance *= 1.0 - cover.clamp(0.0, 1.0);
    }

    /// A long way through a medium: see [`through`].
    pub(crate) fn medium(&mut self, medium: Vec4, length_m: f32) {
        let sheet = through(medium, length_m);
        self.sheet(sheet.xyz(), sheet.w);
    }

    /// Something solid, which ends the ray.
    pub(crate) fn solid(&mut self, colour: Vec3) {
        self.sheet(colour, 1.0);
    }

    /// True once nothing behind can be seen.
    pub(crate) fn is_opaque(&self) -> bool {
        self.transmittance < OPAQUE
    }
}

/// The sheet (`xyz` its colour, `w` its cover) that does as much as `length_m` of a medium whose
/// `xyz` is the light that it sends out and whose `w` is its extinction, both per metre. This is
/// 1 - (1 - a)^(ds / ref): what is gathered does not depend on how a path is cut into steps.
pub(crate) fn through(medium: Vec4, length_m: f32) -> Vec4 {
    let depth = medium.w * length_m;
    // Also false where a length is no number.
    if depth > 0.0 { medium * ((1.0 - (-depth).exp()) / medium.w) } else { Vec4::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_medium_looks_the_same_in_one_step_and_in_many() {
        let medium = Vec4::new(3.0, 2.0, 1.0, 10.0);
        let (mut one, mut many) = (Film::CLEAR, Film::CLEAR);
        one.medium(medium, 0.2);
        (0..50).for_each(|_| many.medium(medium, 0.004));
        assert!(one.colour.distance(many.colour) < 1e-5);
        assert!((one.transmittance - many.transmittance).abs() < 1e-5);
    }

    #[test]
    fn nothing_is_seen_behind_a_solid() {
        let mut film = Film::CLEAR;
        film.solid(Vec3::X);
        film.solid(Vec3::Y);
        assert_eq!(film.colour, Vec3::X);
        assert!(film.is_opaque());
    }
}
