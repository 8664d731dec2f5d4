//! Shapes on a canvas: smooth lines and polygons.

use super::shape::{Area, DASH_PX, GAP_PX, Pen, Shape, Size};
use crate::{
    canvas::Canvas,
    text::{self, LARGE, SMALL},
};

/// Samples along each edge of a pixel that say how much of it a polygon covers.
const SAMPLES: i32 = 4;

/// Draws all shapes; what sticks out of the canvas is cut off.
pub(super) fn draw(canvas: &mut Canvas, page: Area, shapes: &[Shape]) {
    for shape in shapes {
        match shape {
            Shape::Fill { area, colour } => fill(canvas, cut(*area, page), *colour),
            Shape::Line { points_px, pen } => line(canvas, page, points_px, *pen),
            Shape::Polygon { corners_px, colour } => {
                polygon(canvas, page, corners_px, *colour);
            }
            Shape::Words(words) => {
                let font = if words.size == Size::Large { LARGE } else { SMALL };
                let style = (font, words.colour, words.alignment);
                text::write(canvas, &words.words, words.at_px, style);
            }
        }
    }
}

/// What is in both.
fn cut(area: Area, clip: Area) -> Area {
    Area {
        left: area.left.max(clip.left),
        top: area.top.max(clip.top),
        right: area.right.min(clip.right),
        bottom: area.bottom.min(clip.bottom),
    }
}

fn fill(canvas: &mut Canvas, area: Area, colour: [u8; 3]) {
    for y in area.top..area.bottom {
        for x in area.left..area.right {
            canvas.blend(x as usize, y as usize, colour, 1.0);
        }
    }
}

/// Draws a line through `points_px`.
fn line(canvas: &mut Canvas, area: Area, points_px: &[[f64; 2]], pen: Pen) {
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
            let is_gap =
                pen.is_dashed && (drawn_px + part * length_px) % (DASH_PX + GAP_PX) > DASH_PX;
            let cover = (reach_px - off_px).clamp(0.0, 1.0);
            if cover > 0.0 && !is_gap {
                canvas.blend(x as usize, y as usize, pen.colour, cover as f32);
            }
        }
    }
    drawn_px + length_px
}

/// Draws a small polygon.
fn polygon(canvas: &mut Canvas, area: Area, corners_px: &[[f64; 2]], colour: [u8; 3]) {
    let ends = |axis: usize| {
        let along = corners_px.iter().map(move |corner| corner[axis]);
        let low = along.clone().fold(f64::INFINITY, f64::min).floor() as i32;
        [low, along.fold(f64::NEG_INFINITY, f64::max).ceil() as i32]
    };
    let [[left, right], [top, bottom]] = [ends(0), ends(1)];
    let around = cut(Area { left, top, right, bottom }, area);
    for y in around.top..around.bottom {
        for x in around.left..around.right {
            let covered = (0..SAMPLES * SAMPLES).filter(|sample| {
                let part = |count: i32| (f64::from(count) + 0.5) / f64::from(SAMPLES);
                let (along_x, along_y) = (part(sample % SAMPLES), part(sample / SAMPLES));
                is_inside(corners_px, [f64::from(x) + along_x, f64::from(y) + along_y])
            });
            let cover = covered.count() as f32 / (SAMPLES * SAMPLES) as f32;
            canvas.blend(x as usize, y as usize, colour, cover);
        }
    }
}

/// Whether a ray from the point to the right leaves the polygon once more than it enters it.
fn is_inside(corners_px: &[[f64; 2]], point_px: [f64; 2]) -> bool {
    let next = corners_px.iter().cycle().skip(1);
    let crossed = corners_px.iter().zip(next).filter(|(a, b)| {
        let part = (point_px[1] - a[1]) / (b[1] - a[1]);
        (a[1] > point_px[1]) != (b[1] > point_px[1]) && point_px[0] < a[0] + part * (b[0] - a[0])
    });
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn a_polygon_covers_its_area() {
        let mut canvas = Canvas::new(20, 20, [255; 3]);
        let area = Area { left: 0, top: 0, right: 20, bottom: 20 };
        polygon(&mut canvas, area, &[[2.0, 2.0], [14.0, 2.0], [2.0, 18.0]], [0; 3]);
        let ink: f64 = canvas.pixels().map(|pixel| 1.0 - f64::from(pixel[0]) / 255.0).sum();
        assert!((ink - 96.0).abs() < 2.0, "{ink}");
    }
}
