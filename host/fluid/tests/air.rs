//! The gas above the liquid against closed forms, and its books.

use std::sync::Arc;

use cauldron_fluid::{
    Grid, Pot, Vessel, air::Air, pool::Pool, scenes, simd::SimdClass, solver::Solver,
};
use glam::{DVec3, Vec3};

const ROOM: Grid = Grid { cells: [24, 1, 24], spacing_m: 0.01, origin_in_world_m: Vec3::ZERO };

fn gas() -> scenes::Gas {
    scenes::Gas { height_m: 0.24, ..scenes::find("fumes").expect("a scene").gas.expect("gas") }
}

fn air(gas: &scenes::Gas, vessel: &Vessel) -> Air {
    let simd = SimdClass::detect();
    Air::new(gas, (&ROOM, vessel), 9.81, Arc::new(Pool::inline()), simd).expect("gas")
}

fn breathe(air: &mut Air, steps: usize) -> u32 {
    let acts = |_| air.step(0.01, |_| 0.0).expect("finite").guard_actions;
    (0..steps).map(acts).sum()
}

#[test]
fn no_vents_and_no_wind_is_no_work() {
    let mut air = air(&scenes::Gas { vents: 0, ..gas() }, &Vessel::Box);
    for _ in 0..5 {
        assert!(air.step(0.01, |_| 0.0).expect("finite").asleep);
    }
    assert_eq!(air.smoke().volume_m3(0), 0.0);
}

/// Warm gas is as hot as the vents where there is nothing else, and as the room where there is
/// none; between, 1/T mixes.
#[test]
fn gas_is_between_the_room_and_the_vents() {
    let mut air = air(&gas(), &Vessel::Box);
    breathe(&mut air, 60);
    let mut hottest = 0f32;
    let [nx, ny, nz] = air.grid().cells;
    for (i, j, k) in
        (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))))
    {
        let kelvin = air.temperature_k(air.grid().centre_in_world_m(i, j, k));
        assert!((292.999..=323.001).contains(&kelvin), "{kelvin}");
        hottest = hottest.max(kelvin);
    }
    assert!(hottest > 310.0, "{hottest}");
    assert_eq!(air.temperature_k(Vec3::splat(-1.0)), 293.0);
}

#[test]
fn smoke_rises_as_warmth_carries_it_and_stays_low_without() {
    let mean_height_m = |hotter_k: f32| {
        let mut air = air(&scenes::Gas { hotter_k, ..gas() }, &Vessel::Box);
        breathe(&mut air, 80);
        let view = air.view();
        let [nx, ny, nz] = view.grid.cells;
        let (mut sum, mut all) = (0.0, 0.0);
        for (i, j, k) in
            (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))))
        {
            let part = view.fraction[view.grid.cell(i, j, k)];
            sum += part * (view.grid.centre_in_world_m(i, j, k).y - view.grid.origin_in_world_m.y);
            all += part;
        }
        sum / all
    };
    let (cold_m, warm_m, hot_m) = (mean_height_m(0.0), mean_height_m(10.0), mean_height_m(30.0));
    assert!(
        cold_m < 0.01 && warm_m > 1.2 * cold_m && hot_m > 1.3 * warm_m,
        "{cold_m} {warm_m} {hot_m}"
    );
}

/// What is there was poured, and only the open sides let any out.
#[test]
fn smoke_is_kept_until_it_drifts_out() {
    let mut air = air(&scenes::Gas { height_m: 0.08, ..gas() }, &Vessel::Box);
    let mut lost_m3 = 0.0;
    for _ in 0..300 {
        breathe(&mut air, 1);
        let lost_now_m3 = air.smoke().poured_m3(0) - air.smoke().volume_m3(0);
        assert!(lost_now_m3 > lost_m3 - 1e-5 * air.smoke().poured_m3(0));
        lost_m3 = lost_now_m3;
    }
    assert!(lost_m3 > 0.1 * air.smoke().poured_m3(0), "{lost_m3}");
}

#[test]
fn vents_are_over_the_liquid_and_ride_on_it() {
    let pot = Vessel::Pot { centre_in_world_m: Vec3::new(0.12, 0.005, 0.12), radius_m: 0.05 };
    let mut air = air(&scenes::Gas { hotter_k: 0.0, ..gas() }, &pot);
    air.step(0.01, |_| 0.055).expect("finite");
    let view = air.view();
    let grid = view.grid;
    let mut found = 0;
    for (i, j, k) in
        (0..24).flat_map(|k| (0..24).flat_map(move |j| (0..24).map(move |i| (i, j, k))))
    {
        if view.fraction[grid.cell(i, j, k)] > 0.0 {
            let at = grid.centre_in_world_m(i, j, k);
            let from_axis_m = (at - Vec3::new(0.12, at.y, 0.12)).length();
            assert!(from_axis_m < 0.05 + 0.02 && (at.y - 0.065).abs() < 0.02, "{at}");
            found += 1;
        }
    }
    assert!(found > 0);
}

