//! The cauldron: a round iron pot, its near half cut away so that one sees into it.

use glam::{Vec2, Vec3};

use crate::{
    camera::Ray,
    light,
    solid::{self, Solid},
};

/// Sizes as parts of the inner radius.
const WALL: f32 = 0.055;
/// How far in front of the middle the wall is cut.
const CUT: f32 = 0.12;
const RIM_ABOVE_LIQUID: f32 = 0.17;
/// However little there is in it, a pot is more than a bowl: there is room for the ears.
const LEAST_RIM: f32 = 0.5;
const RIM_WIRE: f32 = 0.042;
const EAR: [f32; 2] = [0.11, 0.028];
const LEG_WIRE: f32 = 0.065;
const LEG_TOP: [f32; 2] = [0.84, -0.71];
const LEG_FOOT: [f32; 2] = [0.95, -1.22];
/// Ways of the legs from the axis: two mirrored ones beside, one behind.
const BESIDE: Vec3 = Vec3::new(0.999, 0.0, 0.04);
const BEHIND: Vec3 = Vec3::NEG_Z;
/// A ray this close to the wall has met it.
const TOUCH_M: f32 = 1e-4;

/// A pot as it is drawn.
pub(crate) struct Pot {
    centre_in_world_m: Vec3,
    radius_m: f32,
    rim_m: f32,
    /// Horizontal unit vectors to the right of, and towards, whoever looks.
    right: Vec3,
    front: Vec3,
}

impl Pot {
    /// A pot filled up to `liquid_in_world_m`, cut open towards `eye_in_world_m`.
    pub(crate) fn new(
        centre_in_world_m: Vec3,
        radius_m: f32,
        liquid_in_world_m: f32,
        eye_in_world_m: Vec3,
    ) -> Self {
        // From straight above no side is nearer: any will do.
        let front = (eye_in_world_m - centre_in_world_m).with_y(0.0).normalize_or(Vec3::Z);
        let liquid_m = liquid_in_world_m - centre_in_world_m.y;
        let rim_m = (liquid_m + RIM_ABOVE_LIQUID * radius_m).max(LEAST_RIM * radius_m);
        Self { centre_in_world_m, radius_m, rim_m, right: Vec3::Y.cross(front), front }
    }

    /// Distance to the inner wall, positive inside.
    pub(crate) fn depth_inside_m(&self, point_in_world_m: Vec3) -> f32 {
        self.hollow_m(point_in_world_m - self.centre_in_world_m)
    }

    /// The part of `ray` in the hollow, up to the rim.
    pub(crate) fn span_inside_m(&self, ray: &Ray) -> Option<[f32; 2]> {
        self.span_in_hull_m(ray, self.radius_m)
    }

    /// Distance along `ray` to the first iron.
    pub(crate) fn hit_m(&self, ray: &Ray) -> Option<f32> {
        let bowl_m = self.hit_bowl_m(ray);
        let [from_m, to_m] = self.span_around_m(ray)?;
        solid::hit(&Fittings(self), ray, [from_m, bowl_m.unwrap_or(to_m)]).or(bowl_m)
    }

    /// Distance along `ray` to the wall: where the ray enters it from outside, comes to the cut,
    /// or leaves the hollow. In closed form, for most rays meet this and nothing else.
    fn hit_bowl_m(&self, ray: &Ray) -> Option<f32> {
        let outside_m = self.span_in_hull_m(ray, (1.0 + WALL) * self.radius_m)?[0];
        let inside_m = self.span_inside_m(ray).map(|span_m| span_m[1]);
        let to_cut_m = self.centre_in_world_m + self.cut_m() * self.front - ray.origin_in_world_m;
        let cut_m = to_cut_m.dot(self.front) / ray.direction.dot(self.front);
        [Some(outside_m), inside_m, Some(cut_m)]
            .into_iter()
            .flatten()
            .filter(|along_m| self.shell_m(self.local_m(ray.at(*along_m))) < TOUCH_M)
            .filter(|along_m| *along_m > 0.0)
            .min_by(f32::total_cmp)
    }

