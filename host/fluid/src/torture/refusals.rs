//! Inputs that are not finite, and the names they have to be refused by.

use glam::{DVec3, Vec3};

use super::world::World;
use crate::{
    grid::Grid,
    solver::{
        Obstacle, Setup, SetupError, Side, Sides, Solver,
        flow::{Drag, Flow, Medium},
    },
};

/// One input: the name that its refusal has to contain, and how a bad value is offered to it.
struct Input {
    name: &'static str,
    offer: fn(&mut World<'_>, f64) -> Result<(), String>,
}

/// Every input of the flow and of the substances that takes a number.
const INPUTS: &[Input] = &[
    Input { name: "dt_s", offer: |world, bad| said(world.flow.step(bad).map(drop)) },
    Input {
        name: "dt_s",
        offer: |world, bad| said(world.substances.step(&world.flow, bad).map(drop)),
    },
    Input {
        name: "velocity_m_s",
        offer: |world, bad| said(world.flow.set_velocity(&|_| DVec3::splat(bad))),
    },
    Input {
        name: "acceleration_m_s2",
        offer: |world, bad| said(world.flow.set_force(&|_| DVec3::splat(bad))),
    },
    Input { name: "force scale", offer: |world, bad| said(world.flow.scale_force(1.0, bad)) },
    Input { name: "force scale", offer: |world, bad| said(world.flow.scale_force(bad, 1.0)) },
    Input {
        name: "viscosity_m2_s",
        offer: |world, bad| said(world.flow.set_viscosity_m2_s(bad as f32)),
    },
    Input {
        name: "gravity_m_s2",
        offer: |world, bad| said(world.flow.set_gravity_m_s2(Vec3::splat(bad as f32))),
    },
    Input { name: "density_kg_m3", offer: |world, bad| fill(world, bad, 1.0) },
    Input { name: "viscosity_m2_s", offer: |world, bad| fill(world, 1.0, bad) },
    Input { name: "impulse_n_s", offer: |world, bad| push(world, middle(world), 0.0, bad) },
    Input { name: "radius_m", offer: |world, bad| push(world, middle(world), bad as f32, 1.0) },
    Input { name: "centre_in_world_m", offer: |world, bad| push(world, at(bad), 0.0, 1.0) },
    Input {
        name: "viscosity_m2_s",
        offer: |world, bad| make(Setup { viscosity_m2_s: bad as f32, ..world.setup.clone() }),
    },
    Input {
        name: "density_kg_m3",
        offer: |world, bad| make(Setup { density_kg_m3: bad as f32, ..world.setup.clone() }),
    },
    Input {
        name: "spacing_m",
        offer: |world, bad| {
            make(Setup {
                grid: Grid { spacing_m: bad as f32, ..world.setup.grid },
                ..world.setup.clone()
            })
        },
    },
    Input {
        name: "origin_in_world_m",
        offer: |world, bad| {
            make(Setup {
                grid: Grid { origin_in_world_m: at(bad), ..world.setup.grid },
                ..world.setup.clone()
            })
        },
    },
    Input {
        name: "velocity of a side",
        offer: |world, bad| {
            make(Setup { sides: Sides::all(Side::Moving(at(bad))), ..world.setup.clone() })
        },
    },
    Input {
        name: "velocity of a side",
        offer: |world, bad| {
            make(Setup { sides: Sides::all(Side::Inflow(at(bad))), ..world.setup.clone() })
        },
    },
    Input { name: "radius_m", offer: |world, bad| put(world, middle(world), bad as f32, 0.0) },
    Input { name: "centre_in_world_m", offer: |world, bad| put(world, at(bad), 1.0, 0.0) },
    Input { name: "velocity_m_s", offer: |world, bad| put(world, middle(world), 1.0, bad) },
    Input { name: "centre_in_world_m", offer: |world, bad| pour(world, at(bad), 1.0, 1.0) },
    Input { name: "radius_m", offer: |world, bad| pour(world, Vec3::ZERO, bad as f32, 1.0) },
    Input { name: "centre_in_world_m", offer: |world, bad| drag(world, at(bad), 1.0, 1.0, 1.0) },
    Input { name: "radius_m", offer: |world, bad| drag(world, Vec3::ZERO, bad, 1.0, 1.0) },
    Input { name: "drag_n_s_per_m", offer: |world, bad| drag(world, Vec3::ZERO, 1.0, bad, 1.0) },
    Input { name: "velocity_m_s", offer: |world, bad| drag(world, Vec3::ZERO, 1.0, 1.0, bad) },
    Input { name: "fraction_per_s", offer: |world, bad| pour(world, Vec3::ZERO, 1.0, bad as f32) },
    Input { name: "centre_in_world_m", offer: |world, bad| drain(world, at(bad), 1.0, 1.0) },
    Input { name: "radius_m", offer: |world, bad| drain(world, Vec3::ZERO, bad as f32, 1.0) },
    Input { name: "share_per_s", offer: |world, bad| drain(world, Vec3::ZERO, 1.0, bad as f32) },
];

fn said<E: std::fmt::Display>(result: Result<(), E>) -> Result<(), String> {
    result.map_err(|refused| refused.to_string())
}

fn make(setup: Setup) -> Result<(), String> {
    said::<SetupError>(Flow::new(&setup).map(drop))
}

fn fill(world: &mut World<'_>, density_kg_m3: f64, viscosity_m2_s: f64) -> Result<(), String> {
    said(world.flow.set_medium(&|_| Medium { density_kg_m3, viscosity_m2_s }))
}

fn push(world: &mut World<'_>, centre: Vec3, radius_m: f32, impulse: f64) -> Result<(), String> {
    said(world.flow.push(centre, radius_m, DVec3::new(0.0, impulse, 0.0)).map(drop))
}

fn drag(
    world: &mut World<'_>,
    centre_in_world_m: Vec3,
    radius_m: f64,
    drag_n_s_per_m: f64,
    speed_m_s: f64,
) -> Result<(), String> {
    let velocity_m_s = Vec3::new(0.0, speed_m_s as f32, 0.0);
    let (radius_m, drag_n_s_per_m) = (radius_m as f32, drag_n_s_per_m as f32);
    let drag = Drag { centre_in_world_m, radius_m, drag_n_s_per_m, velocity_m_s };
    said(world.flow.couple(Some(drag)))
}

fn put(world: &mut World<'_>, centre: Vec3, radius_m: f32, speed_m_s: f64) -> Result<(), String> {
    let mut ball = Obstacle::sphere(centre, radius_m);
    ball.motion.velocity_m_s.y = speed_m_s as f32;
    said(world.flow.add_obstacle(ball).map(drop))
}

fn pour(world: &mut World<'_>, centre: Vec3, radius_m: f32, per_s: f32) -> Result<(), String> {
    said(world.substances.pour(0, centre, radius_m, per_s, 0.01))
}

fn drain(world: &mut World<'_>, centre: Vec3, radius_m: f32, per_s: f32) -> Result<(), String> {
    said(world.substances.drain(centre, radius_m, per_s, 0.01))
}

fn middle(world: &World<'_>) -> Vec3 {
    world.setup.grid.origin_in_world_m + 0.5 * world.setup.grid.extent_m()
}

fn at(bad: f64) -> Vec3 {
    Vec3::new(0.0, bad as f32, 0.0)
}

/// Offers a random bad value to a random input. It has to be refused by the input's name, and
/// to change no bit.
///
/// # Errors
/// What happened instead, in words.
pub fn offer_one(world: &mut World<'_>) -> Result<(), String> {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][world.draw(3)];
    let index = world.draw(INPUTS.len());
    offer(world, &INPUTS[index], bad)
}

fn offer(world: &mut World<'_>, input: &Input, bad: f64) -> Result<(), String> {
    let before = world.fingerprint();
    match (input.offer)(world, bad) {
        Ok(()) => Err(format!("{} = {bad} was taken", input.name)),
        Err(said) if !said.contains(input.name) => {
            Err(format!("{} = {bad} was refused as '{said}'", input.name))
        }
        Err(_) if world.fingerprint() != before => {
            Err(format!("{} = {bad} was refused, but changed bits", input.name))
        }
        Err(_) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{pool::Pool, simd::SimdClass, torture::draw::Case};

    #[test]
    fn every_input_is_refused_by_name_and_changes_no_bits() {
        let mut case = Case::of_seed(2);
        case.set_cells([6, 7, 5], false);
        let mut world =
            World::new(&case, &Arc::new(Pool::inline()), SimdClass::detect()).expect("a world");
        world.pour_or_drain(0).expect("finite");
        for input in INPUTS {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert_eq!(offer(&mut world, input, bad), Ok(()));
            }
        }
        let fine = Input { name: "dt_s", offer: |world, _| said(world.step(0.01).map(drop)) };
        assert!(offer(&mut world, &fine, 0.0).is_err(), "what is taken is told");
    }
}
