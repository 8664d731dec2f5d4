use super::super::{
    Surface, SurfaceParams,
    tests::{WATER, over_box},
};
use glam::Vec3;
use std::f64::consts::PI;

/// Frequency of the mode of m and n half waves in a box of 16 by 12 cm, 8 cm deep.
fn omega_per_s(m: f64, n: f64, tension_n_per_m: f64) -> f64 {
    let k = PI * (m / 0.16).hypot(n / 0.12);
    ((9.81 * k + tension_n_per_m * k.powi(3) / 1000.0) * (k * 0.08).tanh()).sqrt()
}

fn standing(params: SurfaceParams, m: f32, n: f32, viscosity_m2_s: f32) -> Surface {
    let mut surface = over_box(params, [16, 12], viscosity_m2_s);
    let wave = move |x: f32, z: f32| {
        let pi = std::f32::consts::PI;
        1e-3 * (pi * m * x / 0.16).cos() * (pi * n * z / 0.12).cos()
    };
    surface.set(wave, |_, _| 0.0);
    surface
}

fn run(surface: &mut Surface, steps: usize) {
    for _ in 0..steps {
        surface.step(0.01);
    }
}

#[test]
fn every_mode_swings_as_the_dispersion_relation_says_whatever_the_step() {
    for tension_n_per_m in [0.0, 0.072, 5.0] {
        let params = SurfaceParams { tension_n_per_m, ..WATER };
        for [m, n] in [[1.0, 0.0], [2.0, 1.0], [0.0, 5.0], [15.0, 11.0]] {
            let omega = omega_per_s(f64::from(m), f64::from(n), f64::from(tension_n_per_m));
            for dt_s in [1e-3, 0.01, 0.7] {
                let mut surface = standing(params, m, n, 0.0);
                let start = f64::from(surface.height_m()[0]);
                for step in 1..=20 {
                    surface.step(dt_s);
                    let exact = start * (omega * f64::from(dt_s) * f64::from(step)).cos();
                    let error = f64::from(surface.height_m()[0]) - exact;
                    assert!(
                        error.abs() < 2e-4 * start + 1e-8,
                        "{m} {n} {dt_s}: {error} of {start}"
                    );
                }
            }
        }
    }
}

#[test]
fn waves_die_by_twice_nu_k_squared() {
    let nu = 1e-5;
    let params = SurfaceParams { tension_n_per_m: 0.0, ..WATER };
    let mut surface = standing(params, 3.0, 0.0, nu);
    let before_j = surface.energy_j();
    run(&mut surface, 100);
    let k = 3.0 * PI / 0.16;
    let decay = -0.5 * (surface.energy_j() / before_j).ln();
    // Lamb's next term takes some of it back.
    let exact = 2.0 * f64::from(nu) * k * k;
    assert!((decay / exact - 1.0).abs() < 0.05, "{decay} {exact}");
}

#[test]
fn a_dent_in_honey_creeps_back() {
    let params = SurfaceParams { tension_n_per_m: 0.0, ..WATER };
    let (nu, m) = (0.05, 4.0);
    let mut surface = standing(params, m as f32, 0.0, nu as f32);
    let k = PI * m / 0.16;
    // At once the fast root takes what it holds; then the slow one is all there is.
    run(&mut surface, 20);
    let before = f64::from(surface.height_m()[0]);
    run(&mut surface, 100);
    let rate = (before / f64::from(surface.height_m()[0])).ln();
    let creep = 9.81 * (k * 0.08).tanh() / (2.0 * nu * k);
    assert!((rate / creep - 1.0).abs() < 0.05, "{rate} {creep}");
}

#[test]
fn a_poke_runs_at_the_speed_of_long_waves_in_shallow_water() {
    // 64 cells long, 8 deep; waves much longer than the depth run at sqrt(g h) = 0.886 m/s.
    let params = SurfaceParams { tension_n_per_m: 0.0, ..WATER };
    let mut surface = over_box(params, [256, 4], 0.0);
    let hump = |x: f32, _: f32| 1e-3 * (-(x / 0.3).powi(2)).exp();
    surface.set(hump, |_, _| 0.0);
    let front = |surface: &Surface| {
        let height = |n: usize| surface.at(Vec3::new(0.01 * n as f32, 0.0, 0.02)).0;
        (100..256).max_by(|a, b| height(*a).total_cmp(&height(*b))).expect("some") as f32 * 0.01
    };
    run(&mut surface, 160);
    let from_m = front(&surface);
    run(&mut surface, 60);
    let speed_m_s = (front(&surface) - from_m) / 0.6;
    assert!((speed_m_s / 0.886 - 1.0).abs() < 0.05, "{speed_m_s}");
}
