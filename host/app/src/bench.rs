//! `cauldron bench`.

use cauldron_fluid::bench::{self, Options, Row};
use cauldron_render::{
    Plot,
    plot::{Axis, Panel, Series, Style},
    png, svg,
};
use std::{
    collections::BTreeMap,
    fs,
    io::{self, Write},
    path::Path,
};

use crate::{Failure, cli::BenchArgs};

/// Repetitions of the quick run and of the full one; medians are printed.
const REPETITIONS: [usize; 2] = [3, 9];

/// Width and height of a diagram.
const DIAGRAM: [usize; 2] = [900, 600];

/// Measures the flow solvers.
///
/// # Errors
/// [`Failure::Check`] if a row of ours misses its target; [`Failure::Input`] if a diagram cannot
/// be written.
pub fn fluid(args: &BenchArgs) -> Result<(), Failure> {
    let repetitions = REPETITIONS[usize::from(!args.quick)];
    let options = Options { repetitions, ..Options::default() };
    let rows = bench::run(&options, &mut |what| eprintln!("measuring {what}"))
        .map_err(|refused| Failure::Check(refused.to_string()))?;
    let text: Vec<String> = if args.json {
        rows.iter().map(|row| serde_json::to_string(row).unwrap_or_default()).collect()
    } else {
        table(&rows)
    };
    writeln!(io::stdout(), "{}", text.join("\n"))
        .map_err(|e| Failure::Input(format!("cannot write to stdout: {e}")))?;
    if let Some(dir) = &args.plot {
        draw(&rows, dir)?;
    }
    let misses: Vec<String> = rows.iter().filter(|r| r.pass == Some(false)).map(name).collect();
    if misses.is_empty() {
        Ok(())
    } else {
        Err(Failure::Check(format!("missed: {}", misses.join(", "))))
    }
}

fn name(row: &Row) -> String {
    format!("{} {} n={}", row.case, row.method, row.n.unwrap_or(0))
}

fn table(rows: &[Row]) -> Vec<String> {
    let head = format!(
        "{:<14} {:<18} {:>3}  {:<18} {:>10}  {:>8} {:>4}  {:>9} {:>12}",
        "case", "method", "n", "quantity", "value", "target", "", "ms/step", "to founding"
    );
    let line = |row: &Row| {
        let target = row.target.map_or(String::new(), |t| format!("{t:.1e}"));
        let pass = row.pass.map_or("", |pass| if pass { "ok" } else { "MISS" });
        let ms = row.ms.map_or(String::new(), |ms| format!("{ms:.3}"));
        let ratio = row.ratio_to_founding.map_or(String::new(), |r| format!("1/{:.1}", 1.0 / r));
        format!(
            "{:<14} {:<18} {:>3}  {:<18} {:>10.3e}  {target:>8} {pass:>4}  {ms:>9} {ratio:>12}",
            row.case,
            row.method,
            row.n.unwrap_or(0),
            row.quantity,
            row.value,
        )
    };
    std::iter::once(head).chain(rows.iter().map(line)).collect()
}

/// A work-precision diagram for each case: error over time per step, a line for each solver.
fn draw(rows: &[Row], dir: &Path) -> Result<(), Failure> {
    let cannot = |why: &dyn std::fmt::Display| {
        Failure::Input(format!("cannot write into {}: {why}", dir.display()))
    };
    fs::create_dir_all(dir).map_err(|e| cannot(&e))?;
    let mut cases: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    rows.iter().for_each(|row| cases.entry(&row.case).or_default().push(row));
    for (case, rows) in cases {
        let (plot, [width, height]) = (diagram(case, &rows), DIAGRAM);
        let path = |ending: &str| dir.join(format!("fluid-{case}.{ending}"));
        png::write(path("png"), &plot.draw(width, height)).map_err(|e| cannot(&e))?;
        svg::write(path("svg"), &plot.svg(width, height)).map_err(|e| cannot(&e))?;
    }
    Ok(())
}

fn diagram(case: &str, rows: &[&Row]) -> Plot {
    let mut lines: BTreeMap<&str, Series> = BTreeMap::new();
    for row in rows {
        let colour = lines.len();
        let line = lines.entry(&row.method).or_insert_with(|| Series {
            style: Style::MarkedLine,
            ..Series::line(&row.method, Vec::new(), colour)
        });
        line.points.push([row.ms.unwrap_or(f64::NAN), row.value]);
        line.notes.push(row.n.map_or(String::new(), |n| format!("n={n}")));
    }
    let quantity = rows.first().map_or("", |row| row.quantity);
    Plot {
        title: format!("{case}: error against time"),
        shares_x: false,
        panels: vec![Panel {
            x: Axis::log10("CPU time of a step [ms]"),
            y: Axis::log10(quantity),
            series: lines.into_values().collect(),
            spans: Vec::new(),
        }],
    }
}
