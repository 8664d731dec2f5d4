//! One list of scenarios, and rigs that they run on.
//!
//! A [`scenario::Scenario`] says what the hand does, what befalls the wire, and what must be
//! true of the trace; a [`rig::Rig`] makes the trace. The simulated rig ([`sim::SimRig`]) runs on
//! virtual time; every other rig runs the same list.

pub mod rig;
pub mod scenario;
pub mod scenarios;
pub mod sim;
pub mod trace;

pub use rig::{Rig, RigError};
pub use scenario::Scenario;
pub use scenarios::LIST;
pub use sim::SimRig;
pub use trace::Trace;
