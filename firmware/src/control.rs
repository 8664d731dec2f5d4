//! One tick of the servo, and the commands that come between ticks.

use cauldron_protocol::{
    Down, Fault, Limit, Refusal, State, Up, Verdict,
    field::SlabHead,
    frame::Drops,
    state::{Flags, LastCommand},
    units::{NewtonMetres, Ticks},
};

use crate::{
    board::Sensed,
    encoder::Encoder,
    field::Field,
    kinematics::{Kinematics, Pose},
    ledger::Ledger,
    limit::{Acted, Limiter},
    servo::{Contact, Servo, Wanted, channels_for},
    settings::{Image, Settings},
    stopwatch::{Stage, Stopwatch},
    supervisor::{Gate, Signs, Watch},
    vector::Vec3,
    velocity::Velocity,
};

/// What leaves a tick.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    /// For the motors.
    pub torque: [NewtonMetres; 3],
    /// For the host; the link adds what it dropped.
    pub state: State,
}

/// The servo: settings, and what it remembers from tick to tick.
#[derive(Clone, Debug)]
pub struct Control {
    settings: Settings,
    last_command: LastCommand,
    kinematics: Kinematics,
    encoder: Encoder,
    pose: Pose,
    velocity: Velocity,
    field: Field,
    servo: Servo,
    watch: Watch,
    limiter: Limiter,
    ledger: Ledger,
    deadman: bool,
}

impl Control {
    /// In Idle, with nothing uploaded.
    #[must_use]
    pub fn new(image: Image) -> Self {
        Self {
            settings: Settings::new(image),
            last_command: LastCommand::default(),
            kinematics: Kinematics::new(&image.arm),
            encoder: Encoder::new(&image.arm),
            pose: Pose::default(),
            velocity: Velocity::default(),
            field: Field::default(),
            servo: Servo::default(),
            watch: Watch::default(),
            limiter: Limiter::default(),
            ledger: Ledger::default(),
            deadman: false,
        }
    }

    /// One tick: measure, decide, act. It must end within its millisecond; a board that sees it
    /// overrun says so in the next [`Sensed`], and that is a fault.
    pub fn tick(&mut self, now: Ticks, sensed: &Sensed, watch: &mut impl Stopwatch) -> Drive {
        let params = *self.settings.params();

        let joints = self.encoder.read(sensed.counts);
        watch.ended(Stage::Encoder);
        self.pose = joints.map_or(self.pose, |angles| self.kinematics.pose(angles));
        watch.ended(Stage::Kinematics);
        let position_m = self.pose.position_m;
        let velocity_m_s = self.velocity.update(position_m);
        watch.ended(Stage::Velocity);
        let freshness = self.field.advance(now);
        let channels = channels_for(params.modes);
        let medium = self.field.medium(now, position_m, channels, &params.rest);
        watch.ended(Stage::Field);

        let vessel = self.settings.vessel();
        let wanted = self.servo.force(&params, position_m, velocity_m_s, &medium, vessel);
        watch.ended(Stage::Servo);
        let gate = self.supervise(now, sensed, joints.err());
        watch.ended(Stage::Supervisor);

        let acted = self.limit(now, &wanted, gate, freshness);
        let torque = self.pose.torque(acted.force_n);
        watch.ended(Stage::Limit);
        Drive { torque, state: self.state(now, sensed, velocity_m_s, &wanted, &acted) }
    }

    fn supervise(&mut self, now: Ticks, sensed: &Sensed, sensing: Option<Fault>) -> Gate {
        self.deadman = sensed.deadman;
        if sensing.is_some() {
            self.velocity.restart();
        }
        let signs = Signs {
            link_up: sensed.link_up,
            overrun: sensed.overrun,
            deadman: sensed.deadman,
            field_acts: self.field.is_acting(),
            sensing,
        };
        self.watch.advance(now, &signs)
    }

    fn limit(&mut self, now: Ticks, wanted: &Wanted, gate: Gate, freshness: f32) -> Acted {
        let ceilings = self.settings.ceilings();
        let mut acted = self.limiter.apply(wanted.total_n(), gate, self.pose.regularity, ceilings);
        if let Some(fault) = acted.fault {
            self.watch.trip(now, fault);
        }
        if freshness < 1.0 && self.field.is_acting() {
            acted.limits.insert(Limit::Staleness);
        }
        self.ledger.book(wanted, acted.force_n);
        acted
    }

    fn state(
        &self,
        now: Ticks,
        sensed: &Sensed,
        velocity_m_s: Vec3,
        wanted: &Wanted,
        acted: &Acted,
    ) -> State {
        State {
            tick: now,
            supervisor: self.watch.state(),
            last_command: self.last_command,
            position: self.pose.position_m.metres(),
            proxy: wanted.proxy_m.metres(),
            velocity: velocity_m_s.metres_per_second(),
            force: acted.force_n.newtons(),
            impulse_to_fluid: self.ledger.impulse_to_fluid(),
            buttons: sensed.buttons,
            flags: Flags::default()
                .with(Flags::WET, wanted.contact == Contact::Wet)
                .with(Flags::ON_SURFACE, wanted.contact == Contact::OnSurface)
                .with(Flags::CLINGING, wanted.contact == Contact::Clinging)
                .with(Flags::ON_WALL, wanted.on_wall())
                .with(Flags::DEADMAN, sensed.deadman),
            limits: acted.limits,
            field_epoch: self.field.epoch(),
            drops: Drops::default(),
        }
    }

    /// Carries a command out; the answer, where it has one. A field and a Keep are answered only
    /// when they are refused: the epoch in the state tells the rest.
    pub fn command(&mut self, now: Ticks, sequence: u16, down: Down, torn: &mut u16) -> Option<Up> {
        self.watch.hear(now);
        let state = self.watch.state();
        let streamed = matches!(down, Down::Field(_) | Down::Keep(_));
        let done = match down {
            Down::Hello => return Some(Up::Hello(self.settings.identity())),
            Down::Ping { host_us } => return Some(Up::Pong { host_us, tick: now }),
            Down::ReadFaultLog => return Some(Up::FaultLog(self.watch.log().collect())),
            Down::Field(head) => self.field.begin(now, head, torn),
            Down::Keep(keep) => self.field.keep(now, keep),
            Down::Configure(config) => self.settings.configure(state, config),
            Down::Vessel(vessel) => self.settings.load_vessel(state, vessel),
            Down::Params(params) => self.settings.load_params(state, params),
            Down::Arm => self.arm(),
            Down::Disarm => self.watch.disarm(),
            Down::Dfu => Err(Refusal::NotOnThisBoard),
        };
        if done.is_ok() && streamed {
            return None;
        }
        let verdict = done.map_or_else(Verdict::Refused, |()| Verdict::Accepted);
        self.last_command = LastCommand { sequence, verdict };
        Some(Up::Ack { sequence, verdict })
    }

    /// Stores a slab of a field.
    pub fn slab(&mut self, now: Ticks, slab: SlabHead, data: &[u8]) {
        self.watch.hear(now);
        self.field.store(now, slab, data);
    }

    /// Arms with an empty field: what an earlier session left must not act in this one.
    fn arm(&mut self) -> Result<(), Refusal> {
        self.settings.are_complete()?;
        if !self.deadman {
            return Err(Refusal::DeadmanOpen);
        }
        self.watch.arm()?;
        self.field.clear();
        Ok(())
    }
}
