//! Walls that cut cells, against closed forms: at rest, in a pipe, in a bowl, and against any step.

use std::f64::consts::PI;

use cauldron_fluid::{
    Grid, Vessel,
    solver::{Setup, Side, Sides, Solver, Walls, flow::Flow},
};
use glam::{DVec3, Vec3};
use proptest::prelude::*;

const RADIUS_M: f32 = 0.4;

/// What flows through a pipe along z under an acceleration, over what Hagen and Poiseuille say.
fn discharge(n: usize, centre_in_world_m: Vec3) -> f64 {
    let (spacing_m, viscosity_m2_s) = (1.0 / n as f32, 1.0);
    let grid = Grid { cells: [n, n, 2], spacing_m, origin_in_world_m: Vec3::ZERO };
    let vessel = Vessel::Cylinder { centre_in_world_m, axis: Vec3::Z, radius_m: RADIUS_M };
    let sides = Sides::all(Side::FreeSlip).with(2, [Side::Periodic; 2]);
    let walls = Walls::NoSlip;
    let setup = Setup { walls, viscosity_m2_s, sides, ..Setup::new(grid, vessel) };
    let mut flow = Flow::new(&setup).expect("a flow");
    flow.set_force(&|_| DVec3::Z).expect("finite");
    for _ in 0..100 {
        assert_eq!(flow.step(0.004).expect("finite").guard_actions, 0);
    }
    let momentum = flow.momentum_n_s();
    assert!(momentum.x.abs() + momentum.y.abs() < 1e-5 * momentum.z, "{momentum}");
    let flow_m3_s = momentum.z / 1000.0 / f64::from(2.0 * spacing_m);
    flow_m3_s / (PI * f64::from(RADIUS_M).powi(4) / 8.0)
}

#[test]
fn what_flows_through_a_pipe_converges_wherever_it_stands() {
    for centre in [Vec3::splat(0.5), Vec3::new(0.513, 0.487, 0.0)] {
        let errors = [16, 32].map(|n| (discharge(n, centre) - 1.0).abs());
        assert!(errors[0] < 0.04 && errors[1] < 0.01, "{errors:?} at {centre}");
    }
}

#[test]
fn liquid_rests_under_gravity_in_a_pot() {
    let pot = Vessel::Pot { centre_in_world_m: Vec3::splat(0.52), radius_m: 0.45 };
    for walls in [Walls::FreeSlip, Walls::NoSlip] {
        let setup =
            Setup { walls, viscosity_m2_s: 1e-3, ..Setup::new(Grid::unit_cube(16), pot.clone()) };
        let mut flow = Flow::new(&setup).expect("a flow");
        flow.set_force(&|_| DVec3::new(1.0, -9.81, 2.0)).expect("finite");
        let mut worst_m_s = 0f64;
        for _ in 0..50 {
            flow.step(0.02).expect("finite");
            flow.visit(&mut |_, _, u| worst_m_s = worst_m_s.max(u.abs()));
        }
        // In free fall it would be at 10 m/s.
        assert!(worst_m_s < 1e-4, "{worst_m_s}");
    }
}

#[test]
fn inviscid_flow_in_a_bowl_keeps_its_energy_and_its_volume() {
    let bowl = Vessel::Bowl { centre_in_world_m: Vec3::new(0.5, 0.7, 0.5), radius_m: 0.45 };
    let mut flow = Flow::new(&Setup::new(Grid::unit_cube(24), bowl)).expect("a flow");
    flow.set_velocity(&|p| DVec3::new((9.0 * p.y).sin(), (7.0 * p.z).cos(), (8.0 * p.x).sin()))
        .expect("finite");
    let divergence_per_s = flow.divergence_max_per_s();
    flow.project();
    let before_j = flow.kinetic_energy_j();
    for _ in 0..100 {
        flow.step(0.004).expect("finite");
    }
    let kept = flow.kinetic_energy_j() / before_j;
    assert!((0.99..1.002).contains(&kept), "kept {kept}");
    assert!(flow.divergence_max_per_s() < 1e-4 * divergence_per_s);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_vessel_any_push_any_step_stays_finite_and_within_its_energy(
        centre in [0.0f32..1.0, 0.0f32..1.0, 0.0f32..1.0],
        normal in [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0],
        radius_m in 0.02f32..0.8,
        is_plane in any::<bool>(),
        is_sticky in any::<bool>(),
        viscosity_m2_s in prop_oneof![Just(0f32), 1e-5f32..1.0, Just(1e3f32)],
        pushes in prop::collection::vec((0f32..1.0, -1e3..1e3, 1e-4..1.0), 1..8),
    ) {
        let grid = Grid { cells: [9, 8, 7], ..Grid::unit_cube(8) };
        let centre = Vec3::from_array(centre);
        let normal = Vec3::from_array(normal).normalize_or(Vec3::Y);
        let vessel = if is_plane {
            Vessel::from_distance(&grid, |p| (p - centre).dot(normal)).expect("finite")
        } else {
            Vessel::Bowl { centre_in_world_m: centre, radius_m }
        };
        let walls = if is_sticky { Walls::NoSlip } else { Walls::FreeSlip };
        let sides = Sides::of_vessel(walls);
        let setup = Setup { viscosity_m2_s, walls, sides, ..Setup::new(grid, vessel) };
        let mut flow = Flow::new(&setup).expect("a flow");
        for (place, impulse, dt_s) in pushes {
            let at = centre + 0.1 * Vec3::splat(place);
            flow.push(at, 0.3, DVec3::new(impulse, -impulse, 0.3 * impulse)).expect("finite");
            let before_j = flow.kinetic_energy_j();
            let report = flow.step(dt_s).expect("finite");
            prop_assert!(report.kinetic_energy_j <= 1.002 * before_j);
            let mut is_finite = true;
            flow.visit(&mut |_, _, u| is_finite &= u.is_finite());
            prop_assert!(is_finite);
        }
    }
}
