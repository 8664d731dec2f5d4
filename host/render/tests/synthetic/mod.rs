//! Snapshots by formula, to look at and to test with.

#![allow(dead_code, reason = "each test and example uses some of them")]

use cauldron_fluid::{Grid, Snapshot, SubstanceView, SurfaceView, Vessel};
use cauldron_render::{Camera, Handle, View};
use glam::Vec3;

/// Linear colours as scenes have them.
pub const RED: Vec3 = Vec3::new(0.90, 0.02, 0.03);
pub const GREEN: Vec3 = Vec3::new(0.02, 0.70, 0.05);
pub const CLEAR: Vec3 = Vec3::new(0.25, 0.42, 0.60);

const GRID: Grid =
    Grid { cells: [32; 3], spacing_m: 0.008, origin_in_world_m: Vec3::new(-0.128, -0.256, -0.128) };
const POT: Vessel = Vessel::Pot { centre_in_world_m: Vec3::new(0.0, -0.128, 0.0), radius_m: 0.12 };

/// A pot of clear liquid at rest.
pub fn clear() -> Snapshot {
    Snapshot {
        time_s: 0.0,
        grid: GRID,
        vessel: POT,
        liquid_colour: Some(CLEAR),
        substances: Vec::new(),
        surface: Some(surface(|_, _| 0.0)),
        drops: Vec::new(),
        smoke: None,
    }
}

/// A pot with red and green in it, whose fractions are functions of the place.
pub fn poured(red: impl Fn(Vec3) -> f32, green: impl Fn(Vec3) -> f32) -> Snapshot {
    let substances = vec![substance(RED, red), substance(GREEN, green)];
    Snapshot { substances, ..clear() }
}

/// A red blob on the left and a green one on the right.
pub fn blobs() -> Snapshot {
    poured(blob(Vec3::new(-0.055, -0.06, 0.0)), blob(Vec3::new(0.055, -0.06, 0.0)))
}

/// The left half red, the right half green.
pub fn halves() -> Snapshot {
    poured(|at| f32::from(at.x < 0.0), |at| f32::from(at.x >= 0.0))
}

/// Everything blended to equal parts.
pub fn blended(fraction: f32) -> Snapshot {
    poured(move |_| fraction, move |_| fraction)
}

/// Arms of red and green wound around the axis, blended where they meet.
pub fn swirl() -> Snapshot {
    let arm = |at: Vec3| {
        let turned = at.z.atan2(at.x) + 40.0 * at.x.hypot(at.z) + 8.0 * at.y;
        0.5 + 0.5 * (2.0 * turned).sin()
    };
    poured(move |at| 0.5 * arm(at).powi(2), move |at| 0.5 * (1.0 - arm(at)).powi(2))
}

/// A surface with rings running out from beside the middle.
pub fn rippled(snapshot: Snapshot) -> Snapshot {
    let rings = |x: f32, z: f32| {
        let around_m = (x - 0.03).hypot(z + 0.01);
        0.004 * (around_m * 200.0).cos() * (-around_m / 0.05).exp()
    };
    Snapshot { surface: Some(surface(rings)), ..snapshot }
}

/// The box in place of the pot.
pub fn boxed(snapshot: Snapshot) -> Snapshot {
    Snapshot { vessel: Vessel::Box, ..snapshot }
}

/// The pot alone.
pub fn dry() -> Snapshot {
    Snapshot { liquid_colour: None, surface: None, ..clear() }
}

/// A handle at rest at `proxy_in_world_m`.
pub fn handle(proxy_in_world_m: Vec3, force_fraction: f32) -> Handle {
    Handle { tip_in_world_m: proxy_in_world_m, proxy_in_world_m, radius_m: 0.012, force_fraction }
}

/// The default view.
pub fn view(snapshot: &Snapshot, handle: Option<Handle>) -> View<'_> {
    View { snapshot, handle, camera: Camera::over(snapshot) }
}

fn blob(centre_in_world_m: Vec3) -> impl Fn(Vec3) -> f32 {
    move |at| (1.3 - at.distance(centre_in_world_m) / 0.04).clamp(0.0, 1.0)
}

fn substance(colour: Vec3, fraction: impl Fn(Vec3) -> f32) -> SubstanceView {
    let [nx, ny, nz] = GRID.cells;
    let cells = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))));
    let fraction_in = |(i, j, k)| {
        let centre_in_world_m = GRID.centre_in_world_m(i, j, k);
        // As in a simulation, the cells in the wall are empty.
        if POT.depth_inside_m(centre_in_world_m) > 0.0 { fraction(centre_in_world_m) } else { 0.0 }
    };
    SubstanceView { colour, fraction: cells.map(fraction_in).collect() }
}

fn surface(height_m: impl Fn(f32, f32) -> f32) -> SurfaceView {
    let nodes = (0..33).flat_map(|k| (0..33).map(move |i| (i, k)));
    let at = |node: usize| -0.128 + 0.008 * node as f32;
    SurfaceView {
        nodes: [33, 33],
        spacing_m: 0.008,
        origin_in_world_m: [-0.128, -0.128],
        rest_height_in_world_m: 0.0,
        height_m: nodes.map(|(i, k)| height_m(at(i), at(k))).collect(),
        layer_decay_m: 0.03,
    }
}
