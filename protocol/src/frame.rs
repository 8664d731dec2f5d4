//! Framing: COBS, CRC-32, and a decoder that finds its feet again after anything.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::{PROTOCOL_VERSION, field::SlabHead};

const CRC32: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);
const HEAD: usize = 4;
const TAIL: usize = 4;

/// Longest body of a frame: a slab with its head.
pub const MAX_BODY: usize = SlabHead::BYTES + SlabHead::MAX_DATA;

/// Longest frame on the wire: stuffing adds a byte in 254, and the closing zero.
pub const MAX_FRAME: usize = MAX_PLAIN + MAX_PLAIN / 254 + 2;

const MAX_PLAIN: usize = HEAD + MAX_BODY + TAIL;

/// What a frame's body is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// A postcard [`crate::Down`].
    Down = 0x01,
    /// A raw slab of a field.
    FieldSlab = 0x02,
    /// A postcard [`crate::Up`].
    Up = 0x81,
    /// Postcard [`crate::States`].
    States = 0x82,
}

impl Kind {
    fn from_byte(byte: u8) -> Option<Self> {
        [Self::Down, Self::FieldSlab, Self::Up, Self::States].into_iter().find(|k| *k as u8 == byte)
    }
}

/// A frame that came through whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// What `body` is.
    pub kind: Kind,
    /// Running number of the sender.
    pub sequence: u16,
    /// Up to [`MAX_BODY`] bytes.
    pub body: &'a [u8],
}

/// Why a frame could not be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    /// The message does not fit into a frame or into the buffer given.
    TooLong,
}

impl core::fmt::Display for EncodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the message does not fit into a frame of {MAX_BODY} B")
    }
}

impl core::error::Error for EncodeError {}

/// Frames dropped, by reason. Counters stop at their top.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Drops {
    /// Stuffing or CRC wrong.
    pub corrupt: u16,
    /// Shorter than a frame can be.
    pub truncated: u16,
    /// Longer than a frame can be.
    pub oversized: u16,
    /// The same frame twice in a row.
    pub repeated: u16,
    /// Of another protocol version.
    pub version: u16,
    /// Sound, but not a message for this side.
    pub unknown: u16,
    /// Fields that never became whole.
    pub torn: u16,
}

impl Drops {
    /// Every drop added up.
    #[must_use]
    pub fn total(&self) -> u32 {
        [
            self.corrupt,
            self.truncated,
            self.oversized,
            self.repeated,
            self.version,
            self.unknown,
            self.torn,
        ]
        .into_iter()
        .map(u32::from)
        .sum()
    }
}

/// Adds one to a counter, which stops at its top.
pub fn count(counter: &mut u16) {
    *counter = counter.saturating_add(1);
}

/// Writes a frame around what `write_body` puts into the slice it is given; returns its bytes.
///
/// # Errors
/// [`EncodeError::TooLong`] if the body or the frame does not fit.
pub fn encode(
    kind: Kind,
    sequence: u16,
    out: &mut [u8; MAX_FRAME],
    write_body: impl FnOnce(&mut [u8]) -> Option<usize>,
) -> Result<&[u8], EncodeError> {
    let mut plain = [0; MAX_PLAIN];
    let room = plain.get_mut(HEAD..HEAD + MAX_BODY).ok_or(EncodeError::TooLong)?;
    let body = write_body(room).filter(|n| *n <= MAX_BODY).ok_or(EncodeError::TooLong)?;
    let [low, high] = sequence.to_le_bytes();
    for (to, from) in plain.iter_mut().zip([PROTOCOL_VERSION, kind as u8, low, high]) {
        *to = from;
    }
    let end = HEAD + body;
    let (said, rest) = plain.split_at_mut_checked(end).ok_or(EncodeError::TooLong)?;
    for (to, from) in rest.iter_mut().zip(CRC32.checksum(said).to_le_bytes()) {
        *to = from;
    }
    let whole = plain.get(..end + TAIL).ok_or(EncodeError::TooLong)?;
    let stuffed = cobs::try_encode(whole, out).map_err(|_| EncodeError::TooLong)?;
    *out.get_mut(stuffed).ok_or(EncodeError::TooLong)? = 0;
    out.get(..=stuffed).ok_or(EncodeError::TooLong)
}

