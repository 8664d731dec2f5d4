//! The simulated board: a board like any other, made of an arm with inertia, friction and motor
//! lag, encoders that quantise and jitter, and a hand that holds the handle.
//!
//! Everything is seeded, and time is the tick: the same seed gives the same bits.

pub mod arm;
pub mod board;
pub mod hand;
pub mod plant;
pub mod script;
pub mod stroke;

pub use board::{Port, SimBoard};
pub use hand::Grip;
pub use plant::PlantParams;
pub use script::{Act, Script};
