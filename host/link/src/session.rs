//! The session: greet, set up, arm, run; and again from the start whenever the device was lost.

use cauldron_protocol::{
    Down, Kind, PROTOCOL_VERSION, Refusal, State, States, Supervisor, Up, Verdict, Vessel,
    field::{FieldHead, SlabHead},
    frame::{Decoder, MAX_FRAME, encode, encode_message},
    message::{Config, Identity, Keep, Params},
    schema_hash,
    units::Ticks,
};
use std::fmt;

use crate::{clock::DeviceClock, transport::Transport};

/// A command that was not answered is said again after this.
const RETRY_US: u64 = 100_000;
/// The host says something at least this often.
const HEARTBEAT_US: u64 = 50_000;
/// A device that says nothing for so long is lost.
const LOST_US: u64 = 500_000;

/// What a device is set up with; kept, so that a device that was lost gets it again.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Calibration and ceilings.
    pub config: Config,
    /// The static geometry.
    pub vessel: Vessel,
    /// What the servo renders.
    pub params: Params,
}

/// Why a session cannot go on.
#[derive(Clone, Debug, PartialEq)]
pub enum SessionError {
    /// The image on the device speaks another language.
    Mismatch {
        /// What it said of itself.
        device: Box<Identity>,
    },
    /// The device will not have what it is set up with.
    Refused {
        /// Which step.
        step: &'static str,
        /// Why.
        why: Refusal,
    },
}

impl fmt::Display for SessionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mismatch { device } => write!(
                f,
                "the device speaks protocol {} (schema {:#018x}), this program {PROTOCOL_VERSION} \
                 ({:#018x}): flash the firmware that belongs to it",
                device.protocol_version,
                device.schema_hash,
                schema_hash()
            ),
            Self::Refused { step, why } => write!(f, "the device refused to {step}: {why:?}"),
        }
    }
}

impl std::error::Error for SessionError {}

/// The steps of a session in their order; each waits for its answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Greet,
    Disarm,
    Configure,
    LoadVessel,
    LoadParams,
    Arm,
    Run,
}

impl Step {
    fn next(self) -> Self {
        match self {
            Self::Greet => Self::Disarm,
            Self::Disarm => Self::Configure,
            Self::Configure => Self::LoadVessel,
            Self::LoadVessel => Self::LoadParams,
            Self::LoadParams => Self::Arm,
            Self::Arm | Self::Run => Self::Run,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Greet => "say who it is",
            Self::Disarm => "disarm",
            Self::Configure => "take its configuration",
            Self::LoadVessel => "take the vessel",
            Self::LoadParams => "take the params",
            Self::Arm => "arm",
            Self::Run => "run",
        }
    }
}

/// What a step has asked: an answer that comes only after the retry is an answer too.
#[derive(Clone, Copy, Debug)]
struct Asked {
    first: u16,
    last: u16,
    at_us: u64,
}

impl Asked {
    fn is_answered_by(&self, sequence: u16) -> bool {
        sequence.wrapping_sub(self.first) <= self.last.wrapping_sub(self.first)
    }
}

/// What the session counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// States received.
    pub states: u64,
    /// Ticks between states received of which no state came.
    pub missed: u64,
    /// Fields sent.
    pub fields: u64,
    /// Keeps sent.
    pub keeps: u64,
    /// Bytes of fields and Keeps, as on the wire.
    pub field_bytes: u64,
    /// Times the device was set up.
    pub setups: u64,
}

/// A session over a transport.
#[derive(Debug)]
pub struct Session<T> {
    /// What carries it.
    pub transport: T,
    setup: Setup,
    step: Step,
    asked: Option<Asked>,
    sequence: u16,
    decoder: Decoder,
    bytes: Vec<u8>,
    states: Vec<State>,
    newest: Option<Ticks>,
    heard_us: u64,
    spoke_us: u64,
    clock: DeviceClock,
    identity: Option<Identity>,
    counts: Counts,
}

