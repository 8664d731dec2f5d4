//! What the core asks of a board. One file or folder per board under `boards/`; the simulator is
//! one of them.

use cauldron_protocol::units::NewtonMetres;

/// What a board measured for this tick, all at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sensed {
    /// Encoder counts of yaw, shoulder and elbow, from the home pose.
    pub counts: [i32; 3],
    /// Buttons held, a bit each.
    pub buttons: u8,
    /// The deadman is held.
    pub deadman: bool,
    /// The link is alive: a start of frame, or an open pipe, was seen since the last tick.
    pub link_up: bool,
    /// The last tick did not end before its budget did.
    pub overrun: bool,
}

/// A board: three encoders, three motors, and a byte stream to the host.
pub trait Board {
    /// Measures.
    fn sense(&mut self) -> Sensed;

    /// Sets the torque of each joint until the next call.
    fn drive(&mut self, torque: [NewtonMetres; 3]);

    /// Takes bytes that the host sent into `into`; how many.
    fn receive(&mut self, into: &mut [u8]) -> usize;

    /// Hands bytes to the host; what the link cannot take is lost, and shows there as a gap.
    fn send(&mut self, bytes: &[u8]);
}
