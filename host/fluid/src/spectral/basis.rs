//! The vectors that diagonalise the second difference along one axis.
//!
//! ```text
//! (A a)_k = sum over the faces of cell k that liquid may pass of (a_k - a_neighbour)
//! ```
//! has the eigenvalues 2 - 2 cos t for cosines and sines of angle t per cell, as derived by
//! Strang 1999 for all kinds of ends.

use std::f64::consts::PI;

/// Both ends of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// The last cell is the neighbour of the first.
    Periodic,
    /// The lower and the upper end.
    Between([End; 2]),
}

/// One end of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// No liquid passes.
    Closed,
    /// The solution is 0 in a cell beyond the end.
    Open,
    /// The solution is 0 at the end, half way to a cell beyond.
    Odd,
}

impl Ends {
    /// A box's walls.
    #[cfg(test)]
    pub const CLOSED: Self = Self::Between([End::Closed; 2]);

    /// True if the axis looks the same from both of its ends.
    pub fn are_alike(self) -> bool {
        match self {
            Self::Periodic => true,
            Self::Between([low, high]) => low == high,
        }
    }
}

/// One eigenvector.
#[derive(Clone, Debug)]
pub struct Mode {
    /// Its value at each point; the sum of their squares is 1.
    pub values: Vec<f64>,
    /// Its eigenvalue.
    pub eigenvalue: f64,
}

/// All eigenvectors for `points` cells.
pub fn modes(points: usize, ends: Ends) -> Vec<Mode> {
    (0..points)
        .map(|m| match ends {
            Ends::Periodic => {
                let angle = 2.0 * PI * m.div_ceil(2) as f64 / points as f64;
                let wave = if m % 2 == 0 { f64::cos } else { f64::sin };
                Mode::new(points, angle, |k| wave(angle * (k + 0.5)))
            }
            Ends::Between(ends) => {
                let [before, after] = ends.map(|end| if end == End::Open { 1.0 } else { 0.5 });
                let zeros = ends.iter().filter(|end| **end != End::Closed).count() as f64;
                let length = before + (points - 1) as f64 + after;
                let angle = PI * (m as f64 + 0.5 * zeros) / length;
                let wave = if ends[0] == End::Closed { f64::cos } else { f64::sin };
                Mode::new(points, angle, |k| wave(angle * (before + k)))
            }
        })
        .collect()
}

impl Mode {
    fn new(points: usize, angle: f64, value: impl Fn(f64) -> f64) -> Self {
        let values: Vec<f64> = (0..points).map(|k| value(k as f64)).collect();
        let norm = values.iter().map(|v| v * v).sum::<f64>().sqrt();
        let values = values.into_iter().map(|v| v / norm).collect();
        Self { values, eigenvalue: 2.0 - 2.0 * angle.cos() }
    }

    /// The half of it that says all if it is even or odd about the middle, as `is_odd` has it:
    /// an even one up to the middle, an odd one from the middle outwards.
    pub fn fold(&self, is_odd: bool) -> Option<Self> {
        let sign = if is_odd { -1.0 } else { 1.0 };
        let mirrored = self.values.iter().rev();
        if self.values.iter().zip(mirrored).any(|(a, b)| (a - sign * b).abs() > 1e-9) {
            return None;
        }
        let half = self.values.len().div_ceil(2);
        let values = if is_odd {
            self.values[..self.values.len() / 2].iter().rev().copied().collect()
        } else {
            self.values[..half].to_vec()
        };
        Some(Self { values, eigenvalue: self.eigenvalue })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub const ALL: [Ends; 10] = [
        Ends::Periodic,
        Ends::CLOSED,
        Ends::Between([End::Closed, End::Open]),
        Ends::Between([End::Open, End::Closed]),
        Ends::Between([End::Open; 2]),
        Ends::Between([End::Odd; 2]),
        Ends::Between([End::Odd, End::Closed]),
        Ends::Between([End::Closed, End::Odd]),
        Ends::Between([End::Odd, End::Open]),
        Ends::Between([End::Open, End::Odd]),
    ];

    /// The operator as the module states it.
    fn apply(ends: Ends, a: &[f64]) -> Vec<f64> {
        let n = a.len();
        let beyond = |k: usize, end: usize| match ends {
            Ends::Periodic => a[k] - a[n - 1 - k],
            Ends::Between(ends) => match ends[end] {
                End::Closed => 0.0,
                End::Open => a[k],
                End::Odd => 2.0 * a[k],
            },
        };
        let below = |k: usize| if k > 0 { a[k] - a[k - 1] } else { beyond(k, 0) };
        let above = |k: usize| if k + 1 < n { a[k] - a[k + 1] } else { beyond(k, 1) };
        (0..n).map(|k| below(k) + above(k)).collect()
    }

    #[test]
    fn modes_are_orthonormal_eigenvectors() {
        for (ends, n) in ALL.into_iter().flat_map(|ends| [1, 2, 3, 8, 17].map(|n| (ends, n))) {
            let modes = modes(n, ends);
            for (m, mode) in modes.iter().enumerate() {
                for (a, v) in apply(ends, &mode.values).iter().zip(&mode.values) {
                    assert!((a - mode.eigenvalue * v).abs() < 1e-12, "{ends:?} {n} {m}");
                }
                for (l, other) in modes.iter().enumerate() {
                    let dot: f64 = mode.values.iter().zip(&other.values).map(|(a, b)| a * b).sum();
                    assert!((dot - f64::from(u8::from(l == m))).abs() < 1e-12, "{ends:?} {n}");
                }
            }
        }
    }

    #[test]
    fn all_but_unlike_ends_are_even_or_odd() {
        for (ends, n) in ALL.into_iter().flat_map(|ends| [2, 5, 16].map(|n| (ends, n))) {
            let count = |is_odd| modes(n, ends).iter().filter_map(|m| m.fold(is_odd)).count();
            let alike = if ends.are_alike() { [n.div_ceil(2), n / 2] } else { [0, 0] };
            assert_eq!([count(false), count(true)], alike, "{ends:?} {n}");
        }
    }
}
