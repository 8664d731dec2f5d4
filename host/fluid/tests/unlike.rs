//! Obstacles in liquids that are not the same everywhere, against closed forms and each other.

mod ball;

use std::{f64::consts::PI, sync::Arc};

use cauldron_fluid::{
    Grid, Vessel,
    pool::Pool,
    simd::SimdClass,
    solver::{
        Motion, Obstacle, Scheme, Setup, Shape, Side, Sides, Solver, Walls,
        flow::{Flow, Medium},
    },
};
use glam::{DVec3, Vec3};
use proptest::prelude::*;

use self::ball::{
    CENTRE, ask_for_the_energy_of_jumps, ball_m3, hasimoto, jump, periodic, vessel_to_jump_in,
    with_ball,
};

const GRAVITY_M_S2: f64 = 10.0;

fn medium(density_kg_m3: f64, viscosity_m2_s: f64) -> Medium {
    Medium { density_kg_m3, viscosity_m2_s }
}

/// A closed box with gravity along -y.
fn heavy(n: usize) -> Setup {
    let gravity_m_s2 = Vec3::new(0.0, -GRAVITY_M_S2 as f32, 0.0);
    Setup { gravity_m_s2, ..Setup::new(Grid::unit_cube(n), Vessel::Box) }
}

fn values(flow: &Flow) -> Vec<f64> {
    let mut values = Vec::new();
    flow.visit(&mut |_, _, value| values.push(value));
    values
}

/// Size of the difference over that of the first.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    let size = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
    let difference = size(&mut one.iter().zip(other).map(|(a, b)| a - b));
    difference / size(&mut one.iter().copied())
}

fn wild(p: DVec3) -> DVec3 {
    0.1 * DVec3::new((7.0 * p.y).sin(), (5.0 * p.z).cos(), (6.0 * p.x).sin() * (3.0 * p.y).cos())
}

/// A plate across a periodic channel, its underside this far below its centre.
const HALF_PLATE_M: f32 = 0.3;

fn plate() -> Shape {
    let own = Grid { cells: [16; 3], spacing_m: 0.1, origin_in_world_m: Vec3::splat(-0.8) };
    Shape::from_distance(&own, |p| p.y.abs() - HALF_PLATE_M).expect("finite")
}

#[test]
fn layers_under_a_plate_that_is_drawn_along_share_the_shear_as_their_viscosities_say() {
    let n = 16;
    let grid = Grid { cells: [4, n, 3], ..Grid::unit_cube(n) };
    let sides = Sides::all(Side::Periodic).with(1, [Side::NoSlip; 2]);
    let area_m2 = f64::from(grid.extent_m().x * grid.extent_m().z);
    // Whole cells, and cut ones; steps that are long, and explicit ones.
    for (top_m, contrast, dt_s) in
        [(0.75f64, 30.0, 5.0), (0.78, 30.0, 5.0), (0.73, 1e3, 5.0), (0.78, 3.0, 1e-3)]
    {
        let setup = Setup { sides, walls: Walls::NoSlip, ..Setup::new(grid, Vessel::Box) };
        let mut flow = Flow::new(&setup).expect("a flow");
        let middle_m = 6.0 / n as f64;
        let nu = [0.1, 0.1 * contrast];
        let viscosity = |y: f64| if y < middle_m { nu[0] } else { nu[1] };
        flow.set_medium(&|p| medium(1000.0, viscosity(p.y))).expect("in range");
        flow.set_velocity(&|p| DVec3::X * (p.y / top_m).min(1.0)).expect("finite");
        let mut at = Vec3::new(0.1, top_m as f32 + HALF_PLATE_M, 0.1);
        let along = Motion::moving(at, Vec3::X);
        let plate = Obstacle { shape: plate(), motion: along };
        let plate = flow.add_obstacle(plate).expect("a plate");
        let steps = if dt_s > 1.0 { 40 } else { 2000 };
        for _ in 0..steps {
            at.x = (at.x + dt_s as f32) % 0.25;
            flow.move_obstacle(plate, Motion::moving(at, Vec3::X)).expect("finite");
            assert_eq!(flow.step(dt_s).expect("in range").guard_actions, 0);
        }
        let stress = 1.0 / (middle_m / nu[0] + (top_m - middle_m) / nu[1]);
        let exact = |y: f64| match y < middle_m {
            true => stress * y / nu[0],
            false => 1.0 - stress * (top_m - y) / nu[1],
        };
        let mut worst_m_s = 0f64;
        flow.visit(&mut |p, c, u| {
            if p.y < top_m {
                worst_m_s = worst_m_s.max((u - if c == 0 { exact(p.y) } else { 0.0 }).abs());
            }
        });
        assert!(worst_m_s < 0.01, "{top_m} {contrast} {dt_s}: {worst_m_s}");
        let force_n = flow.force_on_n(plate).expect("there") / (1000.0 * stress * area_m2);
        let missed = (force_n + DVec3::X).length();
        assert!(missed < 0.02, "{top_m} {contrast} {dt_s}: {force_n}");
    }
}

