//! What tests of obstacles share: a ball, and the law that its jumps keep.

use std::f64::consts::PI;

use cauldron_fluid::{
    Grid, Vessel,
    solver::{Motion, Obstacle, ObstacleId, Setup, Side, Sides, Solver, Walls, flow::Flow},
};
use glam::Vec3;
use proptest::{prelude::*, test_runner::TestCaseError};

/// Off the symmetry of the grid.
pub const CENTRE: Vec3 = Vec3::new(0.47, 0.52, 0.51);

pub fn with_ball(setup: &Setup, radius_m: f32) -> (Flow, ObstacleId) {
    let mut flow = Flow::new(setup).expect("a flow");
    let ball = flow.add_obstacle(Obstacle::sphere(CENTRE, radius_m)).expect("a ball");
    (flow, ball)
}

pub fn ball_m3(radius_m: f32) -> f64 {
    4.0 / 3.0 * PI * f64::from(radius_m).powi(3)
}

/// Hasimoto (J. Fluid Mech. 5, 1959): drag on each ball of a cubic array that fills the part c,
/// over Stokes' for the mean velocity.
pub fn hasimoto(c: f64) -> f64 {
    1.0 / (1.0 - 1.7601 * c.cbrt() + c - 1.5593 * c * c)
}

/// A box without ends.
pub fn periodic(n: usize, viscosity_m2_s: f32, walls: Walls) -> Setup {
    let sides = Sides::all(Side::Periodic);
    Setup { sides, walls, viscosity_m2_s, ..Setup::new(Grid::unit_cube(n), Vessel::Box) }
}

/// Where a ball is next, how fast it is there, and how long.
pub type Jump = ([f32; 3], [f32; 3], f64);

/// Any jump within the box, or a little out of it.
pub fn jump() -> impl Strategy<Value = Jump> {
    (prop::array::uniform3(-0.5f32..1.5), prop::array::uniform3(-2f32..2.0), 1e-4..1.0)
}

/// A small vessel of inviscid liquid, no two edges of its grid alike, with `side` at both ends
/// of x.
pub fn vessel_to_jump_in(is_sticky: bool, is_pot: bool, side: Side) -> Setup {
    let grid = Grid { cells: [9, 8, 7], ..Grid::unit_cube(8) };
    let walls = if is_sticky { Walls::NoSlip } else { Walls::FreeSlip };
    let pot = Vessel::Pot { centre_in_world_m: Vec3::splat(0.5), radius_m: 0.45 };
    let vessel = if is_pot { pot } else { Vessel::Box };
    let sides = Sides::all(Side::of(walls)).with(0, [side; 2]);
    Setup { viscosity_m2_s: 0.0, walls, sides, ..Setup::new(grid, vessel) }
}

/// Lets a ball jump, and asks that liquid of at most this density gains no more than the ball's
/// work, and what there is in the space that it sweeps may have at its speed.
pub fn ask_for_the_energy_of_jumps(
    (mut flow, ball): (Flow, ObstacleId),
    radius_m: f32,
    densest_kg_m3: f64,
    jumps: Vec<Jump>,
) -> Result<(), TestCaseError> {
    for (at, velocity, dt_s) in jumps {
        let (at, velocity) = (Vec3::from_array(at), Vec3::from_array(velocity));
        flow.move_obstacle(ball, Motion::moving(at, velocity)).expect("finite");
        let before_j = flow.kinetic_energy_j();
        flow.step(dt_s).expect("finite");
        let force_on_n = flow.force_on_n(ball).expect("there");
        let mut is_finite = force_on_n.is_finite();
        flow.visit(&mut |_, _, u| is_finite &= u.is_finite());
        prop_assert!(is_finite);
        let work_j = -dt_s * force_on_n.dot(velocity.as_dvec3());
        let way_m = f64::from(velocity.abs().element_sum()) * dt_s;
        let reach_m = f64::from(radius_m) + 0.125;
        let swept_kg = densest_kg_m3 * way_m * PI * reach_m * reach_m;
        let gain_j = flow.kinetic_energy_j() - before_j;
        let most_j = 1.1 * work_j.max(0.0) + swept_kg * (way_m / dt_s).powi(2);
        prop_assert!(gain_j <= most_j, "{gain_j} J of {work_j} J");
    }
    Ok(())
}
