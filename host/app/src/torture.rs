//! `cauldron torture`.

use cauldron_fluid::{
    pool::Pool,
    simd::SimdClass,
    torture::{self, Group, Summary, Verdict},
};
use cpu_time::ProcessTime;
use serde_json::{Value, json};
use std::{
    fs,
    io::{self, Write},
    path::Path,
    sync::Arc,
    thread,
    time::Instant,
};

use crate::{
    Failure,
    cli::{Shard, TortureArgs},
};

/// Tortures a group, or sums up what did.
///
/// # Errors
/// [`Failure::Check`] if a seed failed, or a seed or a corner of a whole run was left out;
/// [`Failure::Input`] if an output to merge cannot be read, or is of another group, or stdout not
/// be written.
pub fn run(group: &Group, args: &TortureArgs) -> Result<(), Failure> {
    if !args.merge.is_empty() {
        let parts = args.merge.iter().map(|path| read(path)).collect::<Result<Vec<_>, _>>()?;
        let whole = Summary::merge(&parts).map_err(Failure::Input)?;
        if whole.group != group.name {
            return Err(Failure::Input(format!("they are of torture {}", whole.group)));
        }
        return conclude(group, &whole, args.json, true);
    }
    let summary = run_seeds(group, args)?;
    conclude(group, &summary, args.json, args.seed.is_none() && args.shard.is_none())
}

fn run_seeds(group: &Group, args: &TortureArgs) -> Result<Summary, Failure> {
    let Shard { index, count } = args.shard.unwrap_or(Shard { index: 1, count: 1 });
    let seeds: Vec<u64> = match args.seed {
        Some(seed) => vec![seed],
        None => torture::seeds_of_shard(args.seeds, index, count).collect(),
    };
    let cores = thread::available_parallelism().map_or(1, usize::from).min(2);
    let pool = Arc::new(Pool::new(args.threads.map_or(cores, usize::from), true));
    let simd = args.simd.unwrap_or_else(SimdClass::detect);
    let (from, cpu_from) = (Instant::now(), ProcessTime::now());
    let mut summary = Summary::of(group.name, args.seed.map_or(args.seeds, |seed| seed + 1));
    if !args.json {
        print(&head(group))?;
    }
    for (done, &seed) in seeds.iter().enumerate() {
        let (elapsed_s, all) = (from.elapsed().as_secs_f64(), seeds.len());
        eprintln!("seed {seed} ({} of {all}, {elapsed_s:.0} s)", done + 1);
        let verdict = (group.run)(seed, &pool, simd);
        print(&if args.json { json_line(&verdict)? } else { line(group, &verdict) })?;
        if !verdict.failures.is_empty() {
            eprintln!("seed {seed} failed; this does it again: {}", verdict.replay);
        }
        summary.add(&verdict);
    }
    summary.wall_s = from.elapsed().as_secs_f64();
    summary.cpu_s = cpu_from.elapsed().as_secs_f64();
    Ok(summary)
}

/// Says how it went. Only a whole run is asked for its corners.
fn conclude(
    group: &Group,
    summary: &Summary,
    is_json: bool,
    is_whole: bool,
) -> Result<(), Failure> {
    let (corners, seeds) = if is_whole {
        (summary.corners_left_out(group), summary.seeds_left_out())
    } else {
        Default::default()
    };
    let mut wrong = Vec::new();
    if !summary.failed.is_empty() {
        wrong.push(format!("failed: {}", listed(&summary.failed)));
    }
    if !corners.is_empty() {
        wrong.push(format!("corners left out: {}", listed(&corners)));
    }
    if !seeds.is_empty() {
        wrong.push(format!("{} seeds left out, the first {}", seeds.len(), seeds[0]));
    }
    let text = if is_json {
        let pass = wrong.is_empty();
        json!({"group": "torture", "case": "summary", "pass": pass, "summary": summary}).to_string()
    } else {
        told(summary)
    };
    print(&text)?;
    if wrong.is_empty() { Ok(()) } else { Err(Failure::Check(wrong.join("; "))) }
}

fn told(summary: &Summary) -> String {
    let Summary { ran, failed, unsupported, not_taken, wall_s, cpu_s, .. } = summary;
    let mut text = format!(
        "{} seeds ran, {} failed, {} are beyond the solver; {wall_s:.1} s, CPU {cpu_s:.1} s",
        ran.len(),
        failed.len(),
        unsupported.len()
    );
    if !not_taken.is_empty() {
        text += &format!("\ndrawn, but not taken by the solver yet: {}", listed(not_taken));
    }
    text
}

fn listed<T: ToString>(all: impl IntoIterator<Item = T>) -> String {
    all.into_iter().map(|one| one.to_string()).collect::<Vec<_>>().join(", ")
}

/// The summary on the last line of an output.
fn read(path: &Path) -> Result<Summary, Failure> {
    let wrong = |why: String| Failure::Input(format!("{}: {why}", path.display()));
    let text = fs::read_to_string(path).map_err(|e| wrong(format!("cannot read: {e}")))?;
    let last = text.lines().last().unwrap_or_default();
    let value: Value = serde_json::from_str(last).unwrap_or_default();
    serde_json::from_value(value["summary"].clone())
        .map_err(|_| wrong("its last line is not the summary of torture --json".into()))
}

fn json_line(verdict: &Verdict) -> Result<String, Failure> {
    serde_json::to_string(verdict).map_err(|e| Failure::Input(format!("cannot write JSON: {e}")))
}

fn head(group: &Group) -> String {
    let checks: String = group.checks.iter().map(|(_, short)| format!(" {short:>8}")).collect();
    format!("{:>5} {:<13} {:>11}{checks} {:>9}", "seed", "case", "size", "ms/step")
}

fn line(group: &Group, verdict: &Verdict) -> String {
    let row = &verdict.row;
    let edge = |name: &str| row.number(name).unwrap_or(f64::NAN).to_string();
    let size: Vec<String> = group.size.iter().map(|name| edge(name)).collect();
    let size = size.join("x");
    let checks: String = group
        .checks
        .iter()
        .map(|(name, _)| row.number(name).map_or("-".into(), |value| format!("{value:.1e}")))
        .map(|value| format!(" {value:>8}"))
        .collect();
    let ms = verdict.row.ms.map_or("-".into(), |ms| format!("{ms:.2}"));
    let mut line =
        format!("{:>5} {:<13} {size:>11}{checks} {ms:>9}", verdict.seed, verdict.row.case);
    if let Some(why) = &verdict.unsupported {
        line += &format!("  beyond the solver: {why}");
    }
    for failure in &verdict.failures {
        line += &format!("\n      FAILED {failure}");
    }
    if !verdict.failures.is_empty() {
        line += &format!("\n      again: {}", verdict.replay);
    }
    line
}

fn print(text: &str) -> Result<(), Failure> {
    let failed = |e| Failure::Input(format!("cannot write to stdout: {e}"));
    writeln!(io::stdout(), "{text}").map_err(failed)
}
