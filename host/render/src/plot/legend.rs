//! The legend of a panel: in rows above its axes, or beside them if it is long.

use embedded_graphics::text::Alignment;

use super::{
    INK, Panel, SHADE, Series, series,
    shape::{Area, Shape, width_px},
};

pub(super) const LINE_HEIGHT: i32 = 19;
const SWATCH: i32 = 24;
const GAP: i32 = 6;
/// Entries that rows above the axes have room for.
const MOST_IN_ROWS: usize = 6;

/// An entry of the legend.
enum Entry<'a> {
    Series(&'a Series),
    Span(&'a str),
}

impl Entry<'_> {
    fn words(&self) -> &str {
        match self {
            Self::Series(series) => &series.label,
            Self::Span(label) => label,
        }
    }

    fn width(&self) -> i32 {
        SWATCH + GAP + width_px(self.words())
    }

    fn draw(&self, shapes: &mut Vec<Shape>, [x, y]: [i32; 2]) {
        match self {
            Self::Series(series) => shapes.extend(series::sample(series, x, x + SWATCH, y + 7)),
            Self::Span(_) => {
                let area = Area { left: x, top: y, right: x + SWATCH, bottom: y + 13 };
                shapes.push(Shape::Fill { area, colour: SHADE });
            }
        }
        let place = [x + SWATCH + GAP, y];
        shapes.push(Shape::words(self.words(), place, Alignment::Left, INK));
    }
}

/// All entries.
pub(super) struct Legend<'a>(Vec<Entry<'a>>);

impl<'a> Legend<'a> {
    pub(super) fn of(panel: &'a Panel) -> Self {
        let named = panel.series.iter().filter(|series| !series.label.is_empty());
        let mut spans: Vec<&str> = panel.spans.iter().map(|span| span.label.as_str()).collect();
        spans.retain(|label| !label.is_empty());
        spans.dedup();
        Self(named.map(Entry::Series).chain(spans.into_iter().map(Entry::Span)).collect())
    }

    /// Width of a column of all entries, if they are too many for rows and `area` has the room.
    pub(super) fn column_width(&self, area: Area) -> Option<i32> {
        let width = self.0.iter().map(Entry::width).max().unwrap_or(0);
        let is_high_enough = self.0.len() as i32 * LINE_HEIGHT <= area.height();
        let is_wide_enough = 5 * width < 2 * area.width();
        (self.0.len() > MOST_IN_ROWS && is_high_enough && is_wide_enough).then_some(width)
    }

    /// One below the other from (`x`, `y`) on.
    pub(super) fn column(&self, shapes: &mut Vec<Shape>, [x, y]: [i32; 2]) {
        for (line, entry) in (0..).zip(&self.0) {
            entry.draw(shapes, [x, y + line * LINE_HEIGHT]);
        }
    }

    /// In as many rows as it needs. Returns where the next one would begin.
    pub(super) fn rows(&self, shapes: &mut Vec<Shape>, [left, right]: [i32; 2], top: i32) -> i32 {
        let (mut x, mut y) = (left, top);
        for entry in &self.0 {
            let width = entry.width() + 3 * GAP;
            if x + width > right && x > left {
                (x, y) = (left, y + LINE_HEIGHT);
            }
            entry.draw(shapes, [x, y]);
            x += width;
        }
        y + LINE_HEIGHT
    }
}
