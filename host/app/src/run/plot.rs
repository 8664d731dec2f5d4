//! Force and position over time.

use cauldron_protocol::state::Flags;
use cauldron_render::{
    Canvas, Plot,
    plot::{Axis, Panel, Series, Span},
};

use super::Record;

const SIZE: [usize; 2] = [1200, 800];
const AXES: [&str; 3] = ["x", "y", "z"];
const TICK_S: f64 = 1e-3;

/// Draws the trace; time is that of the device, from its first tick heard.
pub fn draw(record: &Record, limit_n: f32) -> Canvas {
    let plot = Plot {
        title: "Force on the hand, and its way; shaded: in the liquid".into(),
        shares_x: true,
        panels: vec![force(record, limit_n), position(record)],
    };
    plot.draw(SIZE[0], SIZE[1])
}

fn force(record: &Record, limit_n: f32) -> Panel {
    let axis = |axis: usize| curve(record, AXES[axis], axis, |s| f64::from(s.force[axis].0));
    let norm = |s: &cauldron_protocol::State| {
        s.force.iter().map(|f| f64::from(f.0) * f64::from(f.0)).sum::<f64>().sqrt()
    };
    let end_s = record.len() as f64 * TICK_S;
    Panel {
        x: Axis::linear("time [s]"),
        y: Axis::linear("felt force [N]"),
        series: vec![
            axis(0),
            axis(1),
            axis(2),
            curve(record, "norm", 3, norm),
            Series::level("limit", f64::from(limit_n), [0.0, end_s], 4),
        ],
        spans: wet_spans(record),
    }
}

fn position(record: &Record) -> Panel {
    let axis =
        |axis: usize| curve(record, AXES[axis], axis, |s| 1e3 * f64::from(s.position[axis].0));
    Panel {
        x: Axis::linear("time [s]"),
        y: Axis::linear("position [mm]"),
        series: vec![axis(0), axis(1), axis(2)],
        spans: wet_spans(record),
    }
}

fn curve(
    record: &Record,
    name: &str,
    colour: usize,
    value: impl Fn(&cauldron_protocol::State) -> f64,
) -> Series {
    let points =
        record.states().iter().enumerate().map(|(i, s)| [i as f64 * TICK_S, value(s)]).collect();
    Series::line(name, points, colour)
}

fn wet_spans(record: &Record) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut since = None;
    let dry_at_end = std::iter::once(false);
    let wet = record.states().iter().map(|s| s.flags.contains(Flags::WET)).chain(dry_at_end);
    for (i, wet) in wet.enumerate() {
        let now_s = i as f64 * TICK_S;
        match (since, wet) {
            (None, true) => since = Some(now_s),
            (Some(from_s), false) => {
                spans.push(Span::along_x("in the liquid", [from_s, now_s]));
                since = None;
            }
            _ => {}
        }
    }
    spans
}
