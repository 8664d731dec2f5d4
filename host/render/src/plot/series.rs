//! A series as shapes: its line, broken where it has no points and made short, and its marks.

use super::{
    Series, Style,
    axis::Ruler,
    mark,
    shape::{Pen, Shape},
};

const WIDTH_PX: f64 = 1.7;

/// Its place on the page for each point that has one.
pub(super) fn places_px(series: &Series, x: &Ruler, y: &Ruler) -> Vec<Option<[f64; 2]>> {
    series.points.iter().map(|point| Some([x.px(point[0])?, y.px(point[1])?])).collect()
}

/// The line and the marks.
pub(super) fn shapes(series: &Series, places_px: &[Option<[f64; 2]>]) -> Vec<Shape> {
    // Each run of points that have a place is a line of its own.
    let runs = places_px.split(Option::is_none);
    let lines =
        runs.filter_map(|run| line(series, &run.iter().copied().flatten().collect::<Vec<_>>()));
    let marks = places_px.iter().flatten().flat_map(|at_px| marks(series, *at_px));
    lines.chain(marks).collect()
}

/// A piece of it for the legend.
pub(super) fn sample(series: &Series, left: i32, right: i32, middle_y: i32) -> Vec<Shape> {
    let [left, right, y] = [left, right, middle_y].map(f64::from);
    let line = line(series, &[[left, y], [right, y]]);
    line.into_iter().chain(marks(series, [0.5 * (left + right), y])).collect()
}

fn line(series: &Series, points_px: &[[f64; 2]]) -> Option<Shape> {
    let is_dashed = series.style == Style::Dashed;
    let pen = Pen { colour: series.rgb(), width_px: WIDTH_PX, is_dashed };
    let is_line = series.style != Style::Marks && points_px.len() > 1;
    is_line.then(|| Shape::Line { points_px: decimated(points_px), pen })
}

fn marks(series: &Series, at_px: [f64; 2]) -> Vec<Shape> {
    match series.style {
        Style::Marks | Style::MarkedLine => mark::shapes(series.colour, at_px, series.rgb()),
        Style::Line | Style::Dashed => Vec::new(),
    }
}

/// `points_px` with no more than four left of those that follow each other in one column of
/// pixels: the first, the lowest, the highest and the last, in their order. A series of any
/// length looks as it did and is drawn in the time of a short one.
fn decimated(points_px: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points_px
        .chunk_by(|a, b| a[0].floor() == b[0].floor())
        .flat_map(|column| {
            let by_y = |a: &&usize, b: &&usize| column[**a][1].total_cmp(&column[**b][1]);
            let places: Vec<usize> = (0..column.len()).collect();
            let lowest = places.iter().min_by(by_y).copied().unwrap_or(0);
            let highest = places.iter().max_by(by_y).copied().unwrap_or(0);
            let mut kept = [0, lowest, highest, column.len() - 1];
            kept.sort_unstable();
            let mut kept = kept.to_vec();
            kept.dedup();
            kept.into_iter().map(|place| column[place])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_series_keeps_its_peaks() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|i| [f64::from(i) / 1e3, 0.0]).collect();
        points[54_321][1] = 7.0;
        points[54_322][1] = -7.0;
        let short = decimated(&points);
        assert!(short.len() <= 400);
        assert!(short.contains(&points[54_321]) && short.contains(&points[54_322]));
        assert_eq!(short.first(), points.first());
        assert_eq!(short.last(), points.last());
        assert!(short.is_sorted_by_key(|point| point[0]));
    }
}
