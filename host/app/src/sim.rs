//! The simulated device: the firmware itself, on a board that is simulated, at its end of a pipe.

use cauldron_board_sim::{Act, Grip, PlantParams, Script, SimBoard, script::Press, stroke};
use cauldron_firmware::{device::Device, presets::OMNI_LIKE, stopwatch::Unwatched, tape};
use cauldron_fluid::scenes::{self, Scene, Story};
use cauldron_link::{PipeEnd, Transport};
use cauldron_protocol::{State, WorldFromDevice};
use glam::{DVec3, Vec3};

/// Firmware, board, and the device's end of the cable.
#[derive(Debug)]
pub struct SimDevice {
    /// The board; its hand and its socket.
    pub board: SimBoard,
    firmware: Device,
    cable: PipeEnd,
    bytes: Vec<u8>,
    tape: Option<Vec<u8>>,
}

impl SimDevice {
    /// An arm like the Omni's in the hand of `script`.
    #[must_use]
    pub fn new(script: Script, grip: Grip, cable: PipeEnd, seed: u64) -> Self {
        Self {
            board: SimBoard::new(&OMNI_LIKE, PlantParams::OMNI_LIKE, grip, script, seed),
            firmware: Device::new(OMNI_LIKE),
            cable,
            bytes: Vec::new(),
            tape: None,
        }
    }

    /// Records from now on what the firmware meets.
    pub fn start_tape(&mut self) {
        self.tape = Some(Vec::new());
    }

    /// The tape so far: what [`tape::play`] plays.
    #[must_use]
    pub fn tape(&self) -> Option<&[u8]> {
        self.tape.as_deref()
    }

    /// The cable, to pull it.
    #[must_use]
    pub fn cable(&self) -> &PipeEnd {
        &self.cable
    }

    /// One tick: bytes in, the firmware's tick, bytes out, a millisecond of the world.
    pub fn tick(&mut self) -> State {
        self.bytes.clear();
        self.board.port.up = self.cable.receive(0, &mut self.bytes).is_ok();
        self.board.port.inbox.extend(self.bytes.iter().copied());
        let drive = match &mut self.tape {
            Some(tape) => {
                let mut board = tape::Recorder::new(&mut self.board, tape);
                self.firmware.tick(&mut board, &mut Unwatched)
            }
            None => self.firmware.tick(&mut self.board, &mut Unwatched),
        };
        // What a pulled cable does not take is lost, as on USB.
        let _ = self.cable.send(0, &self.board.port.outbox);
        self.board.port.outbox.clear();
        self.board.advance();
        drive.state
    }
}

/// A scene's story as the hand plays it: from world metres to device metres.
#[must_use]
pub fn script_of(scene: &Scene) -> Script {
    let Story { start_m, acts, pours, .. } = &scene.story;
    let map = &scene.feel.world_from_device;
    let acts: Vec<Act> = acts.iter().map(|act| act_in_device(act, map)).collect();
    let presses = pours.iter().map(|pour| Press {
        button: pour.substance as u8,
        from_s: f64::from(pour.from_s),
        to_s: f64::from(pour.to_s),
    });
    Script::new(point_in_device(*start_m, map), &acts, presses.collect())
}

fn act_in_device(act: &scenes::Act, map: &WorldFromDevice) -> Act {
    match *act {
        scenes::Act::Reach { to_m, seconds } => {
            Act::Reach { to_m: point_in_device(to_m, map), seconds: seconds.into() }
        }
        scenes::Act::Rest { seconds } => Act::Rest { seconds: seconds.into() },
        scenes::Act::LetGo { seconds } => Act::LetGo { seconds: seconds.into() },
        scenes::Act::Stir { centre_m, radius_m, seconds } => Act::Stir {
            centre_m: point_in_device(centre_m, map),
            radius_m: f64::from(radius_m / map.scale),
            strokes: stroke::circles(),
            seconds: seconds.into(),
        },
    }
}

fn point_in_device(world_m: Vec3, map: &WorldFromDevice) -> DVec3 {
    Vec3::from_array(map.point_in_device(world_m.to_array())).as_dvec3()
}
