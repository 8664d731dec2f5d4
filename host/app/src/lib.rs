//! The program as a library: the simulated device, the host that feeds it, and the commands.
//!
//! ```text
//! device -> link -> host: states -> pot -> field -> link -> device
//!                         pot -> snapshot -> pictures
//! ```

pub mod bench;
pub mod cli;
pub mod failure;
pub mod grid;
pub mod host;
pub mod ledger;
pub mod membrane;
pub mod run;
pub mod scenes;
pub mod sim;
pub mod torture;
pub mod world;

pub use failure::Failure;
pub use host::Host;
pub use sim::SimDevice;
pub use world::World;