/// Gas sticks to the liquid below. One that begins to move at once drags it along by
/// u = U erfc(y / 2 sqrt(nu t)) (Stokes 1851), far from the sides through which calm gas comes in.
#[test]
fn a_liquid_that_moves_carries_the_gas_above_it() {
    let gas = scenes::Gas { vents: 0, ..gas() };
    let mut air = air(&gas, &Vessel::Box);
    air.carry(None).expect("finite");
    assert!(air.step(0.01, |_| 0.0).expect("finite").asleep, "at rest it is no work");
    let stream = |_| DVec3::new(0.1, 0.3, 0.0); // What rises does not go through the border.
    air.carry(Some(&stream)).expect("finite");
    breathe(&mut air, 50);
    // erfc(1/4), erfc(3/4), erfc(5/4) in the middles of the lowest cells, 2 sqrt(nu t) = 2 cm.
    for (row, exact) in [0.723674, 0.288844, 0.0770999].into_iter().enumerate() {
        let at = Vec3::new(0.14, 0.01 * (row as f32 + 1.5), 0.12);
        let carried = air.flow().velocity_at(at).x / 0.1;
        assert!((carried - exact).abs() < 0.02, "row {row}: {carried}, {exact}");
    }
    let broken = |_| DVec3::new(f64::NAN, 0.0, 0.0);
    assert!(air.carry(Some(&broken)).is_err());
    air.carry(None).expect("finite");
    let fastest = |air: &Air| air.flow().velocity_at(Vec3::new(0.14, 0.015, 0.12)).x;
    let before = fastest(&air);
    breathe(&mut air, 50);
    assert!(fastest(&air) < 0.6 * before, "and holds it when it has come to rest");
}

/// A ball of fluid that is a little lighter begins to rise by 2/3 of what its lightness alone would
/// accelerate it by: the fluid around it has to come down (as that of a ball's added mass, Lamb
/// 1932).
#[test]
fn a_warm_ball_begins_to_rise_as_lamb_says() {
    use cauldron_fluid::solver::{Setup, Side, Sides, flow::Flow};
    use cauldron_fluid::substance::{Properties, Substances};
    let n = 40;
    let setup = Setup {
        density_kg_m3: 1.2,
        gravity_m_s2: Vec3::NEG_Y * 9.81,
        sides: Sides::all(Side::Outflow).with(1, [Side::FreeSlip, Side::Outflow]),
        ..Setup::new(Grid::unit_cube(n), Vessel::Box)
    };
    let mut flow = Flow::new(&setup).expect("a flow");
    let light = Properties { density_kg_m3: 1.2 * 0.95, ..Properties::of_liquid(&setup) };
    let mut warmth = Substances::new(&setup, &[light]);
    let middle = Vec3::splat(0.5);
    let inside = |p: Vec3| ((0.12 - p.distance(middle)) * n as f32 + 0.5).clamp(0.0, 1.0);
    warmth.set_fraction(0, inside).expect("fractions");
    flow.set_mixture(&warmth);
    flow.step(1e-3).expect("finite");
    let rises_m_s2 = flow.velocity_at(middle).y / 1e-3;
    let expected_m_s2 = 2.0 / 3.0 * 0.05 * 9.81;
    assert!((rises_m_s2 / expected_m_s2 - 1.0).abs() < 0.05, "{rises_m_s2} {expected_m_s2}");
}

#[test]
fn a_pot_without_gas_has_none_and_one_with_it_is_the_same_below() {
    let make = |name: &str| {
        let scene = scenes::find(name).expect("a scene");
        let mut pot =
            Pot::new(&scene, Arc::new(Pool::inline()), SimdClass::detect()).expect("a pot");
        pot.pour(1, 0.01);
        for _ in 0..5 {
            pot.step(0.01);
        }
        pot
    };
    let (bare, fuming) = (make("cauldron"), make("fumes"));
    assert!(bare.air().is_none() && bare.snapshot().smoke.is_none());
    assert!(fuming.air().expect("air").smoke().volume_m3(0) > 0.0);
    let below = |pot: &Pot| pot.snapshot().substances[0].fraction.clone();
    assert_eq!(below(&bare), below(&fuming));
    let names = |pot: &Pot| {
        pot.plan().iter().filter(|i| i.how.is_some()).map(|i| i.name).collect::<Vec<_>>()
    };
    assert!(!names(&bare).contains(&"smoke") && names(&fuming).contains(&"warmth"));
}
