//! A recording of all that a device met, tick by tick, and a board that plays it: the same tape
//! on two machines must leave the same trace.
//!
//! A tick is `[counts 3 x i32][flags u8][buttons u8][n u16][n bytes from the host]`,
//! little-endian; of the flags bit 0 is the deadman, bit 1 the link, bit 2 an overrun.

use cauldron_protocol::units::NewtonMetres;

use crate::{
    board::{Board, Sensed},
    device::{BYTES_PER_TICK, Device},
    settings::Image,
    stopwatch::Stopwatch,
    trace::TraceHash,
};

/// Bytes of a tick before those of the host.
pub const HEAD_BYTES: usize = 16;

/// The fixed part of a tick on tape, for `received` bytes from the host.
#[must_use]
pub fn head(sensed: &Sensed, received: u16) -> [u8; HEAD_BYTES] {
    let [a, b, c] = sensed.counts.map(i32::to_le_bytes);
    let flags =
        u8::from(sensed.deadman) | u8::from(sensed.link_up) << 1 | u8::from(sensed.overrun) << 2;
    let [low, high] = received.to_le_bytes();
    let tail = [flags, sensed.buttons, low, high];
    let mut bytes = [0; HEAD_BYTES];
    for (to, from) in bytes.as_chunks_mut::<4>().0.iter_mut().zip([a, b, c, tail]) {
        *to = from;
    }
    bytes
}

/// A board that plays a tape.
#[derive(Debug)]
pub struct Tape<'a> {
    rest: &'a [u8],
    received: &'a [u8],
}

impl<'a> Tape<'a> {
    /// At the tape's begin.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, received: &[] }
    }

    /// True if no whole tick is left.
    #[must_use]
    pub fn is_at_end(&self) -> bool {
        self.rest.len() < HEAD_BYTES
    }
}

impl Board for Tape<'_> {
    fn sense(&mut self) -> Sensed {
        let Some((head, rest)) = self.rest.split_first_chunk::<HEAD_BYTES>() else {
            self.rest = &[];
            return Sensed::default();
        };
        let &[a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3, flags, buttons, low, high] = head;
        let bytes = usize::from(u16::from_le_bytes([low, high]));
        let bytes = if bytes < rest.len() { bytes } else { rest.len() };
        (self.received, self.rest) = rest.split_at_checked(bytes).unwrap_or((rest, &[]));
        let counts = [[a0, a1, a2, a3], [b0, b1, b2, b3], [c0, c1, c2, c3]];
        Sensed {
            counts: counts.map(i32::from_le_bytes),
            buttons,
            deadman: flags & 1 != 0,
            link_up: flags & 2 != 0,
            overrun: flags & 4 != 0,
        }
    }

    fn drive(&mut self, _torque: [NewtonMetres; 3]) {}

    fn receive(&mut self, into: &mut [u8]) -> usize {
        let bytes = self.received.len();
        let bytes = if bytes < into.len() { bytes } else { into.len() };
        for (to, from) in into.iter_mut().zip(self.received) {
            *to = *from;
        }
        self.received = &[];
        bytes
    }

    fn send(&mut self, _bytes: &[u8]) {}
}

/// A board that records what another one met; whatever grows takes the bytes.
#[derive(Debug)]
pub struct Recorder<'a, B, T> {
    board: &'a mut B,
    tape: &'a mut T,
    sensed: Sensed,
}

impl<'a, B: Board, T: Extend<u8>> Recorder<'a, B, T> {
    /// Records the next tick of `board` on `tape`.
    pub fn new(board: &'a mut B, tape: &'a mut T) -> Self {
        Self { board, tape, sensed: Sensed::default() }
    }
}

impl<B: Board, T: Extend<u8>> Board for Recorder<'_, B, T> {
    fn sense(&mut self) -> Sensed {
        self.sensed = self.board.sense();
        self.sensed
    }

    fn drive(&mut self, torque: [NewtonMetres; 3]) {
        self.board.drive(torque);
    }

    fn receive(&mut self, into: &mut [u8]) -> usize {
        let bytes = self.board.receive(into);
        let received = u16::try_from(bytes).unwrap_or(u16::MAX);
        self.tape.extend(head(&self.sensed, received));
        self.tape.extend(into.iter().take(bytes).copied());
        bytes
    }

    fn send(&mut self, bytes: &[u8]) {
        self.board.send(bytes);
    }
}

const _: () = assert!(BYTES_PER_TICK <= u16::MAX as usize, "a tick's bytes are counted in 16 bit");

/// Plays a tape to a device just switched on; the ticks and the hash of its trace.
pub fn play(tape: &[u8], image: Image, watch: &mut impl Stopwatch) -> (u32, u64) {
    let mut board = Tape::new(tape);
    let mut device = Device::new(image);
    let mut hash = TraceHash::default();
    let mut ticks = 0;
    while !board.is_at_end() {
        hash.add(&device.tick(&mut board, watch).state);
        ticks += 1;
    }
    (ticks, hash.value())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tick_comes_off_the_tape_as_it_went_on() {
        let sensed = Sensed {
            counts: [1, -2, 3_000_000],
            buttons: 5,
            deadman: true,
            link_up: true,
            overrun: false,
        };
        let mut bytes = head(&sensed, 3).to_vec();
        bytes.extend([7, 8, 9]);
        bytes.extend(head(&Sensed { overrun: true, ..sensed }, 0));
        let mut tape = Tape::new(&bytes);
        assert_eq!(tape.sense(), sensed);
        let mut into = [0; 8];
        assert_eq!((tape.receive(&mut into), into[..3].to_vec()), (3, vec![7, 8, 9]));
        assert_eq!(tape.receive(&mut into), 0);
        assert!(tape.sense().overrun && tape.is_at_end());
    }
}