#[test]
fn a_viscosity_that_hardly_differs_drags_a_ball_as_the_same_everywhere() {
    for velocity_m_s in [Vec3::ZERO, Vec3::new(0.05, -0.02, 0.03)] {
        for (dt_s, scheme) in
            [(1e-4, Scheme::Multistep), (1e-3, Scheme::Central), (5e-3, Scheme::MultistepImplicit)]
        {
            let run = |more: f64| {
                let (mut flow, ball) = with_ball(&periodic(12, 0.5, Walls::NoSlip), 0.2);
                let nu = |p: DVec3| if p.x > 0.5 { 0.5 * (1.0 + more) } else { 0.5 };
                flow.set_medium(&|p| medium(1000.0, nu(p))).expect("in range");
                flow.set_velocity(&wild).expect("finite");
                flow.project();
                let mut at = CENTRE;
                for _ in 0..4 {
                    at += velocity_m_s * dt_s as f32;
                    flow.move_obstacle(ball, Motion::moving(at, velocity_m_s)).expect("finite");
                    let report = flow.step(dt_s).expect("in range");
                    assert_eq!((report.scheme, report.guard_actions), (scheme, 0));
                }
                (values(&flow), flow.force_on_n(ball).expect("there"))
            };
            let ((same, same_n), (other, other_n)) = (run(0.0), run(3e-3));
            let error = apart(&same, &other);
            let force_error = (same_n - other_n).length() / same_n.length();
            assert!(error < 0.015 && force_error < 0.1, "{error} {force_error}");
        }
    }
}

#[test]
fn the_drag_on_a_ball_that_stresses_hold_is_that_of_hasimoto() {
    for (n, at_most) in [(16, 0.05), (20, 0.04)] {
        let (mut flow, ball) = with_ball(&periodic(n, 1.0, Walls::NoSlip), 0.2);
        let nu = |p: DVec3| if p.x > 0.5 { 1.003 } else { 1.0 };
        flow.set_medium(&|p| medium(1000.0, nu(p))).expect("in range");
        flow.set_force(&|_| DVec3::X).expect("finite");
        (0..40).for_each(|_| assert_eq!(flow.step(0.02).expect("finite").guard_actions, 0));
        let u = flow.momentum_n_s().x / 1000.0;
        let ball_m3 = ball_m3(0.2);
        let drag = 1000.0 / (6.0 * PI * 1001.5 * 0.2 * u * hasimoto(ball_m3));
        let balance = flow.force_on_n(ball).expect("there").x / 1000.0 / (1.0 - ball_m3);
        assert!((drag - 1.0).abs() < at_most && (balance - 1.0).abs() < 0.004, "{drag} {balance}");
    }
}

#[test]
fn what_unlike_liquid_loses_a_resting_ball_gets() {
    // Of densities that differ, what flows carry of momentum is another matter: those creep.
    for (dense, thick, dt_s, speed_m_s, at_most) in [
        (1.0, 100.0, 0.02, 1.0, 1e-3),
        (1.0, 10.0, 5e-4, 1.0, 0.015),
        (8.0, 10.0, 0.02, 1e-3, 1e-3),
        (1.0, 10.0, 1e-3, 1.0, 0.015),
        (8.0, 10.0, 1e-3, 3e-2, 5e-3),
        (8.0, 10.0, 2e-4, 3e-2, 5e-3),
    ] {
        let (mut flow, ball) = with_ball(&periodic(16, 0.2, Walls::NoSlip), 0.15);
        let is_other = |p: DVec3| (p.x + 2.0 * p.y) % 1.0 < 0.5;
        let made = |p: DVec3| match is_other(p) {
            true => medium(1000.0 * dense, 0.02 * thick),
            false => medium(1000.0, 0.02),
        };
        flow.set_medium(&made).expect("in range");
        flow.set_velocity(&|_| DVec3::new(speed_m_s, 0.0, 0.3 * speed_m_s)).expect("finite");
        flow.project();
        let before_n_s = flow.momentum_n_s();
        let mut given_n_s = DVec3::ZERO;
        let (mut schemes, mut guard_actions) = (Vec::new(), 0);
        for _ in 0..30 {
            let report = flow.step(dt_s).expect("finite");
            schemes.push(report.scheme);
            guard_actions += report.guard_actions;
            given_n_s += flow.force_on_n(ball).expect("there") * dt_s;
        }
        schemes.dedup();
        let residual_n_s = flow.momentum_n_s() - before_n_s + given_n_s;
        let part = residual_n_s.length() / given_n_s.length();
        assert_eq!(guard_actions, 0);
        assert!(part < at_most && given_n_s.x > 0.0, "{part} {dense} {thick} {schemes:?}");
    }
}

