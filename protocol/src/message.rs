//! The messages themselves: [`Down`] from the host, [`Up`] from the device.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::{
    fault::Fault,
    field::FieldHead,
    transform::WorldFromDevice,
    units::{
        Metres, NewtonSeconds2PerMetre2, NewtonSecondsPerMetre, Newtons, NewtonsPerMetre,
        NewtonsPerSecond, Radians, Ticks,
    },
    vessel::Vessel,
};

/// Entries of a fault log.
pub const FAULT_LOG: usize = 8;

/// What the host says. Its table stands at the top of the crate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Down {
    /// Who are you? The first message of a session.
    Hello,
    /// New calibration and ceilings.
    Configure(Config),
    /// The static geometry.
    Vessel(Vessel),
    /// What the servo renders, and the medium outside of every field.
    Params(Params),
    /// Ready the servo; it runs with the first field.
    Arm,
    /// No more force; clears a Fault whose cause is gone.
    Disarm,
    /// A field begins: its samples follow in slabs.
    Field(FieldHead),
    /// The field that acts stays right until then.
    Keep(Keep),
    /// Heartbeat; the host's clock comes back in [`Up::Pong`].
    Ping {
        /// Host clock in microseconds, wrapping.
        host_us: u32,
    },
    /// Asks for [`Up::FaultLog`].
    ReadFaultLog,
    /// Leave for the firmware loader.
    Dfu,
}

/// What the device answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Up {
    /// Answer to [`Down::Hello`].
    Hello(Identity),
    /// Answer to a command.
    Ack {
        /// Sequence number of the command's frame.
        sequence: u16,
        /// Accepted, or refused and why.
        verdict: Verdict,
    },
    /// Answer to [`Down::Ping`].
    Pong {
        /// The host's clock as it came.
        host_us: u32,
        /// The device's clock.
        tick: Ticks,
    },
    /// The last faults, oldest first.
    FaultLog(Vec<FaultEntry, FAULT_LOG>),
}

/// Accepted, or refused and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Verdict {
    /// Done.
    #[default]
    Accepted,
    /// Not done.
    Refused(Refusal),
}

/// Why a command was refused; nothing was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Refusal {
    /// Not in this supervisor state.
    WrongState,
    /// No vessel was uploaded.
    NoVessel,
    /// No params were uploaded.
    NoParams,
    /// The deadman is not held.
    DeadmanOpen,
    /// A value is NaN, infinite or out of its range.
    BadValue,
    /// A field is larger than the device can hold, or its head contradicts itself.
    BadField,
    /// The fault's cause still stands.
    FaultStands,
    /// The epoch named is not the one that acts.
    WrongEpoch,
    /// This board cannot do that.
    NotOnThisBoard,
}

/// Who the device is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Identity {
    /// [`crate::PROTOCOL_VERSION`] of the image.
    pub protocol_version: u8,
    /// [`crate::schema_hash`] of the image: both sides must have the same.
    pub schema_hash: u64,
    /// Major, minor, patch.
    pub firmware_version: [u8; 3],
    /// Servo ticks per second.
    pub ticks_per_second: u16,
    /// Ceilings that no command can raise.
    pub ceilings: Ceilings,
    /// The mechanism.
    pub arm: Arm,
    /// The calibration in force.
    pub world_from_device: WorldFromDevice,
}

/// What the hand is protected by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Ceilings {
    /// Largest norm of the force.
    pub force: Newtons,
    /// Largest change of the force.
    pub slew: NewtonsPerSecond,
}

/// A serial arm with three revolute joints: yaw, shoulder, elbow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Arm {
    /// Upper arm and forearm.
    pub links: [Metres; 2],
    /// Joint angles of the home pose, which is the origin of device space.
    pub home: [Radians; 3],
    /// Encoder counts in a full turn of a joint.
    pub counts_per_turn: [i32; 3],
    /// Joint angles between which the mechanism can stand.
    pub reach: [[Radians; 2]; 3],
}

/// Calibration and ceilings; ceilings may only be lowered.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Config {
    /// Where the hand's space lies in the world.
    pub world_from_device: WorldFromDevice,
    /// Limits at or below those of the image.
    pub ceilings: Ceilings,
}

/// Which force modes act. What is off costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Modes {
    /// The surface gives and pops.
    pub surface: bool,
    /// Thick is harder to stir.
    pub viscosity: bool,
    /// Currents carry the hand.
    pub flow: bool,
    /// The vessel is solid.
    pub walls: bool,
}

/// What the servo renders.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Params {
    /// Force modes.
    pub modes: Modes,
    /// Medium at rest, outside of every field's window and after it went stale.
    pub rest: RestMedium,
    /// Force at which the surface lets go of a probe that comes out.
    pub pull_force: Newtons,
    /// The probe's buoyancy, to damp it; zero for one that has none.
    pub buoyancy: Buoyancy,
}

/// How stiffly the probe floats. The force itself travels with the field; a spring that is sampled
/// needs its damper beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Buoyancy {
    /// Radius of the probe, at the hand.
    pub radius: Metres,
    /// Change of buoyancy with depth where the probe is half under, at the hand.
    pub stiffness: NewtonsPerMetre,
}

/// A medium at rest: only ever dissipative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct RestMedium {
    /// c1 of F = -(c1 + c2 |v|) v.
    pub linear_drag: NewtonSecondsPerMetre,
    /// c2 of F = -(c1 + c2 |v|) v.
    pub quadratic_drag: NewtonSeconds2PerMetre2,
}

/// The field that acts stays right.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Keep {
    /// Which field.
    pub epoch: u32,
    /// Until when, in device ticks.
    pub valid_until: Ticks,
}

/// A fault and when it struck.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FaultEntry {
    /// When.
    pub tick: Ticks,
    /// Why.
    pub fault: Fault,
}
