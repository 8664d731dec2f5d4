//! One panel laid out: legend, spans, grid, axes, series, notes.

use embedded_graphics::text::Alignment;

use super::{
    INK, Panel, SHADE, Span,
    axis::{Ruler, Tick},
    legend::{LINE_HEIGHT, Legend},
    note::{self, Note},
    series,
    shape::{Area, Pen, Shape, width_px},
};

const LEFT: i32 = 84;
const RIGHT: i32 = 24;
const X_NUMBERS_HEIGHT: i32 = 46;
const BELOW: i32 = 14;
/// Least distances between numbers, in pixels.
const X_NUMBER_PX: i32 = 64;
const Y_NUMBER_PX: i32 = 44;
/// No axes are smaller.
const LEAST_PX: i32 = 8;

const GRID: [u8; 3] = [220, 220, 220];
const FINE_GRID: [u8; 3] = [241, 241, 241];
const LIMIT: Pen = Pen { colour: [110, 130, 150], width_px: 1.2, is_dashed: true };

/// Where a panel goes.
pub(super) struct Place {
    pub(super) page: Area,
    pub(super) top: i32,
    pub(super) bottom: i32,
    pub(super) has_x_numbers: bool,
    /// A long legend may take some of the width.
    pub(super) may_narrow: bool,
}

/// Lays `panel` out: its shapes, the last on top.
pub(super) fn draw(shapes: &mut Vec<Shape>, panel: &Panel, place: &Place) {
    let area = place_legend(shapes, panel, place);
    if area.width() < LEAST_PX || area.height() < LEAST_PX {
        return;
    }
    let x_ends_px = [area.left, area.right].map(f64::from);
    let y_ends_px = [area.bottom, area.top].map(f64::from);
    let x = Ruler::new(&panel.x, panel.all_x(), x_ends_px, 0.02);
    let y = Ruler::new(&panel.y, panel.all_y(), y_ends_px, 0.06);
    let mut limits = Vec::new();
    for span in &panel.spans {
        let edges_px =
            [span.x.map(|value| x.px_within(value)), span.y.map(|value| y.px_within(value))];
        shapes.push(Shape::Fill { area: shade(edges_px), colour: SHADE });
        // The grid is not to hide the borders of a target.
        limits.extend(borders(span, edges_px, area));
    }
    draw_grid(shapes, area, &x, &y, place.has_x_numbers);
    if place.has_x_numbers {
        let at_px = [(area.left + area.right) / 2, area.bottom + 23];
        shapes.push(Shape::words(&panel.x.label, at_px, Alignment::Center, INK));
    }
    shapes.append(&mut limits);
    draw_series(shapes, panel, area, &x, &y);
}

/// Draws all series, and over them the words beside their points.
fn draw_series(shapes: &mut Vec<Shape>, panel: &Panel, area: Area, x: &Ruler, y: &Ruler) {
    let (mut marks_px, mut notes) = (Vec::new(), Vec::new());
    let seen = |at_px: &Option<[f64; 2]>| at_px.filter(|at_px| area.contains(*at_px));
    for series in &panel.series {
        let places_px = series::places_px(series, x, y);
        series::draw_lines(shapes, series, &places_px, area);
        if series.is_marked() {
            marks_px.extend(places_px.iter().filter_map(seen));
            let marks = places_px.iter().filter_map(seen);
            shapes.extend(marks.flat_map(|at_px| series::mark(series, at_px)));
        }
        for (at_px, words) in places_px.iter().zip(&series.notes) {
            let colour = darker(series.rgb());
            notes.extend(seen(at_px).map(|at_px| Note { at_px, words, colour }));
        }
    }
    shapes.extend(note::shapes(&notes, &marks_px, area));
}

