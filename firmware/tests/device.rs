//! The whole device on a bench made of nothing but a byte pipe and counts that we choose.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use cauldron_firmware::{
    board::{Board, Sensed},
    device::Device,
    presets::OMNI_LIKE,
    settings::Image,
    stopwatch::Unwatched,
};
use cauldron_protocol::{
    Down, Fault, Kind, Refusal, State, States, Supervisor, Up, Verdict, Vessel, Wall,
    field::SlabHead,
    frame::{Decoder, MAX_FRAME, encode, encode_message},
    message::{Buoyancy, Ceilings, Keep, Modes, Params, RestMedium},
    units::{
        Metres, NewtonMetres, NewtonSecondsPerMetre, Newtons, NewtonsPerMetre, NewtonsPerSecond,
        Ticks,
    },
};
use proptest::prelude::*;

const IMAGE: Image = Image {
    ceilings: Ceilings { force: Newtons(3.0), slew: NewtonsPerSecond(500.0) },
    ..OMNI_LIKE
};

#[derive(Default)]
struct Bench {
    sensed: Sensed,
    to_device: Vec<u8>,
    from_device: Vec<u8>,
    torque: [NewtonMetres; 3],
}

impl Board for Bench {
    fn sense(&mut self) -> Sensed {
        self.sensed
    }
    fn drive(&mut self, torque: [NewtonMetres; 3]) {
        self.torque = torque;
    }
    fn receive(&mut self, into: &mut [u8]) -> usize {
        let n = into.len().min(self.to_device.len());
        into[..n].copy_from_slice(&self.to_device[..n]);
        self.to_device.drain(..n);
        n
    }
    fn send(&mut self, bytes: &[u8]) {
        self.from_device.extend(bytes);
    }
}

struct Rig {
    device: Device,
    bench: Bench,
    sequence: u16,
    ticks: u32,
    ups: Vec<Up>,
    decoder: Decoder,
}

impl Rig {
    fn new() -> Self {
        let sensed = Sensed { deadman: true, link_up: true, ..Sensed::default() };
        Self {
            device: Device::new(IMAGE),
            bench: Bench { sensed, ..Bench::default() },
            sequence: 0,
            ticks: 0,
            ups: Vec::new(),
            decoder: Decoder::default(),
        }
    }

    fn say(&mut self, down: &Down) {
        self.sequence += 1;
        let mut frame = [0; MAX_FRAME];
        let bytes = encode_message(Kind::Down, self.sequence, down, &mut frame).unwrap();
        self.bench.to_device.extend_from_slice(bytes);
    }

    /// Says that the first field stays right, which is also a sign of life.
    fn keep(&mut self) {
        let valid_until = Ticks(self.ticks + 500);
        self.say(&Down::Keep(Keep { epoch: 1, valid_until }));
    }

    fn tick(&mut self) -> State {
        self.ticks += 1;
        let state = self.device.tick(&mut self.bench, &mut Unwatched).state;
        let bytes = std::mem::take(&mut self.bench.from_device);
        let mut rest = &bytes[..];
        while let Some(frame) = self.decoder.feed(&mut rest) {
            match frame.kind {
                Kind::Up => self.ups.push(postcard::from_bytes(frame.body).unwrap()),
                _ => assert!(postcard::from_bytes::<States>(frame.body).unwrap().is_full()),
            }
        }
        state
    }

    fn verdict(&mut self, down: &Down) -> Verdict {
        self.say(down);
        self.tick();
        match self.ups.pop() {
            Some(Up::Ack { sequence, verdict }) if sequence == self.sequence => verdict,
            other => panic!("no answer to {down:?}: {other:?}"),
        }
    }
}

fn floor() -> Vessel {
    let wall = Wall::Plane { normal: [0.0, 1.0, 0.0], offset: Metres(0.002) };
    Vessel {
        walls: [wall].into_iter().collect(),
        stiffness: NewtonsPerMetre(500.0),
        damping: NewtonSecondsPerMetre(0.0),
    }
}

fn params() -> Params {
    let modes = Modes { walls: true, viscosity: true, ..Modes::default() };
    let (rest, buoyancy) = (RestMedium::default(), Buoyancy::default());
    Params { modes, rest, pull_force: Newtons(0.0), buoyancy }
}

/// A rig that runs and leans 2 mm into a floor of 500 N/m.
fn pressing() -> Rig {
    let mut rig = Rig::new();
    rig.tick();
    assert_eq!(rig.verdict(&Down::Vessel(floor())), Verdict::Accepted);
    assert_eq!(rig.verdict(&Down::Params(params())), Verdict::Accepted);
    assert_eq!(rig.verdict(&Down::Arm), Verdict::Accepted);
    let head = cauldron_protocol::field::FieldHead {
        epoch: 1,
        valid_until: Ticks(500),
        nodes: [2; 3],
        spacing: Metres(0.01),
        ..Default::default()
    };
    rig.say(&Down::Field(head)); // no channel: whole with its head
    for _ in 0..300 {
        rig.keep();
        rig.tick();
    }
    rig
}

