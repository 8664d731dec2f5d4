//! What a person should see in a picture, told from the picture.

use cauldron_fluid::{Grid, Snapshot, SurfaceView, Vessel};
use cauldron_render::{Camera, Canvas, Handle, Image, Layer, Shares, View, render};
use glam::Vec3;

mod synthetic;
use synthetic::{blended, blobs, boxed, clear, dry, halves, handle, poured, rippled, view};

const DIPPED: Vec3 = Vec3::new(0.03, 0.01, 0.02);
const SUNK: Vec3 = Vec3::new(0.0, -0.12, 0.03);

fn picture(snapshot: &Snapshot, handle: Option<Handle>) -> Image {
    render(&view(snapshot, handle), 240, 180, 2)
}

fn shares(snapshot: &Snapshot, handle: Option<Handle>) -> Shares {
    Shares::of(&picture(snapshot, handle).resolve())
}

/// Mean sRGB of the pixels that show `layer`.
fn mean(image: &Image, layer: Layer) -> [f32; 3] {
    let canvas = image.resolve();
    let shown = canvas.pixels().zip(&image.layer).filter(|(_, shown)| **shown == layer);
    let sum = shown.map(|(rgb, _)| Vec3::from(rgb.map(f32::from))).sum::<Vec3>();
    (sum / image.count(layer).max(1) as f32).to_array()
}

#[test]
fn clear_liquid_holds_no_pigment() {
    for snapshot in [clear(), rippled(clear()), boxed(clear())] {
        let shares = shares(&snapshot, None);
        assert_eq!((shares.red, shares.green, shares.blend, shares.handle), (0.0, 0.0, 0.0, 0.0));
        assert!(shares.clear > 0.12, "{shares:?}");
    }
}

#[test]
fn halves_are_red_and_green_but_for_the_seam() {
    let shares = shares(&halves(), None).of_liquid();
    assert!(shares.red > 0.35 && shares.green > 0.45, "{shares:?}");
    assert!(shares.blend < 0.05, "{shares:?}");
}

#[test]
fn what_is_stirred_through_is_blended_however_much_it_is() {
    for fraction in [0.5, 0.2, 0.05] {
        let shares = shares(&rippled(blended(fraction)), None).of_liquid();
        assert!(shares.blend > 0.9, "{fraction}: {shares:?}");
        assert!(shares.red + shares.green < 0.01, "{fraction}: {shares:?}");
    }
}

#[test]
fn two_blobs_in_clear_liquid_are_all_three_things() {
    let shares = shares(&blobs(), None).of_liquid();
    assert!(shares.red > 0.08 && shares.green > 0.08 && shares.clear > 0.4, "{shares:?}");
    assert!(shares.blend < 0.02, "{shares:?}");
}

#[test]
fn more_of_a_substance_is_brighter() {
    let greens = [0.02, 0.1, 0.5].map(|fraction| {
        let image = picture(&poured(|_| 0.0, |_| fraction), None);
        mean(&image, Layer::Liquid)[1] - mean(&image, Layer::Liquid)[2]
    });
    assert!(greens[0] + 10.0 < greens[1] && greens[1] + 10.0 < greens[2], "{greens:?}");
}

#[test]
fn the_handle_goes_from_green_over_yellow_to_red_and_is_no_pigment() {
    let snapshot = clear();
    let [light, moderate, strong] = [0.0, 0.3, 0.9].map(|force| {
        let image = picture(&snapshot, Some(handle(DIPPED, force)));
        let shares = Shares::of(&image.resolve());
        assert!(shares.handle > 0.004, "{force}: {shares:?}");
        assert!(shares.red + shares.green + shares.blend < 0.002, "{force}: {shares:?}");
        mean(&image, Layer::Handle)
    });
    assert!(light[1] > light[0] + 60.0, "{light:?}");
    assert!(moderate[0].min(moderate[1]) > moderate[2] + 60.0, "{moderate:?}");
    assert!(strong[0] > strong[1] + 80.0, "{strong:?}");
}

#[test]
fn the_handle_under_clear_liquid_is_no_pigment_and_under_potion_it_is_hidden() {
    for force in [0.0, 0.3, 0.9] {
        let shares = shares(&clear(), Some(handle(SUNK, force)));
        assert!(shares.red + shares.green + shares.blend < 0.004, "{force}: {shares:?}");
    }
    let shares = shares(&blended(0.05), Some(handle(SUNK, 0.9)));
    assert!(shares.red < 0.001 && shares.handle > 0.002, "{shares:?}");
    let [seen, hidden] = [clear(), blended(0.4)]
        .map(|snapshot| picture(&snapshot, Some(handle(SUNK, 0.0))).count(Layer::Handle));
    assert!(seen > 2 * hidden && hidden > 0, "{seen} {hidden}");
}

#[test]
fn every_layer_is_there_and_the_whole_pot_is_in_the_picture() {
    for snapshot in [clear(), boxed(clear())] {
        let image = picture(&snapshot, None);
        for layer in [Layer::Background, Layer::Vessel, Layer::Liquid, Layer::Surface] {
            assert!(image.count(layer) > 1000, "{layer:?} {}", image.count(layer));
        }
        let (last_x, last_y) = (image.width - 1, image.height - 1);
        for (at, layer) in image.layer.iter().enumerate() {
            let (x, y) = (at % image.width, at / image.width);
            if x == 0 || y == 0 || x == last_x || y == last_y {
                assert_eq!(*layer, Layer::Background, "at {x}, {y}");
            }
        }
    }
}

