//! A hand stirs: the liquid resists, is set in motion, and gets just the impulse that the hand
//! gave.

use cauldron_fluid::scenes::Act;
use cauldron_protocol::state::Flags;
use glam::Vec3;

use super::small_cauldron;
use crate::scenario::{Scenario, must};

const CENTRE_M: Vec3 = Vec3::new(0.0, -0.05, 0.0);
const RADIUS_M: f32 = 0.045;

pub const SCENARIO: Scenario = Scenario {
    name: "stir",
    about: "a hand stirs the pot in circles",
    scene: || {
        let acts = vec![
            Act::Rest { seconds: 0.4 },
            Act::Reach { to_m: CENTRE_M - RADIUS_M * Vec3::Z, seconds: 0.8 },
            Act::Stir { centre_m: CENTRE_M, radius_m: RADIUS_M, seconds: 2.5 },
        ];
        small_cauldron(Vec3::new(0.0, 0.05, 0.0), acts)
    },
    seconds: 3.7,
    events: &[],
    verdict: |trace| {
        let stirring = 1500..3700;
        must(stirring.clone().all(|t| trace.has(t, Flags::WET)), || "the probe came out".into())?;
        let felt_n = trace.force_rms_n(stirring.clone());
        must(felt_n >= 0.05, || format!("only {felt_n} N rms"))?;
        let given_j = trace.energy_to_hand_j(stirring);
        must(given_j < 0.0, || format!("stirring gave the hand {given_j} J"))?;
        must(trace.impulse_n_s >= 0.01, || format!("{} N s", trace.impulse_n_s))?;
        let open = trace.momentum_residual_rel;
        must(open <= 1e-5, || format!("the books of momentum are open by {open}"))?;
        must(trace.counts.missed == 0, || format!("{} ticks missed", trace.counts.missed))
    },
};
