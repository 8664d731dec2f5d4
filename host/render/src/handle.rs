//! The player's handle: a sphere where the hand is let be, and a rod up to where it is held.

use glam::Vec3;

use crate::{
    camera::Ray,
    light,
    solid::{self, Solid},
    unit,
};

/// What the player holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handle {
    /// Where the device is, world metres. It may be inside a wall, so nothing is drawn there: the
    /// rod's upper end follows it, and the handle leans the way the hand pushes.
    pub tip_in_world_m: Vec3,
    /// Where the walls let the handle be, world metres: the sphere is drawn here.
    pub proxy_in_world_m: Vec3,
    /// Radius of the sphere.
    pub radius_m: f32,
    /// Force on the hand now, over the most that the device is allowed to give.
    pub force_fraction: f32,
}

/// Sizes as parts of the sphere's radius.
const ROD_LENGTH: f32 = 13.0;
const ROD_RADIUS: f32 = 0.26;
/// Way of a rod that nothing pushes: up, to the right and a little back.
const SLANT: Vec3 = Vec3::new(0.44, 0.88, -0.17);
/// The hand leans the rod no further than this many radii, whatever the device says.
const MOST_LEAN: f32 = 4.0;

/// Linear colour of a handle under `force_fraction` of the largest force: pale green when light,
/// yellow at 0.3, pink red from 0.7 on. Paler than any substance, so that neither people nor
/// programs take it for one.
#[must_use]
pub fn force_colour(force_fraction: f32) -> Vec3 {
    const LIGHT: Vec3 = Vec3::new(0.14, 1.0, 0.60);
    const MODERATE: Vec3 = Vec3::new(0.96, 0.96, 0.22);
    const STRONG: Vec3 = Vec3::new(1.0, 0.11, 0.26);
    let smooth = |from: f32, to: f32| {
        let part = unit((force_fraction - from) / (to - from));
        part * part * (3.0 - 2.0 * part)
    };
    LIGHT.lerp(MODERATE, smooth(0.0, 0.3)).lerp(STRONG, smooth(0.3, 0.7))
}

/// A handle as it is drawn.
pub(crate) struct Rod {
    ends_in_world_m: [Vec3; 2],
    radius_m: f32,
    colour: Vec3,
}

impl Rod {
    /// The rod of `handle`; `None` where it has no place or no size.
    pub(crate) fn new(handle: &Handle) -> Option<Self> {
        let Handle { tip_in_world_m, proxy_in_world_m, radius_m, force_fraction } = *handle;
        let lean_m = (tip_in_world_m - proxy_in_world_m).clamp_length_max(MOST_LEAN * radius_m);
        let lean_m = if lean_m.is_finite() { lean_m } else { Vec3::ZERO };
        let held_at_m = proxy_in_world_m + ROD_LENGTH * radius_m * SLANT + lean_m;
        (held_at_m.is_finite() && radius_m > 0.0).then_some(Self {
            ends_in_world_m: [proxy_in_world_m, held_at_m],
            radius_m,
            colour: force_colour(force_fraction),
        })
    }

    /// Distance along `ray` to the handle, and its colour there.
    pub(crate) fn hit(&self, ray: &Ray) -> Option<(f32, Vec3)> {
        let [proxy_m, held_at_m] = self.ends_in_world_m;
        let middle_m = 0.5 * (proxy_m + held_at_m);
        let reach_m = 0.5 * proxy_m.distance(held_at_m) + self.radius_m;
        let span_m = solid::span_in_sphere_m(ray, middle_m, reach_m)?;
        let along_m = solid::hit(self, ray, span_m)?;
        let normal = solid::normal(self, ray.at(along_m));
        // Mostly its own light: the colour is a reading and must not depend on the lamp.
        let shade = 0.88 + 0.12 * normal.dot(-ray.direction).max(0.0);
        let highlight = 0.25 * light::gloss(normal, ray.direction, 32);
        Some((along_m, self.colour * shade + highlight))
    }
}

impl Solid for Rod {
    fn distance_m(&self, point_in_world_m: Vec3) -> f32 {
        let sphere_m = point_in_world_m.distance(self.ends_in_world_m[0]) - self.radius_m;
        let rod_m =
            solid::rod_m(point_in_world_m, self.ends_in_world_m, ROD_RADIUS * self.radius_m);
        sphere_m.min(rod_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HANDLE: Handle = Handle {
        tip_in_world_m: Vec3::new(0.0, -0.5, 0.0),
        proxy_in_world_m: Vec3::ZERO,
        radius_m: 0.012,
        force_fraction: 0.0,
    };

    #[test]
    fn the_sphere_is_at_the_proxy_and_nothing_at_the_device() {
        let rod = Rod::new(&HANDLE).unwrap();
        assert!(rod.distance_m(HANDLE.proxy_in_world_m) < 0.0);
        assert!(rod.distance_m(HANDLE.tip_in_world_m) > 0.4);
    }

    #[test]
    fn a_handle_without_a_place_is_not_drawn() {
        assert!(Rod::new(&Handle { proxy_in_world_m: Vec3::NAN, ..HANDLE }).is_none());
        assert!(Rod::new(&Handle { radius_m: f32::NAN, ..HANDLE }).is_none());
        assert!(Rod::new(&Handle { tip_in_world_m: Vec3::NAN, ..HANDLE }).is_some());
    }

    #[test]
    fn the_colour_goes_from_green_over_yellow_to_red() {
        let [light, moderate, strong] = [0.0, 0.3, 0.7].map(force_colour);
        assert!(light.y > 2.0 * light.x && strong.x > 2.0 * strong.y);
        assert!(moderate.x > 0.8 && moderate.y > 0.8 && moderate.z < 0.3);
        assert_eq!(force_colour(f32::INFINITY), strong);
        assert_eq!(force_colour(f32::NAN), light);
    }
}
