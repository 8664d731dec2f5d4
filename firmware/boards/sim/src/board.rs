//! The board itself.

use cauldron_firmware::{
    TICK_S,
    board::{Board, Sensed},
    settings::Image,
};
use cauldron_protocol::units::NewtonMetres;
use glam::DVec3;
use oorandom::Rand64;
use std::collections::VecDeque;

use crate::{
    arm::ArmModel,
    hand::{Grip, Hand},
    plant::{Plant, PlantParams},
    script::Script,
};

/// Jitter of an optical encoder's edges, as a part of a count.
const NOISE_COUNTS: f64 = 0.05;

/// What the board's USB socket holds: bytes that came, bytes to go, and whether it is plugged.
#[derive(Clone, Debug)]
pub struct Port {
    /// From the host, not yet read.
    pub inbox: VecDeque<u8>,
    /// To the host, not yet taken.
    pub outbox: Vec<u8>,
    /// The cable is in.
    pub up: bool,
}

/// An arm, a hand that holds it, and a socket.
#[derive(Debug)]
pub struct SimBoard {
    /// The socket; whoever carries the bytes fills and empties it.
    pub port: Port,
    arm: ArmModel,
    plant: Plant,
    hand: Hand,
    random: Rand64,
    time_s: f64,
    torque_n_m: [f64; 3],
}

impl SimBoard {
    /// A hand at its script's start holds the handle of `image`'s arm.
    #[must_use]
    pub fn new(image: &Image, plant: PlantParams, grip: Grip, script: Script, seed: u64) -> Self {
        let mut random = Rand64::new(u128::from(seed));
        let plant = Plant::new(plant, script.start_m());
        Self {
            port: Port { inbox: VecDeque::new(), outbox: Vec::new(), up: true },
            arm: ArmModel::new(&image.arm),
            plant,
            hand: Hand::new(script, grip, &mut random),
            random,
            time_s: 0.0,
            torque_n_m: [0.0; 3],
        }
    }

    /// Where the handle really is, in device metres.
    #[must_use]
    pub fn handle_m(&self) -> DVec3 {
        self.plant.position_m
    }

    /// Lets a tick of time pass.
    pub fn advance(&mut self) {
        let tick_s = f64::from(TICK_S);
        let joints = self.arm.joints_rad(self.plant.position_m);
        let motor_n = self.arm.force_n(joints, self.torque_n_m);
        let hand_n = self.hand.force_n(self.time_s, tick_s);
        self.plant.advance(tick_s, motor_n, self.hand.mass_kg(self.time_s), hand_n);
        self.time_s += tick_s;
    }

    fn counts(&mut self) -> [i32; 3] {
        let readings = self.arm.readings(self.arm.joints_rad(self.plant.position_m));
        readings.map(|r| (r + NOISE_COUNTS * normal(&mut self.random)).round() as i32)
    }
}

/// A draw from the normal distribution (Box & Muller 1958).
fn normal(random: &mut Rand64) -> f64 {
    let radius = (-2.0 * (1.0 - random.rand_float()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.rand_float()).cos()
}

impl Board for SimBoard {
    fn sense(&mut self) -> Sensed {
        Sensed {
            counts: self.counts(),
            buttons: self.hand.buttons(self.time_s),
            deadman: true, // a pedal, held even where the hand lets go
            link_up: self.port.up,
            overrun: false,
        }
    }

    fn drive(&mut self, torque: [NewtonMetres; 3]) {
        self.torque_n_m = torque.map(|t| f64::from(t.0));
    }

    fn receive(&mut self, into: &mut [u8]) -> usize {
        let bytes = into.len().min(self.port.inbox.len());
        for (to, from) in into.iter_mut().zip(self.port.inbox.drain(..bytes)) {
            *to = from;
        }
        bytes
    }

    fn send(&mut self, bytes: &[u8]) {
        if self.port.up {
            self.port.outbox.extend_from_slice(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::Act;
    use cauldron_firmware::presets::OMNI_LIKE;

    fn board(seed: u64) -> SimBoard {
        let script = Script::resting(DVec3::new(0.02, -0.03, 0.01));
        SimBoard::new(&OMNI_LIKE, PlantParams::OMNI_LIKE, Grip::RELAXED, script, seed)
    }

    fn counts(seed: u64) -> Vec<[i32; 3]> {
        let there = Act::Reach { to_m: DVec3::new(0.0, 0.03, 0.0), seconds: 0.2 };
        let script = Script::new(DVec3::ZERO, &[there], Vec::new());
        let omni = PlantParams::OMNI_LIKE;
        let mut board = SimBoard::new(&OMNI_LIKE, omni, Grip::RELAXED, script, seed);
        (0..200).map(|_| (board.sense().counts, board.advance()).0).collect()
    }

    #[test]
    fn a_seed_is_a_run_and_another_seed_another() {
        assert_eq!(counts(1), counts(1));
        assert_ne!(counts(1), counts(2));
    }

    #[test]
    fn a_torque_moves_the_handle_against_the_grip() {
        let mut board = board(1);
        let at = board.handle_m();
        let joints = board.arm.joints_rad(at);
        // Columns: the force at the handle for a unit torque at each joint.
        let unit = |joint: usize| [0, 1, 2].map(|j| if j == joint { 1.0 } else { 0.0 });
        let force_of = |joint| board.arm.force_n(joints, unit(joint));
        let forces = glam::DMat3::from_cols(force_of(0), force_of(1), force_of(2));
        let torque = (forces.inverse() * DVec3::Y).to_array().map(|t| NewtonMetres(t as f32));
        board.drive(torque);
        for _ in 0..300 {
            board.advance();
        }
        let moved = board.handle_m() - at;
        // 1 N on 400 N/m is 2.5 mm, of which friction may keep 0.26 N.
        assert!((1.8e-3..2.6e-3).contains(&moved.y), "{moved}");
        assert!(moved.x.abs() < 3e-4 && moved.z.abs() < 3e-4, "{moved}");
    }

    #[test]
    fn an_unplugged_board_says_nothing() {
        let mut board = board(1);
        board.port.up = false;
        board.send(&[1, 2, 3]);
        assert!(board.port.outbox.is_empty() && !board.sense().link_up);
    }
}
