//! The flow solver against closed forms, and against everything a hand may do to it.

use std::{f64::consts::PI, sync::Arc};

use cauldron_fluid::{
    Grid, Vessel,
    pool::Pool,
    simd::SimdClass,
    solver::{Scheme, Setup, Side, Sides, Solver, StepReport, Walls, flow::Flow},
};
use glam::{DVec3, Vec3};
use proptest::prelude::*;

const PROBE_RADIUS_M: f32 = 0.012;

/// The pot of the default scene, cut into `n` cells along each edge.
fn pot(n: usize) -> Setup {
    let grid = Grid { cells: [n; 3], spacing_m: 0.256 / n as f32, origin_in_world_m: Vec3::ZERO };
    let centre_in_world_m = Vec3::new(0.128, 0.14, 0.128);
    let vessel = Vessel::Pot { centre_in_world_m, radius_m: 0.12 };
    Setup { walls: Walls::NoSlip, viscosity_m2_s: 1e-5, ..Setup::new(grid, vessel) }
}

/// Where a stirring hand is at step `step`, and which way it pushes.
fn stir(step: usize) -> (Vec3, DVec3) {
    let (sin, cos) = (step as f32 * 0.1).sin_cos();
    let at = Vec3::new(0.128 + 0.06 * cos, 0.14, 0.128 + 0.06 * sin);
    (at, DVec3::new(f64::from(-sin), 0.2, f64::from(cos)))
}

/// Stirs with a force for some steps; returns the last report and the number of guard actions.
fn stirred(flow: &mut Flow, steps: usize, force_n: f64, dt_s: f64) -> (StepReport, u32) {
    let (mut report, mut guard_actions) = (StepReport::at_rest(), 0);
    for step in 0..steps {
        let (at, direction) = stir(step);
        flow.push(at, PROBE_RADIUS_M, direction * force_n * dt_s).expect("finite");
        report = flow.step(dt_s).expect("finite");
        guard_actions += report.guard_actions;
        assert!(report.kinetic_energy_j.is_finite());
    }
    (report, guard_actions)
}

fn bits(flow: &Flow) -> Vec<u64> {
    let mut bits = Vec::new();
    flow.visit(&mut |_, _, value| bits.push(value.to_bits()));
    bits
}

#[test]
fn the_error_falls_with_the_square_of_the_spacing() {
    let error = |n: usize| {
        let mut flow = Flow::new(&Setup::new(Grid::unit_cube(n), Vessel::Box)).expect("a flow");
        let exact = |p: DVec3| {
            let (s, c) = ((PI * p).map(f64::sin), (PI * p).map(f64::cos));
            DVec3::new(s.x * c.y, -c.x * s.y, 0.0)
        };
        // Inviscid Taylor-Green is steady: what the scheme makes of a viscous one is not.
        flow.set_viscosity_m2_s(0.02).expect("in range");
        flow.set_velocity(&exact).expect("finite");
        for _ in 0..4 * n {
            flow.step(0.25 / n as f64).expect("finite");
        }
        let decay = (-2.0 * PI * PI * 0.02f64).exp();
        let (mut error, mut norm) = (0.0, 0.0);
        flow.visit(&mut |point, c, value| {
            error += (value - decay * exact(point)[c]).powi(2);
            norm += (decay * exact(point)[c]).powi(2);
        });
        (error / norm).sqrt()
    };
    let order = (error(8) / error(16)).log2();
    assert!((1.7..2.6).contains(&order), "order {order}");
}

#[test]
fn between_sliding_walls_inviscid_flow_keeps_its_energy() {
    let mut flow = Flow::new(&Setup::new(Grid::unit_cube(16), Vessel::Box)).expect("a flow");
    let wild = |p: DVec3| DVec3::new((9.0 * p.y).sin(), (7.0 * p.z).cos(), (8.0 * p.x).sin());
    flow.set_velocity(&wild).expect("finite");
    flow.project();
    let before = flow.kinetic_energy_j();
    let mut guard_actions = 0;
    for _ in 0..200 {
        guard_actions += flow.step(0.01).expect("finite").guard_actions;
    }
    let kept = flow.kinetic_energy_j() / before;
    assert!((0.95..1.001).contains(&kept), "kept {kept}");
    assert_eq!(guard_actions, 0);
}

