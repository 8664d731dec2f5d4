//! What the hand feels, over whole runs.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use cauldron::world::{Options, World};
use cauldron_board_sim::{Act, Grip, PlantParams, Script, SimBoard};
use cauldron_firmware::presets::OMNI_LIKE;
use cauldron_fluid::scenes::{self, Probe, Scene};
use cauldron_protocol::{Limit, State, Supervisor, state::Flags};
use cauldron_tests::{Trace, trace::force_n};
use glam::DVec3;

fn cauldron() -> Scene {
    let mut scene = (scenes::INDEX[0].make)();
    scene.regrid(20);
    scene
}

fn run(world: &mut World, ticks: usize) -> Trace {
    let states = (0..ticks).map(|_| world.tick().unwrap()).collect();
    Trace { states, ..Trace::default() }
}

/// Mean of the force against the motion, which is what "costs force" means.
fn resistance_n(trace: &Trace) -> f64 {
    let wet: Vec<&State> =
        trace.states.iter().skip(1600).filter(|s| s.flags.contains(Flags::WET)).collect();
    let against = |s: &&State| {
        let velocity = DVec3::from_array(s.velocity.map(|v| f64::from(v.0)));
        -force_n(s).dot(velocity.normalize_or_zero())
    };
    wet.iter().map(against).sum::<f64>() / wet.len() as f64
}

fn stirred(viscosity_m2_s: f32) -> f64 {
    let mut scene = cauldron();
    if let Some(liquid) = &mut scene.liquid {
        liquid.viscosity_m2_s = viscosity_m2_s;
    }
    resistance_n(&run(&mut World::new(&scene, &Options::new(1)).expect("a world"), 4000))
}

#[test]
fn a_thick_liquid_costs_at_least_twice_the_force_of_a_thin_one() {
    let (thin, thick) = (stirred(2e-5), stirred(1e-3));
    assert!(thin > 0.0 && thick >= 2.0 * thin, "{thin} N thin, {thick} N thick");
}

#[test]
fn a_resting_hand_is_given_no_more_than_a_millijoule() {
    let mut scene = cauldron();
    scene.story.acts.clear();
    // In the liquid, at its surface, and leaning on the pot.
    let places = [
        [0.0, -0.04, 0.02],
        [0.0, -0.0003, 0.0],
        [0.0, -0.0005, 0.0],
        [0.0, -0.0008, 0.0],
        [0.0, -0.002, 0.0],
        [0.0, -0.04, 0.0548],
    ];
    for (start, seed) in places.map(DVec3::from_array).into_iter().flat_map(|p| [(p, 3), (p, 4)]) {
        let mut world = World::with_script(&scene, Script::resting(start), &Options::new(seed))
            .expect("a world");
        let trace = run(&mut world, 10_000);
        let given_j = trace.energy_to_hand_j(0..10_000);
        assert!(given_j <= 1e-3, "at {start}, seed {seed}: {given_j} J");
    }
}

/// As thick as honey: the drag could stop the liquid that it moves several times over within a
/// step. The loop must neither swing nor blow up.
#[test]
fn a_coupling_far_beyond_the_step_stays_calm() {
    let mut scene = cauldron();
    if let Some(liquid) = &mut scene.liquid {
        liquid.viscosity_m2_s = 0.2;
    }
    let mut world = World::new(&scene, &Options::new(1)).expect("a world");
    let pot = &world.host.pot;
    let drag = pot.drag().linear_n_s_per_m;
    world.host.pot.place_probe(glam::Vec3::new(0.0, -0.05, 0.0));
    let stiff = drag * f64::from(scene.step_s) / world.host.pot.moved_mass_kg().unwrap();
    assert!(stiff >= 4.0, "c dt/m = {stiff}");
    let trace = run(&mut world, 3000);
    let jump = |w: &[State]| (force_n(&w[1]) - force_n(&w[0])).length();
    let roughest_n = trace.states[1500..].windows(2).map(jump).fold(0.0, f64::max);
    assert!(roughest_n < 0.3, "{roughest_n} N in a tick");
    assert!(resistance_n(&trace) > 0.1, "{} N", resistance_n(&trace));
    assert!(world.host.pot.exchange().residual_rel() <= 1e-5);
    assert!(trace.energy_to_hand_j(1500..3000) < 0.0, "honey takes, it does not give");
}

/// Fields come at 100 Hz. Of that rate, and of half of it (states come four to a frame, so a
/// careless ledger gives the liquid a saw of 50 Hz), the hand must feel nothing: a line of 5 mN
/// is a quarter of the threshold (Lee & Hannaford 2003).
#[test]
fn the_refresh_of_the_field_is_not_felt() {
    let trace = run(&mut World::new(&cauldron(), &Options::new(1)).expect("a world"), 5000);
    for hertz in [50.0, 100.0] {
        let mut wave = [DVec3::ZERO; 2];
        for (tick, state) in trace.states.iter().enumerate().skip(2000) {
            let phase = std::f64::consts::TAU * hertz * tick as f64 * 1e-3;
            wave[0] += force_n(state) * phase.cos();
            wave[1] += force_n(state) * phase.sin();
        }
        let line_n = wave[0].length().hypot(wave[1].length()) * 2.0 / 3000.0;
        assert!(line_n > 0.0 && line_n < 5e-3, "{hertz} Hz: {line_n} N");
    }
}

