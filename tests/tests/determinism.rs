//! The same seed and scene give the same bits, for any number of threads and on any machine.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use cauldron::world::{Options, World};
use cauldron_firmware::{presets::OMNI_LIKE, stopwatch::Unwatched, tape, trace::TraceHash};
use cauldron_fluid::{pool::Pool, scenes, simd::SimdClass};
use std::sync::Arc;

/// Long enough to be through the surface and to stir.
const TICKS: usize = 2200;

fn world(options: &Options) -> World {
    let mut scene = (scenes::INDEX[0].make)();
    scene.regrid(20);
    World::new(&scene, options).expect("a world")
}

fn hash(options: &Options) -> u64 {
    let mut world = world(options);
    let mut hash = TraceHash::default();
    (0..TICKS).for_each(|_| hash.add(&world.tick().unwrap()));
    assert!(world.host.pot.exchange().given_n_s() > 0.01, "the liquid was stirred");
    hash.value()
}

#[test]
fn a_seed_is_a_run_and_another_seed_is_another() {
    assert_eq!(hash(&Options::new(5)), hash(&Options::new(5)));
    assert_ne!(hash(&Options::new(5)), hash(&Options::new(6)));
}

#[test]
fn threads_change_no_bit_and_neither_do_256_or_512() {
    for simd in SimdClass::ALL.into_iter().filter(|class| *class <= SimdClass::detect()) {
        let one = hash(&Options { simd, ..Options::new(5) });
        let pool = Arc::new(Pool::new(2, false));
        assert_eq!(hash(&Options { pool, simd, ..Options::new(5) }), one, "{simd}, two threads");
        if simd == SimdClass::Avx512 {
            let narrow = hash(&Options { simd: SimdClass::Avx2, ..Options::new(5) });
            assert_eq!(narrow, one, "256 and 512 bits");
        }
    }
}

/// What the emulated ARM board is held to as well, by its own check.
#[test]
fn a_tape_leaves_the_trace_that_the_run_left() {
    let mut world = world(&Options::new(5));
    world.device.start_tape();
    let mut hash = TraceHash::default();
    (0..TICKS).for_each(|_| hash.add(&world.tick().unwrap()));
    let played = tape::play(world.device.tape().unwrap(), OMNI_LIKE, &mut Unwatched);
    assert_eq!(played, (TICKS as u32, hash.value()));
}

/// Half of the work at 64^3 is the second thread's.
#[test]
fn the_second_thread_does_its_share_at_64() {
    let mut scene = (scenes::INDEX[0].make)();
    scene.regrid(64);
    let pool = Arc::new(Pool::new(2, false));
    let mut world =
        World::new(&scene, &Options { pool: pool.clone(), ..Options::new(1) }).expect("a world");
    world.host.pot.place_probe(glam::Vec3::new(0.03, -0.05, 0.0));
    for _ in 0..3 {
        world.host.pot.take(glam::DVec3::new(1e-3, 0.0, 2e-3), 0.0, 0.01);
        world.host.pot.pour(0b11, 0.01);
        world.host.pot.step(0.01);
    }
    let cells = pool.cells_done();
    let share = cells[1] as f64 / cells.iter().sum::<u64>() as f64;
    assert!(share >= 0.4, "{cells:?}");
}
