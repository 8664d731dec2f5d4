//! Draws a contact sheet and two plots of made-up data into a folder (the first argument, else
//! `out/gallery`).

use std::{f64::consts::TAU, path::PathBuf};

use cauldron_render::{
    DEFAULT_THREADS, Plot,
    plot::{Axis, Panel, Series, Span, Style},
    png, render,
    sheet::{Thumbnail, contact_sheet},
};
use glam::Vec3;

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("out/gallery".to_owned()));
    std::fs::create_dir_all(&folder)?;
    png::write(folder.join("sheet.png"), &sheet())?;
    png::write(folder.join("trace.png"), &trace().draw(1200, 800))?;
    png::write(folder.join("work.png"), &work_precision().draw(1200, 800))?;
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
    let wet = |from: f64| Span { range: [from, from + 8.0], label: "wet".to_owned() };
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

/// Work against precision of three made-up solvers.
fn work_precision() -> Plot {
    let solver = |label: &str, colour, order: i32, cost: f64| Series {
        label: label.to_owned(),
        points: (3..9).map(|n| 2_f64.powi(n)).map(|n| [cost * n.powi(3), n.powi(-order)]).collect(),
        style: Style::MarkedLine,
        colour,
    };
    Plot {
        title: "Work and precision".to_owned(),
        shares_x: false,
        panels: vec![Panel {
            x: Axis::log10("time per step [µs]"),
            y: Axis::log10("error [-]"),
            series: vec![
                solver("first order", 0, 1, 0.01),
                solver("second order", 1, 2, 0.03),
                solver("spectral, order 4", 2, 4, 0.2),
            ],
            spans: Vec::new(),
        }],
    }
}