#[test]
fn level_layers_lift_a_resting_ball_and_stay_at_rest() {
    // Volume of a ball below a height above its centre.
    let cap_m3 = |r: f64, h: f64| PI * (2.0 / 3.0 * r.powi(3) + r * r * h - h.powi(3) / 3.0);
    let radius_m = 0.2f64;
    for (lower, upper) in [(1000.0, 950.0), (1080.0, 1000.0), (13_000.0, 900.0)] {
        let setup = Setup { viscosity_m2_s: 1e-3, walls: Walls::NoSlip, ..heavy(16) };
        let (mut flow, ball) = with_ball(&setup, radius_m as f32);
        let layers = |p: DVec3| medium(if p.y < 0.5 { lower } else { upper }, 1e-3);
        flow.set_medium(&layers).expect("in range");
        for _ in 0..10 {
            let report = flow.step(0.02).expect("in range");
            assert!(report.asleep && report.guard_actions == 0);
        }
        let below_m3 = cap_m3(radius_m, 0.5 - f64::from(CENTRE.y));
        let above_m3 = 4.0 / 3.0 * PI * radius_m.powi(3) - below_m3;
        // Beyond what liquid of the setup's density lifts.
        let exact_kg = (lower - 1000.0) * below_m3 + (upper - 1000.0) * above_m3;
        let lift_kg = flow.force_on_n(ball).expect("there") / GRAVITY_M_S2;
        let missed = (lift_kg / exact_kg - DVec3::Y).length();
        assert!(missed < 0.05, "{lower} {upper}: {lift_kg} {exact_kg}");
        assert_eq!(flow.kinetic_energy_j(), 0.0);
    }
}

#[test]
fn what_floats_far_away_changes_no_lift() {
    let lift_n = |is_disturbed: bool| {
        let setup = Setup { viscosity_m2_s: 1.0, walls: Walls::NoSlip, ..heavy(12) };
        let (mut flow, ball) = with_ball(&setup, 0.2);
        // Light liquid in a corner, at the level of the ball.
        let corner = |p: DVec3| p.x < 0.09 && p.z < 0.09 && (0.4..0.6).contains(&p.y);
        let density = |p: DVec3| if is_disturbed && corner(p) { 950.0 } else { 1050.0 };
        let all = |p: DVec3| medium(if p.y > 0.9 { 1000.0 } else { density(p) }, 1.0);
        flow.set_medium(&all).expect("in range");
        flow.step(1e-3).expect("in range");
        flow.force_on_n(ball).expect("there").y
    };
    let (calm_n, disturbed_n) = (lift_n(false), lift_n(true));
    assert!((disturbed_n / calm_n - 1.0).abs() < 0.03, "{calm_n} {disturbed_n}");
}

#[test]
fn a_ball_in_what_is_denser_than_the_setup_meets_as_much_more() {
    for (walls, viscosity_m2_s) in [(Walls::FreeSlip, 0.0), (Walls::NoSlip, 0.01)] {
        let run = |is_medium: bool| {
            let (mut setup, density_kg_m3) = (periodic(16, viscosity_m2_s, walls), 5e3);
            setup.density_kg_m3 = if is_medium { 1e3 } else { density_kg_m3 as f32 };
            let (mut flow, ball) = with_ball(&setup, 0.15);
            if is_medium {
                // A little less in one cell, or it were the same everywhere.
                let less = |p: DVec3| if p.max_element() < 0.06 { 1.0 } else { 0.0 };
                flow.set_medium(&|p| medium(density_kg_m3 - less(p), f64::from(viscosity_m2_s)))
                    .expect("in range");
            }
            let (mut at, dt_s, mut forces_n) = (CENTRE, 6e-3, Vec::new());
            for step in 1..20 {
                let velocity_m_s = Vec3::new(0.01 * step as f32, 0.0, 0.0);
                at += velocity_m_s * dt_s as f32;
                flow.move_obstacle(ball, Motion::moving(at, velocity_m_s)).expect("finite");
                assert_eq!(flow.step(dt_s).expect("finite").guard_actions, 0);
                forces_n.push(flow.force_on_n(ball).expect("there").x);
            }
            (forces_n, flow.kinetic_energy_j())
        };
        let ((all_n, all_j), (medium_n, medium_j)) = (run(false), run(true));
        let error = apart(&all_n, &medium_n);
        assert!(error < 0.05 && (medium_j / all_j - 1.0).abs() < 0.03, "{error}");
    }
}

