//! The program: parses, runs, says how it went.

use cauldron::{bench, cli, cli::Command, run, scenes, torture};
use cauldron_fluid::{
    bench::{FLUID, surface::SURFACE},
    torture as fluid_torture,
};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    let done = match cli.command.unwrap_or_default() {
        Command::Run(args) => run::run(&args),
        Command::Scenes(args) => scenes::list(&args),
        Command::Bench { group: cli::BenchGroup::Fluid(args) } => bench::run(&FLUID, &args),
        Command::Bench { group: cli::BenchGroup::Surface(args) } => bench::run(&SURFACE, &args),
        Command::Torture { group: cli::TortureGroup::Fluid(args) } => {
            torture::run(&fluid_torture::FLUID, &args)
        }
        Command::Torture { group: cli::TortureGroup::Surface(args) } => {
            torture::run(&fluid_torture::surface::SURFACE, &args)
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("cauldron: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}