#[test]
fn a_step_across_many_cells_is_traced_and_keeps_most_of_its_energy() {
    let mut flow = Flow::new(&Setup::new(Grid::unit_cube(32), Vessel::Box)).expect("a flow");
    let vortex = |p: DVec3| {
        let (s, c) = ((PI * p).map(f64::sin), (PI * p).map(f64::cos));
        DVec3::new(s.x * c.y, -c.x * s.y, 0.0)
    };
    flow.set_velocity(&vortex).expect("finite");
    let before = flow.kinetic_energy_j();
    let report = flow.step(1.0).expect("finite");
    assert_eq!(report.scheme, Scheme::Traced);
    let kept = flow.kinetic_energy_j() / before;
    assert!((0.2..1.001).contains(&kept), "kept {kept}");
    // Sixteen cells a step for two seconds: traced, and as the solver chooses by itself.
    let setup = Setup::new(Grid::unit_cube(32), Vessel::Box);
    for (scheme, least) in [(Scheme::Traced, 0.82), (Scheme::Central, 0.99)] {
        let made = if scheme == Scheme::Traced {
            Flow::with_scheme(&setup, scheme)
        } else {
            Flow::new(&setup)
        };
        let mut flow = made.expect("a flow");
        flow.set_velocity(&vortex).expect("finite");
        (0..4).for_each(|_| assert_eq!(flow.step(0.5).expect("finite").scheme, scheme));
        let kept = flow.kinetic_energy_j() / before;
        assert!((least..1.001).contains(&kept), "{scheme:?} kept {kept}");
    }
    flow.set_velocity(&vortex).expect("finite");
    for _ in 0..6 {
        assert_eq!(flow.step(0.35).expect("finite").scheme, Scheme::Central, "11 cells a step");
    }
    let kept = flow.kinetic_energy_j() / before;
    assert!((0.8..1.001).contains(&kept), "kept {kept}");
}

#[test]
fn a_push_from_rest_is_taken_whole_however_it_changes() {
    for dt_s in [1e-3, 0.05, 20.0] {
        for scale in [[2.0, 0.0], [0.0, 2.0], [-1.0, 3.0]] {
            let mut flow = Flow::new(&Setup::new(Grid::unit_cube(8), Vessel::Box)).expect("a flow");
            let (s, c) = (|x: f64| (PI * x).sin(), |x: f64| (PI * x).cos());
            let roll = |p: DVec3| DVec3::new(s(p.x) * c(p.y), -c(p.x) * s(p.y), 0.0);
            flow.set_force(&|p| roll(p) * 1e-3 / dt_s).expect("finite");
            flow.scale_force(scale[0], scale[1]).expect("finite");
            let report = flow.step(dt_s).expect("finite");
            let pushed = flow.velocity_at(Vec3::new(0.5, 0.0, 0.5)).x;
            assert_eq!(report.guard_actions, 0, "{dt_s} {scale:?} {report:?}");
            assert!((pushed - 0.96e-3).abs() < 5e-5, "{dt_s} {scale:?}: {pushed}");
        }
    }
}

#[test]
fn thick_liquid_decays_as_its_modes_whether_explicit_or_implicit() {
    // A roll in a box of 2 x 1, so slow that it does not carry itself.
    let roll = |p: DVec3| {
        let (x, y) = (PI * p.x / 2.0, PI * p.y);
        DVec3::new(x.sin() * y.cos(), -0.5 * x.cos() * y.sin(), 0.0) * 1e-3
    };
    let spacing_m = 1.0 / 16.0;
    let grid = Grid { cells: [32, 16, 2], spacing_m, origin_in_world_m: Vec3::ZERO };
    for (steps, scheme) in [(192, Scheme::Central), (24, Scheme::MultistepImplicit)] {
        let mut flow = Flow::new(&Setup { viscosity_m2_s: 0.1, ..Setup::new(grid, Vessel::Box) })
            .expect("a flow");
        flow.set_velocity(&roll).expect("finite");
        let before = flow.kinetic_energy_j();
        for _ in 0..steps {
            assert_eq!(flow.step(1.0 / f64::from(steps)).expect("finite").scheme, scheme);
        }
        let rate = 0.1 * PI * PI * 1.25;
        let decay = (flow.kinetic_energy_j() / before).sqrt() / (-rate).exp();
        assert!((decay - 1.0).abs() < 0.03, "{scheme:?}: {decay}");
    }
}

