//! Smooth lines and marks, cut to a rectangle, and long series made short.

use crate::canvas::Canvas;

/// A part of the canvas, in pixels: the right and lower borders lie outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) right: i32,
    pub(super) bottom: i32,
}

/// What lines are drawn with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    pub(super) colour: [u8; 3],
    pub(super) width_px: f64,
    pub(super) is_dashed: bool,
}

const DASH_PX: f64 = 9.0;
const DASH_AND_GAP_PX: f64 = 15.0;

/// Draws a line through `points_px`.
pub(super) fn line(canvas: &mut Canvas, area: Area, points_px: &[[f64; 2]], pen: Pen) {
    let mut drawn_px = 0.0;
    for ends in points_px.windows(2) {
        drawn_px = segment(canvas, area, [ends[0], ends[1]], pen, drawn_px);
    }
}

/// Draws one straight piece, of which `drawn_px` of the whole line come before it, and returns
/// how many come before its end. Each pixel is covered by as much as its distance from the
/// middle of the stroke leaves of it.
fn segment(
    canvas: &mut Canvas,
    area: Area,
    [from, to]: [[f64; 2]; 2],
    pen: Pen,
    drawn_px: f64,
) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length_px = along[0].hypot(along[1]);
    let reach_px = 0.5 * pen.width_px + 0.5;
    let pixels = |low: f64, high: f64, bounds: [i32; 2]| {
        let first = (low - reach_px).max(f64::from(bounds[0])) as i32;
        first..((high + reach_px).min(f64::from(bounds[1] - 1)) as i32 + 1).min(bounds[1])
    };
    let rows = pixels(from[1].min(to[1]), from[1].max(to[1]), [area.top, area.bottom]);
    for y in rows {
        let columns = pixels(from[0].min(to[0]), from[0].max(to[0]), [area.left, area.right]);
        for x in columns {
            let at = [f64::from(x) + 0.5 - from[0], f64::from(y) + 0.5 - from[1]];
            let part = (at[0] * along[0] + at[1] * along[1]) / (length_px * length_px).max(1e-12);
            let part = part.clamp(0.0, 1.0);
            let off_px = (at[0] - part * along[0]).hypot(at[1] - part * along[1]);
            let is_gap = pen.is_dashed && (drawn_px + part * length_px) % DASH_AND_GAP_PX > DASH_PX;
            let cover = (reach_px - off_px).clamp(0.0, 1.0);
            if cover > 0.0 && !is_gap {
                canvas.blend(x as usize, y as usize, pen.colour, cover as f32);
            }
        }
    }
    drawn_px + length_px
}

/// Draws a round mark.
pub(super) fn mark(canvas: &mut Canvas, area: Area, at_px: [f64; 2], colour: [u8; 3]) {
    const DIAMETER_PX: f64 = 7.0;
    let pen = Pen { colour, width_px: DIAMETER_PX, is_dashed: false };
    segment(canvas, area, [at_px, at_px], pen, 0.0);
}

/// `points_px` with no more than four left of those that follow each other in one column of
/// pixels: the first, the lowest, the highest and the last, in their order. A series of any
/// length looks as it did and is drawn in the time of a short one.
pub(super) fn decimated(points_px: &[[f64; 2]]) -> Vec<[f64; 2]> {
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

    #[test]
    fn a_line_stays_in_its_area() {
        let mut canvas = Canvas::new(20, 20, [255; 3]);
        let area = Area { left: 5, top: 5, right: 15, bottom: 15 };
        let pen = Pen { colour: [0; 3], width_px: 3.0, is_dashed: false };
        line(&mut canvas, area, &[[-1e9, 10.0], [1e9, 10.0]], pen);
        assert_eq!(canvas.get(4, 10), Some([255; 3]));
        assert_eq!(canvas.get(5, 10), Some([0; 3]));
        assert_eq!(canvas.get(14, 10), Some([0; 3]));
        assert_eq!(canvas.get(15, 10), Some([255; 3]));
    }
}
