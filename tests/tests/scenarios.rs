//! The list on the simulated rig, a test for each scenario.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use cauldron_tests::{LIST, Rig, SimRig};

fn play(name: &str) {
    let scenario = LIST.iter().find(|s| s.name == name).unwrap();
    let trace = SimRig::new(1).play(scenario).unwrap();
    if let Err(wrong) = scenario.judge(&trace) {
        panic!("{name}: {wrong}\nreplay: cargo run -p cauldron-hil -- --rig sim --only '{name}'");
    }
}

macro_rules! scenarios {
    ($($test:ident: $name:literal,)*) => {
        $(#[test] fn $test() { play($name); })*
        const TESTED: &[&str] = &[$($name),*];
    };
}

scenarios! {
    free_air: "free air",
    wall: "wall",
    stir: "stir",
    through_the_surface: "through the surface",
    pull_out: "pull out",
    float: "float",
    ripple: "ripple",
    splash: "splash",
    unplug_while_pressing: "unplug while pressing",
    host_silent: "host silent",
    garbage_on_the_wire: "garbage on the wire",
}

#[test]
fn every_scenario_of_the_list_is_tested() {
    assert_eq!(LIST.iter().map(|s| s.name).collect::<Vec<_>>(), TESTED);
}
