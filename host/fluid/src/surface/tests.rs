//! What every model has to do.

mod looks;

use super::*;
use crate::{Grid, Vessel};

pub(super) const WATER: SurfaceParams =
    SurfaceParams { tension_n_per_m: 5.0, ..SurfaceParams::WATER };

/// A surface in an upright pot of 14 cm, 8 cells deep, of cells of 1 cm.
pub(super) fn in_pot(params: SurfaceParams) -> Surface {
    let grid = Grid { cells: [16, 8, 16], spacing_m: 0.01, origin_in_world_m: Vec3::splat(-0.08) };
    let pot = Vessel::Pot { centre_in_world_m: Vec3::ZERO, radius_m: 0.07 };
    Surface::new(params, &Basin::of_water(&grid, &pot)).expect("a pot will do")
}

/// A surface over a box, 8 cells deep, of cells of 1 cm.
pub(super) fn over_box(params: SurfaceParams, nodes: [usize; 2], viscosity_m2_s: f32) -> Surface {
    let [nx, nz] = nodes;
    let grid = Grid { cells: [nx, 8, nz], spacing_m: 0.01, origin_in_world_m: Vec3::ZERO };
    let basin = Basin { viscosity_m2_s, ..Basin::of_water(&grid, &Vessel::Box) };
    Surface::new(params, &basin).expect("a box will do")
}

fn all(params: SurfaceParams) -> impl Iterator<Item = Surface> {
    INDEX
        .iter()
        .map(move |row| over_box(SurfaceParams { model: row.name, ..params }, [16, 12], 1e-6))
}

fn volume_m3(surface: &Surface) -> f64 {
    let sum: f64 = surface.height_m().iter().map(|y| f64::from(*y)).sum();
    sum * f64::from(surface.lattice().node_m2())
}

#[test]
fn volume_stays_whatever_presses() {
    for mut surface in all(WATER) {
        for step in 0..100 {
            let at = Vec3::new(0.05 + 1e-4 * step as f32, 0.0, 0.07);
            surface.touch(at, 0.012, -0.3, 0.0);
            surface.press(|at| 1e3 * at.x);
            surface.step(10e-3);
            assert!(volume_m3(&surface).abs() < 1e-9, "{}", volume_m3(&surface));
        }
        assert!(surface.at(Vec3::new(0.06, 0.0, 0.07)).0 < -1e-4, "pressed in");
    }
}

#[test]
fn energy_never_grows_and_drag_brings_rest() {
    for mut surface in all(SurfaceParams { drag_n_s_per_m3: 60.0, bend: 0.1, ..WATER }) {
        surface.set(|x, z| 1e-3 * (x - 2.0 * z), |x, _| 0.01 * (40.0 * x).sin());
        let mut energy = surface.energy_j();
        assert!(energy > 0.0);
        for _ in 0..10_000 {
            surface.step(10e-3);
            let now = surface.energy_j();
            assert!(now <= energy * (1.0 + 1e-6), "{now} after {energy}");
            energy = now;
        }
        assert!(surface.is_asleep());
        assert_eq!(surface.step(10e-3), SurfaceReport::default(), "sleep costs nothing");
        assert!(surface.height_m().iter().all(|y| *y == 0.0));
    }
}

#[test]
fn a_push_gives_the_energy_of_its_work() {
    for mut surface in all(WATER) {
        let (at, radius_m) = (Vec3::new(0.06, 0.0, 0.07), 0.02);
        let mut under = Vec::new();
        surface.lattice().find_under(at, radius_m, &mut under);
        let mean = |surface: &Surface| -> f64 {
            under.iter().map(|(n, share)| f64::from(share * surface.height_m()[*n])).sum()
        };
        let mut work_j = 0.0;
        for step in 0..200 {
            let force_n = -0.2 * (step as f32 * 0.17).sin();
            surface.touch(at, radius_m, force_n, 0.0);
            let before_m = mean(&surface);
            surface.step(2e-3);
            work_j += f64::from(force_n) * (mean(&surface) - before_m);
        }
        let energy_j = surface.energy_j();
        // RK4 loses a little, at no time does any gain.
        assert!(energy_j <= work_j * (1.0 + 1e-4), "{energy_j} of {work_j}");
        assert!(energy_j >= work_j * 0.8, "{energy_j} of {work_j}");
    }
}

