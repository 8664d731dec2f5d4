//! The wire between host and device, read like a datasheet.
//!
//! Every frame is `[version u8][kind u8][sequence u16][body][crc32 u32]`, little-endian, byte
//! stuffed by COBS (Cheshire & Baker 1999) and ended by a zero byte. CRC-32 is that of
//! ISO-HDLC over everything before it. Control bodies are postcard; bulk bodies are raw.
//!
//! | kind | way | body | what it is |
//! |---|---|---|---|
//! | `0x01` [`Kind::Down`] | host to device | postcard [`Down`] | a command, or the head of a field
//! |
//! | `0x02` [`Kind::FieldSlab`] | host to device | raw [`field::SlabHead`] + at most 512 B | a
//! slice of a field's samples |
//! | `0x81` [`Kind::Up`] | device to host | postcard [`Up`] | an answer |
//! | `0x82` [`Kind::States`] | device to host | postcard [`state::States`] | four ticks |
//!
//! | [`Down`] | answered by | accepted when |
//! |---|---|---|
//! | `Hello` | [`Up::Hello`] | always; starts the sequence anew |
//! | `Configure` | [`Up::Ack`] | Idle, every value in range |
//! | `Vessel` | [`Up::Ack`] | Idle or Armed, every value finite |
//! | `Params` | [`Up::Ack`] | any state but Fault, every value in range |
//! | `Arm` | [`Up::Ack`] | Idle, vessel and params there, deadman held |
//! | `Disarm` | [`Up::Ack`] | always; clears a Fault whose cause is gone |
//! | `Field` + slabs | epoch in [`State`] | always; committed as a whole or not at all |
//! | `Keep` | epoch in [`State`] | the epoch named is the one that acts |
//! | `Ping` | [`Up::Pong`] | always; the host's heartbeat |
//! | `ReadFaultLog` | [`Up::FaultLog`] | always |
//! | `Dfu` | [`Up::Ack`] | Idle, on a board with a loader |
//!
//! A frame that is corrupt, truncated, oversized, repeated or of another version is dropped and
//! counted ([`frame::Drops`]); the zero byte brings the stream back into step.
#![no_std]
#![forbid(unsafe_code)]

pub mod fault;
pub mod field;
pub mod frame;
pub mod message;
pub mod schema;
pub mod state;
pub mod transform;
pub mod units;
pub mod vessel;

pub use fault::{Fault, Limit, Limits};
pub use frame::{Drops, Frame, Kind};
pub use message::{Down, Refusal, Up, Verdict};
pub use schema::schema_hash;
pub use state::{State, States, Supervisor};
pub use transform::WorldFromDevice;
pub use vessel::{Vessel, Wall};

/// Version of the frame layout; a frame of another version is dropped.
pub const PROTOCOL_VERSION: u8 = 1;

/// States that travel in one frame.
pub const STATES_PER_FRAME: usize = 4;
