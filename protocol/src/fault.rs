//! Why the device stopped ([`Fault`]), and what holds it back while it goes on ([`Limit`]).
//!
//! "Limited" is not "failed": a limit acts for a tick and is named in that tick's state; a fault
//! stays until it is cleared.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Why the device is in Fault. Numbers in decades: 10 link, 20 sensing, 30 time, 40 force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Fault {
    /// The cable is gone: no start of frame, or a closed pipe, for 5 ms.
    CableGone,
    /// The host said nothing for 250 ms while the device was armed.
    HostSilent,
    /// An encoder moved further in one tick than the mechanism can.
    EncoderJump,
    /// The joints stand outside of what the mechanism can reach.
    OutsideWorkspace,
    /// A servo tick overran its budget.
    Overrun,
    /// A force came out as NaN or infinity.
    NonFiniteForce,
}

impl Fault {
    /// Every fault, in the order of its number.
    pub const ALL: [Self; 6] = [
        Self::CableGone,
        Self::HostSilent,
        Self::EncoderJump,
        Self::OutsideWorkspace,
        Self::Overrun,
        Self::NonFiniteForce,
    ];

    /// The number that people read off a log.
    #[must_use]
    pub fn number(self) -> u8 {
        match self {
            Self::CableGone => 10,
            Self::HostSilent => 11,
            Self::EncoderJump => 20,
            Self::OutsideWorkspace => 21,
            Self::Overrun => 30,
            Self::NonFiniteForce => 40,
        }
    }
}

/// What held a tick's force back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The norm of the force was clamped.
    Force,
    /// The change of the force was clamped.
    Slew,
    /// The force still ramps up after arming.
    ArmingRamp,
    /// The field is out of date and has been faded.
    Staleness,
    /// The arm is near a singular pose and the force was scaled down.
    Singularity,
}

impl Limit {
    /// Every limit, in the order of its bit.
    pub const ALL: [Self; 5] =
        [Self::Force, Self::Slew, Self::ArmingRamp, Self::Staleness, Self::Singularity];

    /// Name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Slew => "slew",
            Self::ArmingRamp => "arming ramp",
            Self::Staleness => "staleness",
            Self::Singularity => "singularity",
        }
    }

    fn bit(self) -> u16 {
        1 << self as u16
    }
}

/// The set of limits that acted in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Limits(u16);

impl Limits {
    /// Adds `limit` to the set.
    pub fn insert(&mut self, limit: Limit) {
        self.0 |= limit.bit();
    }

    /// True if `limit` acted.
    #[must_use]
    pub fn contains(self, limit: Limit) -> bool {
        self.0 & limit.bit() != 0
    }

    /// True if nothing acted.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fault_numbers_differ() {
        for (i, a) in Fault::ALL.iter().enumerate() {
            assert!(Fault::ALL.iter().skip(i + 1).all(|b| a.number() != b.number()));
        }
    }

    #[test]
    fn limits_are_told_apart() {
        for limit in Limit::ALL {
            let mut set = Limits::default();
            set.insert(limit);
            assert_eq!(Limit::ALL.iter().filter(|l| set.contains(**l)).count(), 1);
            assert!(set.contains(limit) && !set.is_empty());
        }
    }
}
