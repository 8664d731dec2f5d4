//! One panel on the page: legend, grid, axes, spans, series.

use embedded_graphics::text::Alignment;

use super::{
    INK, Panel, Series, Style,
    axis::Ruler,
    stroke::{self, Area, Pen},
};
use crate::{
    canvas::Canvas,
    text::{self, SMALL},
};

const LEFT: i32 = 84;
const RIGHT: i32 = 24;
const LINE_HEIGHT: i32 = 19;
const X_NUMBERS_HEIGHT: i32 = 46;
const BELOW: i32 = 14;
const SWATCH: i32 = 24;
/// Least distances between numbers, in pixels.
const X_NUMBER_PX: usize = 90;
const Y_NUMBER_PX: usize = 44;

const GRID: [u8; 3] = [226, 226, 226];
const FINE_GRID: [u8; 3] = [243, 243, 243];
const SHADE: [u8; 3] = [222, 236, 247];

/// An entry of the legend.
enum Entry<'a> {
    Series(&'a Series),
    Span(&'a str),
}

/// Draws `panel` between two heights of the page.
pub(super) fn draw(
    canvas: &mut Canvas,
    panel: &Panel,
    [top, bottom]: [i32; 2],
    has_x_numbers: bool,
) {
    let right = canvas.width() as i32 - RIGHT;
    let below_legend = draw_legend(canvas, panel, [LEFT, right], top);
    let below = if has_x_numbers { X_NUMBERS_HEIGHT } else { BELOW };
    let area = Area { left: LEFT, top: below_legend, right, bottom: bottom - below };
    if area.right - area.left < 8 || area.bottom - area.top < 8 {
        return;
    }
    let x_ends_px = [f64::from(area.left), f64::from(area.right)];
    let y_ends_px = [f64::from(area.bottom), f64::from(area.top)];
    let x = Ruler::new(&panel.x, panel.all_x(), x_ends_px, 0.02);
    let y = Ruler::new(&panel.y, panel.all_y(), y_ends_px, 0.06);
    draw_spans(canvas, panel, area, &x);
    draw_x_axis(canvas, panel, area, &x, has_x_numbers);
    draw_y_axis(canvas, area, &y);
    draw_border(canvas, area);
    for series in &panel.series {
        draw_series(canvas, series, area, &x, &y);
    }
}

/// Writes the name of the y axis and, to the right of it, the legend in as many lines as it
/// needs. Returns where the next line would begin.
fn draw_legend(canvas: &mut Canvas, panel: &Panel, [left, right]: [i32; 2], top: i32) -> i32 {
    text::write(canvas, &panel.y.label, [8, top], (SMALL, INK, Alignment::Left));
    let first = left + text::width_px(&panel.y.label, SMALL);
    let (mut x, mut y) = (first, top);
    for entry in legend(panel) {
        let words = match entry {
            Entry::Series(series) => &series.label,
            Entry::Span(label) => label,
        };
        let width = SWATCH + 6 + text::width_px(words, SMALL) + 18;
        if x + width > right && x > first {
            (x, y) = (first, y + LINE_HEIGHT);
        }
        draw_swatch(canvas, &entry, [x, y]);
        text::write(canvas, words, [x + SWATCH + 6, y], (SMALL, INK, Alignment::Left));
        x += width;
    }
    y + LINE_HEIGHT
}

fn legend(panel: &Panel) -> Vec<Entry<'_>> {
    let named = panel.series.iter().filter(|series| !series.label.is_empty()).map(Entry::Series);
    let mut spans: Vec<&str> = panel.spans.iter().map(|span| span.label.as_str()).collect();
    spans.retain(|label| !label.is_empty());
    spans.dedup();
    named.chain(spans.into_iter().map(Entry::Span)).collect()
}