    /// The part of `ray` in the hull of a hemisphere and a cylinder of `radius_m`, which is
    /// convex, up to the rim.
    fn span_in_hull_m(&self, ray: &Ray, radius_m: f32) -> Option<[f32; 2]> {
        let centre_m = self.centre_in_world_m;
        let reach_m = Vec3::new(radius_m, 0.0, radius_m);
        let down_m = Vec3::Y * radius_m;
        let up_m = Vec3::Y * self.rim_m;
        let below = solid::span_in_box_m(ray, centre_m - reach_m - down_m, centre_m + reach_m)
            .zip(solid::span_in_sphere_m(ray, centre_m, radius_m))
            .and_then(|(a, b)| solid::common(a, b));
        let above = solid::span_in_box_m(ray, centre_m - reach_m, centre_m + reach_m + up_m)
            .zip(solid::span_in_cylinder_m(ray, centre_m, radius_m))
            .and_then(|(a, b)| solid::common(a, b));
        match (below, above) {
            (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
            (one, other) => one.or(other),
        }
    }

    /// The part of `ray` in a box around the whole pot.
    fn span_around_m(&self, ray: &Ray) -> Option<[f32; 2]> {
        let reach_m = 1.4 * self.radius_m;
        let low_m = Vec3::new(-reach_m, -1.3 * self.radius_m, -reach_m);
        let high_m = Vec3::new(reach_m, self.rim_m + 0.1 * self.radius_m, reach_m);
        solid::span_in_box_m(ray, self.centre_in_world_m + low_m, self.centre_in_world_m + high_m)
    }

    /// Colour of the iron at a point of its surface.
    pub(crate) fn colour(&self, point_in_world_m: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let from_centre_m = point_in_world_m - self.centre_in_world_m;
        let below_rim = ((self.rim_m - from_centre_m.y) / (self.rim_m + self.radius_m)).max(0.0);
        let is_inner = self.depth_inside_m(point_in_world_m) > -0.5 * WALL * self.radius_m;
        let before_cut_m = from_centre_m.dot(self.front) - self.cut_m();
        let is_cut = normal.dot(self.front) > 0.95 && before_cut_m.abs() < 10.0 * TOUCH_M;
        let (grey, shade) = match (is_cut, is_inner) {
            (true, _) => (0.42, 1.0),
            // The deeper inside, the less of the room is seen from there.
            (_, true) => (0.24, 1.0 - 0.75 * below_rim.min(1.0)),
            _ => (0.12, 1.0),
        };
        let iron = Vec3::new(0.96, 0.98, 1.0) * grey;
        let highlight = 0.25 * light::gloss(normal, direction, 24) * shade;
        iron * light::matt(normal) * shade + highlight
    }

    fn shell_m(&self, local_m: Vec3) -> f32 {
        let half_wall_m = 0.5 * WALL * self.radius_m;
        let shell_m = (self.hollow_m(local_m) + half_wall_m).abs() - half_wall_m;
        shell_m.max(local_m.y - self.rim_m).max(local_m.z - self.cut_m())
    }

    /// How far inside the hollow a point is.
    fn hollow_m(&self, local_m: Vec3) -> f32 {
        self.radius_m - local_m.with_y(local_m.y.min(0.0)).length()
    }

    fn rim_ring_m(&self, local_m: Vec3) -> f32 {
        let around_m = Vec2::new(local_m.x, local_m.z).length();
        let ring_m = (1.0 + 0.5 * WALL) * self.radius_m;
        solid::ring_m(around_m, local_m.y - self.rim_m, ring_m, RIM_WIRE * self.radius_m)
    }

    fn ear_m(&self, local_m: Vec3) -> f32 {
        let [ear_m, wire_m] = EAR.map(|part| part * self.radius_m);
        let out_m = (1.0 + WALL) * self.radius_m + 0.8 * ear_m;
        let around_m = Vec2::new(local_m.x - out_m, local_m.y - self.rim_m + 1.5 * ear_m).length();
        solid::ring_m(around_m, local_m.z + 2.0 * wire_m, ear_m, wire_m)
    }

    /// Height of the lowest point of rim and ears.
    fn lowest_ear_m(&self) -> f32 {
        self.rim_m - (2.5 * EAR[0] + EAR[1]) * self.radius_m
    }

    /// A leg towards `axis`, a horizontal unit vector.
    fn leg_m(&self, local_m: Vec3, axis: Vec3) -> f32 {
        let end = |[out, up]: [f32; 2]| self.radius_m * (out * axis + up * Vec3::Y);
        solid::rod_m(local_m, [end(LEG_TOP), end(LEG_FOOT)], LEG_WIRE * self.radius_m)
    }

    /// A point seen from the centre: to the right, up, and towards whoever looks.
    fn local_m(&self, point_in_world_m: Vec3) -> Vec3 {
        let from_centre_m = point_in_world_m - self.centre_in_world_m;
        from_centre_m.with_x(from_centre_m.dot(self.right)).with_z(from_centre_m.dot(self.front))
    }

    fn cut_m(&self) -> f32 {
        CUT * self.radius_m
    }
}

impl Solid for Pot {
    fn distance_m(&self, point_in_world_m: Vec3) -> f32 {
        let fittings_m = Fittings(self).distance_m(point_in_world_m);
        fittings_m.min(self.shell_m(self.local_m(point_in_world_m)))
    }
}

/// The pot without its wall.
struct Fittings<'a>(&'a Pot);

impl Solid for Fittings<'_> {
    fn distance_m(&self, point_in_world_m: Vec3) -> f32 {
        let pot = self.0;
        let local_m = pot.local_m(point_in_world_m);
        let mirrored_m = local_m.with_x(local_m.x.abs());
        // Rim and ears are all above the middle, and legs below it: from the other side, the
        // distance in height alone is a bound, and cheap.
        if local_m.y > 0.0 {
            let feet_m = local_m.y - (LEG_TOP[1] + LEG_WIRE) * pot.radius_m;
            pot.rim_ring_m(local_m).min(pot.ear_m(mirrored_m)).min(feet_m)
        } else {
            let rim_m = pot.lowest_ear_m() - local_m.y;
            pot.leg_m(mirrored_m, BESIDE).min(pot.leg_m(local_m, BEHIND)).min(rim_m)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_agrees_with_the_distances() {
        let eye_in_world_m = Vec3::new(0.2, 0.5, 0.6);
        let pot = Pot::new(Vec3::new(0.0, -0.128, 0.0), 0.12, 0.0, eye_in_world_m);
        let mut hits = 0;
        for (x, y) in (-30..30).flat_map(|y| (-30..30).map(move |x| (x as f32, y as f32))) {
            let target_m = Vec3::new(0.006 * x, -0.12 + 0.006 * y, 0.0);
            let direction = (target_m - eye_in_world_m).normalize_or_zero();
            let ray = Ray { origin_in_world_m: eye_in_world_m, direction };
            let marched_m = solid::hit(&pot, &ray, [0.0, 2.0]);
            let closed_m = pot.hit_m(&ray);
            // A ray that grazes the iron may be stopped by one way of looking and not by the other.
            if let (Some(marched_m), Some(closed_m)) = (marched_m, closed_m) {
                hits += i32::from((marched_m - closed_m).abs() < 0.004);
            } else {
                hits += i32::from(marched_m == closed_m);
            }
        }
        assert!(hits > 60 * 60 * 98 / 100, "{hits}");
    }
}
