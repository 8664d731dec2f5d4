//! The liquid's free surface: a height field, met by rays, lit, and felt below as damped layers.

use cauldron_fluid::{Snapshot, SurfaceView};
use glam::{Vec2, Vec3};

use crate::{camera::Ray, film::Film, light};

/// The surface as it is drawn.
pub(crate) struct Surface {
    nodes: [usize; 2],
    per_m: f32,
    origin_in_world_m: Vec2,
    rest_in_world_m: f32,
    greatest_move_m: f32,
    /// World y of the lowest and the highest point.
    range_in_world_m: [f32; 2],
    height_m: Vec<f32>,
    slope: Vec<Vec2>,
    layers_per_m: f32,
    /// Further than this from the rest surface no layer moves by anything that could be seen.
    moving_m: f32,
}

impl Surface {
    /// The surface of `snapshot`; without one, the top of the grid's box.
    pub(crate) fn new(snapshot: &Snapshot) -> Self {
        let grid = &snapshot.grid;
        let flat = SurfaceView {
            nodes: [1, 1],
            spacing_m: 1.0,
            origin_in_world_m: [0.0; 2],
            rest_height_in_world_m: grid.origin_in_world_m.y + grid.extent_m().y,
            height_m: vec![0.0],
            layer_decay_m: 1.0,
        };
        Self::from_view(snapshot.surface.as_ref().unwrap_or(&flat))
    }

    /// A view whose heights do not fit its nodes is level.
    fn from_view(view: &SurfaceView) -> Self {
        let is_whole = view.nodes[0].checked_mul(view.nodes[1]) == Some(view.height_m.len());
        let (nodes, height_m) = if is_whole && !view.height_m.is_empty() {
            let finite = |m: &f32| if m.is_finite() { *m } else { 0.0 };
            (view.nodes, view.height_m.iter().map(finite).collect())
        } else {
            ([1, 1], vec![0.0])
        };
        let rest_in_world_m = view.rest_height_in_world_m;
        let low_m = height_m.iter().copied().fold(f32::INFINITY, f32::min);
        let high_m = height_m.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let greatest_move_m = high_m.max(-low_m);
        let decay_m = view.layer_decay_m.max(1e-6);
        let layers_moving_m = decay_m * (greatest_move_m / LEAST_MOVE_M).ln();
        let moving_m = if greatest_move_m > LEAST_MOVE_M {
            layers_moving_m + greatest_move_m
        } else {
            f32::NEG_INFINITY
        };
        let per_m = 1.0 / view.spacing_m.max(f32::MIN_POSITIVE);
        Self {
            nodes,
            per_m,
            origin_in_world_m: Vec2::from_array(view.origin_in_world_m),
            rest_in_world_m,
            greatest_move_m,
            range_in_world_m: [rest_in_world_m + low_m, rest_in_world_m + high_m],
            slope: slopes(nodes, per_m, &height_m),
            height_m,
            layers_per_m: 1.0 / decay_m,
            moving_m,
        }
    }

    /// Height of `point_in_world_m` over the surface below or above it.
    pub(crate) fn clearance_m(&self, point_in_world_m: Vec3) -> f32 {
        let height_m = self.between_nodes(point_in_world_m, &self.height_m);
        point_in_world_m.y - self.rest_in_world_m - height_m
    }

    /// Where the layer now at `point_in_world_m` lies when the liquid is at rest: a layer at a
    /// distance d from the surface has moved by exp(-d / decay) times what the surface there has
    /// (Mora 2008); below it in the liquid, and above it in the gas.
    pub(crate) fn at_rest(&self, point_in_world_m: Vec3) -> Vec3 {
        if (point_in_world_m.y - self.rest_in_world_m).abs() > self.moving_m {
            return point_in_world_m;
        }
        let height_m = self.between_nodes(point_in_world_m, &self.height_m);
        let away_m = (self.rest_in_world_m + height_m - point_in_world_m.y).abs();
        let moved_m = height_m * (-away_m * self.layers_per_m).exp();
        point_in_world_m - Vec3::Y * moved_m
    }

    /// Greatest way that any layer has moved.
    pub(crate) fn greatest_move_m(&self) -> f32 {
        self.greatest_move_m
    }

    /// Distance along `ray`, within `span_m`, to where it next goes through the surface.
    pub(crate) fn crossing_m(&self, ray: &Ray, span_m: [f32; 2]) -> Option<f32> {
        let [mut from_m, to_m] = self.span_in_range_m(ray, span_m)?;
        // A crest or a funnel that a ray only grazes is some nodes wide.
        let nodes = (to_m - from_m) * self.per_m;
        let steps = nodes.clamp(LEAST_STEPS, MOST_STEPS).ceil();
        let step_m = (to_m - from_m) / steps;
        let mut from_clearance_m = self.clearance_m(ray.at(from_m));
        for _ in 0..steps as u32 {
            let next_m = from_m + step_m;
            let next_clearance_m = self.clearance_m(ray.at(next_m));
            if (from_clearance_m > 0.0) != (next_clearance_m > 0.0) {
                // Within so short a step the surface is as good as flat: one secant is enough.
                let part = from_clearance_m / (from_clearance_m - next_clearance_m);
                return Some(from_m + part * step_m);
            }
            (from_m, from_clearance_m) = (next_m, next_clearance_m);
        }
        None
    }

