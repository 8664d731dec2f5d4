//! The simulated rig: firmware on the simulated board, host beside it, virtual time.

use cauldron::world::{Options, World};
use cauldron_link::Faults;

use crate::{
    rig::{Rig, RigError},
    scenario::{Event, Mishap, Scenario},
    trace::Trace,
};

/// Faults of a wire full of garbage.
const GARBAGE: Faults = Faults { loss: 0.1, bit_flips: 0.002, ..Faults::TRANSFER };

/// A rig that is always there.
#[derive(Clone)]
pub struct SimRig {
    /// Seed, threads and wire of every world it makes.
    pub options: Options,
}

impl SimRig {
    /// With a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { options: Options::new(seed) }
    }
}

impl Rig for SimRig {
    fn name(&self) -> &'static str {
        "sim"
    }

    fn play(&mut self, scenario: &Scenario) -> Result<Trace, RigError> {
        let scene = (scenario.scene)();
        scene.check().map_err(|wrong| RigError(wrong.to_string()))?;
        let mut world =
            World::new(&scene, &self.options).map_err(|wrong| RigError(wrong.to_string()))?;
        let ticks = (scenario.seconds * 1e3).round() as usize;
        let mut trace =
            Trace { force_limit_n: f64::from(world.host.force_limit_n()), ..Trace::default() };
        let mut events = scenario.events.iter().peekable();
        let mut silent = false;
        for tick in 0..ticks {
            while let Some(event) = events.next_if(|e| is_due(e, tick)) {
                befall(&mut world, event.what, &mut silent);
            }
            let state = if silent { world.tick_device() } else { world.tick()? };
            trace.states.push(state);
        }
        trace.counts = world.host.counts();
        trace.airborne_m3 = world.host.pot.splash().map_or(0.0, |splash| splash.airborne_m3());
        trace.splash = world.host.pot.splash().map_or_else(Default::default, |s| *s.books());
        trace.impulse_n_s = world.host.pot.exchange().given_n_s();
        trace.momentum_residual_rel = world.host.pot.exchange().residual_rel();
        trace.released_j = world.host.pot.totals().released_j;
        Ok(trace)
    }
}

fn is_due(event: &Event, tick: usize) -> bool {
    event.at_s * 1e3 <= tick as f64
}

fn befall(world: &mut World, what: Mishap, silent: &mut bool) {
    let transport = &mut world.host.session.transport;
    match what {
        Mishap::Unplug => world.device.cable().set_plugged(false),
        Mishap::Plug => world.device.cable().set_plugged(true),
        Mishap::Silence => *silent = true,
        Mishap::Speak => *silent = false,
        Mishap::Garbage => {
            (transport.down, transport.up) = (GARBAGE, Faults { delay_us: 0, ..GARBAGE })
        }
        Mishap::Sound => (transport.down, transport.up) = (Faults::TRANSFER, Faults::default()),
    }
}

impl From<cauldron_link::SessionError> for RigError {
    fn from(error: cauldron_link::SessionError) -> Self {
        Self(error.to_string())
    }
}
