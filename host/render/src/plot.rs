//! Curves on white paper: panels one above the other, each with axes, a legend and shaded spans.
//!
//! The same axes serve a session's traces (force and place over time) and diagrams of work
//! against precision, whose axes are logarithmic. A page is laid out once, into simple shapes;
//! [`Plot::draw`] puts them on a canvas and [`Plot::svg`] writes them as a document.

mod axis;
mod legend;
mod mark;
mod note;
mod panel;
mod raster;
mod series;
mod shape;
mod vector;

use embedded_graphics::text::Alignment;

pub use axis::{Axis, Scale};

use self::shape::{Area, Shape, Size, Words};
use crate::canvas::Canvas;

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
    /// What is shaded, behind all series.
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
    /// Number of its colour and of its mark: see [`COLOURS`]; counted round if there are too
    /// few. Each of a dozen has a mark of its own.
    pub colour: usize,
    /// Words beside the points, in their order, say what was varied along the series: `"n=32"`.
    /// Points may go without.
    pub notes: Vec<String>,
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

/// A shaded rectangle: a time in which something holds, or a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Where it begins and ends along x.
    pub x: [f64; 2],
    /// Where it begins and ends along y. If it does end there, dashed lines are its borders.
    pub y: [f64; 2],
    /// Its name in the legend, where equal names are listed once.
    pub label: String,
}

/// Colours of series. The first seven are those of Okabe and Ito (2008), without the yellow,
/// which white paper swallows: blue, vermilion, green, purple, orange, sky blue, black. The rest
/// are of Tol's muted scheme (2021), and a grey: wine, olive, indigo, grey, dark green. People
/// with any kind of colour blindness tell the first seven apart; beyond, look at the marks.
pub const COLOURS: [[u8; 3]; 12] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [0, 0, 0],
    [136, 34, 85],
    [153, 153, 51],
    [51, 34, 136],
    [128, 128, 128],
    [17, 119, 51],
];

const PAPER: [u8; 3] = [255, 255, 255];
const INK: [u8; 3] = [40, 40, 40];
const SHADE: [u8; 3] = [222, 236, 247];
const TITLE_HEIGHT: i32 = 36;

impl Series {
    /// A line through `points` in colour number `colour`.
    #[must_use]
    pub fn line(label: impl Into<String>, points: Vec<[f64; 2]>, colour: usize) -> Self {
        Self { label: label.into(), points, colour, ..Self::default() }
    }

    /// A dashed level line at `y` between two values of x.
    #[must_use]
    pub fn level(label: impl Into<String>, y: f64, x_range: [f64; 2], colour: usize) -> Self {
        let points = x_range.map(|x| [x, y]).to_vec();
        Self { style: Style::Dashed, ..Self::line(label, points, colour) }
    }

    fn rgb(&self) -> [u8; 3] {
        COLOURS[self.colour % COLOURS.len()]
    }

    fn is_marked(&self) -> bool {
        matches!(self.style, Style::Marks | Style::MarkedLine)
    }
}

impl Span {
    /// From one end of an axis to the other.
    pub const ENDLESS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    /// A range of x at any y.
    #[must_use]
    pub fn along_x(label: impl Into<String>, x: [f64; 2]) -> Self {
        Self { x, y: Self::ENDLESS, label: label.into() }
    }

    /// A target: no more than `x` and no more than `y`, of which one may be infinite.
    #[must_use]
    pub fn at_most(label: impl Into<String>, x: f64, y: f64) -> Self {
        Self { x: [f64::NEG_INFINITY, x], y: [f64::NEG_INFINITY, y], label: label.into() }
    }
}

impl Plot {
    /// Draws the page; 1200 x 800 is a good size. What a small page has no room for is left out.
    #[must_use]
    pub fn draw(&self, width: usize, height: usize) -> Canvas {
        let mut canvas = Canvas::new(width, height, PAPER);
        let page = page(width, height);
        raster::draw(&mut canvas, page, &self.shapes(page));
        canvas
    }

