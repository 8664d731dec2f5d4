//! One line on stderr that says how far it is.

use std::{
    io::{self, IsTerminal, Write},
    time::{Duration, Instant},
};

use super::Record;

/// How often the line changes: on a terminal, and in a log, where each is a new one.
const LIVE: Duration = Duration::from_millis(100);
const LOGGED: Duration = Duration::from_secs(2);

/// The line.
#[derive(Debug)]
pub struct Progress {
    ticks: usize,
    live: bool,
    started: Instant,
    shown: Option<Instant>,
}

impl Progress {
    /// Of a run of `ticks` ticks.
    pub fn new(ticks: usize) -> Self {
        let live = io::stderr().is_terminal();
        Self { ticks, live, started: Instant::now(), shown: None }
    }

    /// Shows how far the run is, if it is time to.
    pub fn show(&mut self, record: &Record, steps: u64) {
        if !record.len().is_multiple_of(64) {
            return; // the clock need not be asked every tick
        }
        let every = if self.live { LIVE } else { LOGGED };
        let now = Instant::now();
        if self.shown.is_some_and(|shown| now - shown < every) {
            return;
        }
        self.shown = Some(now);
        let seconds = (now - self.started).as_secs_f64().max(1e-3);
        let force_n = record.states().last().map_or(0.0, |state| {
            state.force.iter().map(|f| f64::from(f.0) * f64::from(f.0)).sum::<f64>().sqrt()
        });
        let line = format!(
            "{:6.2} of {:.2} s | {:5.0} steps/s | {:6.0} ticks/s | force {force_n:5.2} N",
            record.len() as f64 * 1e-3,
            self.ticks as f64 * 1e-3,
            steps as f64 / seconds,
            record.len() as f64 / seconds,
        );
        let (start, end) = if self.live { ("\r\x1b[2K", "") } else { ("", "\n") };
        // Nobody may be looking.
        let _ = write!(io::stderr(), "{start}{line}{end}");
    }

    /// Leaves the terminal to what comes next.
    pub fn finish(&self) {
        if self.live {
            let _ = write!(io::stderr(), "\r\x1b[2K");
        }
    }
}
