//! Real time: the device on a thread of its own, on the wall's clock, and the host beside it.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use crate::sim::SimDevice;

const TICK: Duration = Duration::from_millis(1);

/// A simulated device that runs by itself.
#[derive(Debug)]
pub struct LiveDevice {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<u64>>,
}

impl LiveDevice {
    /// Starts `device` on its own thread.
    ///
    /// # Errors
    /// What the system said if it gave no thread.
    pub fn start(mut device: SimDevice) -> std::io::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let asked = stop.clone();
        let thread = thread::Builder::new().name("device".into()).spawn(move || {
            let mut pace = Pace::new();
            while !asked.load(Ordering::Relaxed) {
                pace.wait();
                device.tick();
            }
            pace.late_ticks
        })?;
        Ok(Self { stop, thread: Some(thread) })
    }

    /// Stops it; the ticks that began more than a tick late.
    pub fn stop(mut self) -> u64 {
        self.join()
    }

    fn join(&mut self) -> u64 {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().and_then(|thread| thread.join().ok()).unwrap_or(0)
    }
}

impl Drop for LiveDevice {
    fn drop(&mut self) {
        self.join();
    }
}

/// Holds a loop to a thousand ticks a second.
#[derive(Debug)]
pub struct Pace {
    due: Instant,
    late_ticks: u64,
}

impl Pace {
    /// The first tick is due now.
    pub fn new() -> Self {
        Self { due: Instant::now(), late_ticks: 0 }
    }

    /// Waits for the next tick's time. A loop that is more than a tick late is counted and goes
    /// on from where it is: late ticks are not made up for in a burst.
    pub fn wait(&mut self) {
        let now = Instant::now();
        match self.due.checked_duration_since(now) {
            Some(early) => thread::sleep(early),
            None if now - self.due > TICK => {
                self.late_ticks += 1;
                self.due = now;
            }
            None => {}
        }
        self.due += TICK;
    }
}
