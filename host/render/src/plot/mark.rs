//! The marks of series: a form for each number, so that no series is told by its colour alone.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use super::{
    PAPER,
    shape::{Pen, Shape},
};

/// Forms there are; further numbers are counted round.
const COUNT: usize = 12;

const RIM_PX: f64 = 1.5;

/// How far a mark reaches from its middle, no more.
pub(super) const REACH_PX: f64 = 6.0;

/// Mark number `number` around a point.
pub(super) fn shapes(number: usize, at_px: [f64; 2], colour: [u8; 3]) -> Vec<Shape> {
    let (corners, is_open) = form(number);
    let mut corners_px: Vec<_> =
        corners.iter().map(|corner| [at_px[0] + corner[0], at_px[1] + corner[1]]).collect();
    if !is_open {
        return vec![Shape::Polygon { corners_px, colour }];
    }
    let inside = Shape::Polygon { corners_px: corners_px.clone(), colour: PAPER };
    corners_px.extend_from_within(..1);
    let pen = Pen { colour, width_px: RIM_PX, is_dashed: false };
    vec![inside, Shape::Line { points_px: corners_px, pen }]
}

/// Corners around the origin, in pixels, and whether only the rim is drawn.
fn form(number: usize) -> (Vec<[f64; 2]>, bool) {
    match number % COUNT {
        0 => (circle(4.0), false),
        1 => (around([5.0; 4], FRAC_PI_4), false),
        2 => (around([5.6; 3], 0.0), false),
        3 => (around([5.4; 4], 0.0), false),
        4 => (cross(FRAC_PI_4), false),
        5 => (circle(3.7), true),
        6 => (around([5.6; 3], PI), false),
        7 => (around([4.8; 4], FRAC_PI_4), true),
        8 => (cross(0.0), false),
        9 => (around([5.2; 3], 0.0), true),
        10 => (around([5.0; 4], 0.0), true),
        _ => (around([5.9, 2.5, 5.9, 2.5, 5.9, 2.5, 5.9, 2.5, 5.9, 2.5], 0.0), false),
    }
}

/// As good as round at this size.
fn circle(radius_px: f64) -> Vec<[f64; 2]> {
    around([radius_px; 16], 0.0)
}

/// Corners at these distances, evenly turned clockwise from the top.
fn around<const N: usize>(distances_px: [f64; N], turned_rad: f64) -> Vec<[f64; 2]> {
    let place = |(number, distance): (usize, f64)| {
        let (sine, cosine) = (turned_rad + TAU * number as f64 / N as f64).sin_cos();
        [distance * sine, -distance * cosine]
    };
    distances_px.into_iter().enumerate().map(place).collect()
}

/// Two crossed bars.
fn cross(turned_rad: f64) -> Vec<[f64; 2]> {
    const ARM_PX: f64 = 5.2;
    const HALF_PX: f64 = 1.1;
    let (sine, cosine) = turned_rad.sin_cos();
    let arm = [[-HALF_PX, -HALF_PX], [-HALF_PX, -ARM_PX], [HALF_PX, -ARM_PX]];
    let quarter_turns = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let turn = |[x, y]: [f64; 2], [c, s]: [f64; 2]| [c * x - s * y, s * x + c * y];
    let corners = quarter_turns.into_iter().flat_map(|by| arm.map(|corner| turn(corner, by)));
    corners.map(|corner| turn(corner, [cosine, sine])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dozen_marks_differ_and_stay_within_reach() {
        let forms: Vec<_> = (0..COUNT).map(form).collect();
        for (number, form) in forms.iter().enumerate() {
            assert!(forms[..number].iter().all(|earlier| earlier != form), "{number}");
            let reach = form.0.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
            assert!(reach > 3.0 && reach <= REACH_PX, "{number}: {reach}");
        }
    }
}