#[test]
fn a_kick_leaves_as_a_wave_of_its_energy() {
    for mut surface in all(WATER) {
        for kick_j in [2e-4, -3e-5] {
            surface.touch(Vec3::new(0.1, 0.0, 0.02), 0.012, 0.01, 0.0);
            surface.step(1e-3);
            let before_j = surface.energy_j();
            surface.kick(Vec3::new(0.06, 0.0, 0.07), 0.012, kick_j);
            surface.step(1e-6);
            let gained = surface.energy_j() - before_j;
            assert!((gained / f64::from(kick_j.abs()) - 1.0).abs() < 0.01, "{gained} {kick_j}");
        }
    }
}

#[test]
fn a_damper_takes_and_never_gives() {
    for mut surface in all(WATER) {
        surface.set(|x, _| 0.01 * (20.0 * x).cos(), |_, _| 0.0);
        let first_j = surface.energy_j();
        let mut energy_j = first_j;
        for _ in 0..200 {
            surface.touch(Vec3::new(0.02, 0.0, 0.03), 0.02, 0.0, 3.0);
            surface.step(10e-3);
            assert!(surface.energy_j() <= energy_j * (1.0 + 1e-6));
            energy_j = surface.energy_j();
        }
        assert!(energy_j < 0.7 * first_j, "{energy_j} of {first_j}");
    }
}

#[test]
fn dampers_of_several_bodies_take_and_never_give() {
    for row in INDEX {
        let mut surface = over_box(SurfaceParams { model: row.name, ..WATER }, [2, 3], 1e-6);
        surface.set(|x, z| 0.01 * (20.0 * x + 60.0 * z).cos(), |_, _| 0.0);
        let mut energy_j = surface.energy_j();
        for _ in 0..50 {
            for z in [0.005, 0.015, 0.025] {
                surface.touch(Vec3::new(0.005, 0.0, z), 0.02, 0.0, 1e3);
            }
            surface.step(1e-3);
            assert!(surface.energy_j() <= energy_j * (1.0 + 1e-6), "{}", row.name);
            energy_j = surface.energy_j();
        }
    }
}

#[test]
fn a_liquid_that_presses_from_below_lifts_the_surface_by_the_height_of_its_pressure() {
    for mut surface in all(SurfaceParams { tension_n_per_m: 0.0, drag_n_s_per_m3: 2e3, ..WATER }) {
        let pressure = |x: f32| 30.0 * (std::f32::consts::PI * x / 0.16).cos();
        for _ in 0..2000 {
            surface.press(|at| pressure(at.x));
            surface.step(10e-3);
        }
        for at in [0.005, 0.065, 0.155] {
            let height_m = surface.at(Vec3::new(at, 0.0, 0.06)).0;
            assert!((height_m - pressure(at) / 9810.0).abs() < 2e-5, "{at}: {height_m}");
        }
    }
}

#[test]
fn nothing_blows_up() {
    for row in INDEX {
        for (tension, dt_s, force) in
            [(1e7, 1.0, 1e4), (5.0, 1.0, 1e4), (0.0, 1e-9, 1e-9), (1e7, 1e-2, 1e4), (5.0, 1e3, 1.0)]
        {
            for nodes in [[16, 12], [2, 2], [1, 7], [1, 1]] {
                let params = SurfaceParams { model: row.name, tension_n_per_m: tension, ..WATER };
                let mut surface = over_box(params, nodes, 1e-6);
                for _ in 0..20 {
                    surface.touch(Vec3::splat(0.005), 0.012, force, force);
                    surface.touch(Vec3::splat(f32::NAN), 0.012, f32::NAN, 0.0);
                    surface.touch(Vec3::splat(3e38), 3e38, 1.0, 3e38);
                    surface.kick(Vec3::splat(0.01), 1e-3, force);
                    surface.press(|at| if at.x < 0.01 { f32::NAN } else { force });
                    surface.step(dt_s);
                    let mut values = surface.height_m().iter().chain(surface.speed_m_s());
                    assert!(values.all(|y| y.abs() <= MOST), "{} {tension} {dt_s}", row.name);
                }
            }
        }
    }
}