    /// The same page as an SVG document: white, with words that are words, as wide and as high
    /// as [`Plot::draw`] has it until it is scaled. [`crate::svg::write`] puts it into a file.
    #[must_use]
    pub fn svg(&self, width: usize, height: usize) -> String {
        let page = page(width, height);
        vector::document(page, &self.title, &self.shapes(page))
    }

    fn shapes(&self, page: Area) -> Vec<Shape> {
        let title = Shape::Words(Words {
            words: self.title.clone(),
            at_px: [page.right / 2, 10],
            alignment: Alignment::Center,
            size: Size::Large,
            colour: INK,
        });
        let mut shapes = vec![title];
        let all_x = self.panels.iter().flat_map(Panel::all_x);
        let shared_x = self.shares_x.then(|| axis::extent(Scale::Linear, all_x)).flatten();
        let count = self.panels.len() as i32;
        let room = page.bottom - TITLE_HEIGHT;
        for (number, panel) in (0..).zip(&self.panels) {
            let mut panel = panel.clone();
            panel.x.range = panel.x.range.or(shared_x);
            let place = panel::Place {
                page,
                top: TITLE_HEIGHT + room * number / count,
                bottom: TITLE_HEIGHT + room * (number + 1) / count,
                has_x_numbers: !self.shares_x || number + 1 == count,
                // Panels that share their x stay equally wide.
                may_narrow: !self.shares_x,
            };
            panel::draw(&mut shapes, &panel, &place);
        }
        shapes
    }
}

fn page(width: usize, height: usize) -> Area {
    Area { left: 0, top: 0, right: width as i32, bottom: height as i32 }
}

impl Panel {
    fn all_x(&self) -> impl Iterator<Item = f64> + '_ {
        let points = self.series.iter().flat_map(|series| &series.points);
        points.map(|point| point[0]).chain(self.spans.iter().flat_map(|span| span.x))
    }

    fn all_y(&self) -> impl Iterator<Item = f64> + '_ {
        let points = self.series.iter().flat_map(|series| &series.points);
        points.map(|point| point[1]).chain(self.spans.iter().flat_map(|span| span.y))
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
        for [width, height] in [[0, 0], [1, 1], [60, 40], [1200, 800]] {
            let _ = Plot::default().draw(width, height);
            for scale in [Scale::Linear, Scale::Log10] {
                for points in [vec![], vec![[0.0, 0.0]], vec![[1e300, -1e300], [-1e300, 1e300]]] {
                    let plot = one_series(points, scale);
                    let _ = plot.draw(width, height);
                    let svg = plot.svg(width, height);
                    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
                }
            }
        }
    }

    #[test]
    fn a_dozen_colours_differ() {
        for (number, colour) in COLOURS.iter().enumerate() {
            for earlier in &COLOURS[..number] {
                let far: u32 = (0..3).map(|i| u32::from(colour[i].abs_diff(earlier[i]))).sum();
                assert!(far > 60, "{colour:?} {earlier:?}");
            }
        }
    }

    #[test]
    fn a_target_is_shaded_below_its_limits_and_is_on_the_page() {
        let mut plot = one_series(vec![[1.0, 1.0], [100.0, 0.1]], Scale::Log10);
        plot.panels[0].spans = vec![Span::at_most("", 0.1, 1e-3)];
        let shaded = |plot: &Plot, y: usize| {
            let canvas = plot.draw(400, 300);
            (84..370).filter(|x| canvas.get(*x, y) == Some(SHADE)).count()
        };
        assert!((5..140).contains(&shaded(&plot, 250)), "{}", shaded(&plot, 250));
        assert_eq!(shaded(&plot, 100), 0);
        plot.panels[0].spans = vec![Span::at_most("", f64::INFINITY, 1e-3)];
        assert!(shaded(&plot, 250) > 200);
    }
}
