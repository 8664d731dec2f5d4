//! Looks ahead and below, and steps that are none.

use std::f32::consts::PI;

use super::*;

const AHEAD_S: f32 = 0.03;
const DT_S: f32 = 0.01;
const TOUCHED: Vec3 = Vec3::new(0.06, 0.08, 0.07);

/// One wave along x, of which the walls are half a wave apart: 16 cm, and 8 cm deep.
fn standing(model: &'static str) -> Surface {
    let params = SurfaceParams { model, tension_n_per_m: 0.0, ..WATER };
    let mut surface = over_box(params, [16, 12], 0.0);
    surface.set(|x, _| 1e-3 * (PI * x / 0.16).cos(), |_, _| 0.0);
    surface
}

fn bits(surface: &Surface) -> Vec<u32> {
    let all = surface.height_m().iter().chain(surface.speed_m_s());
    all.map(|value| value.to_bits()).collect()
}

#[test]
fn a_wave_is_told_ahead_as_it_swings() {
    let k = PI / 0.16;
    let [of_water, of_springs] = [9.81 * k * (k * 0.08).tanh(), 9810.0 / 20.0].map(f32::sqrt);
    for (model, omega, most) in [("wave", of_water, 3e-7), ("spring", of_springs, 2e-6)] {
        let mut surface = standing(model);
        let at = surface.lattice().in_world_m(3);
        let first_m = surface.at(at).0;
        surface.look_ahead(AHEAD_S);
        assert_eq!(surface.ahead(at), surface.at(at), "{model}: before a step nothing is known");
        surface.step(DT_S);
        let before = bits(&surface);
        for ahead_s in [1e-3, 4e-3, AHEAD_S] {
            surface.look_ahead(ahead_s);
            let (height_m, speed_m_s) = surface.ahead(at);
            let (sin, cos) = (omega * (DT_S + ahead_s)).sin_cos();
            assert!((height_m - first_m * cos).abs() < most, "{model}: {height_m}");
            assert!((speed_m_s + first_m * omega * sin).abs() < 20.0 * most, "{model}");
        }
        assert_eq!(bits(&surface), before, "{model}: it only looks");
    }
}

#[test]
fn what_acts_is_told_to_go_on_and_what_is_to_come_still_comes() {
    for row in INDEX {
        let [mut looks, mut goes] = [(); 2].map(|()| standing(row.name));
        let touch = |surface: &mut Surface| surface.touch(TOUCHED, 0.02, -0.1, 0.5);
        for surface in [&mut looks, &mut goes] {
            touch(surface);
            surface.press(|at| 20.0 * at.x);
            surface.kick(TOUCHED, 0.02, 1e-5);
            surface.step(DT_S);
        }
        looks.look_ahead(AHEAD_S);
        for _ in 0..3 {
            touch(&mut goes);
            goes.press(|at| 20.0 * at.x);
            goes.step(DT_S);
        }
        let (told, came) = (looks.ahead(TOUCHED), goes.at(TOUCHED));
        assert!((told.0 - came.0).abs() < 1e-6, "{}: {told:?} {came:?}", row.name);
        assert!((told.1 - came.1).abs() < 2e-5, "{}: {told:?} {came:?}", row.name);
        // A look between takes nothing from what is to come.
        let [mut looks, mut goes] = [(); 2].map(|()| standing(row.name));
        for _ in 0..3 {
            for surface in [&mut looks, &mut goes] {
                touch(surface);
                surface.kick(TOUCHED, 0.02, -1e-4);
            }
            looks.look_ahead(AHEAD_S);
            looks.look_below(TOUCHED);
            assert_eq!(looks.step(DT_S), goes.step(DT_S));
        }
        assert_eq!(bits(&looks), bits(&goes), "{}", row.name);
    }
}

#[test]
fn a_step_that_lasts_no_time_is_none() {
    for row in INDEX {
        let mut surface = standing(row.name);
        surface.step(DT_S);
        let before = bits(&surface);
        for bad_s in [0.0, -0.0, -DT_S, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            surface.touch(TOUCHED, 0.02, 1.0, 1.0);
            surface.press(|_| 10.0);
            assert_eq!(surface.step(bad_s), SurfaceReport::default());
            assert_eq!(bits(&surface), before, "{} {bad_s}", row.name);
        }
        let mut twin = standing(row.name);
        for surface in [&mut surface, &mut twin] {
            surface.set(|x, _| 1e-3 * x, |_, _| 0.0);
            surface.step(DT_S);
        }
        assert_eq!(bits(&surface), bits(&twin), "{}: what was put for them is gone", row.name);
    }
}

#[test]
fn the_liquid_below_moves_as_a_potential_flow_over_a_floor() {
    let mut surface = standing("wave");
    let (k, depth_m) = (PI / 0.16, 0.08);
    surface.set(|_, _| 0.0, |x, _| 0.05 * (k * x).cos());
    for below_m in [0.005, 0.02, 0.047, 0.075] {
        let up = k * (depth_m - below_m);
        let at = Vec3::new(0.05, depth_m - below_m, 0.04);
        surface.look_below(at);
        let u = surface.orbit_m_s(at);
        let (sin, cos) = (k * at.x).sin_cos();
        let along = -0.05 * sin * up.cosh() / (k * depth_m).sinh();
        let upwards = 0.05 * cos * up.sinh() / (k * depth_m).sinh();
        assert!((u.x / along - 1.0).abs() < 0.01, "{below_m}: {u} {along}");
        assert!((u.y / upwards - 1.0).abs() < 0.01, "{below_m}: {u} {upwards}");
        assert!(u.z.abs() < 1e-6);
    }
    // Beyond the floor and above the surface it is what is nearest.
    for y in [-1e30, 1e30] {
        surface.look_below(Vec3::new(0.05, y, 0.04));
        assert!(surface.orbit_m_s(Vec3::new(0.05, y, 0.04)).is_finite());
    }
}

#[test]
fn where_nothing_moves_nothing_is_told() {
    for row in INDEX {
        let mut surface = over_box(SurfaceParams { model: row.name, ..WATER }, [16, 12], 1e-6);
        surface.look_ahead(AHEAD_S);
        surface.look_below(TOUCHED);
        assert_eq!(surface.ahead(TOUCHED), (0.0, 0.0));
        assert_eq!(surface.orbit_m_s(TOUCHED), Vec3::ZERO);
        assert_eq!(surface.find_drift(0.0), 0.0);
        assert!(surface.is_asleep());
    }
}

#[test]
fn no_drift_is_above_what_is_said_of_it() {
    let params = SurfaceParams { model: "wave", drag_n_s_per_m3: 10.0, ..WATER };
    for mut surface in [over_box(params, [16, 12], 1e-4), in_pot(params)] {
        surface.set(|x, _| 1e-3 * (20.0 * x).sin(), |_, z| 0.01 * (31.0 * z).cos());
        for _ in 0..40 {
            surface.touch(0.5 * TOUCHED, 0.02, -0.01, 0.0);
            surface.step(DT_S);
            let most = surface.model.most_drift_m2_s2(surface.extremes[1]);
            let found = surface.find_drift(0.0);
            assert!(found > 0.0 && found <= most && most < 100.0 * found, "{found} {most}");
            assert_eq!(surface.find_drift(most), 0.0, "it is not looked for");
        }
    }
}