#[test]
fn a_probe_that_leans_is_told_of_all_waves_but_its_own() {
    let (hand, elsewhere) = (Vec3::new(0.06, 0.0, 0.07), Vec3::new(0.12, 0.0, 0.03));
    for [mut pushed, mut idle] in all(WATER).zip(all(WATER)).map(|(a, b)| [a, b]) {
        for surface in [&mut pushed, &mut idle] {
            surface.set(|x, _| 1e-3 * (20.0 * x).cos(), |_, _| 0.0);
        }
        let mut push = |force_n: f32, poke_n: f32| {
            for (surface, force_n) in [(&mut pushed, force_n), (&mut idle, 0.0)] {
                surface.touch(elsewhere, 0.02, poke_n, 0.0);
                surface.lean(hand, 0.02, force_n, 0.3);
                surface.step(10e-3);
                surface.look_ahead(20e-3);
            }
            let apart = |of: fn(&Surface, Vec3) -> (f32, f32)| {
                (of(&pushed, hand).0 - of(&idle, hand).0).abs()
            };
            [apart(Surface::at), apart(Surface::ahead)]
        };
        for step in 0..100 {
            let [seen_m, told_m] = push(-0.3, if step < 10 { -0.2 } else { 0.0 });
            assert!(step < 3 || seen_m > 1e-4, "step {step}: it is seen");
            assert!(told_m < 2e-6, "step {step}: {told_m} m of its own");
        }
        assert!(push(0.0, 0.0)[1] < 2e-6, "it leans by nothing");
        pushed.step(10e-3);
        pushed.look_ahead(1e-6);
        let [seen_m, told_m] = [pushed.at(hand).0, pushed.ahead(hand).0];
        assert!((seen_m - told_m).abs() < 2e-6, "gone, it is told of all: {seen_m} {told_m}");
    }
}

#[test]
fn beside_the_pot_nothing_moves() {
    for row in INDEX {
        let mut surface = in_pot(SurfaceParams { model: row.name, ..WATER });
        let mut lowest_m: f32 = 0.0;
        for _ in 0..30 {
            surface.touch(Vec3::ZERO, 0.012, -0.2, 1.0);
            surface.step(10e-3);
            lowest_m = lowest_m.min(surface.at(Vec3::ZERO).0);
        }
        assert_eq!(surface.height_m()[0], 0.0);
        assert!(lowest_m < -1e-3, "{lowest_m}");
    }
}

#[test]
fn all_classes_and_repetitions_give_the_same_bits() {
    for row in INDEX {
        let run = |simd: SimdClass| {
            let params = SurfaceParams { model: row.name, ..WATER };
            let grid = Grid { cells: [33, 8, 16], ..Grid::unit_cube(16) };
            let basin = Basin { simd, ..Basin::of_water(&grid, &Vessel::Box) };
            let mut surface = Surface::new(params, &basin).expect("a box will do");
            for _ in 0..20 {
                surface.touch(Vec3::splat(0.3), 0.1, -2.0, 1.0);
                surface.step(10e-3);
            }
            surface.height_m().iter().map(|y| y.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(run(SimdClass::Avx2), run(SimdClass::Avx512), "{}", row.name);
        assert_eq!(run(SimdClass::Portable), run(SimdClass::Portable), "{}", row.name);
    }
}

#[test]
fn an_unknown_model_is_refused() {
    let grid = Grid::unit_cube(4);
    let basin = Basin::of_water(&grid, &Vessel::Box);
    assert!(Surface::new(SurfaceParams { model: "jelly", ..WATER }, &basin).is_err());
}