/// Friction and a force balance: f ~ nu gives the same flow however thick the liquid is.
#[test]
fn thick_liquid_that_is_pushed_hard_moves_as_friction_lets_it() {
    let energy_j = |viscosity_m2_s: f32| {
        let push = 40.0 * f64::from(viscosity_m2_s);
        let force = |p: DVec3| {
            let (x, y) = (PI * p.x, PI * p.y);
            push * DVec3::new(x.sin() * y.cos(), -x.cos() * y.sin(), 0.0)
        };
        let sides = Sides::all(Side::NoSlip);
        let setup = Setup { viscosity_m2_s, sides, ..Setup::new(Grid::unit_cube(16), Vessel::Box) };
        let mut flow = Flow::new(&setup).expect("a flow");
        flow.set_force(&force).expect("finite");
        let mut report = StepReport::at_rest();
        for _ in 0..20 {
            report = flow.step(1.0 / 32.0).expect("finite");
        }
        assert_eq!(report.guard_actions, 0);
        (report.scheme, report.kinetic_energy_j)
    };
    let ((scheme, exact_j), (traced, energy_j)) = (energy_j(2.0), energy_j(500.0));
    assert_eq!([scheme, traced], [Scheme::MultistepImplicit, Scheme::Traced]);
    assert!((energy_j / exact_j - 1.0).abs() < 0.2, "{energy_j} {exact_j}");
}

#[test]
fn no_slip_walls_hold_the_liquid_and_free_slip_walls_do_not() {
    let left = |walls| {
        let sides = Sides::of_vessel(walls);
        let grid = Grid::unit_cube(16);
        let mut flow =
            Flow::new(&Setup { sides, viscosity_m2_s: 0.01, ..Setup::new(grid, Vessel::Box) })
                .expect("a flow");
        flow.set_velocity(&|p| {
            let (s, c) = ((PI * p).map(f64::sin), (PI * p).map(f64::cos));
            DVec3::new(s.x * c.z, 0.0, -c.x * s.z) * 0.1
        })
        .expect("finite");
        (0..64).for_each(|_| assert!(flow.step(0.05).expect("finite").guard_actions == 0));
        flow.kinetic_energy_j()
    };
    assert!(left(Walls::NoSlip) < 0.6 * left(Walls::FreeSlip));
}

#[test]
fn the_pot_is_left_free_of_divergence_and_closed() {
    let mut flow = Flow::new(&pot(32)).expect("a flow");
    let (report, guard_actions) = stirred(&mut flow, 50, 0.05, 0.01);
    assert_eq!(guard_actions, 0);
    assert!(report.pressure_iterations > 0);
    // 0.2 m/s across cells of 8 mm: 25 per second.
    let left_per_s = flow.divergence_max_per_s();
    assert!(left_per_s < 1e-4 * 25.0, "{left_per_s}");
    assert_eq!(flow.velocity_at(Vec3::new(0.01, 0.01, 0.01)), Vec3::ZERO, "outside of the pot");
    flow.set_velocity(&|p| DVec3::new((20.0 * p.x).sin(), (25.0 * p.y).cos(), p.z))
        .expect("finite");
    let before = flow.divergence_l2_per_s();
    flow.project();
    assert!(flow.divergence_l2_per_s() < 1e-4 * before);
}

