//! The emulated board: plays a tape through the firmware on a Cortex-M4F under QEMU, and prints
//! what each stage of a tick costs and the hash of its trace.
#![no_std]
#![no_main]

mod float;
mod host;
mod watch;

use cauldron_firmware::{presets::OMNI_LIKE, tape::play};
use cortex_m_rt::entry;
use cortex_m_semihosting::hprintln;

use watch::Watch;

/// Longest tape; stack and statics have the rest of the board's 4 MB.
const TAPE_BYTES: usize = 3 << 20;

#[entry]
fn main() -> ! {
    static mut TAPE: [u8; TAPE_BYTES] = [0; TAPE_BYTES];
    match run(TAPE) {
        Ok(()) => host::leave(Ok(())),
        Err(trouble) => host::leave(Err(&trouble)),
    }
}

fn run(room: &mut [u8]) -> Result<(), &'static str> {
    float::check()?;
    let tape = host::read_tape(room)?;
    let mut watch = Watch::start()?;
    let (ticks, hash) = play(tape, OMNI_LIKE, &mut watch);
    if ticks == 0 {
        return Err("there is no tick on the tape");
    }
    hprintln!("{watch}");
    hprintln!("ticks {ticks}");
    hprintln!("trace_hash {hash:#018x}");
    Ok(())
}
