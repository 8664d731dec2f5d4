//! A hand leans on a wall: the wall pushes by its stiffness, the proxy stays inside, and leaning
//! costs the hand energy but never gives it any.

use cauldron_fluid::scenes::Act;
use cauldron_protocol::state::Flags;
use glam::Vec3;

use super::scene;
use crate::{
    scenario::{Scenario, must},
    trace::position_m,
};

/// The probe's centre meets the floor of the empty box here.
pub const FLOOR_Y_M: f64 = -0.07;
pub const STIFFNESS_N_PER_M: f64 = 500.0;

pub const SCENARIO: Scenario = Scenario {
    name: "wall",
    about: "a hand leans on the floor of a box",
    scene: || {
        let acts = vec![
            Act::Rest { seconds: 0.5 },
            Act::Reach { to_m: Vec3::new(0.0, -0.074, 0.0), seconds: 0.8 },
            Act::Rest { seconds: 0.7 },
            Act::Reach { to_m: Vec3::ZERO, seconds: 0.6 },
        ];
        scene("empty", Vec3::ZERO, acts)
    },
    seconds: 3.0,
    events: &[],
    verdict: |trace| {
        let leaning = 1800;
        must(trace.has(leaning, Flags::ON_WALL), || "the wall is not touched".into())?;
        let state = &trace.states[leaning];
        let depth_m = FLOOR_Y_M - position_m(state).y;
        let push_n = f64::from(state.force[1].0);
        let wanted_n = STIFFNESS_N_PER_M * depth_m;
        must((push_n / wanted_n - 1.0).abs() < 0.05, || {
            format!("{push_n} N at {depth_m} m, wanted {wanted_n} N")
        })?;
        must(push_n > 0.5, || format!("only {push_n} N"))?;
        let proxy_y_m = f64::from(state.proxy[1].0);
        must((proxy_y_m - FLOOR_Y_M).abs() < 1e-5, || format!("the proxy is at {proxy_y_m} m"))?;
        let end = trace.states.len();
        must(trace.force_n(end - 1) == 0.0, || "a force is left in the air".into())?;
        let given_j = trace.energy_to_hand_j(0..end);
        must(given_j <= 1e-3, || format!("{given_j} J given to the hand"))
    },
};