/// In a pot at rest one field is sent, and then nothing but Keeps of it.
#[test]
fn a_field_that_was_lost_is_sent_again_even_if_nothing_changes() {
    let mut scene = cauldron();
    scene.story.acts.clear();
    let script = Script::resting(DVec3::new(0.0, -0.04, 0.02));
    let mut world = World::with_script(&scene, script, &Options::new(3)).expect("a world");
    while !world.host.session.is_running() {
        world.tick().unwrap();
    }
    world.host.session.transport.down.loss = 1.0;
    run(&mut world, 60);
    world.host.session.transport.down.loss = 0.0;
    let trace = run(&mut world, 400);
    let last = trace.states.last().unwrap();
    assert_eq!(last.supervisor, Supervisor::Running);
    assert!(last.field_epoch > 0 && !last.limits.contains(Limit::Staleness), "{last:?}");
}

/// The medium at rest that a stale field fades to must only ever resist, however thick it is.
#[test]
fn a_silent_host_leaves_a_thick_liquid_that_only_resists() {
    for viscosity_m2_s in [0.05, 1.0, 1e4] {
        let mut scene = cauldron();
        if let Some(liquid) = &mut scene.liquid {
            liquid.viscosity_m2_s = viscosity_m2_s;
        }
        let mut world = World::new(&scene, &Options::new(1)).expect("a world");
        run(&mut world, 2000);
        let silent: Vec<State> = (0..240).map(|_| world.tick_device()).collect();
        for pair in silent[100..].windows(2) {
            let velocity = DVec3::from_array(pair[1].velocity.map(|v| f64::from(v.0)));
            assert!(force_n(&pair[1]).dot(velocity) <= 1e-9, "nu {viscosity_m2_s}: it drives");
            let jump_n = (force_n(&pair[1]) - force_n(&pair[0])).length();
            assert!(jump_n < 0.1, "nu {viscosity_m2_s}: {jump_n} N in a tick");
        }
    }
}

/// Without the arm's dry friction: the depth of the ball under the surface as it were without its
/// dent is where its buoyancy bears its weight, the membrane helping as long as it holds, and
/// nothing swings.
#[test]
fn a_ball_let_go_floats_at_the_depth_that_bears_it() {
    for (density_kg_m3, start_y_m) in
        [(300.0, 0.004), (500.0, 0.004), (600.0, 0.003), (700.0, 0.01)]
    {
        let mut scene = cauldron();
        scene.probe = Probe { radius_m: 0.02, density_kg_m3: Some(density_kg_m3) };
        let acts = [Act::Rest { seconds: 0.8 }, Act::LetGo { seconds: 5.0 }];
        let script = Script::new(DVec3::Y * start_y_m, &acts, Vec::new());
        let smooth = PlantParams { friction_n: 0.0, ..PlantParams::OMNI_LIKE };
        let mut world =
            World::with_script(&scene, script.clone(), &Options::new(1)).expect("a world");
        world.device.board = SimBoard::new(&OMNI_LIKE, smooth, Grip::RELAXED, script, 1);
        let trace = run(&mut world, 3500);
        let y_m = |tick: usize| 1.2 * f64::from(trace.states[tick].position[1].0);
        let mean_m = (3000..3500).map(y_m).sum::<f64>() / 500.0;
        let swing_m = (3000..3500).map(|t| (y_m(t) - mean_m).abs()).fold(0.0, f64::max);
        let risen_m = world.host.pot.surface().unwrap().ahead(glam::Vec3::ZERO).0;
        let depth_m = f64::from(risen_m) - mean_m;
        let floating = world.host.pot.floating().unwrap();
        let is_held = (3000..3500).all(|tick| !trace.has(tick, Flags::WET));
        let membrane = scene.surface.map_or(0.0, |s| f64::from(s.contact_stiffness_n_per_m));
        let membrane = if is_held { membrane } else { 0.0 };
        let up_n = floating.force_n(depth_m) + membrane * depth_m.max(0.0);
        let off_m = up_n / (floating.stiffness_n_per_m() + membrane);
        assert!(off_m.abs() < 0.1 * (0.02 + depth_m), "{density_kg_m3}: {depth_m}, off {off_m} m");
        assert!(swing_m < 1e-3, "{density_kg_m3}: swings by {swing_m} m");
    }
}

#[test]
fn a_current_carries_the_hand() {
    let scene = (scenes::INDEX[2].make)();
    let trace = run(&mut World::new(&scene, &Options::new(1)).expect("a world"), 1500);
    // At (-0.06, mid height, 0) of the vortex the current runs along -y or +y at about U.
    let y_n: f64 =
        trace.states[1000..1500].iter().map(|s| f64::from(s.force[1].0)).sum::<f64>() / 500.0;
    assert!(y_n.abs() > 0.05, "{y_n} N");
}
