//! A pinhole camera in world metres, and the rays that leave it.

use cauldron_fluid::{Snapshot, Vessel};
use glam::Vec3;

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, world metres.
    pub origin_in_world_m: Vec3,
    /// Unit direction in world space.
    pub direction: Vec3,
}

impl Ray {
    /// The point `distance_m` along the ray.
    #[must_use]
    pub fn at(&self, distance_m: f32) -> Vec3 {
        self.origin_in_world_m + distance_m * self.direction
    }
}

/// Where the picture is taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole, world metres.
    pub eye_in_world_m: Vec3,
    /// What the middle of the picture shows, world metres.
    pub target_in_world_m: Vec3,
    /// Angle of view across the shorter side of the picture, so that what is framed stays framed
    /// in an upright picture too.
    pub fov_rad: f32,
}

/// Default view: how far the camera looks down, and how far it stands to the right of the front.
const DOWN_RAD: f32 = 38.0 * std::f32::consts::PI / 180.0;
const ASIDE_RAD: f32 = 14.0 * std::f32::consts::PI / 180.0;
/// A long lens: a pot seen from across the table, not from above its rim.
const FOV_RAD: f32 = 28.0 * std::f32::consts::PI / 180.0;
/// Distance over that at which the vessel's bounding sphere would just touch the picture's edge.
/// Below 1 because the vessel does not fill its sphere.
const CLOSENESS: f32 = 1.08;

/// Room above the vessel for the handle, as a part of the sphere's radius.
const HEADROOM: f32 = 0.22;

/// The same where there is smoke to be seen, and how much further away one stands for it.
const SMOKE_ROOM: [f32; 2] = [0.62, 1.3];

impl Camera {
    /// The default view: down into the whole vessel, from the front and a little aside.
    #[must_use]
    pub fn over(snapshot: &Snapshot) -> Self {
        let (middle_in_world_m, radius_m) = bounding_sphere(snapshot);
        let (down_sin, down_cos) = DOWN_RAD.sin_cos();
        let (aside_sin, aside_cos) = ASIDE_RAD.sin_cos();
        let towards_eye = Vec3::new(down_cos * aside_sin, down_sin, down_cos * aside_cos);
        let [headroom, further] =
            if snapshot.smoke.is_some() { SMOKE_ROOM } else { [HEADROOM, 1.0] };
        let distance_m = further * CLOSENESS * radius_m / (0.5 * FOV_RAD).sin();
        Self {
            eye_in_world_m: middle_in_world_m
                + distance_m * towards_eye
                + Vec3::Y * headroom * radius_m,
            target_in_world_m: middle_in_world_m + Vec3::Y * headroom * radius_m,
            fov_rad: FOV_RAD,
        }
    }

    /// The camera made ready for a picture of `width` x `height` pixels.
    pub(crate) fn lens(&self, width: usize, height: usize) -> Lens {
        let forward = (self.target_in_world_m - self.eye_in_world_m).normalize_or(Vec3::NEG_Z);
        // Looking straight down, every direction is upright: world x then runs to the right.
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        let shorter_px = width.min(height).max(1) as f32;
        Lens {
            origin_in_world_m: self.eye_in_world_m,
            forward,
            right,
            up: right.cross(forward),
            slope_per_px: 2.0 * (0.5 * self.fov_rad).tan() / shorter_px,
            middle_px: [0.5 * width as f32, 0.5 * height as f32],
        }
    }
}

/// Middle and radius of a sphere around the vessel.
fn bounding_sphere(snapshot: &Snapshot) -> (Vec3, f32) {
    let grid = &snapshot.grid;
    let half_m = 0.5 * grid.extent_m();
    match snapshot.vessel {
        Vessel::Box | Vessel::Cylinder { .. } | Vessel::Distance(_) => {
            (grid.origin_in_world_m + half_m, half_m.length())
        }
        Vessel::Pot { centre_in_world_m, radius_m }
        | Vessel::Bowl { centre_in_world_m, radius_m } => {
            let top_m = grid.origin_in_world_m.y + 2.0 * half_m.y - centre_in_world_m.y;
            let half_height_m = 0.5 * (top_m + radius_m);
            let middle_m = centre_in_world_m + Vec3::Y * (half_height_m - radius_m);
            (middle_m, half_height_m.hypot(radius_m))
        }
    }
}

/// A camera whose trigonometry is done.
pub(crate) struct Lens {
    origin_in_world_m: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
    slope_per_px: f32,
    middle_px: [f32; 2],
}

impl Lens {
    /// The ray through a point of the picture, in pixels from its upper left corner.
    pub(crate) fn ray(&self, x_px: f32, y_px: f32) -> Ray {
        let across = self.slope_per_px * (x_px - self.middle_px[0]);
        let upward = self.slope_per_px * (self.middle_px[1] - y_px);
        let direction = self.forward + across * self.right + upward * self.up;
        Ray { origin_in_world_m: self.origin_in_world_m, direction: direction.normalize_or_zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Camera = Camera {
        eye_in_world_m: Vec3::new(0.0, 1.0, 1.0),
        target_in_world_m: Vec3::ZERO,
        fov_rad: 1.0,
    };

    #[test]
    fn the_middle_of_the_picture_shows_the_target() {
        let ray = CAMERA.lens(480, 360).ray(240.0, 180.0);
        assert!(ray.at(2.0_f32.sqrt()).length() < 1e-6);
    }

    #[test]
    fn right_and_up_are_right_and_up() {
        let lens = CAMERA.lens(480, 360);
        assert!(lens.ray(480.0, 180.0).direction.x > 0.1);
        assert!(lens.ray(240.0, 0.0).direction.y > lens.ray(240.0, 360.0).direction.y);
    }

    #[test]
    fn straight_down_still_has_a_right_side() {
        let camera = Camera { eye_in_world_m: Vec3::Y, ..CAMERA };
        assert!(camera.lens(10, 10).ray(9.0, 5.0).direction.x > 0.1);
    }
}
