//! Curves on white paper: panels one above the other, each with axes, a legend and shaded spans.
//!
//! The same axes serve a session's traces (force and place over time) and diagrams of work
//! against precision, whose axes are logarithmic. Colours are those of Okabe and Ito (2008),
//! which people with any kind of colour blindness tell apart.

mod axis;
mod panel;
mod stroke;

use embedded_graphics::text::Alignment;

pub use axis::{Axis, Scale};

use crate::{
    canvas::Canvas,
    text::{self, LARGE},
};

/// A page of panels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Stands above all panels.
    pub title: String,
    /// From top to bottom.
    pub panels: Vec<Panel>,
    /// All panels show the same range of x, and only the lowest one has numbers under it.
    pub shares_x: bool,
}

/// One pair of axes and what is drawn between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// To the right.
    pub x: Axis,
    /// Upward.
    pub y: Axis,
    /// In the order in which they are drawn, the last on top.
    pub series: Vec<Series>,
    /// Ranges of x that are shaded, behind all series.
    pub spans: Vec<Span>,
}

/// One curve or cloud of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend; without one it is not listed there.
    pub label: String,
    /// Pairs of x and y. A pair that the axes cannot show (NaN, infinite, or not above zero on a
    /// logarithmic one) is left out, and the line is broken there.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub style: Style,
    /// Number of its colour: see [`COLOURS`]; counted round if there are too few.
    pub colour: usize,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// A line through all points.
    #[default]
    Line,
    /// A dashed line, for limits and references.
    Dashed,
    /// A mark at each point.
    Marks,
    /// Both a line and marks.
    MarkedLine,
}

/// A shaded range of x.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Span {
    /// Where it begins and ends.
    pub range: [f64; 2],
    /// Its name in the legend, where equal names are listed once.
    pub label: String,
}

/// Colours of series (Okabe and Ito 2008, without the yellow, which white paper swallows): blue,
/// vermilion, green, purple, orange, sky blue, black.
pub const COLOURS: [[u8; 3]; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [0, 0, 0],
];

const PAPER: [u8; 3] = [255, 255, 255];
const INK: [u8; 3] = [40, 40, 40];
const TITLE_HEIGHT: i32 = 36;

impl Series {
    /// A line through `points` in colour number `colour`.
    #[must_use]
    pub fn line(label: impl Into<String>, points: Vec<[f64; 2]>, colour: usize) -> Self {
        Self { label: label.into(), points, style: Style::Line, colour }
    }

    /// A dashed level line at `y` between two values of x.
    #[must_use]
    pub fn level(label: impl Into<String>, y: f64, x_range: [f64; 2], colour: usize) -> Self {
        let points = x_range.map(|x| [x, y]).to_vec();
        Self { label: label.into(), points, style: Style::Dashed, colour }
    }

    fn rgb(&self) -> [u8; 3] {
        COLOURS[self.colour % COLOURS.len()]
    }
}

impl Plot {
    /// Draws the page; 1200 x 800 is a good size. What a small page has no room for is left out.
    #[must_use]
    pub fn draw(&self, width: usize, height: usize) -> Canvas {
        let mut canvas = Canvas::new(width, height, PAPER);
        let middle = [width as i32 / 2, 10];
        text::write(&mut canvas, &self.title, middle, (LARGE, INK, Alignment::Center));
        let all_x = self.panels.iter().flat_map(Panel::all_x);
        let shared_x = self.shares_x.then(|| axis::extent(Scale::Linear, all_x)).flatten();
        let count = self.panels.len() as i32;
        let room = height as i32 - TITLE_HEIGHT;
        for (number, panel) in (0..).zip(&self.panels) {
            let mut panel = panel.clone();
            panel.x.range = panel.x.range.or(shared_x);
            let top = TITLE_HEIGHT + room * number / count;
            let bottom = TITLE_HEIGHT + room * (number + 1) / count;
            let has_x_numbers = !self.shares_x || number + 1 == count;
            panel::draw(&mut canvas, &panel, [top, bottom], has_x_numbers);
        }
        canvas
    }
}

impl Panel {
    fn all_x(&self) -> impl Iterator<Item = f64> + '_ {
        self.series.iter().flat_map(|series| series.points.iter().map(|point| point[0]))
    }

    fn all_y(&self) -> impl Iterator<Item = f64> + '_ {
        self.series.iter().flat_map(|series| series.points.iter().map(|point| point[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(canvas: &Canvas, colour: usize) -> usize {
        canvas.pixels().filter(|pixel| *pixel == COLOURS[colour]).count()
    }

    fn one_series(points: Vec<[f64; 2]>, scale: Scale) -> Plot {
        let axis = Axis { scale, ..Axis::default() };
        let series = vec![Series::line("", points, 1)];
        let panel = Panel { x: axis.clone(), y: axis, series, spans: Vec::new() };
        Plot { panels: vec![panel], ..Plot::default() }
    }

    #[test]
    fn samples_that_are_no_numbers_are_left_out() {
        let points = vec![[0.0, 0.0], [1.0, f64::NAN], [f64::INFINITY, 1.0], [2.0, 1.0]];
        let canvas = one_series(points, Scale::Linear).draw(400, 300);
        assert_eq!(count(&canvas, 1), 0, "the line is broken on both sides of what is left out");
        let canvas = one_series(vec![[0.0, 0.0], [2.0, 1.0]], Scale::Linear).draw(400, 300);
        assert!(count(&canvas, 1) > 100);
    }

    #[test]
    fn a_power_law_is_straight_on_logarithmic_axes() {
        let law = |x: f64| [x, x.powi(3)];
        let whole = (0..=60).map(|i| law(10_f64.powf(f64::from(i) / 20.0))).collect();
        let ends = vec![law(1.0), law(1000.0)];
        let [whole, ends] = [whole, ends].map(|points| one_series(points, Scale::Log10));
        let differing = whole.draw(400, 300);
        let ends = ends.draw(400, 300);
        let pairs = differing.pixels().zip(ends.pixels());
        let far = pairs.filter(|(a, b)| a[0].abs_diff(b[0]) > 60).count();
        assert!(far < 20, "{far} pixels differ");
    }

    #[test]
    fn any_page_can_be_drawn() {
        for size in [[0, 0], [1, 1], [60, 40], [1200, 800]] {
            let _ = Plot::default().draw(size[0], size[1]);
            for scale in [Scale::Linear, Scale::Log10] {
                for points in [vec![], vec![[0.0, 0.0]], vec![[1e300, -1e300], [-1e300, 1e300]]] {
                    let _ = one_series(points, scale).draw(size[0], size[1]);
                }
            }
        }
    }
}
