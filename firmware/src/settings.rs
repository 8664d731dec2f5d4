//! What the tick reads and never writes: the image's ceilings, the calibration, the vessel, the
//! params. All of it is checked here, where it enters, and swapped whole.

use cauldron_protocol::{
    PROTOCOL_VERSION, Refusal, Supervisor, Vessel, Wall,
    message::{Arm, Buoyancy, Ceilings, Config, Identity, Modes, Params, RestMedium},
    schema_hash,
    transform::WorldFromDevice,
    units::{Metres, NewtonSeconds2PerMetre2, NewtonSecondsPerMetre, Newtons, NewtonsPerMetre},
};
use heapless::Vec;

use crate::TICKS_PER_SECOND;

/// What is burnt into an image: the mechanism, and ceilings that no command can raise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// Major, minor, patch.
    pub version: [u8; 3],
    /// The mechanism.
    pub arm: Arm,
    /// The hand's protection.
    pub ceilings: Ceilings,
}

const NOTHING: Params = Params {
    modes: Modes { surface: false, viscosity: false, flow: false, walls: false },
    rest: RestMedium {
        linear_drag: NewtonSecondsPerMetre(0.0),
        quadratic_drag: NewtonSeconds2PerMetre2(0.0),
    },
    pull_force: Newtons(0.0),
    buoyancy: Buoyancy { radius: Metres(0.0), stiffness: NewtonsPerMetre(0.0) },
};

/// Settings in force.
#[derive(Clone, Debug)]
pub struct Settings {
    image: Image,
    config: Config,
    vessel: Vessel,
    params: Params,
    has_vessel: bool,
    has_params: bool,
}

impl Settings {
    /// The image's own, with nothing uploaded: every mode is off.
    #[must_use]
    pub fn new(image: Image) -> Self {
        let world_from_device = WorldFromDevice::default();
        Self {
            image,
            config: Config { world_from_device, ceilings: image.ceilings },
            vessel: Vessel {
                walls: Vec::new(),
                stiffness: NewtonsPerMetre(0.0),
                damping: NewtonSecondsPerMetre(0.0),
            },
            params: NOTHING,
            has_vessel: false,
            has_params: false,
        }
    }

    /// The hand's protection.
    #[must_use]
    pub fn ceilings(&self) -> &Ceilings {
        &self.config.ceilings
    }

    /// What the servo renders.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// The static geometry.
    #[must_use]
    pub fn vessel(&self) -> &Vessel {
        &self.vessel
    }

    /// Who the device is.
    #[must_use]
    pub fn identity(&self) -> Identity {
        Identity {
            protocol_version: PROTOCOL_VERSION,
            schema_hash: const { schema_hash() },
            firmware_version: self.image.version,
            ticks_per_second: TICKS_PER_SECOND,
            ceilings: self.config.ceilings,
            arm: self.image.arm,
            world_from_device: self.config.world_from_device,
        }
    }

    /// Takes calibration and ceilings, in Idle.
    ///
    /// # Errors
    /// [`Refusal::WrongState`]; [`Refusal::BadValue`] for a map that cannot be used and for
    /// ceilings that are not above zero or above those of the image.
    pub fn configure(&mut self, state: Supervisor, config: Config) -> Result<(), Refusal> {
        let (asked, burnt) = (config.ceilings, self.image.ceilings);
        let held = is_within(asked.force.0, burnt.force.0) && is_within(asked.slew.0, burnt.slew.0);
        if state != Supervisor::Idle {
            return Err(Refusal::WrongState);
        }
        if !(held && config.world_from_device.is_sound()) {
            return Err(Refusal::BadValue);
        }
        self.config = config;
        Ok(())
    }

    /// Takes a vessel, while no force acts.
    ///
    /// # Errors
    /// [`Refusal::WrongState`]; [`Refusal::BadValue`] for a number that is not finite or a
    /// stiffness, damping or radius below zero.
    pub fn load_vessel(&mut self, state: Supervisor, vessel: Vessel) -> Result<(), Refusal> {
        if !matches!(state, Supervisor::Idle | Supervisor::Armed) {
            return Err(Refusal::WrongState);
        }
        let hard = is_gain(vessel.stiffness.0) && is_gain(vessel.damping.0);
        if !(hard && vessel.walls.iter().all(is_sound)) {
            return Err(Refusal::BadValue);
        }
        self.vessel = vessel;
        self.has_vessel = true;
        Ok(())
    }

