//! Whichever vessel the scene has, and the sheen of the glass where its wall is cut away.

use cauldron_fluid::{Snapshot, Vessel};
use glam::Vec3;

use crate::{
    camera::Ray,
    film::Film,
    frame::Frame,
    light,
    pot::Pot,
    solid::{self, Solid},
};

/// The vessel as it is drawn.
pub(crate) enum Walls {
    Frame(Frame),
    Pot(Pot),
}

impl Walls {
    /// The walls of `snapshot`, opened towards `eye_in_world_m`. A bowl is drawn as a pot, and a
    /// vessel of no round shape as the frame of its grid.
    pub(crate) fn new(snapshot: &Snapshot, eye_in_world_m: Vec3) -> Self {
        let low_in_world_m = snapshot.grid.origin_in_world_m;
        let extent_m = snapshot.grid.extent_m();
        match snapshot.vessel {
            Vessel::Box | Vessel::Cylinder { .. } | Vessel::Distance(_) => {
                Self::Frame(Frame::new(low_in_world_m, extent_m))
            }
            Vessel::Pot { centre_in_world_m, radius_m }
            | Vessel::Bowl { centre_in_world_m, radius_m } => {
                let liquid_in_world_m = low_in_world_m.y + extent_m.y;
                Self::Pot(Pot::new(centre_in_world_m, radius_m, liquid_in_world_m, eye_in_world_m))
            }
        }
    }

    /// Distance along `ray` to the first wall, and the wall's colour there.
    pub(crate) fn hit(&self, ray: &Ray) -> Option<(f32, Vec3)> {
        let along_m = match self {
            Self::Frame(frame) => frame.hit_m(ray),
            Self::Pot(pot) => pot.hit_m(ray),
        }?;
        let point_in_world_m = ray.at(along_m);
        let normal = solid::normal(self, point_in_world_m);
        let colour = match self {
            Self::Frame(frame) => frame.colour(point_in_world_m, normal, ray.direction),
            Self::Pot(pot) => pot.colour(point_in_world_m, normal, ray.direction),
        };
        Some((along_m, colour))
    }

    /// The part of `ray` in the hollow, up to the rim.
    pub(crate) fn span_inside_m(&self, ray: &Ray) -> Option<[f32; 2]> {
        match self {
            Self::Frame(frame) => frame.span_inside_m(ray),
            Self::Pot(pot) => pot.span_inside_m(ray),
        }
    }

    /// Distance from a point to the wall, positive inside.
    pub(crate) fn depth_inside_m(&self, point_in_world_m: Vec3) -> f32 {
        match self {
            Self::Frame(frame) => frame.depth_inside_m(point_in_world_m),
            Self::Pot(pot) => pot.depth_inside_m(point_in_world_m),
        }
    }

    /// The sheen of the glass that stands in for a wall cut away, where `ray` enters through it
    /// at `point_in_world_m`. Entering from above, through the mouth, it meets no glass.
    pub(crate) fn sheen(&self, ray: &Ray, point_in_world_m: Vec3, film: &mut Film) {
        const GLASS_M: f32 = 1e-3;
        if self.depth_inside_m(point_in_world_m) > GLASS_M {
            return;
        }
        let inward = |axis: Vec3| {
            self.depth_inside_m(point_in_world_m + GLASS_M * axis)
                - self.depth_inside_m(point_in_world_m - GLASS_M * axis)
        };
        let normal =
            -Vec3::new(inward(Vec3::X), inward(Vec3::Y), inward(Vec3::Z)).normalize_or_zero();
        let mirrored = 0.5 * light::fresnel(normal, ray.direction);
        let room = light::room(light::mirrored(ray.direction, normal));
        let lamp = 0.5 * light::gloss(normal, ray.direction, 60);
        film.sheet(Vec3::splat(mirrored * room + lamp), mirrored);
    }
}

impl Solid for Walls {
    fn distance_m(&self, point_in_world_m: Vec3) -> f32 {
        match self {
            Self::Frame(frame) => frame.distance_m(point_in_world_m),
            Self::Pot(pot) => pot.distance_m(point_in_world_m),
        }
    }
}
