//! `cauldron run`.

mod figures;
mod live;
mod output;
mod pictures;
mod plot;
mod progress;
mod record;

pub use figures::Figures;
pub use output::Output;
pub use record::Record;

use cauldron_fluid::{
    Vessel,
    pool::Pool,
    scenes::{self, Scene},
    simd::SimdClass,
};
use cauldron_link::{Faults, SessionError, Transport};
use cauldron_protocol::Supervisor;
use cpu_time::ProcessTime;
use std::{
    io::Write,
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use crate::{
    Failure,
    cli::{DeviceKind, RunArgs},
    grid::{self, Tried},
    host::{Host, Latency},
    world::{Options, SimHost, World},
};
use figures::Run;
use live::{LiveDevice, Pace};
use pictures::{Drawn, Pictures};
use progress::Progress;

/// Runs a scene, writes its folder, prints its figures.
///
/// # Errors
/// [`Failure`]: bad input, a folder that cannot be written, a device that cannot be worked with.
pub fn run(args: &RunArgs) -> Result<(), Failure> {
    let options = options(args);
    let (scene, grid_tried) = scene(args, &options)?;
    let output = Output::claim(&args.out)?;
    let world = match args.device {
        DeviceKind::Sim => {
            World::new(&scene, &options).map_err(|wrong| Failure::Input(wrong.to_string()))?
        }
    };
    let drawn = if args.real_time { Drawn::Afterwards } else { Drawn::AtOnce };
    let mut show = Show {
        ticks: (args.seconds * 1e3).round() as usize,
        record: Record::default(),
        pictures: Pictures::new(&output, args.fps, options.pool.threads(), drawn),
        progress: Progress::new((args.seconds * 1e3).round() as usize),
        clock: Clock::default(),
    };
    let host = if args.real_time { show.play_live(world)? } else { show.play(world)? };
    let clock = show.clock;
    let run = Run { scene: &scene, grid_tried, options: &options, host: &host, clock };
    let figures = Figures::of(&run, &show.record);
    show.record.write_csv(&output.file("run.csv")?)?;
    show.pictures.finish(&show.record)?;
    output.write("run.json", figures.json().as_bytes())?;
    let text = if args.json { figures.json() } else { figures.table(&output) };
    writeln!(std::io::stdout(), "{text}").map_err(|e| Failure::Input(format!("stdout: {e}")))?;
    match show.record.states().last().map(|state| state.supervisor) {
        Some(Supervisor::Fault(fault)) => Err(Failure::Device(format!(
            "the device ended in fault {} ({fault:?})",
            fault.number()
        ))),
        _ => Ok(()),
    }
}

fn scene(args: &RunArgs, options: &Options) -> Result<(Scene, Option<Vec<Tried>>), Failure> {
    let mut scene = scenes::find(&args.scene).map_err(|e| Failure::Input(e.to_string()))?;
    let tried = args.grid.map(|choice| grid::cut(&mut scene, choice, options)).transpose()?;
    if matches!(scene.vessel, Vessel::Cylinder { .. } | Vessel::Distance(_)) {
        eprintln!("{}: the hand feels and sees the grid's box, not the vessel's wall", scene.name);
    }
    Ok((scene, tried.flatten()))
}

fn options(args: &RunArgs) -> Options {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let threads = args.threads.map_or(cores.min(2), usize::from);
    let mut options = Options {
        pool: Arc::new(Pool::new(threads, !args.real_time)),
        simd: args.simd.unwrap_or_else(SimdClass::detect),
        ..Options::new(args.seed)
    };
    if args.real_time {
        options.latency = Latency::LIVE;
        options.down = Faults::default();
    }
    options
}

/// A device that is silent for so long will not speak again.
const LONGEST_SILENCE: Duration = Duration::from_secs(5);

/// What the loop took, without its pictures.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clock {
    /// By the wall.
    pub wall: Duration,
    /// Of all threads.
    pub cpu: Duration,
    /// Ticks that began late; real time only.
    pub late_ticks: u64,
}

/// What is kept and shown of a run while it goes.
struct Show<'a> {
    ticks: usize,
    record: Record,
    pictures: Pictures<'a>,
    progress: Progress,
    clock: Clock,
}

impl Show<'_> {
    /// Plays on virtual time until the host has heard of every tick.
    fn play(&mut self, mut world: World) -> Result<SimHost, Failure> {
        let mut watch = Watch::start();
        while self.record.len() < self.ticks {
            world.tick().map_err(|e| lost(&e))?;
            self.take(&world.host);
            if self.pictures.is_due(world.now_s()) {
                watch.stop(&mut self.clock);
                self.pictures.take(&world.host)?;
                watch = Watch::start();
            }
        }
        watch.stop(&mut self.clock);
        self.progress.finish();
        Ok(world.host)
    }

    /// Plays on the wall's clock: the device beside the host, neither waits for the other.
    fn play_live(&mut self, world: World) -> Result<SimHost, Failure> {
        let mut host = world.host;
        let device = LiveDevice::start(world.device)
            .map_err(|e| Failure::Device(format!("no thread for the device: {e}")))?;
        let (watch, started, mut pace) = (Watch::start(), Instant::now(), Pace::new());
        let mut heard = Duration::ZERO;
        while self.record.len() < self.ticks {
            pace.wait();
            let now = started.elapsed();
            host.poll(now.as_micros() as u64).map_err(|e| lost(&e))?;
            self.take(&host);
            if self.pictures.is_due(now.as_secs_f64()) {
                self.pictures.take(&host)?;
            }
            heard = if host.states.is_empty() { heard } else { now };
            if now - heard > LONGEST_SILENCE {
                let seconds = LONGEST_SILENCE.as_secs();
                return Err(Failure::Device(format!("the device said nothing for {seconds} s")));
            }
        }
        watch.stop(&mut self.clock);
        self.clock.late_ticks = device.stop();
        self.progress.finish();
        Ok(host)
    }

    fn take<T: Transport>(&mut self, host: &Host<T>) {
        self.record.take(&host.states, self.ticks);
        self.progress.show(&self.record, host.pot.totals().steps);
    }
}

fn lost(error: &SessionError) -> Failure {
    Failure::Device(error.to_string())
}

/// Wall and CPU time since it was started.
struct Watch {
    wall: Instant,
    cpu: ProcessTime,
}

impl Watch {
    fn start() -> Self {
        Self { wall: Instant::now(), cpu: ProcessTime::now() }
    }

    fn stop(&self, clock: &mut Clock) {
        clock.wall += self.wall.elapsed();
        clock.cpu += self.cpu.elapsed();
    }
}
