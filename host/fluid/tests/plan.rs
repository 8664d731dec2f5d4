//! What is planned is what is made, and no more.

use cauldron_fluid::{
    Grid, Pot, Vessel,
    plan::Item,
    pool::Pool,
    scenes,
    simd::SimdClass,
    solver::{Setup, flow::Flow},
    substance::{Properties, Substances},
};
use std::sync::Arc;

fn bytes(items: &[Item]) -> usize {
    items.iter().map(|item| item.bytes).sum()
}

fn is_on(items: &[Item], name: &str) -> bool {
    items.iter().find(|item| item.name == name).expect("it is listed").how.is_some()
}

#[test]
fn a_box_with_one_substance_takes_a_hundred_bytes_a_cell() {
    let grid = Grid::unit_cube(64);
    let setup = Setup { viscosity_m2_s: 1e-3, ..Setup::new(grid, Vessel::Box) };
    let flow = Flow::new(&setup).expect("a flow").plan();
    let substances = Substances::new(&setup, &[Properties::of_liquid(&setup)]).plan();
    let per_cell = (bytes(&flow) + bytes(&substances)) as f64 / grid.len() as f64;
    assert!(per_cell <= 100.0 && per_cell > 50.0, "{per_cell}");
}

#[test]
fn what_a_scene_lacks_is_off_and_takes_nothing() {
    let plan = |name: &str| {
        let scene = scenes::find(name).expect("it ships");
        let pot = Pot::new(&scene, Arc::new(Pool::inline()), SimdClass::detect()).expect("a pot");
        pot.plan()
    };
    for name in ["cauldron", "taylor-green", "empty"] {
        let off = plan(name).into_iter().filter(|item| item.how.is_none());
        assert!(off.into_iter().all(|item| item.bytes == 0), "{name}");
    }
    let (full, bare) = (plan("cauldron"), plan("taylor-green"));
    for part in ["walls", "substances", "surface"] {
        assert!(is_on(&full, part) && !is_on(&bare, part), "{part}");
    }
    assert!(!is_on(&plan("empty"), "liquid"));
    let surface = full.iter().find(|item| item.name == "surface").expect("it is listed");
    let how = surface.how.as_deref().expect("it is on");
    assert!(how.starts_with("wave, 64 x 64 nodes"), "what auto came to: {how}");
}