impl<T: Transport> Session<T> {
    /// A session that has not yet greeted.
    #[must_use]
    pub fn new(transport: T, setup: Setup) -> Self {
        Self {
            transport,
            setup,
            step: Step::Greet,
            asked: None,
            sequence: 0,
            decoder: Decoder::default(),
            bytes: Vec::new(),
            states: Vec::new(),
            newest: None,
            heard_us: 0,
            spoke_us: 0,
            clock: DeviceClock::default(),
            identity: None,
            counts: Counts::default(),
        }
    }

    /// True while the device is armed or runs: it takes fields.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.step == Step::Run
    }

    /// What the device said of itself.
    #[must_use]
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// What was counted.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The device's tick at `now_us`, once it has said one.
    #[must_use]
    pub fn device_tick(&self, now_us: u64) -> Option<Ticks> {
        self.clock.tick_at(now_us)
    }

    /// Takes in what the device said, says what is due; the states that came, oldest first.
    ///
    /// # Errors
    /// [`SessionError`] if the device and this program cannot work together. A link that is down
    /// is no error: the session waits and begins anew.
    pub fn poll(&mut self, now_us: u64) -> Result<&[State], SessionError> {
        self.states.clear();
        let mut bytes = std::mem::take(&mut self.bytes);
        bytes.clear();
        let link = self.transport.receive(now_us, &mut bytes);
        let taken = self.take(now_us, &bytes);
        self.bytes = bytes;
        taken?;
        if link.is_err() || now_us.saturating_sub(self.heard_us) > LOST_US {
            self.begin_anew(now_us);
        }
        self.say_what_is_due(now_us);
        Ok(&self.states)
    }

    /// Sends a field: its head, and its samples in slabs.
    pub fn send_field(&mut self, now_us: u64, head: &FieldHead, samples: &[i16]) {
        self.counts.fields += 1;
        self.counts.field_bytes += self.say(now_us, &Down::Field(*head)) as u64;
        let bytes: Vec<u8> = samples.iter().flat_map(|s| s.to_le_bytes()).collect();
        for (index, data) in (0..).zip(bytes.chunks(SlabHead::MAX_DATA)) {
            let slab = SlabHead { epoch: head.epoch, index };
            let mut frame = [0; MAX_FRAME];
            let sequence = self.next_sequence();
            let sent = encode(Kind::FieldSlab, sequence, &mut frame, |room| slab.join(data, room));
            self.counts.field_bytes += self.hand_over(now_us, sent.unwrap_or(&[])) as u64;
        }
    }

    /// Says that the field that acts stays right.
    pub fn send_keep(&mut self, now_us: u64, keep: Keep) {
        self.counts.keeps += 1;
        self.counts.field_bytes += self.say(now_us, &Down::Keep(keep)) as u64;
    }

    /// Says goodbye: no more force.
    pub fn disarm(&mut self, now_us: u64) {
        self.say(now_us, &Down::Disarm);
    }

    fn take(&mut self, now_us: u64, mut bytes: &[u8]) -> Result<(), SessionError> {
        let mut ups = Vec::new();
        while let Some(frame) = self.decoder.feed(&mut bytes) {
            match frame.kind {
                Kind::States => {
                    let states = postcard::from_bytes::<States>(frame.body).unwrap_or_default();
                    self.states.extend(states);
                }
                Kind::Up => ups.extend(postcard::from_bytes::<Up>(frame.body)),
                Kind::Down | Kind::FieldSlab => {}
            }
        }
        self.note_states(now_us);
        ups.into_iter().try_for_each(|up| self.hear(now_us, up))
    }

    fn note_states(&mut self, now_us: u64) {
        for state in &self.states {
            self.heard_us = now_us;
            self.counts.states += 1;
            let gap = self.newest.map_or(0, |newest| state.tick.since(newest).saturating_sub(1));
            if gap < 0 {
                self.clock.restart(); // the device started anew
            }
            self.counts.missed += u64::try_from(gap).unwrap_or(0);
            self.newest = Some(state.tick);
            self.clock.see(now_us, state.tick);
        }
        let stopped = self
            .states
            .last()
            .is_some_and(|s| matches!(s.supervisor, Supervisor::Idle | Supervisor::Fault(_)));
        if stopped && self.step == Step::Run {
            self.step = Step::Disarm; // it knows us still: set up and arm again
            self.asked = None;
        }
    }

    fn hear(&mut self, now_us: u64, up: Up) -> Result<(), SessionError> {
        self.heard_us = now_us;
        match up {
            Up::Hello(identity) => self.meet(identity),
            Up::Ack { sequence, verdict } => self.judge(sequence, verdict),
            Up::Pong { .. } | Up::FaultLog(_) => Ok(()),
        }
    }

    fn meet(&mut self, identity: Identity) -> Result<(), SessionError> {
        let ours = (PROTOCOL_VERSION, schema_hash());
        if (identity.protocol_version, identity.schema_hash) != ours {
            return Err(SessionError::Mismatch { device: Box::new(identity) });
        }
        self.identity = Some(identity);
        if self.step == Step::Greet {
            self.advance();
        }
        Ok(())
    }

    fn judge(&mut self, sequence: u16, verdict: Verdict) -> Result<(), SessionError> {
        let Some(asked) = self.asked.filter(|asked| asked.is_answered_by(sequence)) else {
            return Ok(()); // the answer to something older
        };
        match verdict {
            Verdict::Accepted => self.advance(),
            // These pass: the cause of a fault goes away, a hand comes back to the grip.
            Verdict::Refused(Refusal::FaultStands | Refusal::DeadmanOpen) => {
                self.asked = Some(Asked { first: self.sequence, last: self.sequence, ..asked });
            }
            Verdict::Refused(Refusal::WrongState) => {
                self.step = Step::Disarm;
                self.asked = None;
            }
            Verdict::Refused(why) => {
                return Err(SessionError::Refused { step: self.step.name(), why });
            }
        }
        Ok(())
    }

    fn advance(&mut self) {
        self.step = self.step.next();
        self.asked = None;
        if self.step == Step::Run {
            self.counts.setups += 1;
        }
    }

    fn begin_anew(&mut self, now_us: u64) {
        self.step = Step::Greet;
        self.heard_us = now_us;
        self.asked = None;
        self.decoder.restart();
    }

    fn say_what_is_due(&mut self, now_us: u64) {
        let waited_us = self.asked.map_or(u64::MAX, |asked| now_us.saturating_sub(asked.at_us));
        if self.step != Step::Run && waited_us > RETRY_US {
            let command = self.command();
            let first = self.asked.map_or(self.sequence, |asked| asked.first);
            self.asked = Some(Asked { first, last: self.sequence, at_us: now_us });
            self.say(now_us, &command);
        } else if now_us.saturating_sub(self.spoke_us) >= HEARTBEAT_US {
            self.say(now_us, &Down::Ping { host_us: now_us as u32 });
        }
    }

    fn command(&self) -> Down {
        match self.step {
            Step::Greet => Down::Hello,
            Step::Disarm => Down::Disarm,
            Step::Configure => Down::Configure(self.setup.config),
            Step::LoadVessel => Down::Vessel(self.setup.vessel.clone()),
            Step::LoadParams => Down::Params(self.setup.params),
            Step::Arm => Down::Arm,
            Step::Run => Down::Ping { host_us: 0 },
        }
    }

    fn say(&mut self, now_us: u64, down: &Down) -> usize {
        let mut frame = [0; MAX_FRAME];
        let sequence = self.next_sequence();
        let bytes = encode_message(Kind::Down, sequence, down, &mut frame).unwrap_or(&[]);
        self.hand_over(now_us, bytes)
    }

    fn hand_over(&mut self, now_us: u64, bytes: &[u8]) -> usize {
        self.spoke_us = now_us;
        // A link that is down shows in the next poll, which begins anew.
        let _ = self.transport.send(now_us, bytes);
        bytes.len()
    }

    fn next_sequence(&mut self) -> u16 {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        sequence
    }
}
