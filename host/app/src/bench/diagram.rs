//! Work-precision diagrams: error over the run time that it takes.

use cauldron_fluid::bench::{Group, Row, target::Target};
use cauldron_render::{
    Plot,
    plot::{Axis, Panel, Series, Span, Style},
    png, svg,
};
use std::{collections::BTreeMap, fs, path::Path};

use crate::Failure;

/// Width and height.
const SIZE: [usize; 2] = [1000, 640];

/// Writes a diagram of each case whose error and time were measured, as PNG and SVG.
pub fn write(group: &Group, rows: &[Row], dir: &Path) -> Result<(), Failure> {
    let cannot = |why: &dyn std::fmt::Display| {
        Failure::Input(format!("cannot write into {}: {why}", dir.display()))
    };
    fs::create_dir_all(dir).map_err(|e| cannot(&e))?;
    let mut cases: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    let is_timed = |row: &&Row| row.ms.is_some() && row.unit == "1";
    for row in rows.iter().filter(is_timed) {
        cases.entry(&row.case).or_default().push(row);
    }
    for (case, rows) in cases {
        let (plot, [width, height]) = (diagram(group, case, &rows), SIZE);
        let path = |ending: &str| dir.join(format!("{}-{case}.{ending}", group.name));
        png::write(path("png"), &plot.draw(width, height)).map_err(|e| cannot(&e))?;
        svg::write(path("svg"), &plot.svg(width, height)).map_err(|e| cannot(&e))?;
    }
    Ok(())
}

/// A line over n for each method at the longest of its steps, and for those that targets are for at
/// each length.
fn diagram(group: &Group, case: &str, rows: &[&Row]) -> Plot {
    let [step, called] = group.step;
    let longest = rows.iter().filter_map(|row| row.number(step)).fold(0.0, f64::max);
    let is_asked = |row: &Row| group.targets.iter().any(|target| target.method == row.method);
    let mut lines: Vec<Series> = Vec::new();
    for row in rows {
        let length = row.number(step).unwrap_or(longest);
        if length < longest && !is_asked(row) {
            continue;
        }
        let label = if length < longest {
            format!("{}, {called} {length}", row.method)
        } else {
            row.method.clone()
        };
        let at = lines.iter().position(|line| line.label == label).unwrap_or_else(|| {
            let line = Series::line(label, Vec::new(), lines.len());
            lines.push(Series { style: Style::MarkedLine, ..line });
            lines.len() - 1
        });
        lines[at].points.push([row.total_ms().unwrap_or(f64::NAN), row.value]);
        lines[at].notes.push(row.n.map_or(String::new(), |n| n.to_string()));
    }
    let at = if longest > 0.0 { format!(", {called} {longest}") } else { String::new() };
    let title = format!("{case}{at}: error against time; beside the marks: n along an edge");
    let time = if rows.iter().any(|row| row.number("steps").is_some()) {
        "CPU time of the whole run, all threads [ms]"
    } else {
        "CPU time of one projection, all threads [ms]"
    };
    Plot {
        title,
        shares_x: false,
        panels: vec![Panel {
            x: Axis::log10(time),
            y: Axis::log10(rows.first().map_or("", |row| row.quantity)),
            series: lines,
            spans: spans(rows),
        }],
    }
}

/// The targets of ours: below the error, and left of the time where that is part of it.
fn spans(rows: &[&Row]) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    for row in rows {
        let Some(target) = Target::of(row) else { continue };
        let founding_ms = row.total_ms().zip(row.ratio_to_founding).map(|(ms, ratio)| ms / ratio);
        let ratio = row.number("ratio_target");
        let most_ms = founding_ms.zip(ratio).map_or(f64::INFINITY, |(ms, ratio)| ms * ratio);
        let n = row.n.unwrap_or(0);
        let span = Span::at_most(format!("target at {n}"), most_ms, target.at_most);
        // One area for each n: the narrowest.
        match spans.iter_mut().find(|other| other.label == span.label) {
            Some(other) if span.x[1] < other.x[1] => *other = span,
            Some(_) => {}
            None => spans.push(span),
        }
    }
    spans
}
