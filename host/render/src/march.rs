//! The reference renderer: one ray per pixel, from the eye through every layer in its order.

use cauldron_fluid::Snapshot;
use glam::Vec3;

use crate::{
    camera::{Camera, Lens, Ray},
    drops::Drops,
    film::Film,
    handle::{Handle, Rod},
    image::{Image, Layer, Sample},
    light, rows, smooth, solid,
    surface::Surface,
    vessel::Walls,
    volume::Volume,
};

/// What is drawn, and from where.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The pot.
    pub snapshot: &'a Snapshot,
    /// The player's handle, where there is one.
    pub handle: Option<Handle>,
    /// Where the picture is taken from.
    pub camera: Camera,
}

/// Draws `view` on `threads` threads (at least one): the same picture for any number of them.
///
/// Whatever numbers the snapshot holds there is a picture; what is NaN or infinite in it counts
/// as nothing poured, as a surface at rest, or as a thing without a place, which is left out.
#[must_use]
pub fn render(view: &View, width: usize, height: usize, threads: usize) -> Image {
    let scene = Scene::new(view, width, height);
    let mut samples = vec![Sample::default(); width * height];
    rows::fill(&mut samples, width, threads, |x, y| scene.sample(x as f32 + 0.5, y as f32 + 0.5));
    let samples = smooth::edges(&samples, width, threads, |x, y| scene.sample(x, y).colour);
    Image {
        width,
        height,
        linear: samples.iter().map(|sample| sample.colour).collect(),
        layer: samples.iter().map(|sample| sample.layer).collect(),
    }
}

/// A view made ready: everything that all rays share.
struct Scene {
    lens: Lens,
    walls: Walls,
    rod: Option<Rod>,
    drops: Drops,
    surface: Surface,
    volume: Volume,
    smoke: Option<Volume>,
    /// False for a scene with neither liquid nor surface, where there is nothing to look through.
    is_wet: bool,
}

/// Where a ray ends.
struct End {
    along_m: f32,
    colour: Vec3,
    layer: Layer,
}

/// A ray goes through a wavy surface a few times at most; more is not followed.
const MOST_CROSSINGS: usize = 4;
/// The handle is what a pixel shows if more than this part of its light gets through.
const HANDLE_SEEN: f32 = 0.5;

impl Scene {
    fn new(view: &View, width: usize, height: usize) -> Self {
        let snapshot = view.snapshot;
        let walls = Walls::new(snapshot, view.camera.eye_in_world_m);
        let volume = Volume::new(snapshot, |point| walls.depth_inside_m(point));
        Self {
            lens: view.camera.lens(width, height),
            rod: view.handle.as_ref().and_then(Rod::new),
            drops: Drops::new(snapshot),
            surface: Surface::new(snapshot),
            smoke: snapshot.smoke.as_ref().map(Volume::of_smoke),
            is_wet: snapshot.surface.is_some() || !volume.is_empty(),
            walls,
            volume,
        }
    }

    /// What is seen at a point of the picture, in pixels from its upper left corner.
    fn sample(&self, x_px: f32, y_px: f32) -> Sample {
        let ray = self.lens.ray(x_px, y_px);
        let end = self.end(&ray);
        let mut film = Film::CLEAR;
        self.gather_smoke(&ray, end.along_m, &mut film);
        let seen_through = self.gather(&ray, end.along_m, &mut film);
        let hides_end = end.layer != Layer::Handle || film.transmittance < HANDLE_SEEN;
        let layer = seen_through.filter(|_| hides_end).unwrap_or(end.layer);
        film.solid(end.colour);
        Sample { colour: film.colour, layer }
    }

    /// The nearest solid thing, or the background.
    fn end(&self, ray: &Ray) -> End {
        let mut end = End {
            along_m: f32::INFINITY,
            colour: light::background(ray.direction),
            layer: Layer::Background,
        };
        let wall = self.walls.hit(ray).map(|hit| (hit, Layer::Vessel));
        let handle = self.rod.as_ref().and_then(|rod| rod.hit(ray)).map(|hit| (hit, Layer::Handle));
        let drop = self.drops.hit(ray).map(|hit| (hit, Layer::Surface));
        for ((along_m, colour), layer) in wall.into_iter().chain(handle).chain(drop) {
            if along_m < end.along_m {
                end = End { along_m, colour, layer };
            }
        }
        end
    }

    /// Gathers smoke up to `end_m` or the liquid's surface. Who looks is above that: smoke is seen
    /// before anything else.
    fn gather_smoke(&self, ray: &Ray, end_m: f32, film: &mut Film) {
        let Some(smoke) = &self.smoke else { return };
        let span_m = smoke.poured_span_m(ray, [0.0, end_m], Some(&self.surface));
        let Some([from_m, to_m]) = span_m else { return };
        let crossing_m = self.surface.crossing_m(ray, [from_m, to_m]);
        smoke.march(ray, [from_m, crossing_m.unwrap_or(to_m)], Some(&self.surface), film);
    }

    /// Gathers glass, surface and liquid up to `end_m`; says what the liquid was seen through.
    fn gather(&self, ray: &Ray, end_m: f32, film: &mut Film) -> Option<Layer> {
        let inside_m = self.walls.span_inside_m(ray)?;
        let [mut from_m, to_m] = solid::common(inside_m, [0.0, end_m])?;
        self.walls.sheen(ray, ray.at(from_m), film);
        if !self.is_wet {
            return None;
        }
        let mut is_under = self.surface.clearance_m(ray.at(from_m)) < 0.0;
        let mut seen_through = is_under.then_some(Layer::Liquid);
        for _ in 0..MOST_CROSSINGS {
            let crossing_m = self.surface.crossing_m(ray, [from_m, to_m]);
            if is_under {
                let span_m = [from_m, crossing_m.unwrap_or(to_m)];
                self.volume.march(ray, span_m, Some(&self.surface), film);
            }
            let Some(crossing_m) = crossing_m.filter(|_| !film.is_opaque()) else { break };
            let point_in_world_m = ray.at(crossing_m);
            let wall_m = self.walls.depth_inside_m(point_in_world_m);
            self.surface.shade(ray, point_in_world_m, wall_m, film);
            seen_through = seen_through.or(Some(Layer::Surface));
            is_under = !is_under;
            from_m = crossing_m + PAST_CROSSING_M;
        }
        seen_through
    }
}

/// Far enough past a crossing not to find it again.
const PAST_CROSSING_M: f32 = 1e-4;
