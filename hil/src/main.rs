//! Runs the scenario list on a rig, and makes tapes for boards that play them.

mod tape;

use cauldron_tests::{LIST, Rig, SimRig};
use clap::{Parser, ValueEnum};
use std::{
    io::{self, Write},
    path::PathBuf,
    process::ExitCode,
};

/// The scenario list on a rig.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Cli {
    /// What to run on
    #[arg(long, value_enum, default_value_t = RigKind::Sim)]
    rig: RigKind,
    /// Seed of every draw
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only the scenario of this name
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Lists the scenarios and runs none
    #[arg(long)]
    list: bool,
    /// Records what the firmware meets in two seconds of the cauldron into this file, and prints
    /// the hash of its trace here
    #[arg(long, value_name = "FILE", conflicts_with_all = ["only", "list"])]
    tape: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  cauldron-hil --rig sim                     every scenario on the simulated rig
  cauldron-hil --rig sim --only stir --seed 7
  cauldron-hil --tape run.tape               what the emulated board plays

Exit codes: 0 all passed, 1 one failed, 2 bad usage, 3 the rig is not there.";

/// Rigs.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum RigKind {
    /// Firmware on the simulated board, virtual time.
    Sim,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Some(path) = &cli.tape {
        return tape::record(path, cli.seed);
    }
    if cli.list {
        LIST.iter().for_each(|s| say(&format!("{:<24} {}", s.name, s.about)));
        return ExitCode::SUCCESS;
    }
    if let Some(name) = cli.only.as_ref().filter(|name| LIST.iter().all(|s| s.name != **name)) {
        eprintln!("cauldron-hil: no scenario is called '{name}'; --list shows them");
        return ExitCode::from(2);
    }
    let mut rig = match cli.rig {
        RigKind::Sim => SimRig::new(cli.seed),
    };
    run(&mut rig, cli.only.as_deref())
}

/// Plays the list; the last line counts.
fn run(rig: &mut dyn Rig, only: Option<&str>) -> ExitCode {
    let (mut passed, mut failed) = (0, 0);
    for scenario in LIST.iter().filter(|s| only.is_none_or(|only| s.name == only)) {
        let verdict = match rig.play(scenario) {
            Ok(trace) => scenario.judge(&trace).map_err(|wrong| wrong.to_string()),
            Err(error) => Err(error.to_string()),
        };
        match verdict {
            Ok(()) => {
                passed += 1;
                say(&format!("ok    {:<24} {}", scenario.name, scenario.about));
            }
            Err(why) => {
                failed += 1;
                say(&format!("FAIL  {:<24} {why}", scenario.name));
            }
        }
    }
    say(&format!("{}: {passed} passed, {failed} failed", rig.name()));
    if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// A line on stdout; whoever closed it does not want to know, and the exit code still tells.
fn say(line: &str) {
    let _ = writeln!(io::stdout(), "{line}");
}
