//! Solid things as signed distances, and where a ray meets them.

use glam::{Vec2, Vec3};

use crate::camera::Ray;

/// A solid body.
pub(crate) trait Solid {
    /// Distance to its surface in metres, negative inside. Never more than the true distance,
    /// or a ray could step through it.
    fn distance_m(&self, point_in_world_m: Vec3) -> f32;
}

/// A ray this close to a body has met it.
const TOUCH_M: f32 = 3e-4;
/// A ray that grazes a body for longer than this is let pass.
const MOST_STEPS: usize = 96;

/// Distance along `ray`, within `span_m`, to the first point of `solid`.
pub(crate) fn hit(solid: &impl Solid, ray: &Ray, span_m: [f32; 2]) -> Option<f32> {
    let mut along_m = span_m[0];
    for _ in 0..MOST_STEPS {
        let gap_m = solid.distance_m(ray.at(along_m));
        if gap_m < TOUCH_M {
            return Some(along_m);
        }
        along_m += gap_m;
        let goes_on = along_m < span_m[1];
        if !goes_on {
            return None;
        }
    }
    None
}

/// Outward unit normal of `solid` at a point on its surface, from the distances at the four
/// corners of a small tetrahedron.
pub(crate) fn normal(solid: &impl Solid, point_in_world_m: Vec3) -> Vec3 {
    const CORNERS: [Vec3; 4] =
        [Vec3::ONE, Vec3::new(1., -1., -1.), Vec3::new(-1., 1., -1.), Vec3::new(-1., -1., 1.)];
    let slope = |corner: Vec3| corner * solid.distance_m(point_in_world_m + TOUCH_M * corner);
    CORNERS.into_iter().map(slope).sum::<Vec3>().normalize_or_zero()
}

/// Distance to a rod with round ends, from `ends_m[0]` to `ends_m[1]`.
pub(crate) fn rod_m(point_m: Vec3, ends_m: [Vec3; 2], radius_m: f32) -> f32 {
    let axis_m = ends_m[1] - ends_m[0];
    let from_start_m = point_m - ends_m[0];
    let part = from_start_m.dot(axis_m) / axis_m.length_squared().max(f32::MIN_POSITIVE);
    (from_start_m - part.clamp(0.0, 1.0) * axis_m).length() - radius_m
}

/// Distance to a ring around the origin, whose axis is `along_m` away in a coordinate system
/// where the point lies `around_m` from that axis.
pub(crate) fn ring_m(around_m: f32, along_m: f32, ring_radius_m: f32, wire_radius_m: f32) -> f32 {
    Vec2::new(around_m - ring_radius_m, along_m).length() - wire_radius_m
}

/// The part of `ray` inside a sphere, in metres along it.
pub(crate) fn span_in_sphere_m(ray: &Ray, centre_m: Vec3, radius_m: f32) -> Option<[f32; 2]> {
    let to_centre_m = centre_m - ray.origin_in_world_m;
    let middle_m = to_centre_m.dot(ray.direction);
    let half_squared =
        radius_m * radius_m - (to_centre_m - middle_m * ray.direction).length_squared();
    span_around(middle_m, half_squared)
}

/// The part of `ray` inside the endless upright cylinder around `centre_m`.
pub(crate) fn span_in_cylinder_m(ray: &Ray, centre_m: Vec3, radius_m: f32) -> Option<[f32; 2]> {
    let flat = |v: Vec3| Vec2::new(v.x, v.z);
    let across = flat(ray.direction);
    let to_axis_m = flat(centre_m - ray.origin_in_world_m);
    // A ray along the axis has no slope: it is inside for a very long way, or never.
    let across_squared = across.length_squared().max(1e-12);
    let middle_m = to_axis_m.dot(across) / across_squared;
    let nearest_squared = (to_axis_m - middle_m * across).length_squared();
    let half_squared = (radius_m * radius_m - nearest_squared) / across_squared;
    span_around(middle_m, half_squared)
}

/// The span of a ray that enters a round body as long before `middle_m` as it leaves it after.
fn span_around(middle_m: f32, half_squared: f32) -> Option<[f32; 2]> {
    let half_m = half_squared.sqrt();
    let span_m = [(middle_m - half_m).max(0.0), middle_m + half_m];
    (half_squared > 0.0 && span_m[0] < span_m[1]).then_some(span_m)
}

/// The part of `ray` inside an upright box, in metres along it.
pub(crate) fn span_in_box_m(ray: &Ray, low_m: Vec3, high_m: Vec3) -> Option<[f32; 2]> {
    // A direction along a face divides by zero: the infinities compare as they should.
    let to_low_m = (low_m - ray.origin_in_world_m) / ray.direction;
    let to_high_m = (high_m - ray.origin_in_world_m) / ray.direction;
    let enter_m = to_low_m.min(to_high_m).max_element().max(0.0);
    let leave_m = to_low_m.max(to_high_m).min_element();
    (enter_m < leave_m).then_some([enter_m, leave_m])
}

/// What `a` and `b` have in common.
pub(crate) fn common(a: [f32; 2], b: [f32; 2]) -> Option<[f32; 2]> {
    let span = [a[0].max(b[0]), a[1].min(b[1])];
    (span[0] < span[1]).then_some(span)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Ball;

    impl Solid for Ball {
        fn distance_m(&self, point_in_world_m: Vec3) -> f32 {
            point_in_world_m.length() - 0.5
        }
    }

    const RAY: Ray = Ray { origin_in_world_m: Vec3::new(0.0, 0.0, 2.0), direction: Vec3::NEG_Z };

    #[test]
    fn a_ray_stops_where_the_ball_begins() {
        let along_m = hit(&Ball, &RAY, [0.0, 10.0]).unwrap();
        assert!((along_m - 1.5).abs() < 2.0 * TOUCH_M);
        assert!(normal(&Ball, RAY.at(along_m)).distance(Vec3::Z) < 1e-2);
        assert_eq!(hit(&Ball, &RAY, [0.0, 1.0]), None);
    }

    #[test]
    fn spans_agree_with_the_bodies_they_cut() {
        let sphere = span_in_sphere_m(&RAY, Vec3::ZERO, 0.5).unwrap();
        let cube = span_in_box_m(&RAY, Vec3::splat(-0.5), Vec3::splat(0.5)).unwrap();
        assert!((sphere[0] - 1.5).abs() < 1e-6 && (sphere[1] - 2.5).abs() < 1e-6);
        assert_eq!(cube, [1.5, 2.5]);
        assert_eq!(span_in_sphere_m(&RAY, Vec3::X, 0.5), None);
        assert_eq!(span_in_box_m(&RAY, Vec3::ONE, Vec3::splat(2.0)), None);
    }

    #[test]
    fn nan_hits_nothing_and_ends() {
        let lost = Ray { direction: Vec3::NAN, ..RAY };
        assert_eq!(hit(&Ball, &lost, [0.0, 1.0]), None);
        assert_eq!(span_in_sphere_m(&lost, Vec3::ZERO, 0.5), None);
        assert_eq!(span_in_box_m(&lost, Vec3::ZERO, Vec3::ONE), None);
    }
}
