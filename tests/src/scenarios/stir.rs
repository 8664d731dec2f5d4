//! A hand stirs: the liquid resists, is set in motion, and gets just the impulse that the hand
//! gave.

use cauldron_protocol::state::Flags;

use super::stirred_cauldron;
use crate::scenario::{Scenario, must};

pub const SCENARIO: Scenario = Scenario {
    name: "stir",
    about: "a hand stirs the pot in circles",
    scene: || stirred_cauldron(2.5),
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
