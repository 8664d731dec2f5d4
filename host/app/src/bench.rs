//! `cauldron bench`.

mod diagram;
mod table;

use cauldron_fluid::{
    bench::{Group, Options},
    pool::Pool,
    simd::SimdClass,
};
use std::{
    io::{self, Write},
    sync::Arc,
};

use crate::{Failure, cli::BenchArgs};

/// Measures a group.
///
/// # Errors
/// [`Failure::Check`] if a row misses its target; [`Failure::Input`] if there is no such
/// case, or a diagram cannot be written.
pub fn run(group: &Group, args: &BenchArgs) -> Result<(), Failure> {
    let options = options(group, args)?;
    let rows = (group.run)(&options, &mut |what| eprintln!("measuring {what}"))
        .map_err(|refused| Failure::Check(refused.to_string()))?;
    let text: Vec<String> = if args.json {
        rows.iter().map(|row| serde_json::to_string(row).unwrap_or_default()).collect()
    } else {
        [table::rows(group, &rows), table::targets(group, &rows)].concat()
    };
    writeln!(io::stdout(), "{}", text.join("\n"))
        .map_err(|e| Failure::Input(format!("cannot write to stdout: {e}")))?;
    if let Some(dir) = &args.plot {
        diagram::write(group, &rows, dir)?;
    }
    let missed = rows.iter().filter(|row| row.pass == Some(false));
    let misses: Vec<String> = missed.map(|row| table::name(group, row)).collect();
    if misses.is_empty() {
        Ok(())
    } else {
        Err(Failure::Check(format!("missed: {}", misses.join(", "))))
    }
}

fn options(group: &Group, args: &BenchArgs) -> Result<Options, Failure> {
    let unknown = args.case.as_deref().filter(|case| !group.cases.contains(case));
    if let Some(case) = unknown {
        let names = group.cases.join(", ");
        return Err(Failure::Input(format!("there is no case '{case}': there are {names}")));
    }
    Ok(Options {
        case: args.case.clone(),
        pool: Arc::new(Pool::new(args.threads.into(), true)),
        simd: args.simd.unwrap_or_else(SimdClass::detect),
        ..(group.options)(args.quick)
    })
}
