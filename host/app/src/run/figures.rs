//! What a run comes to, in figures. Those of force and energy follow from `run.csv`.

use cauldron_fluid::scenes::Scene;
use cauldron_link::Transport;
use cauldron_protocol::{Limit, State, Supervisor, state::Flags};
use glam::DVec3;
use serde::Serialize;

use super::{Clock, Output, Record};
use crate::{grid::Tried, host::Host, world::Options};

const TICKS_PER_SECOND: f64 = cauldron_firmware::TICKS_PER_SECOND as f64;

/// What figures are made of, beside the trace.
pub struct Run<'a, T> {
    /// The scene.
    pub scene: &'a Scene,
    /// How it ran.
    pub options: &'a Options,
    /// Grids that were tried before this one was chosen.
    pub grid_tried: Option<Vec<Tried>>,
    /// The host at the end.
    pub host: &'a Host<T>,
    /// What it took.
    pub clock: Clock,
}

/// The figures of a run, named as in its JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Figures {
    /// Scene.
    pub scene: String,
    /// Cells along x, y, z.
    pub grid: [usize; 3],
    /// Grids that were tried before this one was chosen; null if it was given.
    pub grid_tried: Option<Vec<Tried>>,
    /// How the surface moves; null without one.
    pub surface: Option<&'static str>,
    /// Seed of every draw.
    pub seed: u64,
    /// Vector width.
    pub simd: &'static str,
    /// Threads of the fluid.
    pub threads: usize,
    /// Felt newtons for a physical one.
    pub felt_scale: f32,
    /// World metres in a device metre.
    pub world_scale: f32,
    /// Ticks that the host heard of.
    pub ticks: usize,
    /// Ticks between them of which it did not.
    pub ticks_missed: u64,
    /// Ticks that began late; real time only.
    pub ticks_late: u64,
    /// Simulated time.
    pub seconds: f64,
    /// Steps of the fluid.
    pub steps: u64,
    /// Steps skipped since the fluid was at rest, or there is none.
    pub steps_asleep: u64,
    /// Fields and Keeps sent.
    pub fields: u64,
    /// Fields among them.
    pub fields_sent: u64,
    /// Bytes of both on the wire.
    pub field_bytes: u64,
    /// Largest norm of the felt force.
    pub force_n_max: f64,
    /// Its ceiling.
    pub force_n_limit: f64,
    /// Root mean square of the norm of the felt force over the wet ticks.
    pub force_n_rms_wet: f64,
    /// Ticks in the liquid.
    pub ticks_wet: usize,
    /// Times that the probe broke through the surface.
    pub pops: usize,
    /// Ticks in which each limit acted.
    pub limits: Vec<LimitTicks>,
    /// Energy that left as waves where the surface broke or let go of the probe, in physical
    /// joules.
    pub surface_released_j: f64,
    /// Sum of |J| over the exchanges with the liquid, in physical units.
    pub impulse_n_s: f64,
    /// Sum of |J| that no liquid was in reach to take; in no other figure.
    pub impulse_untaken_n_s: f64,
    /// Largest kinetic energy of the liquid, in joules.
    pub fluid_ke_max: f64,
    /// Largest |div u| left in a cell, in 1/s.
    pub divergence_max: f64,
    /// What the books of momentum miss, over impulse_n_s.
    pub momentum_residual_rel: f64,
    /// Sum of felt force times way: what the device gave to the hand; negative where the hand
    /// worked.
    pub energy_to_hand_j: f64,
    /// Times that the fluid's energy guard acted.
    pub guard_actions: u64,
    /// Frames that the device dropped.
    pub frames_dropped: u32,
    /// Times that the device was set up and armed.
    pub setups: u64,
    /// Times that it went into a fault.
    pub faults: usize,
    /// CPU time of all threads, without pictures.
    pub cpu_s: f64,
    /// Time by the wall, without pictures.
    pub wall_s: f64,
    /// Hash over tick, position and force bits.
    pub trace_hash: String,
}

/// A limit, and in how many ticks it acted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LimitTicks {
    /// Its name.
    pub limit: &'static str,
    /// Ticks.
    pub ticks: usize,
}

impl Figures {
    /// Of a run that is over.
    #[must_use]
    pub fn of<T: Transport>(run: &Run<'_, T>, record: &Record) -> Self {
        let states = record.states();
        let (counts, totals) = (run.host.counts(), run.host.pot.totals());
        let exchange = run.host.pot.exchange();
        Self {
            scene: run.scene.name.clone(),
            grid: run.scene.grid.cells,
            grid_tried: run.grid_tried.clone(),
            surface: run.host.pot.surface().map(|surface| surface.params().model),
            seed: run.options.seed,
            simd: run.options.simd.name(),
            threads: run.options.pool.threads(),
            felt_scale: run.scene.feel.felt_scale,
            world_scale: run.scene.feel.world_from_device.scale,
            ticks: states.len(),
            ticks_missed: counts.missed,
            ticks_late: run.clock.late_ticks,
            seconds: states.len() as f64 / TICKS_PER_SECOND,
            steps: totals.steps,
            steps_asleep: totals.steps_asleep,
            fields: counts.fields + counts.keeps,
            fields_sent: counts.fields,
            field_bytes: counts.field_bytes,
            force_n_max: states.iter().map(|s| force_n(s).length()).fold(0.0, f64::max),
            force_n_limit: f64::from(run.host.force_limit_n()),
            force_n_rms_wet: rms_wet_n(states),
            ticks_wet: states.iter().filter(|s| s.flags.contains(Flags::WET)).count(),
            pops: pops(states),
            surface_released_j: totals.released_j,
            limits: limits(states),
            impulse_n_s: exchange.given_n_s(),
            impulse_untaken_n_s: exchange.untaken_n_s(),
            fluid_ke_max: totals.kinetic_energy_max_j,
            divergence_max: totals.divergence_max_per_s,
            momentum_residual_rel: exchange.residual_rel(),
            energy_to_hand_j: energy_to_hand_j(states),
            guard_actions: totals.guard_actions,
            frames_dropped: states.last().map_or(0, |s| s.drops.total()),
            setups: counts.setups,
            faults: faults(states),
            cpu_s: run.clock.cpu.as_secs_f64(),
            wall_s: run.clock.wall.as_secs_f64(),
            trace_hash: format!("{:#018x}", record.hash()),
        }
    }

