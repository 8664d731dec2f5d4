//! Makes a tape, and plays it here first.

use cauldron::world::{Options, World};
use cauldron_firmware::{presets::OMNI_LIKE, stopwatch::Unwatched, tape};
use cauldron_fluid::scenes;
use std::{fs, path::Path, process::ExitCode};

/// Long enough to arm, to press through the surface, and to stir.
const TICKS: usize = 2500;

/// Records a run of the cauldron into `path`; prints ticks and hash as the boards do.
pub fn record(path: &Path, seed: u64) -> ExitCode {
    let mut scene = (scenes::INDEX[0].make)();
    scene.regrid(16);
    let mut world = match World::new(&scene, &Options::new(seed)) {
        Ok(world) => world,
        Err(wrong) => {
            eprintln!("cauldron-hil: {wrong}");
            return ExitCode::from(2);
        }
    };
    world.device.start_tape();
    for _ in 0..TICKS {
        if let Err(error) = world.tick() {
            eprintln!("cauldron-hil: {error}");
            return ExitCode::from(3);
        }
    }
    let recorded = world.device.tape().unwrap_or(&[]);
    if let Err(why) = fs::write(path, recorded) {
        eprintln!("cauldron-hil: cannot write {}: {why}", path.display());
        return ExitCode::from(2);
    }
    let (ticks, hash) = tape::play(recorded, OMNI_LIKE, &mut Unwatched);
    crate::say(&format!("ticks {ticks}\ntrace_hash {hash:#018x}"));
    ExitCode::SUCCESS
}
