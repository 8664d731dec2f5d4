//! What the hand means to do: a path through device space, and buttons along the way.

use glam::{DVec2, DVec3};

use crate::stroke::Stroke;

/// How long the pen takes from the end of a stroke to the start of the next.
const BETWEEN_STROKES_S: f64 = 0.12;

/// How long fingers take to open, and to close again at the end.
const OPENS_S: f64 = 0.05;
const CLOSES_S: f64 = 0.4;

/// One thing after the other.
#[derive(Clone, Debug, PartialEq)]
pub enum Act {
    /// Goes to a place in device metres as a hand does, by the smoothest way there (minimum
    /// jerk: Flash & Hogan 1985).
    Reach {
        /// Where to.
        to_m: DVec3,
        /// In what time.
        seconds: f64,
    },
    /// Stays.
    Rest {
        /// How long.
        seconds: f64,
    },
    /// Lets go of the handle for so long; the hand itself stays, and takes hold again there.
    LetGo {
        /// How long, the fingers' opening and closing included.
        seconds: f64,
    },
    /// Follows strokes one after the other in the horizontal plane of `centre_m`.
    Stir {
        /// Middle of the strokes.
        centre_m: DVec3,
        /// Device metres of a stroke's unit.
        radius_m: f64,
        /// Strokes, begun anew when all are done.
        strokes: Vec<Stroke>,
        /// How long.
        seconds: f64,
    },
}

/// A button held from one moment to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// Which button, from 0.
    pub button: u8,
    /// When it goes down.
    pub from_s: f64,
    /// When it comes up.
    pub to_s: f64,
}

/// A path in time.
#[derive(Clone, Debug, Default)]
pub struct Script {
    /// Corners of the path in order of time; between them the hand means to go as `way` says.
    corners: Vec<Corner>,
    presses: Vec<Press>,
    /// From when to when the hand lets go.
    free_s: Vec<[f64; 2]>,
    start_m: DVec3,
}

#[derive(Clone, Copy, Debug)]
struct Corner {
    at_s: f64,
    to_m: DVec3,
    smooth: bool,
}

impl Script {
    /// A hand that begins at `start_m`, does `acts`, and then stays where it is.
    #[must_use]
    pub fn new(start_m: DVec3, acts: &[Act], presses: Vec<Press>) -> Self {
        let mut script = Self { corners: Vec::new(), presses, free_s: Vec::new(), start_m };
        acts.iter().for_each(|act| script.append(act));
        script
    }

    /// A hand that stays at `at_m`.
    #[must_use]
    pub fn resting(at_m: DVec3) -> Self {
        Self::new(at_m, &[], Vec::new())
    }

    /// How long the acts take together.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.corners.last().map_or(0.0, |c| c.at_s)
    }

    /// Where the hand begins, in device metres.
    #[must_use]
    pub fn start_m(&self) -> DVec3 {
        self.start_m
    }

    /// Where the hand means to be, in device metres.
    #[must_use]
    pub fn target_m(&self, time_s: f64) -> DVec3 {
        let next = self.corners.partition_point(|c| c.at_s <= time_s);
        let (from_s, from_m) = match next.checked_sub(1).map(|i| self.corners[i]) {
            Some(corner) => (corner.at_s, corner.to_m),
            None => (0.0, self.start_m),
        };
        let Some(to) = self.corners.get(next) else { return from_m };
        let part = (time_s - from_s) / (to.at_s - from_s);
        from_m.lerp(to.to_m, if to.smooth { minimum_jerk(part) } else { part })
    }

    /// How firmly the hand holds on, from 0 (not at all) to 1. It closes as softly as it moves, so
    /// that a handle that drifted is not jerked back.
    #[must_use]
    pub fn hold(&self, time_s: f64) -> f64 {
        let free = self.free_s.iter().find(|[from, to]| (*from..*to).contains(&time_s));
        let Some([from, to]) = free else { return 1.0 };
        let part = |since_s: f64, all_s: f64| minimum_jerk((since_s / all_s).clamp(0.0, 1.0));
        (1.0 - part(time_s - from, OPENS_S)).max(part(time_s - to + CLOSES_S, CLOSES_S))
    }

    /// Buttons held, a bit each.
    #[must_use]
    pub fn buttons(&self, time_s: f64) -> u8 {
        let held = |p: &&Press| (p.from_s..p.to_s).contains(&time_s);
        self.presses.iter().filter(held).fold(0, |bits, p| bits | 1 << p.button)
    }

    fn append(&mut self, act: &Act) {
        let now_s = self.seconds();
        match act {
            Act::Reach { to_m, seconds } => self.go(now_s + seconds, *to_m, true),
            Act::Rest { seconds } => self.go(now_s + seconds, self.end_m(), false),
            Act::LetGo { seconds } => {
                self.free_s.push([now_s, now_s + seconds]);
                self.go(now_s + seconds, self.end_m(), false);
            }
            Act::Stir { centre_m, radius_m, strokes, seconds } => {
                let place = |p: DVec2| *centre_m + *radius_m * DVec3::new(p.x, 0.0, p.y);
                self.stir(now_s + seconds, strokes, place);
            }
        }
    }

    fn stir(&mut self, end_s: f64, strokes: &[Stroke], place: impl Fn(DVec2) -> DVec3) {
        for stroke in strokes.iter().filter(|s| s.seconds() > 0.0).cycle() {
            let begin_s = self.seconds() + BETWEEN_STROKES_S;
            for &(t_s, at) in &stroke.points {
                if begin_s + t_s >= end_s {
                    return self.go(end_s, place(at), false);
                }
                self.go(begin_s + t_s, place(at), t_s == 0.0);
            }
        }
    }

    fn end_m(&self) -> DVec3 {
        self.corners.last().map_or(self.start_m, |c| c.to_m)
    }

    fn go(&mut self, at_s: f64, to_m: DVec3, smooth: bool) {
        if at_s > self.seconds() {
            self.corners.push(Corner { at_s, to_m, smooth });
        }
    }
}