#[test]
fn an_obstacle_that_is_gone_has_left_the_medium_as_it_was() {
    let setup = Setup { walls: Walls::NoSlip, viscosity_m2_s: 0.01, ..heavy(10) };
    let made = |p: DVec3| medium(1000.0 + 4000.0 * p.x.round(), 10f64.powf(-3.0 * p.z.round()));
    let run = |is_met: bool| {
        let mut flow = Flow::new(&setup).expect("a flow");
        flow.set_medium(&made).expect("in range");
        if is_met {
            let ball = flow.add_obstacle(Obstacle::sphere(CENTRE, 0.3)).expect("a ball");
            for at in [CENTRE + 0.2, CENTRE, Vec3::splat(9.0)] {
                flow.move_obstacle(ball, Motion::at(at)).expect("finite");
                flow.step(0.01).expect("in range");
            }
            flow.remove_obstacle(ball).expect("there");
        }
        flow.set_velocity(&wild).expect("finite");
        (0..3).for_each(|_| assert!(flow.step(0.01).is_ok()));
        values(&flow)
    };
    assert!(run(false) == run(true));
}

#[test]
fn bits_of_a_stirred_mixture_depend_on_no_threads() {
    let run = |threads, dt_s| {
        let pool = Arc::new(Pool::new(threads, false));
        let simd = SimdClass::detect();
        let (mut flow, ball) =
            with_ball(&Setup { pool, simd, walls: Walls::NoSlip, ..heavy(14) }, 0.2);
        let share = |p: DVec3| 0.5 + 0.5 * (5.0 * p.x).sin() * (4.0 * p.y).cos();
        let made = |p: DVec3| medium(1000.0 * (1.0 + share(p)), 10f64.powf(4.0 * share(p) - 4.0));
        flow.set_medium(&made).expect("in range");
        let (mut at, velocity_m_s) = (CENTRE, Vec3::new(0.5, 0.2, 0.0));
        for _ in 0..4 {
            at += velocity_m_s * dt_s as f32;
            flow.move_obstacle(ball, Motion::moving(at, velocity_m_s)).expect("finite");
            flow.step(dt_s).expect("in range");
        }
        values(&flow)
    };
    for dt_s in [1e-3, 0.05] {
        assert!(run(1, dt_s) == run(3, dt_s));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn any_jump_in_any_mixture_gives_no_more_than_its_work(
        radius_m in 0.01f32..0.9,
        is_sticky in any::<bool>(),
        is_pot in any::<bool>(),
        ratio in prop_oneof![Just(1.0), 1.0..3.0f64, Just(1e3)],
        viscosity in prop_oneof![Just([0.0, 0.0]), Just([0.0, 0.1]), Just([1e-3, 10.0]), Just([0.1, 1e3])],
        side in prop_oneof![Just(Side::NoSlip), Just(Side::Periodic), Just(Side::Outflow)],
        split in prop::array::uniform3(-1.0..1.0f64),
        jumps in prop::collection::vec(jump(), 1..6),
    ) {
        let (mut flow, ball) = with_ball(&vessel_to_jump_in(is_sticky, is_pot, side), radius_m);
        let is_other = |p: DVec3| (p - 0.5).dot(DVec3::from_array(split)) > 0.0;
        let made = |p: DVec3| match is_other(p) {
            true => medium(1000.0 * ratio, viscosity[1] / ratio),
            false => medium(1000.0, viscosity[0]),
        };
        flow.set_medium(&made).expect("in range");
        ask_for_the_energy_of_jumps((flow, ball), radius_m, 1000.0 * ratio, jumps)?;
    }
}
