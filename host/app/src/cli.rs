//! The command line.

use cauldron_fluid::simd::SimdClass;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

use crate::grid::GridChoice;

/// Stir a pot of fluid with a force-feedback handle: see it, feel it, measure it.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
pub struct Cli {
    /// Without a command: run, with its defaults.
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXAMPLES: &str = "\
Examples:
  cauldron                                  the cauldron, 10 s, pictures in out/
  cauldron run --scene honey.toml --out h   a scene of your own
  cauldron run --json --fps 0               the figures alone, as one line of JSON
  cauldron scenes                           what there is to stir
  cauldron bench fluid --quick              our solver against the founding one
  cauldron bench surface --quick            waves and springs against what they are to do
  cauldron torture fluid --seeds 50         our solver against jerks, jumps and extremes
  cauldron torture surface --seeds 200      the surface against pokes, kicks, jumps and extremes

Exit codes: 0 done, 1 a check failed, 2 bad input or usage, 3 the device failed.";

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Runs a scene on a device and shows what happened.
    #[command(after_help = RUN_EXAMPLES)]
    Run(RunArgs),
    /// Lists the scenes.
    Scenes(ScenesArgs),
    /// Measures run time against error.
    Bench {
        /// What to measure.
        #[command(subcommand)]
        group: BenchGroup,
    },
    /// Does its worst to what moves, seed by seed.
    Torture {
        /// What to torture.
        #[command(subcommand)]
        group: TortureGroup,
    },
}

const RUN_EXAMPLES: &str = "\
Examples:
  cauldron run --scene taylor-green --seconds 4
  cauldron run --seed 7 --fps 10 --out seven
  cauldron run --real-time --threads 1
  cauldron run --json --fps 0 | python3 -m json.tool

out/ holds frame-0001.png ..., contact-sheet.png, plot.png, run.csv and run.json.";

impl Default for Command {
    /// `run`, as if the command line said nothing more.
    fn default() -> Self {
        Self::Run(RunArgs::parse_from(["cauldron"]))
    }
}

/// Where a scene runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DeviceKind {
    /// The simulated device: the firmware itself on a simulated board.
    Sim,
}

