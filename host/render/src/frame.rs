//! The box: a thin frame of edges and a floor.

use glam::{Vec2, Vec3};

use crate::{
    camera::Ray,
    light,
    solid::{self, Solid},
};

/// Sizes as parts of the box's longest edge.
const EDGE: f32 = 0.009;
const FLOOR: f32 = 0.012;
const RIM_ABOVE_LIQUID: f32 = 0.07;

/// A box as it is drawn.
pub(crate) struct Frame {
    low_in_world_m: Vec3,
    high_in_world_m: Vec3,
    longest_m: f32,
}

impl Frame {
    /// A box filled to the top of `extent_m`, with a rim above it.
    pub(crate) fn new(low_in_world_m: Vec3, extent_m: Vec3) -> Self {
        let longest_m = extent_m.max_element();
        let rim_m = Vec3::Y * RIM_ABOVE_LIQUID * longest_m;
        Self { low_in_world_m, high_in_world_m: low_in_world_m + extent_m + rim_m, longest_m }
    }

    /// Distance to the nearest side wall or the floor, positive inside.
    pub(crate) fn depth_inside_m(&self, point_in_world_m: Vec3) -> f32 {
        let above_m = point_in_world_m - self.low_in_world_m;
        let below_m = self.high_in_world_m - point_in_world_m;
        above_m.min_element().min(below_m.x).min(below_m.z)
    }

    /// The part of `ray` inside, up to the rim.
    pub(crate) fn span_inside_m(&self, ray: &Ray) -> Option<[f32; 2]> {
        solid::span_in_box_m(ray, self.low_in_world_m, self.high_in_world_m)
    }

    /// Distance along `ray` to the first edge, or the floor.
    pub(crate) fn hit_m(&self, ray: &Ray) -> Option<f32> {
        let reach_m = Vec3::splat(2.0 * FLOOR.max(EDGE) * self.longest_m);
        let [low_m, high_m] = [self.low_in_world_m - reach_m, self.high_in_world_m + reach_m];
        solid::hit(self, ray, solid::span_in_box_m(ray, low_m, high_m)?)
    }

    /// Colour of a point of frame or floor.
    pub(crate) fn colour(&self, point_in_world_m: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let is_floor = point_in_world_m.y < self.low_in_world_m.y + 1e-3 && normal.y > 0.9;
        let grey = if is_floor { 0.16 } else { 0.50 };
        let steel = Vec3::new(0.96, 0.98, 1.0) * grey;
        steel * light::matt(normal) + 0.2 * light::gloss(normal, direction, 24)
    }
}

impl Solid for Frame {
    fn distance_m(&self, point_in_world_m: Vec3) -> f32 {
        let half_m = 0.5 * (self.high_in_world_m - self.low_in_world_m);
        let from_middle_m = (point_in_world_m - self.low_in_world_m - half_m).abs();
        let outside_m = from_middle_m - half_m;
        let past_end_m = outside_m.max(Vec3::ZERO);
        let edge_x_m = Vec3::new(past_end_m.x, outside_m.y, outside_m.z).length();
        let edge_y_m = Vec3::new(outside_m.x, past_end_m.y, outside_m.z).length();
        let edge_z_m = Vec3::new(outside_m.x, outside_m.y, past_end_m.z).length();
        let edges_m = edge_x_m.min(edge_y_m).min(edge_z_m) - EDGE * self.longest_m;

        let thickness_m = FLOOR * self.longest_m;
        let below_m = self.low_in_world_m.y - 0.5 * thickness_m - point_in_world_m.y;
        let beside_m = Vec2::new(outside_m.x, outside_m.z).max_element();
        edges_m.min((below_m.abs() - 0.5 * thickness_m).max(beside_m))
    }
}
