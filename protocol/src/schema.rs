//! The layout of all messages as one number.

use postcard_schema::key::Key;

use crate::{
    message::{Down, Up},
    state::States,
};

/// A hash over the layout of every message: equal on both sides, or they do not understand each
/// other.
#[must_use]
pub const fn schema_hash() -> u64 {
    let down = u64::from_le_bytes(Key::for_path::<Down>("cauldron/down").to_bytes());
    let up = u64::from_le_bytes(Key::for_path::<Up>("cauldron/up").to_bytes());
    let states = u64::from_le_bytes(Key::for_path::<States>("cauldron/states").to_bytes());
    down ^ up.rotate_left(21) ^ states.rotate_left(42)
}