#[test]
fn a_push_changes_the_momentum_by_exactly_what_it_reports() {
    let mut flow = Flow::new(&pot(32)).expect("a flow");
    stirred(&mut flow, 5, 0.05, 0.01);
    for (at, radius) in [(Vec3::new(0.1, 0.2, 0.12), 0.012), (Vec3::new(0.128, 0.03, 0.128), 0.04)]
    {
        let impulse = DVec3::new(3e-4, -2e-4, 5e-4);
        let before = flow.momentum_n_s();
        let reported = flow.push(at, radius, impulse).expect("finite");
        let measured = flow.momentum_n_s() - before;
        assert!((reported - measured).length() < 1e-15, "{reported} {measured}");
        assert!((reported - impulse).length() < 1e-6 * impulse.length(), "{reported}");
    }
    let nowhere = flow.push(Vec3::splat(-1.0), 0.012, DVec3::X).expect("finite");
    assert_eq!(nowhere, DVec3::ZERO);
}

#[test]
fn what_is_gathered_after_a_push_is_the_impulse_over_the_effective_mass() {
    let mut flow = Flow::new(&pot(32)).expect("a flow");
    let (at, impulse) = (Vec3::new(0.13, 0.18, 0.12), DVec3::new(1e-3, 0.0, 0.0));
    let mass_kg = flow.effective_mass_kg(at, PROBE_RADIUS_M);
    flow.push(at, PROBE_RADIUS_M, impulse).expect("finite");
    let gathered = f64::from(flow.gather(at, PROBE_RADIUS_M).x);
    assert!((gathered * mass_kg / impulse.x - 1.0).abs() < 0.1, "{gathered} {mass_kg}");
    // Power is the same on both sides: the energy given is J . (mean of gathered velocity).
    let given = flow.kinetic_energy_j();
    assert!((given / (0.5 * impulse.x * gathered) - 1.0).abs() < 1e-4);
    assert!(flow.effective_mass_kg(Vec3::splat(-1.0), 0.01).is_infinite());
    assert_eq!(flow.gather(Vec3::splat(-1.0), 0.01), Vec3::ZERO);
}

#[test]
fn velocities_between_points_are_those_of_a_plane_through_them() {
    let mut flow = Flow::new(&Setup::new(Grid::unit_cube(8), Vessel::Box)).expect("a flow");
    flow.set_velocity(&|p| DVec3::new(p.x + 2.0 * p.y, 3.0 * p.z, p.x)).expect("finite");
    let point = Vec3::new(0.41, 0.53, 0.37);
    let exact = Vec3::new(0.41 + 1.06, 1.11, 0.41);
    assert!((flow.velocity_at(point) - exact).length() < 1e-5);
    assert!(flow.velocity_at(Vec3::splat(f32::NAN)).is_finite());
    assert!(flow.velocity_at(Vec3::splat(1e30)).is_finite());
}

#[test]
fn bits_depend_on_neither_threads_nor_the_width_of_a_wide_class() {
    let run = |threads, simd, n: usize, steps| {
        let pool = Arc::new(Pool::new(threads, false));
        let mut flow = Flow::new(&Setup { pool, simd, ..pot(n) }).expect("a flow");
        stirred(&mut flow, steps, 0.5, 0.01);
        bits(&flow)
    };
    let widest = SimdClass::detect();
    let one = run(1, widest, 64, 4);
    assert!(one.iter().any(|bits| *bits != 0));
    assert!(one == run(2, widest, 64, 4));
    let one = run(1, widest, 32, 20);
    assert!(one == run(2, widest, 32, 20));
    assert!(one == run(1, widest.min(SimdClass::Avx2), 32, 20));
    let portable = SimdClass::Portable;
    assert!(run(1, portable, 32, 20) == run(3, portable, 32, 20));
}

