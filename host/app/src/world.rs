//! Device and host together on virtual time: a tick is a millisecond however long it takes, and
//! the same seed gives the same bits.

use cauldron_board_sim::{Grip, Script};
use cauldron_fluid::{Pot, pool::Pool, scenes::Scene, simd::SimdClass, solver::SetupError};
use cauldron_link::{Faults, Faulty, PipeEnd, SessionError, pipe};
use cauldron_protocol::State;
use std::sync::Arc;

use crate::{
    host::{Host, Latency},
    sim::{SimDevice, script_of},
};

/// What a world is made with.
#[derive(Clone)]
pub struct Options {
    /// Draws of noise, tremor and latency.
    pub seed: u64,
    /// Threads of the pot.
    pub pool: Arc<Pool>,
    /// Vector width of the pot.
    pub simd: SimdClass,
    /// How the hand grips.
    pub grip: Grip,
    /// Faults on the way to the device, beside the transfer's time.
    pub down: Faults,
    /// Faults on the way to the host.
    pub up: Faults,
    /// What a field needs to be ready.
    pub latency: Latency,
}

impl Options {
    /// One thread, and a wire that takes its time and loses nothing.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            pool: Arc::new(Pool::inline()),
            simd: SimdClass::detect(),
            grip: Grip::RELAXED,
            down: Faults::TRANSFER,
            up: Faults::default(),
            latency: Latency::DEFAULT,
        }
    }
}

/// The host of a simulated device.
pub type SimHost = Host<Faulty<PipeEnd>>;

/// A device and its host.
pub struct World {
    /// The simulated device.
    pub device: SimDevice,
    /// The host.
    pub host: SimHost,
    now_us: u64,
}

impl World {
    /// A scene whose own story the hand plays.
    ///
    /// # Errors
    /// [`SetupError`] as [`Pot::new`].
    pub fn new(scene: &Scene, options: &Options) -> Result<Self, SetupError> {
        Self::with_script(scene, script_of(scene), options)
    }

    /// A scene in which the hand does something else.
    ///
    /// # Errors
    /// [`SetupError`] as [`Pot::new`].
    pub fn with_script(
        scene: &Scene,
        script: Script,
        options: &Options,
    ) -> Result<Self, SetupError> {
        let seed = options.seed;
        let (host_end, device_end) = pipe();
        let transport = Faulty::new(host_end, options.down, options.up, seed ^ 0x11a7);
        let pot = Pot::new(scene, options.pool.clone(), options.simd)?;
        Ok(Self {
            device: SimDevice::new(script, options.grip, device_end, seed),
            host: Host::new(transport, scene, pot, options.latency, seed ^ 0x7e57),
            now_us: 0,
        })
    }

    /// One tick of the device, and the host's part of that millisecond; the device's own state,
    /// whether or not the host got it.
    ///
    /// # Errors
    /// [`SessionError`] if the two cannot work together.
    pub fn tick(&mut self) -> Result<State, SessionError> {
        let state = self.device.tick();
        self.now_us += 1000;
        self.host.poll(self.now_us)?;
        Ok(state)
    }

    /// One tick of the device while the host does nothing at all.
    pub fn tick_device(&mut self) -> State {
        self.now_us += 1000;
        self.device.tick()
    }

    /// Virtual time since the start.
    #[must_use]
    pub fn now_s(&self) -> f64 {
        1e-6 * self.now_us as f64
    }
}