/// Writes a postcard message as a frame.
///
/// # Errors
/// [`EncodeError::TooLong`] if it does not fit.
pub fn encode_message<'a, T: Serialize>(
    kind: Kind,
    sequence: u16,
    message: &T,
    out: &'a mut [u8; MAX_FRAME],
) -> Result<&'a [u8], EncodeError> {
    encode(kind, sequence, out, |room| postcard::to_slice(message, room).ok().map(|b| b.len()))
}

/// Turns a stream of bytes into frames, and counts what it has to drop.
#[derive(Debug)]
pub struct Decoder {
    buffer: [u8; MAX_FRAME],
    filled: usize,
    overflown: bool,
    last: Option<(u16, u32)>,
    /// What was dropped since the start.
    pub drops: Drops,
    /// Frames that the sender numbered and that never came.
    pub lost: u32,
}

impl Default for Decoder {
    fn default() -> Self {
        Self {
            buffer: [0; MAX_FRAME],
            filled: 0,
            overflown: false,
            last: None,
            drops: Drops::default(),
            lost: 0,
        }
    }
}

impl Decoder {
    /// Takes bytes off the front of `bytes` until a frame is whole or none is left.
    pub fn feed(&mut self, bytes: &mut &[u8]) -> Option<Frame<'_>> {
        while let Some((&byte, rest)) = bytes.split_first() {
            *bytes = rest;
            if byte != 0 {
                self.store(byte);
            } else if let Some((kind, sequence, body)) = self.close() {
                let body = self.buffer.get(HEAD..HEAD + body)?;
                return Some(Frame { kind, sequence, body });
            }
        }
        None
    }

    /// Forgets a half-received frame and the sender's numbering: the cable was pulled.
    pub fn restart(&mut self) {
        self.filled = 0;
        self.overflown = false;
        self.last = None;
    }

    fn store(&mut self, byte: u8) {
        match self.buffer.get_mut(self.filled) {
            Some(place) => {
                *place = byte;
                self.filled += 1;
            }
            None => self.overflown = true,
        }
    }

    /// A zero came: what is in the buffer is a frame or is dropped.
    fn close(&mut self) -> Option<(Kind, u16, usize)> {
        let filled = core::mem::take(&mut self.filled);
        if core::mem::take(&mut self.overflown) {
            count(&mut self.drops.oversized);
            return None;
        }
        if filled == 0 {
            return None; // two zeros in a row: an idle line
        }
        let stuffed = self.buffer.get_mut(..filled)?;
        let Ok(plain) = cobs::decode_in_place(stuffed) else {
            count(&mut self.drops.corrupt);
            return None;
        };
        self.check(plain)
    }

    fn check(&mut self, plain: usize) -> Option<(Kind, u16, usize)> {
        let Some(body) = plain.checked_sub(HEAD + TAIL) else {
            count(&mut self.drops.truncated);
            return None;
        };
        let said = self.buffer.get(..HEAD + body)?;
        let tail = self.buffer.get(HEAD + body..plain)?;
        let crc = CRC32.checksum(said);
        if tail != crc.to_le_bytes() {
            count(&mut self.drops.corrupt);
            return None;
        }
        let &[version, kind, low, high] = said.first_chunk::<HEAD>()?;
        if version != PROTOCOL_VERSION {
            count(&mut self.drops.version);
            return None;
        }
        let Some(kind) = Kind::from_byte(kind) else {
            count(&mut self.drops.unknown);
            return None;
        };
        let sequence = u16::from_le_bytes([low, high]);
        if self.last == Some((sequence, crc)) {
            count(&mut self.drops.repeated);
            return None;
        }
        if let Some((before, _)) = self.last {
            let gap = sequence.wrapping_sub(before).wrapping_sub(1);
            // A jump backwards is a sender that started anew, not 65,000 lost frames.
            if gap < 0x8000 {
                self.lost = self.lost.saturating_add(u32::from(gap));
            }
        }
        self.last = Some((sequence, crc));
        Some((kind, sequence, body))
    }
}