#[test]
fn liquid_left_alone_comes_to_rest_and_sleeps() {
    let mut flow = Flow::new(&Setup { viscosity_m2_s: 1e-2, ..pot(16) }).expect("a flow");
    assert!(flow.step(0.01).expect("finite").asleep);
    stirred(&mut flow, 10, 0.05, 0.01);
    assert!(flow.kinetic_energy_j() > 0.0);
    let asleep = (0..2000).find(|_| flow.step(0.01).expect("finite").asleep);
    assert!(asleep.is_some(), "{}", flow.kinetic_energy_j());
    assert_eq!(flow.kinetic_energy_j(), 0.0);
    let report = flow.step(0.01).expect("finite");
    assert_eq!((report.scheme, report.substeps), (Scheme::Rest, 0));
}

#[test]
fn what_is_not_finite_is_refused_by_name_and_changes_nothing() {
    let mut flow = Flow::new(&pot(16)).expect("a flow");
    stirred(&mut flow, 3, 0.05, 0.01);
    let before = bits(&flow);
    let at = Vec3::splat(0.13);
    let nan = DVec3::new(0.0, f64::NAN, 0.0);
    assert_eq!(flow.push(at, 0.01, nan).expect_err("NaN").what, "impulse_n_s");
    assert_eq!(flow.push(at, f32::INFINITY, DVec3::X).expect_err("inf").what, "radius_m");
    let nowhere = Vec3::new(0.0, f32::NAN, 0.0);
    assert_eq!(flow.push(nowhere, 0.01, DVec3::X).expect_err("NaN").what, "centre_in_world_m");
    assert_eq!(flow.step(f64::NAN).expect_err("NaN").what, "dt_s");
    assert_eq!(flow.step(-1.0).expect_err("negative").value, -1.0);
    assert_eq!(flow.set_velocity(&|_| nan).expect_err("NaN").what, "velocity_m_s");
    assert_eq!(flow.set_force(&|_| nan).expect_err("NaN").what, "acceleration_m_s2");
    assert_eq!(flow.scale_force(f64::INFINITY, 1.0).expect_err("inf").what, "force scale");
    assert!(flow.set_viscosity_m2_s(-1.0).is_err());
    assert_eq!(before, bits(&flow));
}

#[test]
fn nothing_a_hand_does_blows_up() {
    for viscosity_m2_s in [0.0, 1e-5, 1e-2, 1e4] {
        for (force_n, dt_s) in [(0.05, 0.01), (1e3, 0.01), (1e3, 1.0), (1e9, 1e-4)] {
            let mut flow = Flow::new(&Setup { viscosity_m2_s, ..pot(16) }).expect("a flow");
            let (report, _) = stirred(&mut flow, 20, force_n, dt_s);
            let most = 0.5 * 1e8 * flow.cell_mass_kg() * flow.liquid_cells() as f64;
            assert!(report.kinetic_energy_j <= most, "{viscosity_m2_s} {force_n} {dt_s}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_box_any_push_any_step_stays_finite_and_within_its_energy(
        cells in [1usize..9, 1usize..9, 1usize..9],
        viscosity_m2_s in prop_oneof![Just(0f32), 1e-6f32..1.0, Just(1e4f32)],
        is_sticky in any::<bool>(),
        pushes in prop::collection::vec((0f32..1.0, -1e3..1e3, 1e-4..2.0), 1..8),
    ) {
        let grid = Grid { cells, spacing_m: 0.01, origin_in_world_m: Vec3::ZERO };
        let walls = if is_sticky { Walls::NoSlip } else { Walls::FreeSlip };
        let sides = Sides::of_vessel(walls);
        let setup = Setup { viscosity_m2_s, sides, ..Setup::new(grid, Vessel::Box) };
        let mut flow = Flow::new(&setup).expect("a flow");
        for (place, impulse, dt_s) in pushes {
            let at = grid.extent_m() * Vec3::new(place, 1.0 - place, 0.5);
            flow.push(at, 0.02, DVec3::new(impulse, -impulse, 0.3 * impulse)).unwrap();
            let before = flow.kinetic_energy_j();
            let report = flow.step(dt_s).unwrap();
            prop_assert!(report.kinetic_energy_j <= 1.002 * before);
            let mut is_finite = true;
            flow.visit(&mut |_, _, value| is_finite &= value.is_finite());
            prop_assert!(is_finite);
        }
    }
}
