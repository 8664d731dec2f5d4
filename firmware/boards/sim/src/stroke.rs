//! Recorded human strokes: real hands, with their own timing.

use glam::DVec2;

const CIRCLES: &str = include_str!("../data/circles.csv");

/// A stroke of unit size: seconds from its start, and where the pen was.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Points in order of time.
    pub points: Vec<(f64, DVec2)>,
}

impl Stroke {
    /// How long the hand took.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.points.last().map_or(0.0, |p| p.0)
    }
}

/// Ten circles of one person (Wobbrock, Wilson, Li 2007), scaled by one factor so that the
/// strokes' mean radius is 1, and centred each on the middle of its box.
#[must_use]
pub fn circles() -> Vec<Stroke> {
    let mut strokes: Vec<(u32, Stroke)> = Vec::new();
    for (number, t_s, at) in CIRCLES.lines().filter_map(parse) {
        if strokes.last().is_none_or(|s| s.0 != number) {
            strokes.push((number, Stroke { points: Vec::new() }));
        }
        if let Some((_, stroke)) = strokes.last_mut() {
            stroke.points.push((t_s, at));
        }
    }
    let mut strokes: Vec<Stroke> = strokes.into_iter().map(|s| s.1).collect();
    strokes.iter_mut().for_each(centre);
    let points = || strokes.iter().flat_map(|s| &s.points);
    let mean_radius = points().map(|p| p.1.length()).sum::<f64>() / points().count().max(1) as f64;
    for point in strokes.iter_mut().flat_map(|s| &mut s.points) {
        point.1 /= mean_radius;
    }
    strokes
}

/// `stroke,milliseconds,x,y`; `None` for a comment.
fn parse(line: &str) -> Option<(u32, f64, DVec2)> {
    let mut fields = line.split(',');
    let number = fields.next()?.parse().ok()?;
    let mut value = || fields.next()?.parse::<f64>().ok();
    let (ms, x, y) = (value()?, value()?, value()?);
    Some((number, ms * 1e-3, DVec2::new(x, y)))
}

fn centre(stroke: &mut Stroke) {
    let start = stroke.points.first().map_or(DVec2::ZERO, |p| p.1);
    let (low, high) =
        stroke.points.iter().fold((start, start), |(l, h), p| (l.min(p.1), h.max(p.1)));
    for point in &mut stroke.points {
        point.1 -= 0.5 * (low + high);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_people_sized_circles_that_go_round_once_in_about_a_second() {
        let strokes = circles();
        assert_eq!(strokes.len(), 10);
        for stroke in &strokes {
            assert!((0.8..1.2).contains(&stroke.seconds()), "{}", stroke.seconds());
            let turned: f64 =
                stroke.points.windows(2).map(|w| w[0].1.angle_to(w[1].1)).sum::<f64>();
            assert!((turned.abs() / std::f64::consts::TAU - 1.0).abs() < 0.1, "{turned}");
            assert!(stroke.points.windows(2).all(|w| w[1].0 >= w[0].0), "time goes on");
            assert!(stroke.points.iter().all(|p| (0.5..1.6).contains(&p.1.length())));
        }
    }
}