/// Puts down the name of the y axis and the legend. Returns what is left for the axes.
fn place_legend(shapes: &mut Vec<Shape>, panel: &Panel, place: &Place) -> Area {
    let below = if place.has_x_numbers { X_NUMBERS_HEIGHT } else { BELOW };
    let right = place.page.right - RIGHT;
    let first_line = place.top + LINE_HEIGHT;
    let area = Area { left: LEFT, top: first_line, right, bottom: place.bottom - below };
    shapes.push(Shape::words(&panel.y.label, [8, place.top], Alignment::Left, INK));
    let legend = Legend::of(panel);
    match legend.column_width(area).filter(|_| place.may_narrow) {
        Some(width) => {
            legend.column(shapes, [right - width, area.top]);
            Area { right: right - width - RIGHT, ..area }
        }
        None => {
            let ends = [LEFT + width_px(&panel.y.label), right];
            Area { top: legend.rows(shapes, ends, place.top), ..area }
        }
    }
}

/// Small letters need more contrast than lines do.
fn darker(colour: [u8; 3]) -> [u8; 3] {
    colour.map(|part| (f32::from(part) * 0.75) as u8)
}

fn shade([[left, right], [bottom, top]]: [[f64; 2]; 2]) -> Area {
    let [left, top, right, bottom] = [left, top, right, bottom].map(|px| px as i32);
    Area { left, top, right, bottom }
}

/// Dashed lines where a target ends, but for where only the axes do.
fn borders(span: &Span, [x_px, y_px]: [[f64; 2]; 2], area: Area) -> Vec<Shape> {
    let is_inner = |px: f64, low: i32, high: i32| px > f64::from(low) && px < f64::from(high);
    let upright = x_px.into_iter().filter(|px| is_inner(*px, area.left, area.right));
    let level = y_px.into_iter().filter(|px| is_inner(*px, area.top, area.bottom));
    let upright = upright.map(|px| y_px.map(|y| [px, y]).to_vec());
    let lines = upright.chain(level.map(|px| x_px.map(|x| [x, px]).to_vec()));
    let is_target = span.y != Span::ENDLESS;
    lines.filter(|_| is_target).map(|points_px| Shape::Line { points_px, pen: LIMIT }).collect()
}

fn draw_grid(shapes: &mut Vec<Shape>, area: Area, x: &Ruler, y: &Ruler, has_x_numbers: bool) {
    let upright = |tick: &Tick| {
        let left = (tick.at_px as i32).clamp(area.left, area.right - 1);
        Area { left, right: left + 1, ..area }
    };
    let level = |tick: &Tick| {
        let top = (tick.at_px as i32).clamp(area.top, area.bottom - 1);
        Area { top, bottom: top + 1, ..area }
    };
    let along_x = x.ticks((area.width() / X_NUMBER_PX) as usize);
    let along_y = y.ticks((area.height() / Y_NUMBER_PX) as usize);
    let lines_x = along_x.into_iter().map(|tick| (upright(&tick), tick.label, true));
    let lines_y = along_y.into_iter().map(|tick| (level(&tick), tick.label, false));
    // Fine lines first, so that none is drawn across a numbered one.
    let mut lines: Vec<_> = lines_x.chain(lines_y).collect();
    lines.sort_by_key(|(_, label, _)| label.is_some());
    for (line, label, is_upright) in lines {
        let colour = if label.is_some() { GRID } else { FINE_GRID };
        shapes.push(Shape::Fill { area: line, colour });
        let Some(label) = label.filter(|_| has_x_numbers || !is_upright) else { continue };
        let (at_px, alignment) = if is_upright {
            ([line.left, area.bottom + 5], Alignment::Center)
        } else {
            ([area.left - 6, line.top - 6], Alignment::Right)
        };
        shapes.push(Shape::words(&label, at_px, alignment, INK));
    }
    let [left, bottom] = [area.left - 1, area.bottom];
    shapes.push(Shape::Fill { area: Area { left, right: area.left, ..area }, colour: INK });
    let floor = Area { left, top: bottom, bottom: bottom + 1, ..area };
    shapes.push(Shape::Fill { area: floor, colour: INK });
}
