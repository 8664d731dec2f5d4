//! Marks between the stages of a tick, so that a board can count what each costs. A board that
//! does not count pays nothing.

/// The stages of a tick, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stage {
    /// Bytes to frames to commands.
    Link,
    /// Counts to joint angles.
    Encoder,
    /// Joint angles to position and Jacobian.
    Kinematics,
    /// Position to velocity.
    Velocity,
    /// Medium at the probe, of two epochs.
    Field,
    /// Force wanted.
    Servo,
    /// May it act?
    Supervisor,
    /// What of it may act, and as which torque.
    Limit,
    /// State and frame.
    Report,
}

impl Stage {
    /// Every stage, in order.
    pub const ALL: [Self; 9] = [
        Self::Link,
        Self::Encoder,
        Self::Kinematics,
        Self::Velocity,
        Self::Field,
        Self::Servo,
        Self::Supervisor,
        Self::Limit,
        Self::Report,
    ];

    /// Name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Link => "link",
            Self::Encoder => "encoder",
            Self::Kinematics => "kinematics",
            Self::Velocity => "velocity",
            Self::Field => "field",
            Self::Servo => "servo",
            Self::Supervisor => "supervisor",
            Self::Limit => "limit, torque",
            Self::Report => "report",
        }
    }
}

/// Told when a stage has ended.
pub trait Stopwatch {
    /// `stage` has just ended; the next one begins.
    fn ended(&mut self, stage: Stage);
}

/// Counts nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Stopwatch for Unwatched {
    fn ended(&mut self, _stage: Stage) {}
}
