//! What the device tells of every tick.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::{
    STATES_PER_FRAME,
    fault::{Fault, Limits},
    frame::Drops,
    message::Verdict,
    units::{Metres, MetresPerSecond, Newtons, PiconewtonSeconds, Ticks},
};

/// Where the supervisor stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Supervisor {
    /// No force; may be configured.
    #[default]
    Idle,
    /// No force yet; waits for the first field.
    Armed,
    /// The servo acts.
    Running,
    /// Safe and stopped until the fault is cleared.
    Fault(Fault),
}

/// The last command that was answered, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LastCommand {
    /// Sequence number of the command's frame.
    pub sequence: u16,
    /// Accepted, or refused and why.
    pub verdict: Verdict,
}

/// One-bit facts of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Flags(u8);

impl Flags {
    /// The probe is in the medium.
    pub const WET: Self = Self(1);
    /// The probe presses on the surface without being through.
    pub const ON_SURFACE: Self = Self(2);
    /// The probe is out of the medium, and the surface still clings to it.
    pub const CLINGING: Self = Self(16);
    /// The probe presses on a wall.
    pub const ON_WALL: Self = Self(4);
    /// The deadman is held.
    pub const DEADMAN: Self = Self(8);

    /// Adds the facts of `other` if `when`.
    #[must_use]
    pub fn with(self, other: Self, when: bool) -> Self {
        if when { Self(self.0 | other.0) } else { self }
    }

    /// True if all facts of `other` hold.
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// One tick of the device, in device metres and felt newtons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct State {
    /// When.
    pub tick: Ticks,
    /// Where the supervisor stands.
    pub supervisor: Supervisor,
    /// The last command, accepted or refused.
    pub last_command: LastCommand,
    /// The handle's measured position.
    pub position: [Metres; 3],
    /// The handle's position as the walls allow it: what is drawn.
    pub proxy: [Metres; 3],
    /// The handle's estimated velocity.
    pub velocity: [MetresPerSecond; 3],
    /// The force given to the hand, after every limit.
    pub force: [Newtons; 3],
    /// Impulse given to the medium since boot, by the force that acted.
    pub impulse_to_fluid: [PiconewtonSeconds; 3],
    /// Buttons held, a bit each.
    pub buttons: u8,
    /// Facts of the tick.
    pub flags: Flags,
    /// Limits that acted.
    pub limits: Limits,
    /// Epoch of the field that acts; 0 before the first.
    pub field_epoch: u32,
    /// Frames dropped since boot, by reason.
    pub drops: Drops,
}

/// A frame's worth of ticks, oldest first.
pub type States = Vec<State, STATES_PER_FRAME>;
