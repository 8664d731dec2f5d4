//! The machine that emulates the board, met by semihosting: its command line, its files, its end.

use core::{fmt::Display, panic::PanicInfo};

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::{
    debug, heprintln,
    nr::{self, open::R_BINARY},
    syscall, syscall1,
};

/// Longest command line, its closing zero included.
const LINE_BYTES: usize = 1024;

/// Reads the file that the command line names (`mps2 TAPE`) into `room`.
pub fn read_tape(room: &mut [u8]) -> Result<&[u8], &'static str> {
    let mut line = [0; LINE_BYTES];
    let name = name_on(read_line(&mut line)?).ok_or("no tape: the command line is `mps2 TAPE`")?;
    let file = open(name).ok_or("the tape cannot be opened")?;
    let bytes = length(file).ok_or("the tape's length is not known")?;
    let room = room.get_mut(..bytes).ok_or("the tape is longer than the 3 MiB kept for it")?;
    if read(file, room) { Ok(room) } else { Err("the tape cannot be read") }
}

/// Ends the emulation: status 0 if all went well, 1 and a message if not.
pub fn leave(outcome: Result<(), &dyn Display>) -> ! {
    if let Err(trouble) = outcome {
        heprintln!("mps2: {trouble}");
    }
    loop {
        debug::exit(outcome.map_err(|_| ()));
    }
}

#[panic_handler]
fn panicked(info: &PanicInfo<'_>) -> ! {
    leave(Err(info))
}

// SAFETY: it never returns, so the faulty instruction's state does not matter.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    leave(Err(&"hard fault"))
}

/// All that follows the program's name, so that a path may have spaces; with its closing zero.
fn name_on(line: &[u8]) -> Option<&[u8]> {
    let gap = line.iter().position(|byte| *byte == b' ')?;
    line.get(gap + 1..).filter(|name| name.len() > 1)
}

/// The command line with its closing zero.
fn read_line(line: &mut [u8; LINE_BYTES]) -> Result<&[u8], &'static str> {
    let mut block = [line.as_mut_ptr() as usize, line.len()];
    // SAFETY: the block names `line` and its length, and both outlive the call; the host writes
    // within them, and the length that it wrote into the block.
    let failed = unsafe { syscall1(nr::GET_CMDLINE, block.as_mut_ptr() as usize) } != 0;
    let [_, bytes] = block;
    line.get(..=bytes).filter(|_| !failed).ok_or("the command line is too long")
}

/// Opens the file of a name that ends with a zero.
fn open(name: &[u8]) -> Option<usize> {
    let (0, text) = name.split_last()? else { return None };
    // SAFETY: `name` holds `text.len()` bytes and the zero behind them; the host only reads.
    let file = unsafe { syscall!(OPEN, name.as_ptr(), R_BINARY, text.len()) };
    (file != usize::MAX).then_some(file)
}

fn length(file: usize) -> Option<usize> {
    // SAFETY: the call takes a handle, which came from `open`, and touches no memory of ours.
    let bytes = unsafe { syscall!(FLEN, file) };
    (bytes != usize::MAX).then_some(bytes)
}

/// Fills `room` from a file; false if it could not be filled.
fn read(file: usize, room: &mut [u8]) -> bool {
    // SAFETY: the host writes at most `room.len()` bytes to `room`, which is ours alone here.
    let missing = unsafe { syscall!(READ, file, room.as_mut_ptr(), room.len()) };
    missing == 0
}