#[test]
fn a_scene_without_liquid_shows_none() {
    let image = picture(&dry(), Some(handle(SUNK, 0.5)));
    assert_eq!(image.count(Layer::Liquid) + image.count(Layer::Surface), 0);
    assert!(image.count(Layer::Vessel) > 1000 && image.count(Layer::Handle) > 100);
}

#[test]
fn ripples_are_seen() {
    let [level, rippled] = [clear(), rippled(clear())].map(|snapshot| picture(&snapshot, None));
    let surface = level.layer.iter().zip(level.linear.iter().zip(&rippled.linear));
    let changed = surface
        .filter(|(layer, (a, b))| **layer == Layer::Surface && a.distance(**b) > 0.02)
        .count();
    assert!(changed > level.count(Layer::Surface) / 8, "{changed}");
}

#[test]
fn what_lies_below_follows_the_surface_less_the_deeper_it_is() {
    let risen = |snapshot: Snapshot| {
        let mut snapshot = snapshot;
        if let Some(surface) = &mut snapshot.surface {
            surface.height_m.fill(0.012);
        }
        snapshot
    };
    // How far the middle of a red ball at height `y_m` moves up in the picture.
    let moved_px = |y_m: f32| {
        let centre_m = Vec3::Y * y_m;
        let ball = || poured(move |at| f32::from(at.distance(centre_m) < 0.025), |_| 0.0);
        let [rest, up] = [ball(), risen(ball())].map(|snapshot| {
            let canvas = picture(&snapshot, None).resolve();
            let red = |y: usize| canvas.get(120, y).map_or(0.0, |rgb| excess(rgb, 0));
            let weight: f32 = (0..180).map(red).sum();
            (0..180).map(|y| red(y) * y as f32).sum::<f32>() / weight
        });
        rest - up
    };
    let (shallow_px, deep_px) = (moved_px(-0.04), moved_px(-0.15));
    assert!(shallow_px > 1.0 && shallow_px > 3.0 * deep_px.abs(), "{shallow_px} {deep_px}");
}

/// How much one channel of a pixel stands out from the others.
fn excess(rgb: [u8; 3], channel: usize) -> f32 {
    let others = (0..3).filter(|other| *other != channel).map(|other| rgb[other]).max();
    f32::from(rgb[channel].saturating_sub(others.unwrap_or(0)).saturating_sub(20))
}

#[test]
fn the_number_of_threads_does_not_show() {
    let snapshot = rippled(blobs());
    let view = view(&snapshot, Some(handle(DIPPED, 0.5)));
    let alone = render(&view, 120, 91, 1);
    for threads in [0, 2, 5] {
        assert_eq!(render(&view, 120, 91, threads), alone);
    }
}

#[test]
fn any_size_can_be_asked_for() {
    let snapshot = blobs();
    for [width, height] in [[0, 0], [0, 5], [5, 0], [1, 1], [3, 200]] {
        let image = render(&view(&snapshot, None), width, height, 2);
        assert_eq!(image.resolve().rgb().len(), 3 * width * height);
    }
}

#[test]
fn broken_snapshots_make_pictures_all_the_same() {
    let broken: [fn(&mut Snapshot); 12] = [
        |s| s.substances[0].fraction.fill(f32::NAN),
        |s| s.substances[0].fraction.fill(f32::INFINITY),
        |s| s.substances[0].fraction.truncate(7),
        |s| s.substances[0].colour = Vec3::NAN,
        |s| s.liquid_colour = Some(Vec3::NAN),
        |s| s.grid = Grid { cells: [0; 3], ..s.grid },
        |s| s.grid.spacing_m = f32::NAN,
        |s| s.grid.spacing_m = 0.0,
        |s| s.grid.origin_in_world_m = Vec3::NAN,
        |s| s.vessel = Vessel::Pot { centre_in_world_m: Vec3::NAN, radius_m: f32::NAN },
        |s| s.vessel = Vessel::Pot { centre_in_world_m: Vec3::ZERO, radius_m: 0.0 },
        |s| s.surface = s.surface.take().map(nan_surface),
    ];
    for (number, break_it) in broken.iter().enumerate() {
        for sound in [blobs(), boxed(blobs())] {
            let mut snapshot = sound;
            break_it(&mut snapshot);
            let own = view(&snapshot, Some(handle(DIPPED, f32::NAN)));
            let camera = Camera::over(&clear());
            for view in [own, View { camera, ..own }] {
                assert_eq!(all_bytes(&view), 3 * 40 * 30, "case {number}");
            }
        }
    }
}

fn all_bytes(view: &View) -> usize {
    let canvas: Canvas = render(view, 40, 30, 2).resolve();
    canvas.rgb().len()
}

fn nan_surface(surface: SurfaceView) -> SurfaceView {
    SurfaceView {
        height_m: vec![f32::NAN; surface.height_m.len()],
        spacing_m: f32::NAN,
        layer_decay_m: f32::NAN,
        rest_height_in_world_m: f32::NAN,
        ..surface
    }
}

#[test]
fn a_view_from_anywhere_is_a_picture() {
    let snapshot = rippled(blobs());
    let eyes = [
        Vec3::new(0.0, 1.0, 0.0),
        Vec3::new(0.0, -0.1, 0.0),
        Vec3::new(0.0, -1.0, 0.3),
        Vec3::NAN,
        Vec3::splat(1e30),
    ];
    for eye_in_world_m in eyes {
        let camera = Camera { eye_in_world_m, ..Camera::over(&snapshot) };
        let _ = all_bytes(&View { camera, ..view(&snapshot, Some(handle(SUNK, 0.5))) });
    }
}