    /// The part of the span between the lowest and the highest point of the surface.
    fn span_in_range_m(&self, ray: &Ray, span_m: [f32; 2]) -> Option<[f32; 2]> {
        // Room on both sides, so that a crossing at the very top or bottom is a change of sign.
        const MARGIN_M: f32 = 1e-4;
        let along = |y_m: f32| (y_m - ray.origin_in_world_m.y) / ray.direction.y;
        let a_m = along(self.range_in_world_m[0] - MARGIN_M);
        let b_m = along(self.range_in_world_m[1] + MARGIN_M);
        crate::solid::common(span_m, [a_m.min(b_m), a_m.max(b_m)])
    }

    /// Lays the surface at `point_in_world_m` over the film: a mirror of the room, the lamp's
    /// highlight, and a bright line where the liquid wets the wall.
    pub(crate) fn shade(&self, ray: &Ray, point_in_world_m: Vec3, wall_m: f32, film: &mut Film) {
        let slope = self.between_nodes(point_in_world_m, &self.slope);
        let normal = Vec3::new(-slope.x, 1.0, -slope.y).normalize_or(Vec3::Y);
        let mirrored = light::fresnel(normal, ray.direction);
        let room = light::room(light::mirrored(ray.direction, normal));
        let lamp = 0.8 * light::gloss(normal, ray.direction, 90);
        let edge = 0.30 * (1.0 - wall_m / EDGE_M).clamp(0.0, 1.0).powi(2);
        let cover = (mirrored + edge).min(1.0);
        film.sheet(light::TINT * (mirrored * room + edge * 0.8) + lamp, cover);
    }

    /// A field on the nodes, interpolated at the point's x and z; level beyond the outermost.
    fn between_nodes<T>(&self, point_in_world_m: Vec3, field: &[T]) -> T
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
    {
        let [nx, nz] = self.nodes;
        let (i, x) = cell_of((point_in_world_m.x - self.origin_in_world_m.x) * self.per_m, nx);
        let (k, z) = cell_of((point_in_world_m.z - self.origin_in_world_m.y) * self.per_m, nz);
        let (right, next) = (usize::from(nx > 1), if nz > 1 { nx } else { 0 });
        let at = i + nx * k;
        let near = field[at] * (1.0 - x) + field[at + right] * x;
        let far = field[at + next] * (1.0 - x) + field[at + next + right] * x;
        near * (1.0 - z) + far * z
    }
}

/// Steps in which a crossing is looked for.
const LEAST_STEPS: f32 = 12.0;
const MOST_STEPS: f32 = 100.0;
/// A way too short to be seen.
const LEAST_MOVE_M: f32 = 2e-4;
/// Width of the bright line at the wall.
const EDGE_M: f32 = 0.004;

/// The interval of `count` nodes that holds `at`, and the place in it, 0 to 1.
fn cell_of(at: f32, count: usize) -> (usize, f32) {
    let last = count.saturating_sub(2) as f32;
    let at = at.max(0.0).min((count - 1) as f32);
    // Not `floor`, which is a call where the processor's baseline has no instruction for it.
    let first = (at.min(last) as u32) as f32;
    (first as usize, at - first)
}

/// Slope along x and z at each node, by central differences; one-sided at the border.
fn slopes(nodes: [usize; 2], per_m: f32, height_m: &[f32]) -> Vec<Vec2> {
    let [nx, nz] = nodes;
    let slope = |at: usize, count: usize, stride: usize, base: usize| {
        let (before, after) = (at.saturating_sub(1), (at + 1).min(count - 1));
        let rise_m = height_m[base + stride * after] - height_m[base + stride * before];
        rise_m * per_m / (after - before).max(1) as f32
    };
    (0..nz)
        .flat_map(|k| (0..nx).map(move |i| (i, k)))
        .map(|(i, k)| Vec2::new(slope(i, nx, 1, nx * k), slope(k, nz, nx, i)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted() -> Surface {
        let height_m = (0..9).map(|node| 0.01 * (node % 3) as f32).collect();
        Surface::from_view(&SurfaceView {
            nodes: [3, 3],
            spacing_m: 0.1,
            origin_in_world_m: [0.0, 0.0],
            rest_height_in_world_m: 1.0,
            height_m,
            layer_decay_m: 0.05,
        })
    }

    #[test]
    fn a_ray_meets_a_tilted_surface_where_it_is() {
        let down = Ray { origin_in_world_m: Vec3::new(0.13, 2.0, 0.1), direction: Vec3::NEG_Y };
        let along_m = tilted().crossing_m(&down, [0.0, 5.0]).unwrap();
        assert!((along_m - (1.0 - 0.013)).abs() < 1e-5);
        assert_eq!(tilted().crossing_m(&down, [0.0, 0.5]), None);
    }

    #[test]
    fn layers_follow_the_surface_less_the_deeper_they_are() {
        let surface = tilted();
        let moved_m = |y_m: f32| {
            let point_m = Vec3::new(0.1, y_m, 0.1);
            point_m.y - surface.at_rest(point_m).y
        };
        assert!((moved_m(1.01) - 0.01).abs() < 1e-6);
        assert!((moved_m(0.96) - 0.01 * (-1.0_f32).exp()).abs() < 1e-6);
        assert!((moved_m(1.06) - 0.01 * (-1.0_f32).exp()).abs() < 1e-6, "nor the gas above");
        assert!(moved_m(1.5) == 0.0 && moved_m(0.5) == 0.0);
    }

    #[test]
    fn broken_views_are_level_water() {
        let surface = Surface::from_view(&SurfaceView {
            nodes: [0, 5],
            spacing_m: f32::NAN,
            origin_in_world_m: [f32::NAN; 2],
            rest_height_in_world_m: 0.0,
            height_m: vec![f32::NAN; 2],
            layer_decay_m: f32::NAN,
        });
        assert_eq!(surface.clearance_m(Vec3::Y), 1.0);
    }
}
