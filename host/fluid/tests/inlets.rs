//! Sides whose velocity differs from place to place.

use cauldron_fluid::{
    Grid, Vessel,
    solver::{Obstacle, Setup, Side, Sides, Solver, flow::Flow},
};
use glam::{DVec3, Vec3};

/// Between two plates at y = 0 and 1.
fn developed(p: DVec3) -> DVec3 {
    DVec3::new(4.0 * p.y * (1.0 - p.y), 0.0, 0.0)
}

fn channel(n: usize, ends: [Side; 2]) -> Flow {
    let sides = Sides::all(Side::FreeSlip).with(0, ends).with(1, [Side::NoSlip; 2]);
    let grid = Grid { cells: [2 * n, n, 1], ..Grid::unit_cube(n) };
    Flow::new(&Setup { viscosity_m2_s: 0.1, sides, ..Setup::new(grid, Vessel::Box) })
        .expect("a flow")
}

/// Root mean square of the difference to the parabola.
fn error(flow: &Flow) -> f64 {
    let (mut squares, mut count) = (0.0, 0);
    flow.visit(&mut |p, c, u| {
        squares += (u - developed(p)[c]).powi(2);
        count += 1;
    });
    (squares / f64::from(count)).sqrt()
}

#[test]
fn a_parabola_that_flows_in_stays_one() {
    for ends in [[Side::Inflow(Vec3::X), Side::Outflow], [Side::Inflow(Vec3::X); 2]] {
        let mut flow = channel(8, ends);
        flow.set_side_velocities(&|_, _, p| developed(p)).expect("balanced");
        for _ in 0..320 {
            flow.step(0.03).expect("finite");
        }
        // It is one of the scheme's own, too.
        assert!(error(&flow) < 1e-5, "{} with {ends:?}", error(&flow));
    }
}

#[test]
fn a_constant_velocity_is_that_of_the_side_itself() {
    let velocity = Vec3::new(0.3, 0.0, 0.1);
    let run = |is_set: bool| {
        let lid = Side::Moving(if is_set { Vec3::X } else { velocity });
        let sides = Sides::all(Side::NoSlip).with(1, [Side::NoSlip, lid]);
        let setup =
            Setup { viscosity_m2_s: 0.01, sides, ..Setup::new(Grid::unit_cube(8), Vessel::Box) };
        let mut flow = Flow::new(&setup).expect("a flow");
        if is_set {
            // What would lift the lid is left out.
            let given = velocity.as_dvec3() + DVec3::Y;
            flow.set_side_velocities(&|_, _, _| given).expect("finite");
        }
        let mut bits = Vec::new();
        for _ in 0..10 {
            flow.step(0.02).expect("finite");
        }
        flow.visit(&mut |_, _, u| bits.push(u.to_bits()));
        bits
    };
    assert!(run(true) == run(false));
}

#[test]
fn what_is_sampled_unevenly_is_balanced_and_what_does_not_fit_is_refused() {
    let mut flow = channel(8, [Side::Inflow(Vec3::X); 2]);
    let plug = |_: usize, end: usize, p: DVec3| match end {
        0 => developed(p),
        _ => DVec3::X * 2.0 / 3.0,
    };
    flow.set_side_velocities(&plug).expect("the same to 1 %");
    flow.step(0.01).expect("finite");
    assert!(flow.divergence_max_per_s() < 1e-3);
    let refused = flow.set_side_velocities(&|_, end, _| DVec3::X * (1.0 + end as f64));
    assert_eq!(refused.expect_err("too much").what, "net inflow in m^3/s without an outflow");
    let refused = flow.set_side_velocities(&|_, _, p| DVec3::X / (p.z - p.z));
    assert_eq!(refused.expect_err("not finite").what, "velocity of a side in m/s");
}

#[test]
fn a_stream_goes_round_a_ball_with_what_came_in() {
    let sides = Sides::all(Side::FreeSlip).with(0, [Side::Inflow(Vec3::X); 2]);
    let mut flow = Flow::new(&Setup { sides, ..Setup::new(Grid::unit_cube(12), Vessel::Box) })
        .expect("a flow");
    // One that stands in the opening too: what it takes away of it is made up for.
    for centre in [Vec3::splat(0.5), Vec3::new(0.0, 0.5, 0.5)] {
        flow.add_obstacle(Obstacle::sphere(centre, 0.2)).expect("a ball");
        flow.set_side_velocities(&|_, _, p| DVec3::X * p.y).expect("balanced");
        for _ in 0..5 {
            flow.step(0.02).expect("finite");
            assert!(flow.divergence_max_per_s() < 1e-3);
        }
    }
}
