//! A liquid that turns stands higher at its rim: the pressure under the lid lifts the surface by
//! the paraboloid h = omega^2 r^2 / 2g (Newton's bucket; Lamb 1932, art. 26).
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use std::sync::Arc;

use cauldron_fluid::{
    Grid, Pot, Vessel,
    pool::Pool,
    scenes,
    simd::SimdClass,
    solver::{Setup, Solver, Walls, flow::Flow},
    surface::{Basin, INDEX, Surface, SurfaceParams},
};
use glam::{DVec3, Vec3};

const TURN_PER_S: f64 = 4.0;
const RADIUS_M: f32 = 0.09;
const GRID: Grid = Grid {
    cells: [32, 12, 32],
    spacing_m: 0.006,
    origin_in_world_m: Vec3::new(-0.096, -0.072, -0.096),
};

/// A round tub of liquid that turns as a solid body.
fn bucket() -> Setup {
    let tub = Vessel::Cylinder { centre_in_world_m: Vec3::ZERO, axis: Vec3::Y, radius_m: RADIUS_M };
    Setup { walls: Walls::FreeSlip, ..Setup::new(GRID, tub) }
}

fn turning(setup: &Setup) -> Flow {
    let mut flow = Flow::new(setup).unwrap();
    flow.set_velocity(&|p| TURN_PER_S * DVec3::new(-p.z, 0.0, p.x)).unwrap();
    flow.project();
    flow.watch_lid();
    flow
}

/// Of the exact paraboloid between the axis and `r_m`.
fn rise_m(r_m: f64) -> f64 {
    TURN_PER_S.powi(2) * r_m * r_m / (2.0 * 9.81)
}

#[test]
fn the_lid_is_pressed_by_what_turns_below() {
    let setup = bucket();
    let mut flow = turning(&setup);
    assert_eq!(flow.lid_pressure_pa(Vec3::X), 0.0, "no step yet");
    for dt_s in [1e-3, 4e-3, 0.05] {
        for _ in 0..5 {
            flow.step(dt_s).unwrap();
        }
        let middle_pa = flow.lid_pressure_pa(Vec3::ZERO);
        for r_m in [0.03, 0.05, 0.075] {
            for way in [Vec3::X, Vec3::NEG_Z, Vec3::new(0.6, 0.0, -0.8)] {
                let over_pa = f64::from(flow.lid_pressure_pa(r_m * way) - middle_pa);
                let exact_pa = 1000.0 * 9.81 * rise_m(f64::from(r_m));
                assert!(
                    (over_pa / exact_pa - 1.0).abs() < 0.1,
                    "{dt_s} {r_m}: {over_pa} {exact_pa}"
                );
            }
        }
    }
}

#[test]
fn a_turning_liquid_stands_as_a_paraboloid() {
    let setup = bucket();
    for row in INDEX {
        let basin = Basin::of_water(&GRID, &setup.vessel);
        // Thick to the waves, so that they die soon.
        let params = SurfaceParams {
            model: row.name,
            drag_n_s_per_m3: 500.0,
            tear_speed_m_s: 1e6,
            tear_slope: 1e6,
            ..SurfaceParams::WATER
        };
        let mut surface = Surface::new(params, &basin).unwrap();
        let mut flow = turning(&setup);
        for _ in 0..200 {
            flow.step(4e-3).unwrap();
            surface.press(|at| flow.lid_pressure_pa(at));
            surface.step(4e-3);
        }
        let height_m = |x: f32| f64::from(surface.at(Vec3::new(x, 0.0, 0.0)).0);
        for r_m in [0.04, 0.06, 0.081] {
            let dip_m = height_m(r_m) - height_m(0.0);
            let exact_m = rise_m(f64::from(r_m));
            assert!((dip_m / exact_m - 1.0).abs() < 0.1, "{} {r_m}: {dip_m} {exact_m}", row.name);
        }
        assert!(height_m(0.0) < 0.0, "and what rises at the rim is missing in the middle");
    }
}

/// The whirl that ships stands as it turns, and goes on to. (Tension draws its middle up by some
/// 2 %, cells of a seventh of its core blunt it, and friction takes about 2 % a second.)
#[test]
fn a_whirl_dips_as_far_as_it_has_to() {
    let scene = scenes::find("whirl").unwrap();
    let scenes::Start::Whirl(whirl) = scene.start else { panic!("it turns") };
    let mut pot = Pot::new(&scene, Arc::new(Pool::inline()), SimdClass::detect()).unwrap();
    let gravity_m_s2 = f64::from(scene.liquid.unwrap().gravity_m_s2);
    let fall_m = |r_m: f64| whirl.height_m(r_m, gravity_m_s2) - whirl.height_m(0.08, gravity_m_s2);
    for _ in 0..4 {
        let height_m = |x: f32| f64::from(pot.surface().unwrap().at(Vec3::new(x, 0.0, 0.0)).0);
        for (r_m, within) in [(0.06, 0.05), (0.04, 0.05), (0.0, 0.1)] {
            let dip_m = height_m(r_m as f32) - height_m(0.08);
            let off = (dip_m - fall_m(r_m)).abs() / -fall_m(0.0);
            assert!(off < within, "{r_m}: {dip_m} {}", fall_m(r_m));
        }
        for _ in 0..30 {
            pot.step(scene.step_s);
        }
    }
}

/// A packet of waves that runs along a channel has the momentum E/c (Starr 1959): what viscosity
/// takes of it, the liquid below gets.
#[test]
fn waves_that_die_drag_the_liquid_along() {
    let grid = Grid { cells: [192, 12, 4], spacing_m: 0.01, origin_in_world_m: Vec3::ZERO };
    let setup = Setup { walls: Walls::FreeSlip, ..Setup::new(grid, Vessel::Box) };
    let basin = Basin { viscosity_m2_s: 2e-4, ..Basin::of_water(&grid, &setup.vessel) };
    let params = SurfaceParams {
        tension_n_per_m: 0.0,
        tear_speed_m_s: 1e6,
        tear_slope: 1e6,
        ..SurfaceParams::WATER
    };
    let mut surface = Surface::new(params, &basin).unwrap();
    let mut flow = Flow::new(&setup).unwrap();
    // 16 nodes a wave, eight waves in the middle of the channel.
    let k = std::f32::consts::TAU / 0.16;
    let omega = (9.81 * k * (k * 0.12).tanh()).sqrt();
    let packet = move |x: f32| 2e-3 * (-((x - 0.7) / 0.3).powi(2)).exp();
    surface.set(|x, _| packet(x) * (k * x).cos(), |x, _| packet(x) * omega * (k * x).sin());
    let before_j = surface.energy_j();
    let mut given_n_s = 0.0;
    for _ in 0..100 {
        surface.step(5e-3);
        surface.find_drift(0.0);
        let most_j = 5e-3 * surface.drift_w();
        given_n_s += flow.drag_lid(|at| surface.drift_m2_s2(at), 5e-3, most_j).x;
    }
    let exact_n_s = (before_j - surface.energy_j()) / f64::from(omega / k);
    assert!((given_n_s / exact_n_s - 1.0).abs() < 0.1, "{given_n_s} of {exact_n_s}");
    assert!((flow.momentum_n_s().x / given_n_s - 1.0).abs() < 1e-6);
}