    /// Takes params.
    ///
    /// # Errors
    /// [`Refusal::WrongState`] in Fault; [`Refusal::BadValue`] for a value that is not finite
    /// or below zero.
    pub fn load_params(&mut self, state: Supervisor, params: Params) -> Result<(), Refusal> {
        if matches!(state, Supervisor::Fault(_)) {
            return Err(Refusal::WrongState);
        }
        let rest = is_gain(params.rest.linear_drag.0) && is_gain(params.rest.quadratic_drag.0);
        let Buoyancy { radius, stiffness } = params.buoyancy;
        let touch = is_gain(params.pull_force.0) && is_gain(radius.0) && is_gain(stiffness.0);
        if !(rest && touch) {
            return Err(Refusal::BadValue);
        }
        self.params = params;
        self.has_params = true;
        Ok(())
    }

    /// Whether all is there that arming needs.
    ///
    /// # Errors
    /// [`Refusal::NoVessel`], [`Refusal::NoParams`].
    pub fn are_complete(&self) -> Result<(), Refusal> {
        if !self.has_vessel {
            return Err(Refusal::NoVessel);
        }
        if !self.has_params {
            return Err(Refusal::NoParams);
        }
        Ok(())
    }
}

fn is_within(asked: f32, ceiling: f32) -> bool {
    asked > 0.0 && asked <= ceiling
}

fn is_gain(value: f32) -> bool {
    (0.0..=1e6).contains(&value)
}

fn is_sound(wall: &Wall) -> bool {
    match *wall {
        Wall::Plane { normal, offset } => {
            let [x, y, z] = normal;
            let squared = x * x + y * y + z * z;
            offset.0.is_finite() && squared > 0.99 && squared < 1.01
        }
        Wall::Pot { centre, radius, rim } => {
            centre.iter().all(|c| c.0.is_finite()) && is_gain(radius.0) && rim.0.is_finite()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cauldron_protocol::units::NewtonsPerSecond;

    const IMAGE: Image = Image {
        version: [0, 1, 0],
        arm: crate::kinematics::tests::ARM,
        ceilings: Ceilings { force: Newtons(3.0), slew: NewtonsPerSecond(500.0) },
    };

    fn config(force_n: f32) -> Config {
        let ceilings = Ceilings { force: Newtons(force_n), ..IMAGE.ceilings };
        Config { world_from_device: WorldFromDevice::default(), ceilings }
    }

    #[test]
    fn ceilings_can_be_lowered_and_never_raised() {
        let mut settings = Settings::new(IMAGE);
        assert_eq!(settings.configure(Supervisor::Idle, config(1.0)), Ok(()));
        assert_eq!(settings.ceilings().force, Newtons(1.0));
        for bad in [3.1, 0.0, -1.0, f32::NAN, f32::INFINITY] {
            let refused = settings.configure(Supervisor::Idle, config(bad));
            assert_eq!(refused, Err(Refusal::BadValue), "{bad}");
        }
        let running = settings.configure(Supervisor::Running, config(1.0));
        assert_eq!(running, Err(Refusal::WrongState));
        assert_eq!(settings.ceilings().force, Newtons(1.0));
    }

    #[test]
    fn a_wall_may_not_be_swapped_under_a_pressing_hand() {
        let mut settings = Settings::new(IMAGE);
        let refused = settings.load_vessel(Supervisor::Running, Vessel::default());
        assert_eq!(refused, Err(Refusal::WrongState));
        assert_eq!(settings.are_complete(), Err(Refusal::NoVessel));
    }

    #[test]
    fn what_is_not_a_number_is_stopped_here() {
        let mut settings = Settings::new(IMAGE);
        for wall in [
            Wall::Plane { normal: [f32::NAN, 0.0, 0.0], offset: Metres(0.0) },
            Wall::Plane { normal: [1.0, 0.0, 0.0], offset: Metres(f32::INFINITY) },
            Wall::Plane { normal: [2.0, 0.0, 0.0], offset: Metres(0.0) },
            Wall::Pot { centre: [Metres(0.0); 3], radius: Metres(-1.0), rim: Metres(0.0) },
        ] {
            let vessel = Vessel { walls: [wall].into_iter().collect(), ..Vessel::default() };
            assert_eq!(settings.load_vessel(Supervisor::Idle, vessel), Err(Refusal::BadValue));
        }
        let rest =
            RestMedium { linear_drag: NewtonSecondsPerMetre(f32::NAN), ..RestMedium::default() };
        let sound = Params {
            modes: Modes::default(),
            rest: RestMedium::default(),
            pull_force: Newtons(0.1),
            buoyancy: Buoyancy::default(),
        };
        let buoyancy = Buoyancy { radius: Metres(f32::INFINITY), ..Buoyancy::default() };
        assert_eq!(settings.load_params(Supervisor::Idle, sound), Ok(()));
        for params in [
            Params { rest, ..sound },
            Params { pull_force: Newtons(f32::NAN), ..sound },
            Params { pull_force: Newtons(-0.1), ..sound },
            Params { buoyancy, ..sound },
        ] {
            assert_eq!(settings.load_params(Supervisor::Idle, params), Err(Refusal::BadValue));
        }
    }
}