/// Arguments of `run`.
#[derive(Clone, Debug, Parser)]
pub struct RunArgs {
    /// A scene's name, or a file that ends in .toml
    #[arg(long, default_value = "cauldron", value_name = "NAME|FILE.toml")]
    pub scene: String,
    /// The device
    #[arg(long, value_enum, default_value_t = DeviceKind::Sim)]
    pub device: DeviceKind,
    /// Simulated seconds
    #[arg(long, default_value_t = 10.0, value_parser = seconds)]
    pub seconds: f64,
    /// Seed of every draw
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for pictures, trace and figures
    #[arg(long, default_value = "out", value_name = "DIR")]
    pub out: PathBuf,
    /// Pictures per simulated second; 0 for none
    #[arg(long, default_value_t = 5.0, value_parser = frames_per_second)]
    pub fps: f64,
    /// Cells along the box's longest edge, instead of the scene's own, or auto: as many as half the
    /// time leaves room for, by a measurement at the start
    #[arg(long, value_name = "N|auto")]
    pub grid: Option<GridChoice>,
    /// Threads of the fluid; by default as many as there are cores, at most 2
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub threads: Option<u16>,
    /// Vector width of the fluid, by default the widest there is: portable, avx2 or avx512
    #[arg(long, value_parser = simd_class)]
    pub simd: Option<SimdClass>,
    /// Runs on the wall's clock instead of virtual time
    #[arg(long)]
    pub real_time: bool,
    /// Opens no window (this version has none to open)
    #[arg(long)]
    pub headless: bool,
    /// Prints the figures as one line of JSON, the last on stdout
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `scenes`.
#[derive(Args, Debug)]
pub struct ScenesArgs {
    /// One scene alone: a name, or a file
    #[arg(value_name = "NAME", required_if_eq("plan", "true"))]
    pub scene: Option<String>,
    /// Says what the scene's steps compute, and what that takes
    #[arg(long)]
    pub plan: bool,
    /// Cells along the box's longest edge, instead of the scene's own, or auto
    #[arg(long, value_name = "N|auto", requires = "plan")]
    pub grid: Option<GridChoice>,
    /// Prints a line of JSON for each
    #[arg(long)]
    pub json: bool,
}

/// What can be measured.
#[derive(Debug, Subcommand)]
pub enum BenchGroup {
    /// Flow solvers: error, time, and the ratio of their times to the founding solver's
    Fluid(BenchArgs),
    /// Models of the surface: frequency, decay, order, volume, time, and what becomes of a poke
    Surface(BenchArgs),
}

/// Arguments of `bench`.
#[derive(Args, Clone, Debug)]
pub struct BenchArgs {
    /// No more than the targets need: of solvers ours and the founding one, at small n and where
    /// else a target is
    #[arg(long)]
    pub quick: bool,
    /// One case alone
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// Threads of the solvers; rows for two threads have two, and surfaces one
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub threads: u16,
    /// Vector width, by default the widest there is: portable, avx2 or avx512
    #[arg(long, value_parser = simd_class)]
    pub simd: Option<SimdClass>,
    /// Prints a JSON object for each row
    #[arg(long)]
    pub json: bool,
    /// Draws work-precision diagrams into this folder
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
}

/// What can be tortured.
#[derive(Debug, Subcommand)]
pub enum TortureGroup {
    /// The flow solver: seeds 0 to 7 are fixed corners, the rest is drawn
    #[command(after_help = TORTURE_EXAMPLES)]
    Fluid(TortureArgs),
    /// The surface, of springs and of waves, with and without splashes: as the flow solver
    #[command(after_help = TORTURE_EXAMPLES)]
    Surface(TortureArgs),
}

const TORTURE_EXAMPLES: &str = "\
Examples:
  cauldron torture fluid --seeds 50
  cauldron torture fluid --seeds 1000 --shard 3/16 --json > part-3.jsonl
  cauldron torture fluid --merge part-*.jsonl
  cauldron torture fluid --seed 1234
  cauldron torture surface --seeds 200

Shard I/N, I from 1 to N, takes every N-th seed from seed I - 1 on. The last line of --json
sums a run up; --merge reads those lines, and fails if a seed failed or a corner was left out.";

/// Arguments of `torture`.
#[derive(Args, Clone, Debug)]
pub struct TortureArgs {
    /// Number of seeds, from 0 on; at least the corners
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u64).range(8..))]
    pub seeds: u64,
    /// Only this seed
    #[arg(long, conflicts_with_all = ["seeds", "shard"])]
    pub seed: Option<u64>,
    /// Only this part of the seeds
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Runs nothing: sums up the outputs of all shards
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["seeds", "seed", "shard"])]
    pub merge: Vec<PathBuf>,
    /// Prints a JSON object for each seed, and one that sums them up
    #[arg(long)]
    pub json: bool,
    /// Threads of the fluid; by default as many as there are cores, at most 2
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub threads: Option<u16>,
    /// Vector width of the fluid, by default the widest there is: portable, avx2 or avx512
    #[arg(long, value_parser = simd_class)]
    pub simd: Option<SimdClass>,
}

/// Part `index` of `count`, both counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1 to `count`.
    pub index: u64,
    /// Number of parts.
    pub count: u64,
}

fn shard(text: &str) -> Result<Shard, String> {
    let parsed = text.split_once('/').and_then(|(index, count)| {
        Some(Shard { index: index.parse().ok()?, count: count.parse().ok()? })
    });
    let shard = parsed.ok_or(format!("'{text}' is not two numbers, as in 3/16"))?;
    if (1..=shard.count).contains(&shard.index) {
        Ok(shard)
    } else {
        Err("shards are counted from 1".into())
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    bounded(text, 0.001, 86_400.0)
}

fn frames_per_second(text: &str) -> Result<f64, String> {
    bounded(text, 0.0, 1000.0)
}

fn bounded(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("'{text}' is not a number"))?;
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(format!("must be from {least} to {most}"))
    }
}

fn simd_class(text: &str) -> Result<SimdClass, String> {
    let class = SimdClass::parse(text).ok_or("there are portable, avx2 and avx512")?;
    if class <= SimdClass::detect() {
        Ok(class)
    } else {
        Err("this processor does not have it".into())
    }
}
