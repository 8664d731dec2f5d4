use super::{super::tests::WATER, *};
use crate::surface::Touch;
use crate::{grid::Grid, vessel::Vessel};
use glam::Vec3;

fn sheet(params: SurfaceParams) -> SpringSheet {
    let grid = Grid { cells: [17, 8, 17], spacing_m: 0.01, origin_in_world_m: Vec3::ZERO };
    let basin = Basin::of_water(&grid, &Vessel::Box);
    let lattice = Lattice::over(&grid, &Vessel::Box, 1);
    SpringSheet::new(&params, &lattice, &basin).expect("sound numbers")
}

/// Tilted along x by 1 mm.
fn tilted(params: SurfaceParams) -> SpringSheet {
    let mut sheet = sheet(params);
    let height_m: Vec<f32> = (0..17 * 17).map(|n| 1e-3 * (0.5 - (n % 17) as f32 / 16.0)).collect();
    sheet.add(&height_m, &vec![0.0; 17 * 17]);
    sheet
}

/// Height and speed of the first node.
fn first(sheet: &SpringSheet) -> [f64; 2] {
    let at = sheet.springs.at(0);
    [sheet.motion.height_m[at], sheet.motion.speed_m_s[at]].map(f64::from)
}

#[test]
fn gravity_alone_swings_every_node_at_its_frequency() {
    let mut sheet = tilted(SurfaceParams { tension_n_per_m: 0.0, ..WATER });
    let omega = (9810.0_f64 / 20.0).sqrt();
    let [start, _] = first(&sheet);
    for step in 1..=50 {
        sheet.step(4e-3, Load::default());
        let error = first(&sheet)[0] - start * (omega * 4e-3 * f64::from(step)).cos();
        assert!(error.abs() < 2e-3 * start, "step {step}: {error}");
    }
}

#[test]
fn halving_the_step_divides_the_error_by_sixteen() {
    let params = SurfaceParams { tension_n_per_m: 0.0, ..WATER };
    let omega = (9810.0_f64 / 20.0).sqrt();
    let error = |dt_s: f32, steps: u32| {
        let mut sheet = tilted(params);
        (0..steps).for_each(|_| sheet.runge_kutta(dt_s));
        let (sin, cos) = (omega * f64::from(dt_s) * f64::from(steps)).sin_cos();
        let [height_m, speed_m_s] = first(&sheet);
        (height_m - 5e-4 * cos).hypot((speed_m_s + 5e-4 * omega * sin) / omega)
    };
    let order = (error(0.02, 16) / error(0.01, 32)).log2();
    assert!((3.8..4.2).contains(&order), "{order}");
}

#[test]
fn a_step_too_long_for_springs_is_stable_and_keeps_what_it_can_tell() {
    // The slowest mode is resolved by steps that are far too long for the fastest.
    let params = SurfaceParams { tension_n_per_m: 2e5, ..WATER };
    let mut sheet = tilted(params);
    let mut energy_j = sheet.energy_j();
    for _ in 0..200 {
        assert_eq!(sheet.step(0.1, Load::default()), 1, "one implicit step");
        assert!(sheet.energy_j() <= energy_j * (1.0 + 1e-5));
        energy_j = sheet.energy_j();
    }
    assert!(energy_j > 0.0);
}

#[test]
fn an_implicit_step_is_the_midpoint_rule() {
    let params = SurfaceParams { tension_n_per_m: 0.0, drag_n_s_per_m3: 0.0, ..WATER };
    let mut sheet = tilted(params);
    let [x0, v0] = first(&sheet);
    let mut implicit = Implicit::new(sheet.springs.len());
    let dt_s = 0.05;
    let load = sheet.load_m_s2.clone();
    implicit.step(&sheet.springs, SimdClass::detect(), &mut sheet.motion, &load, dt_s);
    let (omega2, dt) = (9810.0 / 20.0, f64::from(dt_s));
    let v = (v0 - 0.5 * dt * omega2 * x0) / (1.0 + 0.25 * dt * dt * omega2);
    let [x1, v1] = first(&sheet);
    assert!((x1 - (x0 + dt * v)).abs() < 1e-8, "{x1}");
    assert!((v1 - (2.0 * v - v0)).abs() < 1e-6, "{v1}");
}

/// A body that is on all nodes moves them by no more than what its touch differs from node to node:
/// what a kick brings must not be lost in what it gives to all alike.
#[test]
fn a_kick_of_all_nodes_brings_its_energy() {
    let grid = Grid { cells: [17, 8, 17], spacing_m: 0.01, origin_in_world_m: Vec3::ZERO };
    let lattice = Lattice::over(&grid, &Vessel::Box, 1);
    for radius_m in [0.1, 1.0, 30.0] {
        let mut under = Vec::new();
        lattice.find_under(Vec3::new(0.08, 0.0, 0.07), radius_m, &mut under);
        let kick_j = 1e-3;
        let kick = Touch { under, kick_j, ..Touch::default() };
        let mut sheet = sheet(WATER);
        sheet.take(1e-3, Load { touches: &[kick.clone(), kick], force_n: None });
        let off = sheet.energy_j() / f64::from(2.0 * kick_j) - 1.0;
        assert!(off.abs() < 1e-4, "{radius_m} m: off by {off}");
    }
}