    /// One line of JSON.
    #[must_use]
    pub fn json(&self) -> String {
        // Strings, finite numbers and lists of them: there is nothing that JSON cannot say.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// A table for people.
    #[must_use]
    pub fn table(&self, output: &Output) -> String {
        let [nx, ny, nz] = self.grid;
        let speed = self.seconds / self.wall_s.max(1e-9);
        let limits: Vec<String> =
            self.limits.iter().map(|l| format!("{} {}", l.limit, l.ticks)).collect();
        let kb_s = self.field_bytes as f64 / self.seconds / 1e3;
        let rows = [
            ("scene", format!("{}, {nx} x {ny} x {nz} cells, seed {}", self.scene, self.seed)),
            (
                "time",
                format!(
                    "{:.2} s in {:.2} s, {speed:.1} x real time, {:.2} s CPU, {} threads, {}",
                    self.seconds, self.wall_s, self.cpu_s, self.threads, self.simd
                ),
            ),
            (
                "ticks",
                format!("{}, {} missed, {} late", self.ticks, self.ticks_missed, self.ticks_late),
            ),
            (
                "fluid",
                format!(
                    "{} steps, {} of them asleep; kinetic energy at most {:.3} mJ",
                    self.steps,
                    self.steps_asleep,
                    1e3 * self.fluid_ke_max
                ),
            ),
            ("divergence", format!("at most {:.1e} 1/s", self.divergence_max)),
            (
                "fields",
                format!(
                    "{} and {} keeps, {kb_s:.0} kB/s",
                    self.fields_sent,
                    self.fields - self.fields_sent
                ),
            ),
            (
                "force",
                format!(
                    "at most {:.3} N of {:.1} N; {:.3} N rms in the liquid; felt scale {}",
                    self.force_n_max, self.force_n_limit, self.force_n_rms_wet, self.felt_scale
                ),
            ),
            (
                "surface",
                format!(
                    "{} times through, {:.2} s in the liquid, {:.2} mJ left as waves",
                    self.pops,
                    self.ticks_wet as f64 / TICKS_PER_SECOND,
                    1e3 * self.surface_released_j
                ),
            ),
            (
                "limits",
                if limits.is_empty() {
                    "none acted".into()
                } else {
                    format!("ticks: {}", limits.join(", "))
                },
            ),
            (
                "momentum",
                format!(
                    "{:.4} N s given, books open by {:.1e}",
                    self.impulse_n_s, self.momentum_residual_rel
                ),
            ),
            ("energy", format!("{:+.2} mJ to the hand", 1e3 * self.energy_to_hand_j)),
            ("trace", format!("{}, {}", self.trace_hash, output.dir().display())),
        ];
        rows.map(|(name, what)| format!("{name:<11} {what}")).join("\n")
    }
}

fn force_n(state: &State) -> DVec3 {
    DVec3::from_array(state.force.map(|f| f64::from(f.0)))
}

fn position_m(state: &State) -> DVec3 {
    DVec3::from_array(state.position.map(|x| f64::from(x.0)))
}

fn rms_wet_n(states: &[State]) -> f64 {
    let wet = || states.iter().filter(|s| s.flags.contains(Flags::WET));
    let sum = wet().fold(0.0, |sum, s| sum + force_n(s).length_squared());
    (sum / wet().count().max(1) as f64).sqrt()
}

fn pops(states: &[State]) -> usize {
    let broke =
        |w: &&[State]| w[0].flags.contains(Flags::ON_SURFACE) && w[1].flags.contains(Flags::WET);
    states.windows(2).filter(broke).count()
}

fn faults(states: &[State]) -> usize {
    let is_fault = |s: &State| matches!(s.supervisor, Supervisor::Fault(_));
    states.windows(2).filter(|w| !is_fault(&w[0]) && is_fault(&w[1])).count()
}

/// Sum of f_k . (x_k+1 - x_k).
fn energy_to_hand_j(states: &[State]) -> f64 {
    states.windows(2).map(|w| force_n(&w[0]).dot(position_m(&w[1]) - position_m(&w[0]))).sum()
}

fn limits(states: &[State]) -> Vec<LimitTicks> {
    let ticks = |limit| states.iter().filter(|s| s.limits.contains(limit)).count();
    let all = Limit::ALL.map(|limit| LimitTicks { limit: limit.name(), ticks: ticks(limit) });
    all.into_iter().filter(|l| l.ticks > 0).collect()
}
