//! A series as shapes: its line, broken where it has no points and made short, and its marks.

use super::{
    Series, Style,
    axis::Ruler,
    mark,
    shape::{Area, Pen, Shape},
};

const WIDTH_PX: f64 = 1.7;

/// Its place on the page for each point that has one.
pub(super) fn places_px(series: &Series, x: &Ruler, y: &Ruler) -> Vec<Option<[f64; 2]>> {
    series.points.iter().map(|point| Some([x.px(point[0])?, y.px(point[1])?])).collect()
}

/// Draws as much of the line as lies in `area`; each run of points that have a place is a line
/// of its own.
pub(super) fn draw_lines(
    shapes: &mut Vec<Shape>,
    series: &Series,
    places_px: &[Option<[f64; 2]>],
    area: Area,
) {
    for run in places_px.split(Option::is_none).filter(|_| series.style != Style::Marks) {
        let run_px: Vec<[f64; 2]> = run.iter().copied().flatten().collect();
        let pieces = pieces_in(area, &decimated(&run_px));
        shapes.extend(pieces.into_iter().map(|points_px| line(series, points_px)));
    }
}

/// A piece of it for the legend.
pub(super) fn sample(series: &Series, left: i32, right: i32, middle_y: i32) -> Vec<Shape> {
    let [left, right, y] = [left, right, middle_y].map(f64::from);
    let is_line = series.style != Style::Marks;
    let line = is_line.then(|| line(series, vec![[left, y], [right, y]]));
    let mark = series.is_marked().then(|| mark(series, [0.5 * (left + right), y]));
    line.into_iter().chain(mark.into_iter().flatten()).collect()
}

/// Its mark around a point.
pub(super) fn mark(series: &Series, at_px: [f64; 2]) -> Vec<Shape> {
    mark::shapes(series.colour, at_px, series.rgb())
}

fn line(series: &Series, points_px: Vec<[f64; 2]>) -> Shape {
    let is_dashed = series.style == Style::Dashed;
    let pen = Pen { colour: series.rgb(), width_px: WIDTH_PX, is_dashed };
    Shape::Line { points_px, pen }
}

/// What lies in `area` of the line through `points_px`, in as many pieces as that is.
fn pieces_in(area: Area, points_px: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    for ends in points_px.windows(2) {
        let Some([from, to]) = cut(area, [ends[0], ends[1]]) else { continue };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&from) => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
    }
    pieces
}

/// The part of one straight line that lies in `area`, if any (Liang, Barsky 1984).
fn cut(area: Area, ends: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    // As far off any page, and still exact to a pixel.
    let [from, to] = ends.map(|end| end.map(|px| px.clamp(-1e9, 1e9)));
    let bounds = [[area.left, area.right], [area.top, area.bottom]];
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let [low, high] = bounds[axis].map(f64::from);
        let along = to[axis] - from[axis];
        if along == 0.0 {
            if from[axis] < low || from[axis] > high {
                return None;
            }
            continue;
        }
        let [a, b] = [(low - from[axis]) / along, (high - from[axis]) / along];
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    let at = |part: f64| [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
    let first = if enters > 0.0 { at(enters) } else { from };
    let last = if leaves < 1.0 { at(leaves) } else { to };
    (enters <= leaves).then_some([first, last])
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
    fn a_line_stays_in_its_area() {
        let area = Area { left: 0, top: 0, right: 10, bottom: 10 };
        let line = [[-5.0, 5.0], [5.0, 5.0], [5.0, 15.0], [7.0, 15.0], [7.0, -1e300], [20.0, 5.0]];
        let pieces = pieces_in(area, &line);
        let wanted = [vec![[0.0, 5.0], [5.0, 5.0], [5.0, 10.0]], vec![[7.0, 10.0], [7.0, 0.0]]];
        assert_eq!(pieces.len(), 2, "{pieces:?}");
        for (at, wanted) in pieces.iter().flatten().zip(wanted.iter().flatten()) {
            assert!((0..2).all(|axis| (at[axis] - wanted[axis]).abs() < 1e-5), "{pieces:?}");
        }
    }

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
