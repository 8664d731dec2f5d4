//! `cauldron bench`.

mod diagram;
mod table;

use cauldron_fluid::{
    bench::{self, NAMES, Options},
    pool::Pool,
    simd::SimdClass,
};
use std::{
    io::{self, Write},
    sync::Arc,
};

use crate::{Failure, cli::BenchArgs};

/// Measures the flow solvers.
///
/// # Errors
/// [`Failure::Check`] if a row of ours misses its target; [`Failure::Input`] if there is no such
/// case, or a diagram cannot be written.
pub fn fluid(args: &BenchArgs) -> Result<(), Failure> {
    let options = options(args)?;
    let rows = bench::run(&options, &mut |what| eprintln!("measuring {what}"))
        .map_err(|refused| Failure::Check(refused.to_string()))?;
    let text: Vec<String> = if args.json {
        rows.iter().map(|row| serde_json::to_string(row).unwrap_or_default()).collect()
    } else {
        [table::rows(&rows), table::targets(&rows)].concat()
    };
    writeln!(io::stdout(), "{}", text.join("\n"))
        .map_err(|e| Failure::Input(format!("cannot write to stdout: {e}")))?;
    if let Some(dir) = &args.plot {
        diagram::write(&rows, dir)?;
    }
    let misses: Vec<String> =
        rows.iter().filter(|row| row.pass == Some(false)).map(table::name).collect();
    if misses.is_empty() {
        Ok(())
    } else {
        Err(Failure::Check(format!("missed: {}", misses.join(", "))))
    }
}

fn options(args: &BenchArgs) -> Result<Options, Failure> {
    let unknown = args.case.as_deref().filter(|case| !NAMES.contains(case));
    if let Some(case) = unknown {
        let names = NAMES.join(", ");
        return Err(Failure::Input(format!("there is no case '{case}': there are {names}")));
    }
    let given = if args.quick { Options::quick() } else { Options::full() };
    Ok(Options {
        case: args.case.clone(),
        pool: Arc::new(Pool::new(args.threads.into(), true)),
        simd: args.simd.unwrap_or_else(SimdClass::detect),
        ..given
    })
}
