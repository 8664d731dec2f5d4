use std::sync::Arc;

use super::*;
use crate::{
    pool::Pool,
    scenes::{INDEX, Probe, Scene},
    simd::SimdClass,
};

const AHEAD_S: f32 = 0.02;

/// What is baked of a scene with the probe at the surface, which got a push a step ago.
fn baked(scene: &Scene, pushed_n_s: f64) -> (Baker, Pot, Baked) {
    let mut pot = Pot::new(scene, Arc::new(Pool::inline()), SimdClass::detect()).unwrap();
    let feel = &scene.feel;
    let mut baker = Baker::new(&pot, feel.world_from_device, feel.felt_scale, 0.03);
    baker.aim(&pot, Vec3::ZERO);
    pot.place_probe(Vec3::ZERO);
    pot.take(glam::DVec3::ZERO, pushed_n_s, 0.01);
    pot.step(0.01);
    pot.look_ahead(AHEAD_S);
    let life = Life { from: Ticks(0), until: Ticks(10), ahead_s: AHEAD_S };
    match baker.bake(&pot, 0.01, life) {
        Update::Field(baked) => (baker, pot, baked),
        Update::Keep(_) => panic!("a first field cannot be kept"),
    }
}

fn scene(density_kg_m3: Option<f32>) -> Scene {
    let mut scene = Scene { probe: Probe { radius_m: 0.02, density_kg_m3 }, ..(INDEX[0].make)() };
    scene.regrid(16);
    scene
}

#[test]
fn what_has_no_weight_sends_no_byte_of_it() {
    let (_, _, weightless) = baked(&scene(None), 0.0);
    assert!(!weightless.head.channels.contains(Channel::BIAS_Y));
    let (_, _, heavy) = baked(&scene(Some(500.0)), 0.0);
    assert_eq!(heavy.samples.len(), weightless.samples.len() + NODES * NODES * NODES);
}

#[test]
fn the_bias_of_a_node_is_its_felt_weight_and_buoyancy_and_rides_on_the_waves() {
    let scene = scene(Some(700.0));
    let (baker, pot, baked) = baked(&scene, -5e-3);
    let surface = pot.surface().unwrap();
    let (sunk_m, sinking_m_s) = surface.at(Vec3::ZERO);
    assert!(sunk_m < -1e-4 && sinking_m_s < -0.01, "{sunk_m} m, {sinking_m_s} m/s");
    let floating = pot.floating().unwrap();
    let first = Channel::FLOW.and(Channel::DRAG).count() * NODES * NODES * NODES;
    let quantum = baked.head.quanta[Channel::BiasY as usize];
    for n in 0..NODES * NODES * NODES {
        let node = [n % NODES, n / NODES % NODES, n / (NODES * NODES)];
        let at = baker.node(&pot, node);
        let depth_m = f64::from(surface.ahead(at).0 - at.y);
        let wanted_n = scene.feel.felt_scale * floating.force_n(depth_m) as f32;
        let sent_n = f32::from(baked.samples[first + n]) * quantum;
        assert!((sent_n - wanted_n).abs() <= quantum, "{node:?}: {sent_n} {wanted_n} N");
    }
    let patch = baked.head.patch.unwrap();
    assert_eq!(baked.samples.len() - first - NODES * NODES * NODES, 4 * patch.node_count());
}

#[test]
fn the_pull_force_is_felt_as_the_break_force_is() {
    let (baker, pot, _) = baked(&scene(None), 0.0);
    assert!((baker.pull_force_n(&pot) - 6.0 * 0.085).abs() < 1e-6);
}
