//! Draws a contact sheet and plots of made-up data, as PNG and SVG, into a folder (the first
//! argument, else `out/gallery`).

use std::{f64::consts::TAU, path::PathBuf};

use cauldron_render::{
    DEFAULT_THREADS, Plot,
    plot::{Axis, Panel, Series, Span, Style},
    png, render,
    sheet::{Thumbnail, contact_sheet},
    svg,
};
use glam::Vec3;

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("out/gallery".to_owned()));
    std::fs::create_dir_all(&folder)?;
    png::write(folder.join("sheet.png"), &sheet())?;
    let plots = [
        ("trace", trace(), [1200, 800]),
        ("work", work_precision(3), [900, 600]),
        ("work-dozen", work_precision(12), [900, 600]),
    ];
    for (name, plot, [width, height]) in plots {
        png::write(folder.join(format!("{name}.png")), &plot.draw(width, height))?;
        svg::write(folder.join(format!("{name}.svg")), &plot.svg(width, height))?;
    }
    Ok(())
}

/// A handle that is pushed ever deeper and harder.
fn sheet() -> cauldron_render::Canvas {
    let snapshot = synthetic::rippled(synthetic::blobs());
    let frames: Vec<_> = (0..10)
        .map(|frame| {
            let part = frame as f32 / 9.0;
            let place = Vec3::new(0.04 - 0.08 * part, 0.03 - 0.15 * part, 0.02);
            let view = synthetic::view(&snapshot, Some(synthetic::handle(place, part)));
            let label = format!("t = {:.2} s", 0.5 * part);
            (render(&view, 480, 360, DEFAULT_THREADS).resolve(), label)
        })
        .collect();
    let thumbnails: Vec<_> =
        frames.iter().map(|(picture, label)| Thumbnail { picture, label }).collect();
    contact_sheet(&thumbnails, 5)
}

/// Force and place of a long session at 1 kHz.
fn trace() -> Plot {
    let series = |label: &str, colour, value: &dyn Fn(f64) -> f64| {
        let points = (0..60_000).map(|tick| f64::from(tick) / 1e3).map(|t| [t, value(t)]);
        Series::line(label, points.collect(), colour)
    };
    let x = |t: f64| 1.8 * (TAU * t / 7.0).sin() + 0.3 * (TAU * t * 23.0).sin();
    let y = |t: f64| if t % 20.0 > 12.0 { 2.4 + 0.1 * (TAU * 40.0 * t).sin() } else { 0.0 };
    let z = |t: f64| 0.8 * (TAU * t / 3.0).cos();
    let norm = |t: f64| Vec3::new(x(t) as f32, y(t) as f32, z(t) as f32).length().into();
    let wet = |from: f64| Span::along_x("wet", [from, from + 8.0]);
    let spans = vec![wet(12.0), wet(32.0), wet(52.0)];
    let time = Axis::linear("time [s]");
    Plot {
        title: "Stirring a made-up pot".to_owned(),
        shares_x: true,
        panels: vec![
            Panel {
                x: time.clone(),
                y: Axis::linear("force [N]"),
                series: vec![
                    series("x", 0, &x),
                    series("y", 1, &y),
                    series("z", 2, &z),
                    series("norm", 6, &norm),
                    Series::level("limit", 3.3, [0.0, 60.0], 3),
                ],
                spans: spans.clone(),
            },
            Panel {
                x: time,
                y: Axis::linear("position [mm]"),
                series: vec![
                    series("x", 0, &|t| 60.0 * (TAU * t / 7.0).cos()),
                    series("y", 1, &|t| -40.0 * y(t)),
                    series("z", 2, &|t| 60.0 * (TAU * t / 7.0).sin()),
                ],
                spans,
            },
        ],
    }
}

/// Work against precision of made-up solvers, whose order and price grow with their number.
fn work_precision(solvers: usize) -> Plot {
    let sizes = (3..9).map(|power| 2_i32.pow(power));
    let solver = |number: usize| {
        let (order, price) = (1.0 + 0.25 * number as f64, 0.01 * 1.6_f64.powi(number as i32));
        let point = |n: i32| [price * f64::from(n).powi(3), f64::from(n).powf(-order)];
        let is_noted = number.is_multiple_of(4);
        Series {
            style: Style::MarkedLine,
            notes: sizes.clone().filter(|_| is_noted).map(|n| format!("n={n}")).collect(),
            ..Series::line(format!("order {order}"), sizes.clone().map(point).collect(), number)
        }
    };
    Plot {
        title: "Work and precision".to_owned(),
        shares_x: false,
        panels: vec![Panel {
            x: Axis::log10("time per step [µs]"),
            y: Axis::log10("error [-]"),
            series: (0..solvers).map(solver).collect(),
            spans: vec![Span::at_most("target", 1e4, 1e-4)],
        }],
    }
}
