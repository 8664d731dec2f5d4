//! The host's side of the loop: states in, the pot on by a step, the next field out.

use cauldron_fluid::{
    Pot,
    force::{Baker, Life, Update},
    scenes::Scene,
    vessel::{RIM_M, Vessel},
};
use cauldron_link::{Session, SessionError, Setup, Transport, session::Counts};
use cauldron_protocol::{
    State, Wall, WorldFromDevice,
    message::{Ceilings, Config, Params},
    units::{Metres, NewtonSecondsPerMetre, Newtons, NewtonsPerMetre},
};
use glam::Vec3;
use oorandom::Rand64;

use crate::{ledger::Ledger, membrane::Membrane};

/// A field that has not come to act so long after it was sent is lost: its way and its wait take
/// some 20 ms, and so does the news of it.
const FIELD_LOST_US: u64 = 60_000;

/// What a field needs to get from the pot to the device, on virtual time. In real time it takes
/// what it takes, and this is what the host expects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latency {
    /// From a state of the pot to the field's first byte.
    pub compute_us: u64,
    /// Most that chance takes away from it or adds to it.
    pub jitter_us: u64,
    /// From the field's first byte to its last.
    pub transfer_us: u64,
}

impl Latency {
    /// In real time the way takes what it takes; this is what the host counts on.
    pub const LIVE: Self = Self { compute_us: 0, jitter_us: 0, transfer_us: 8_000 };
    /// 10 ms, and 6 ms with the jitters of both on top: a field that comes before its time waits
    /// for it, one that comes after it has lost its ramp.
    pub const DEFAULT: Self = Self { compute_us: 10_000, jitter_us: 1_000, transfer_us: 8_000 };

    fn total_us(&self) -> u64 {
        self.compute_us + self.transfer_us
    }
}

/// Session, pot, and the field between them.
pub struct Host<T> {
    /// The session with the device.
    pub session: Session<T>,
    /// The pot.
    pub pot: Pot,
    baker: Baker,
    world_from_device: WorldFromDevice,
    latency: Latency,
    random: Rand64,
    step_us: u64,
    next_step_us: u64,
    due: Option<(u64, Update)>,
    setups: u64,
    field_sent_us: u64,
    probe: Option<State>,
    ledger: Ledger,
    membrane: Membrane,
    /// States that came with the last poll, oldest first.
    pub states: Vec<State>,
}

impl<T: Transport> Host<T> {
    /// Over `transport`, for a scene and its pot.
    #[must_use]
    pub fn new(transport: T, scene: &Scene, pot: Pot, latency: Latency, seed: u64) -> Self {
        let feel = &scene.feel;
        let step_us = (f64::from(scene.step_s) * 1e6).round() as u64;
        let loop_s = 1e-6 * (step_us + latency.total_us()) as f64;
        let baker = Baker::new(&pot, feel.world_from_device, feel.felt_scale, loop_s);
        let params = Params {
            modes: feel.modes,
            rest: baker.rest_medium(&pot),
            pull_force: Newtons(baker.pull_force_n(&pot)),
            buoyancy: baker.buoyancy(&pot),
        };
        let config = Config { world_from_device: feel.world_from_device, ceilings: CEILINGS };
        let setup = Setup { config, vessel: vessel_of(scene), params };
        Self {
            session: Session::new(transport, setup),
            pot,
            baker,
            world_from_device: feel.world_from_device,
            latency,
            random: Rand64::new(u128::from(seed)),
            step_us,
            next_step_us: step_us,
            due: None,
            setups: 0,
            field_sent_us: 0,
            probe: None,
            ledger: Ledger::new(f64::from(feel.felt_scale), (step_us / 1000) as u32),
            membrane: Membrane::new(scene),
            states: Vec::new(),
        }
    }

    /// The newest state heard.
    #[must_use]
    pub fn probe(&self) -> Option<&State> {
        self.probe.as_ref()
    }

    /// The probe's radius in world metres.
    #[must_use]
    pub fn probe_radius_m(&self) -> f32 {
        self.pot.probe_radius_m()
    }

    /// Largest norm of the felt force.
    #[must_use]
    pub fn force_limit_n(&self) -> f32 {
        CEILINGS.force.0
    }

    /// Takes in what the device said; steps the pot and sends a field when it is time to.
    ///
    /// # Errors
    /// [`SessionError`] if device and program cannot work together.
    pub fn poll(&mut self, now_us: u64) -> Result<(), SessionError> {
        self.states.clear();
        self.states.extend_from_slice(self.session.poll(now_us)?);
        for state in &self.states {
            self.ledger.note(state);
            if let Some(energy_j) = self.membrane.note(state) {
                self.pot.release(energy_j);
            }
        }
        self.probe = self.states.last().copied().or(self.probe);
        if self.session.counts().setups != self.setups {
            self.setups = self.session.counts().setups;
            self.baker.restart();
        }
        if now_us >= self.next_step_us {
            self.next_step_us += self.step_us;
            self.step(now_us);
        }
        self.send_what_is_due(now_us);
        Ok(())
    }

