//! The run as pictures: frames, a contact sheet, and a plot.

use cauldron_fluid::Snapshot;
use cauldron_link::Transport;
use cauldron_protocol::State;
use cauldron_render::{
    Camera, Canvas, Handle, View, png, render,
    sheet::{Thumbnail, contact_sheet},
};

use super::{Output, Record, plot};
use crate::{Failure, host::Host};

/// Size of a frame in pixels.
const FRAME: [usize; 2] = [480, 360];

/// Pictures that wait to be drawn until a run in real time is over; later ones are left out.
const MOST_WAITING: usize = 600;

/// When pictures are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// At once: time waits.
    AtOnce,
    /// When the run is over: drawing may not hold it up.
    Afterwards,
}

/// What is drawn of one moment.
struct Shot {
    snapshot: Snapshot,
    handle: Option<Handle>,
}

/// Draws frames as the run goes, and the sheet and the plot at its end.
pub struct Pictures<'a> {
    output: &'a Output,
    fps: f64,
    threads: usize,
    drawn: Drawn,
    shots: usize,
    frames: usize,
    waiting: Vec<Shot>,
    sheet: Sheet,
    limit_n: f32,
}

impl<'a> Pictures<'a> {
    /// `fps` frames per simulated second, none for 0.
    pub fn new(output: &'a Output, fps: f64, threads: usize, drawn: Drawn) -> Self {
        Self {
            output,
            fps,
            threads,
            drawn,
            shots: 0,
            frames: 0,
            waiting: Vec::new(),
            sheet: Sheet::default(),
            limit_n: 1.0,
        }
    }

    /// True if the next frame's time has come.
    pub fn is_due(&self, now_s: f64) -> bool {
        self.fps > 0.0 && now_s * self.fps + 1e-9 >= (self.shots + 1) as f64
    }

    /// Takes the frame of now.
    ///
    /// # Errors
    /// [`Failure::Input`] if its file cannot be written.
    pub fn take<T: Transport>(&mut self, host: &Host<T>) -> Result<(), Failure> {
        self.shots += 1;
        self.limit_n = host.force_limit_n();
        let shot = Shot {
            snapshot: host.pot.snapshot(),
            handle: host.probe().map(|state| handle(host, state)),
        };
        match self.drawn {
            Drawn::AtOnce => self.draw(&shot),
            Drawn::Afterwards if self.waiting.len() < MOST_WAITING => {
                self.waiting.push(shot);
                Ok(())
            }
            Drawn::Afterwards => Ok(()),
        }
    }

    /// Draws what waits, the sheet and the plot; the frames drawn.
    ///
    /// # Errors
    /// [`Failure::Input`] if a file cannot be written.
    pub fn finish(mut self, record: &Record) -> Result<usize, Failure> {
        for shot in std::mem::take(&mut self.waiting) {
            self.draw(&shot)?;
        }
        if self.fps > 0.0 {
            if self.frames > 0 {
                self.write("contact-sheet.png", &self.sheet.draw())?;
            }
            self.write("plot.png", &plot::draw(record, self.limit_n))?;
        }
        Ok(self.frames)
    }

    fn draw(&mut self, shot: &Shot) -> Result<(), Failure> {
        let camera = Camera::over(&shot.snapshot);
        let view = View { snapshot: &shot.snapshot, handle: shot.handle, camera };
        let canvas = render(&view, FRAME[0], FRAME[1], self.threads).resolve();
        self.frames += 1;
        self.write(&format!("frame-{:04}.png", self.frames), &canvas)?;
        self.sheet.add(canvas, shot.snapshot.time_s);
        Ok(())
    }

    fn write(&self, name: &str, canvas: &Canvas) -> Result<(), Failure> {
        png::write(self.output.file(name)?, canvas).map_err(|e| Failure::Input(e.to_string()))
    }
}

/// Frames for the contact sheet: all of a short run, every n-th of a long one.
struct Sheet {
    kept: Vec<(Canvas, String)>,
    seen: usize,
    every: usize,
}

impl Default for Sheet {
    fn default() -> Self {
        Self { kept: Vec::new(), seen: 0, every: 1 }
    }
}

impl Sheet {
    const COLUMNS: usize = 10;
    const MOST: usize = 60;

    fn add(&mut self, canvas: Canvas, time_s: f64) {
        if self.seen.is_multiple_of(self.every) {
            self.kept.push((canvas, format!("{time_s:.1} s")));
        }
        self.seen += 1;
        if self.kept.len() > Self::MOST {
            self.every *= 2;
            let mut place = 0;
            self.kept.retain(|_| {
                place += 1;
                place % 2 == 1
            });
        }
    }

    fn draw(&self) -> Canvas {
        let thumbnails: Vec<Thumbnail<'_>> =
            self.kept.iter().map(|(picture, label)| Thumbnail { picture, label }).collect();
        contact_sheet(&thumbnails, Self::COLUMNS)
    }
}

fn handle<T: Transport>(host: &Host<T>, state: &State) -> Handle {
    let force_n = state.force.iter().map(|f| f.0 * f.0).sum::<f32>().sqrt();
    Handle {
        tip_in_world_m: host.in_world_m(state.position),
        proxy_in_world_m: host.in_world_m(state.proxy),
        radius_m: host.probe_radius_m(),
        force_fraction: force_n / host.force_limit_n(),
    }
}