#[test]
fn arming_needs_vessel_params_and_deadman() {
    let mut rig = Rig::new();
    rig.tick();
    assert_eq!(rig.verdict(&Down::Arm), Verdict::Refused(Refusal::NoVessel));
    rig.verdict(&Down::Vessel(floor()));
    assert_eq!(rig.verdict(&Down::Arm), Verdict::Refused(Refusal::NoParams));
    rig.verdict(&Down::Params(params()));
    rig.bench.sensed.deadman = false;
    rig.tick();
    assert_eq!(rig.verdict(&Down::Arm), Verdict::Refused(Refusal::DeadmanOpen));
    rig.bench.sensed.deadman = true;
    rig.tick();
    assert_eq!(rig.verdict(&Down::Arm), Verdict::Accepted);
    assert_eq!(rig.tick().supervisor, Supervisor::Armed);
    assert_eq!(rig.verdict(&Down::Arm), Verdict::Refused(Refusal::WrongState));
    assert_eq!(rig.verdict(&Down::Dfu), Verdict::Refused(Refusal::NotOnThisBoard));
}

#[test]
fn a_wall_pushes_by_its_stiffness_and_an_unplugged_one_is_safe_in_ten_milliseconds() {
    let mut rig = pressing();
    let state = rig.tick();
    assert_eq!(state.supervisor, Supervisor::Running);
    assert!((state.force[1].0 - 1.0).abs() < 1e-4, "{:?}", state.force);
    assert!(rig.bench.torque.iter().any(|t| t.0.abs() > 0.05));
    rig.bench.sensed.link_up = false;
    let unplugged: Vec<State> = (0..10).map(|_| rig.tick()).collect();
    assert_eq!(unplugged[9].supervisor, Supervisor::Fault(Fault::CableGone));
    assert!(unplugged[9].force.iter().all(|f| f.0 == 0.0));
    assert!(rig.bench.torque.iter().all(|t| t.0 == 0.0));
}

#[test]
fn an_overrun_and_an_encoder_jump_are_safe_in_two_milliseconds() {
    for fault in [Fault::Overrun, Fault::EncoderJump] {
        let mut rig = pressing();
        match fault {
            Fault::Overrun => rig.bench.sensed.overrun = true,
            _ => rig.bench.sensed.counts[1] += 3000,
        }
        rig.tick();
        let state = rig.tick();
        assert_eq!(state.supervisor, Supervisor::Fault(fault));
        assert!(state.force.iter().all(|f| f.0 == 0.0), "{:?}", state.force);
        rig.bench.sensed.overrun = false;
        rig.tick();
        assert_eq!(rig.verdict(&Down::Disarm), Verdict::Accepted);
        assert_eq!(rig.tick().supervisor, Supervisor::Idle);
        rig.say(&Down::ReadFaultLog);
        rig.tick();
        let Some(Up::FaultLog(log)) = rig.ups.pop() else { panic!("no log") };
        assert_eq!(log.iter().map(|e| e.fault).collect::<Vec<_>>(), [fault]);
    }
}

#[test]
fn a_keep_for_another_field_is_refused_and_told() {
    let mut rig = pressing();
    let keep = Keep { epoch: 9, valid_until: Ticks(500) };
    assert_eq!(rig.verdict(&Down::Keep(keep)), Verdict::Refused(Refusal::WrongEpoch));
    assert_eq!(rig.tick().last_command.verdict, Verdict::Refused(Refusal::WrongEpoch));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn whatever_bytes_come_forces_stay_finite_and_below_the_ceiling(
        junk in proptest::collection::vec(any::<u8>(), 0..4000),
        walk in proptest::collection::vec(-60..60_i32, 120),
    ) {
        let mut rig = pressing();
        rig.bench.to_device.extend(junk);
        for (i, step) in walk.into_iter().enumerate() {
            rig.bench.sensed.counts[i % 3] += step;
            let force = rig.tick().force.map(|f| f.0);
            let squared: f32 = force.iter().map(|f| f * f).sum();
            prop_assert!(squared <= 9.0, "{force:?}");
        }
    }

    /// Sound frames around hostile bodies: what gets past the CRC must not get past the checks.
    #[test]
    fn whatever_messages_come_forces_stay_finite_and_below_the_ceiling(
        bodies in proptest::collection::vec(
            (0..11_u8, proptest::collection::vec(any::<u8>(), 0..90)), 1..40),
        slabs in proptest::collection::vec(any::<u8>(), 0..500),
    ) {
        let mut rig = pressing();
        for (kind, rest) in bodies {
            let mut frame = [0; MAX_FRAME];
            rig.sequence += 1;
            let body = [&[kind][..], &rest].concat();
            let bytes = encode(Kind::Down, rig.sequence, &mut frame, |room| {
                room.get_mut(..body.len())?.copy_from_slice(&body);
                Some(body.len())
            });
            rig.bench.to_device.extend_from_slice(bytes.unwrap());
            rig.sequence += 1;
            let slab = encode(Kind::FieldSlab, rig.sequence, &mut frame, |room| {
                SlabHead { epoch: 2, index: 0 }.join(&slabs, room)
            });
            rig.bench.to_device.extend_from_slice(slab.unwrap());
            for _ in 0..3 {
                let force = rig.tick().force.map(|f| f.0);
                let squared: f32 = force.iter().map(|f| f * f).sum();
                prop_assert!(squared <= 9.0, "{force:?}");
            }
        }
    }
}