fn draw_swatch(canvas: &mut Canvas, entry: &Entry, [x, y]: [i32; 2]) {
    let area = Area { left: x, top: y, right: x + SWATCH, bottom: y + 13 };
    let middle = f64::from(y) + 7.0;
    let points_px = [[f64::from(x), middle], [f64::from(x + SWATCH), middle]];
    match entry {
        Entry::Series(series) => draw_points(canvas, area, &points_px, series),
        Entry::Span(_) => fill(canvas, area, SHADE),
    }
}

fn draw_spans(canvas: &mut Canvas, panel: &Panel, area: Area, x: &Ruler) {
    for span in &panel.spans {
        if let [Some(from), Some(to)] = span.range.map(|value| x.px(value)) {
            let left = (from as i32).max(area.left);
            fill(canvas, Area { left, right: (to as i32).min(area.right), ..area }, SHADE);
        }
    }
}

fn draw_x_axis(canvas: &mut Canvas, panel: &Panel, area: Area, x: &Ruler, has_numbers: bool) {
    for tick in x.ticks((area.right - area.left) as usize / X_NUMBER_PX) {
        let at = (tick.at_px as i32).clamp(area.left, area.right - 1);
        let colour = if tick.label.is_some() { GRID } else { FINE_GRID };
        fill(canvas, Area { left: at, right: at + 1, ..area }, colour);
        if let Some(label) = tick.label.filter(|_| has_numbers) {
            let place = [at, area.bottom + 5];
            text::write(canvas, &label, place, (SMALL, INK, Alignment::Center));
        }
    }
    if has_numbers {
        let place = [(area.left + area.right) / 2, area.bottom + 23];
        text::write(canvas, &panel.x.label, place, (SMALL, INK, Alignment::Center));
    }
}

fn draw_y_axis(canvas: &mut Canvas, area: Area, y: &Ruler) {
    for tick in y.ticks((area.bottom - area.top) as usize / Y_NUMBER_PX) {
        let at = (tick.at_px as i32).clamp(area.top, area.bottom - 1);
        let colour = if tick.label.is_some() { GRID } else { FINE_GRID };
        fill(canvas, Area { top: at, bottom: at + 1, ..area }, colour);
        if let Some(label) = tick.label {
            let place = [area.left - 6, at - 6];
            text::write(canvas, &label, place, (SMALL, INK, Alignment::Right));
        }
    }
}

fn draw_border(canvas: &mut Canvas, area: Area) {
    fill(canvas, Area { left: area.left - 1, right: area.left, ..area }, INK);
    let bottom = area.bottom + 1;
    fill(canvas, Area { left: area.left - 1, top: area.bottom, bottom, ..area }, INK);
}

fn draw_series(canvas: &mut Canvas, series: &Series, area: Area, x: &Ruler, y: &Ruler) {
    let places_px: Vec<Option<[f64; 2]>> =
        series.points.iter().map(|point| Some([x.px(point[0])?, y.px(point[1])?])).collect();
    // Each run of points that have a place is a line of its own.
    for run in places_px.split(Option::is_none) {
        let run_px: Vec<[f64; 2]> = run.iter().copied().flatten().collect();
        draw_points(canvas, area, &run_px, series);
    }
}

fn draw_points(canvas: &mut Canvas, area: Area, points_px: &[[f64; 2]], series: &Series) {
    let is_dashed = series.style == Style::Dashed;
    let pen = Pen { colour: series.rgb(), width_px: 1.7, is_dashed };
    if series.style != Style::Marks {
        stroke::line(canvas, area, &stroke::decimated(points_px), pen);
    }
    if matches!(series.style, Style::Marks | Style::MarkedLine) {
        for at_px in points_px {
            stroke::mark(canvas, area, *at_px, pen.colour);
        }
    }
}

fn fill(canvas: &mut Canvas, area: Area, colour: [u8; 3]) {
    for y in area.top.max(0)..area.bottom {
        for x in area.left.max(0)..area.right {
            canvas.blend(x as usize, y as usize, colour, 1.0);
        }
    }
}
