//! The device's core, in the order its data flows:
//!
//! ```text
//! encoder -> kinematics -> velocity -> field -> servo -> supervisor -> limit -> torque
//! ```
//!
//! A board ([`board::Board`]) gives counts and takes torques; [`device::Device`] is the loop that
//! stands between, and [`control::Control::tick`] is all that happens in one of its ticks. The
//! simulator is a board like any other.
//!
//! The same bits come out on every machine: no fused multiply-add, no library's transcendentals
//! ([`math`] has our own), no `f32::min` or `max`, no NaN kept. The lints of this folder watch.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::unreachable,
        clippy::unwrap_used,
        reason = "the device trips to a safe state, it does not panic"
    )
)]

pub mod board;
pub mod control;
pub mod device;
pub mod encoder;
pub mod field;
pub mod kinematics;
pub mod ledger;
pub mod limit;
pub mod math;
pub mod presets;
pub mod servo;
pub mod settings;
pub mod stopwatch;
pub mod supervisor;
pub mod tape;
pub mod trace;
pub mod vector;
pub mod velocity;

/// Servo ticks per second.
pub const TICKS_PER_SECOND: u16 = 1000;
/// Length of a tick in seconds.
pub const TICK_S: f32 = 1.0 / TICKS_PER_SECOND as f32;
