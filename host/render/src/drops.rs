//! Drops in the air: small balls of liquid, each with the colour of what is in it.

use cauldron_fluid::{DropView, Snapshot};
use glam::Vec3;

use crate::{camera::Ray, light, solid};

/// The drops of a snapshot, and a ball around all of them.
pub(crate) struct Drops {
    drops: Vec<DropView>,
    middle_in_world_m: Vec3,
    reach_m: f32,
}

impl Drops {
    /// Those that have a place and a size.
    pub(crate) fn new(snapshot: &Snapshot) -> Self {
        let is_there = |d: &&DropView| d.at_in_world_m.is_finite() && d.radius_m > 0.0;
        let drops: Vec<_> = snapshot.drops.iter().filter(is_there).copied().collect();
        let low = drops.iter().fold(Vec3::INFINITY, |low, d| low.min(d.at_in_world_m));
        let high = drops.iter().fold(Vec3::NEG_INFINITY, |high, d| high.max(d.at_in_world_m));
        let middle_in_world_m = 0.5 * (low + high);
        let far = |d: &DropView| d.at_in_world_m.distance(middle_in_world_m) + d.radius_m;
        let reach_m = drops.iter().map(far).fold(0.0, f32::max);
        Self { drops, middle_in_world_m, reach_m }
    }

    /// Distance along `ray` to the nearest drop, and its colour there.
    pub(crate) fn hit(&self, ray: &Ray) -> Option<(f32, Vec3)> {
        if self.drops.is_empty() {
            return None;
        }
        solid::span_in_sphere_m(ray, self.middle_in_world_m, self.reach_m)?;
        let met = |drop: &DropView| {
            let [from_m, _] = solid::span_in_sphere_m(ray, drop.at_in_world_m, drop.radius_m)?;
            (from_m > 0.0).then_some((from_m, *drop))
        };
        let nearest = self.drops.iter().filter_map(met).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(along_m, drop)| (along_m, shaded(&drop, ray, along_m)))
    }
}

/// Wet and round: its own colour, the room mirrored at its edge, and the lamp.
fn shaded(drop: &DropView, ray: &Ray, along_m: f32) -> Vec3 {
    let normal = (ray.at(along_m) - drop.at_in_world_m) / drop.radius_m;
    let mirrored = light::fresnel(normal, ray.direction);
    let room = light::room(light::mirrored(ray.direction, normal));
    let own = drop.colour * light::matt(normal);
    own + light::TINT * (mirrored * room) + 0.8 * light::gloss(normal, ray.direction, 48)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snapshot(drops: Vec<DropView>) -> Snapshot {
        Snapshot {
            time_s: 0.0,
            grid: cauldron_fluid::Grid::unit_cube(2),
            vessel: cauldron_fluid::Vessel::Box,
            liquid_colour: None,
            substances: Vec::new(),
            surface: None,
            drops,
            smoke: None,
        }
    }

    #[test]
    fn the_nearest_drop_is_seen_and_one_without_a_place_is_not() {
        let drop = |z: f32, radius_m: f32, colour: Vec3| DropView {
            at_in_world_m: Vec3::new(0.0, 0.0, z),
            radius_m,
            colour,
        };
        let drops = vec![
            drop(1.0, 0.1, Vec3::X),
            drop(2.0, 0.1, Vec3::Y),
            drop(f32::NAN, 0.1, Vec3::Z),
            drop(3.0, f32::NAN, Vec3::Z),
        ];
        let drops = Drops::new(&snapshot(drops));
        let ray =
            |x: f32| Ray { origin_in_world_m: Vec3::new(x, 0.0, 5.0), direction: Vec3::NEG_Z };
        let (along_m, colour) = drops.hit(&ray(0.0)).expect("a drop");
        assert!((along_m - 2.9).abs() < 1e-5 && colour.y > colour.x, "{along_m} {colour}");
        assert!(drops.hit(&ray(0.11)).is_none());
        assert!(Drops::new(&snapshot(Vec::new())).hit(&ray(0.0)).is_none());
    }
}
