//! The whole device: the loop between a board and the link, one tick at a time.

use cauldron_protocol::{
    Down, Drops, Frame, Kind, State, States, Up,
    field::SlabHead,
    frame::{Decoder, MAX_FRAME, count, encode_message},
    units::Ticks,
};
use heapless::Vec;
use serde::Serialize;

use crate::{
    board::Board,
    control::{Control, Drive},
    settings::Image,
    stopwatch::{Stage, Stopwatch},
};

/// Bytes taken from the link in a tick: a little under what full-speed USB can bring, so that a
/// flood cannot make a tick long.
pub const BYTES_PER_TICK: usize = 1024;

/// Answers that can wait to be sent; more than a tick's bytes can ask for is not a host.
const MAX_ANSWERS: usize = 8;

/// A device: servo and link.
#[derive(Debug)]
pub struct Device {
    now: Ticks,
    control: Control,
    decoder: Decoder,
    torn: u16,
    unknown: u16,
    sequence: u16,
    answers: Vec<Up, MAX_ANSWERS>,
    states: States,
    was_up: bool,
    bytes: [u8; BYTES_PER_TICK],
}

impl Device {
    /// A device just switched on.
    #[must_use]
    pub fn new(image: Image) -> Self {
        Self {
            now: Ticks(0),
            control: Control::new(image),
            decoder: Decoder::default(),
            torn: 0,
            unknown: 0,
            sequence: 0,
            answers: Vec::new(),
            states: States::new(),
            was_up: false,
            bytes: [0; BYTES_PER_TICK],
        }
    }

    /// One tick. Measures first, so that what the host sent cannot delay the sample.
    pub fn tick(&mut self, board: &mut impl Board, watch: &mut impl Stopwatch) -> Drive {
        let sensed = board.sense();
        self.receive(board, sensed.link_up);
        watch.ended(Stage::Link);
        let mut drive = self.control.tick(self.now, &sensed, watch);
        board.drive(drive.torque);
        drive.state.drops = self.drops();
        self.report(board, drive.state);
        watch.ended(Stage::Report);
        self.now = self.now.plus(1);
        drive
    }

    /// Bytes to frames to commands.
    fn receive(&mut self, board: &mut impl Board, link_up: bool) {
        if link_up && !self.was_up {
            self.decoder.restart();
        }
        self.was_up = link_up;
        let received = board.receive(&mut self.bytes);
        let mut rest = self.bytes.get(..received).unwrap_or(&[]);
        while let Some(frame) = self.decoder.feed(&mut rest) {
            let Some(answer) = obey(&mut self.control, self.now, &frame, &mut self.torn) else {
                count(&mut self.unknown);
                continue;
            };
            if let Some(answer) = answer {
                // A host that asks for more than we can queue has to ask again.
                let _ = self.answers.push(answer);
            }
        }
    }

    fn drops(&self) -> Drops {
        let decoder = self.decoder.drops;
        Drops { torn: self.torn, unknown: decoder.unknown.saturating_add(self.unknown), ..decoder }
    }

    /// Answers at once, states four ticks at a time.
    fn report(&mut self, board: &mut impl Board, state: State) {
        for answer in &self.answers {
            send(board, &mut self.sequence, Kind::Up, answer);
        }
        self.answers.clear();
        // Sent whenever it is full, so there is room.
        let _ = self.states.push(state);
        if self.states.is_full() {
            send(board, &mut self.sequence, Kind::States, &self.states);
            self.states.clear();
        }
    }
}

fn send<T: Serialize>(board: &mut impl Board, sequence: &mut u16, kind: Kind, message: &T) {
    let mut frame = [0; MAX_FRAME];
    if let Ok(bytes) = encode_message(kind, *sequence, message, &mut frame) {
        board.send(bytes);
    }
    *sequence = sequence.wrapping_add(1);
}

/// Carries a frame out; `None` if it is not for a device.
fn obey(
    control: &mut Control,
    now: Ticks,
    frame: &Frame<'_>,
    torn: &mut u16,
) -> Option<Option<Up>> {
    match frame.kind {
        Kind::Down => {
            let down = postcard::from_bytes::<Down>(frame.body).ok()?;
            Some(control.command(now, frame.sequence, down, torn))
        }
        Kind::FieldSlab => {
            let (head, data) = SlabHead::split(frame.body)?;
            control.slab(now, head, data);
            Some(None)
        }
        Kind::Up | Kind::States => None,
    }
}