    /// What the session counted.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.session.counts()
    }

    /// A device position in world metres.
    #[must_use]
    pub fn in_world_m(&self, device: [Metres; 3]) -> Vec3 {
        self.world_from_device.point(device.map(|x| x.0)).into()
    }

    /// One step of the pot, and the field that comes of it.
    fn step(&mut self, now_us: u64) {
        let dt_s = 1e-6 * self.step_us as f32;
        let ahead_us = self.latency.total_us() + self.step_us;
        let given = self.ledger.draw();
        if let Some(probe) = self.probe {
            let at = self.in_world_m(probe.position);
            let velocity =
                Vec3::from_array(probe.velocity.map(|v| v.0)) * self.world_from_device.scale;
            self.baker.aim(&self.pot, at + velocity * (1e-6 * ahead_us as f32));
            self.pot.place_probe(at);
            self.pot.take(given.to_liquid_n_s, given.to_surface_n_s, dt_s);
            self.pot.pour(probe.buttons, dt_s);
        }
        self.pot.step(dt_s);
        self.pot.look_ahead(1e-6 * ahead_us as f32);
        let Some(tick) = self.session.device_tick(now_us).filter(|_| self.session.is_running())
        else {
            return;
        };
        let from = tick.plus((self.latency.total_us() / 1000) as u32);
        let life = Life {
            from,
            until: from.plus((self.step_us / 1000) as u32),
            ahead_s: 1e-6 * ahead_us as f32,
        };
        if self.is_field_lost(now_us) {
            self.baker.restart();
        }
        let update = self.baker.bake(&self.pot, dt_s, life);
        self.send_now(now_us); // the one before, if it still waits
        self.due = Some((now_us + self.compute_us(), update));
    }

    /// True if the device should have the last field by now and says that it has another: a
    /// slab was lost, and a Keep of what never came whole keeps nothing.
    fn is_field_lost(&self, now_us: u64) -> bool {
        let overdue = now_us.saturating_sub(self.field_sent_us) > FIELD_LOST_US;
        overdue && self.probe.is_some_and(|state| state.field_epoch != self.baker.epoch())
    }

    fn compute_us(&mut self) -> u64 {
        let chance = 2.0 * self.random.rand_float() - 1.0;
        self.latency
            .compute_us
            .saturating_add_signed((chance * self.latency.jitter_us as f64) as i64)
    }

    fn send_what_is_due(&mut self, now_us: u64) {
        if self.due.as_ref().is_some_and(|(due_us, _)| *due_us <= now_us) {
            self.send_now(now_us);
        }
    }

    fn send_now(&mut self, now_us: u64) {
        match self.due.take() {
            Some((_, Update::Field(field))) => {
                self.field_sent_us = now_us;
                self.session.send_field(now_us, &field.head, &field.samples);
            }
            Some((_, Update::Keep(keep))) => self.session.send_keep(now_us, keep),
            None => {}
        }
    }
}

/// What the host asks for: the image's own ceilings.
const CEILINGS: Ceilings = cauldron_firmware::presets::OMNI_LIKE.ceilings;

/// The scene's vessel as the device holds it: shrunk by the probe, in device metres. The wire has
/// planes and pots: a bowl is felt as a pot, and a vessel of another shape as the grid's box.
fn vessel_of(scene: &Scene) -> cauldron_protocol::Vessel {
    let feel = &scene.feel;
    let map = &feel.world_from_device;
    let probe_m = scene.probe.radius_m;
    let walls = match scene.vessel {
        Vessel::Box | Vessel::Cylinder { .. } | Vessel::Distance(_) => box_walls(scene, probe_m),
        Vessel::Pot { centre_in_world_m, radius_m }
        | Vessel::Bowl { centre_in_world_m, radius_m } => {
            let top_m = scene.grid.origin_in_world_m.y + scene.grid.extent_m().y;
            [Wall::Pot {
                centre: map.point_in_device(centre_in_world_m.to_array()).map(Metres),
                radius: Metres((radius_m - probe_m).max(0.0) / map.scale),
                rim: Metres((top_m - centre_in_world_m.y + RIM_M) / map.scale),
            }]
            .into_iter()
            .collect()
        }
    };
    cauldron_protocol::Vessel {
        walls,
        stiffness: NewtonsPerMetre(feel.wall_stiffness_n_per_m),
        damping: NewtonSecondsPerMetre(feel.wall_damping_n_s_per_m),
    }
}

/// The six faces of the grid's box; five if it holds a liquid with a surface, which one must get
/// into.
fn box_walls<const N: usize>(scene: &Scene, probe_m: f32) -> heapless::Vec<Wall, N> {
    let map = &scene.feel.world_from_device;
    let low = scene.grid.origin_in_world_m;
    let high = low + scene.grid.extent_m();
    let mut walls = heapless::Vec::new();
    for axis in 0..3 {
        for (corner, inward) in [(low, 1.0_f32), (high, -1.0)] {
            if axis == 1 && inward < 0.0 && scene.surface.is_some() {
                continue;
            }
            let mut normal = [0.0; 3];
            normal[axis] = inward;
            let mut face = corner;
            face[axis] += inward * probe_m;
            let offset = inward * map.point_in_device(face.to_array())[axis];
            // Six planes at most, and a vessel holds eight.
            let _ = walls.push(Wall::Plane { normal, offset: Metres(offset) });
        }
    }
    walls
}