/// 10 s^3 - 15 s^4 + 6 s^5 (Flash & Hogan 1985).
fn minimum_jerk(s: f64) -> f64 {
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::circles;

    #[test]
    fn reaches_rests_and_stays() {
        let acts = [Act::Reach { to_m: DVec3::X, seconds: 2.0 }, Act::Rest { seconds: 1.0 }];
        let script = Script::new(DVec3::ZERO, &acts, Vec::new());
        assert_eq!(script.target_m(0.0), DVec3::ZERO);
        assert!((script.target_m(1.0).x - 0.5).abs() < 1e-12, "half way at half time");
        assert!(script.target_m(0.2).x < 0.01, "starts softly");
        assert_eq!(script.target_m(99.0), DVec3::X);
        assert_eq!(script.seconds(), 3.0);
    }

    #[test]
    fn a_stir_keeps_the_strokes_own_timing() {
        let strokes = circles();
        let stir = Act::Stir {
            centre_m: DVec3::Y,
            radius_m: 0.04,
            strokes: strokes.clone(),
            seconds: 5.0,
        };
        let script = Script::new(DVec3::Y, &[stir], Vec::new());
        let (t, p) = strokes[0].points[20];
        let at = script.target_m(BETWEEN_STROKES_S + t);
        assert!((at - (DVec3::Y + 0.04 * DVec3::new(p.x, 0.0, p.y))).length() < 1e-9);
        assert!((script.seconds() - 5.0).abs() < 1e-9);
    }

    #[test]
    fn fingers_open_at_once_and_close_softly() {
        let acts = [Act::Rest { seconds: 1.0 }, Act::LetGo { seconds: 2.0 }];
        let script = Script::new(DVec3::X, &acts, Vec::new());
        assert_eq!(
            [0.0, 0.99, 1.06, 2.5, 3.0, 9.0].map(|t| script.hold(t)),
            [1., 1., 0., 0., 1., 1.]
        );
        assert!((script.hold(2.8) - 0.5).abs() < 1e-9 && script.hold(2.65) < 0.02);
        assert_eq!((script.target_m(2.0), script.seconds()), (DVec3::X, 3.0));
    }

    #[test]
    fn buttons_are_held_while_they_are() {
        let presses = vec![
            Press { button: 0, from_s: 1.0, to_s: 2.0 },
            Press { button: 1, from_s: 1.5, to_s: 3.0 },
        ];
        let script = Script::new(DVec3::ZERO, &[], presses);
        let held = [0.5, 1.2, 1.7, 2.5, 3.0].map(|t| script.buttons(t));
        assert_eq!(held, [0, 1, 3, 2, 0]);
    }
}
