//! Small dense symmetric matrices: condensation and eigenvectors.
//!
//! They are small and few: eighty lines of ours instead of a crate for linear algebra.

/// A square matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Square {
    /// Rows, and columns.
    pub size: usize,
    /// Its values.
    pub values: Vec<f64>,
}

impl Square {
    /// The matrix with `value(row, column)` everywhere.
    pub fn new(size: usize, mut value: impl FnMut(usize, usize) -> f64) -> Self {
        let mut values = Vec::with_capacity(size * size);
        for r in 0..size {
            values.extend((0..size).map(|c| value(r, c)));
        }
        Self { size, values }
    }

    /// The matrix without values.
    pub fn zeros(size: usize) -> Self {
        Self { size, values: vec![0.0; size * size] }
    }

    /// A row.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.size..][..self.size]
    }

    /// The matrix with rows for columns.
    pub fn transposed(&self) -> Self {
        Self::new(self.size, |r, c| self.at(c, r))
    }

    /// The value in a row and a column.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.size + column]
    }

    /// The matrix without its first rows and columns.
    pub fn without_first(&self, dropped: usize) -> Self {
        Self::new(self.size - dropped, |r, c| self.at(r + dropped, c + dropped))
    }

    /// v^T A v.
    pub fn form(&self, v: &[f64]) -> f64 {
        let rows = self.values.chunks_exact(self.size);
        rows.zip(v).map(|(row, v_r)| v_r * dot(row, v)).sum()
    }

    /// What is left of a positive form on its last `kept` unknowns when the others take the
    /// values that make it least: Schur's complement, by Gauss. It reads the upper triangle.
    pub fn condense(mut self, kept: usize) -> Self {
        let (n, eliminated) = (self.size, self.size - kept);
        for pivot in 0..eliminated {
            let (above, below) = self.values.split_at_mut((pivot + 1) * n);
            let row = &above[pivot * n..];
            for (r, target) in (pivot + 1..n).zip(below.chunks_exact_mut(n)) {
                let factor = row[r] / row[pivot];
                for (t, p) in target[r..].iter_mut().zip(&row[r..]) {
                    *t -= factor * p;
                }
            }
        }
        Self::new(kept, |r, c| self.at(eliminated + r.min(c), eliminated + r.max(c)))
    }

    /// Eigenvalues, smallest first, each with its vector of length 1, by the rotations of
    /// Jacobi 1846 in cyclic order.
    pub fn eigenvectors(mut self) -> Vec<(f64, Vec<f64>)> {
        let n = self.size;
        let mut vectors = Self::new(n, |r, c| f64::from(u8::from(r == c)));
        for _ in 0..SWEEPS {
            let mut largest = 0.0f64;
            for p in 0..n {
                for q in p + 1..n {
                    let (a_pq, a_pp, a_qq) = (self.at(p, q), self.at(p, p), self.at(q, q));
                    // Beside both of its diagonals what is below rounding is 0.
                    if a_pq.abs() <= 1e-17 * (a_pp * a_qq).abs().sqrt() {
                        continue;
                    }
                    largest = largest.max(a_pq.abs());
                    let slope = 0.5 * (a_qq - a_pp) / a_pq;
                    let tangent = slope.signum() / (slope.abs() + slope.hypot(1.0));
                    let cosine = 1.0 / tangent.hypot(1.0);
                    let turn = [cosine, cosine * tangent];
                    rotate_rows(&mut self, [p, q], turn);
                    for row in self.values.chunks_exact_mut(n) {
                        (row[p], row[q]) = turned(turn, row[p], row[q]);
                    }
                    rotate_rows(&mut vectors, [p, q], turn);
                }
            }
            if largest == 0.0 {
                break;
            }
        }
        let mut all: Vec<_> =
            (0..n).map(|r| (self.at(r, r), vectors.values[r * n..][..n].to_vec())).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }
}

/// Sweeps converge quadratically: no matrix here takes ten.
const SWEEPS: usize = 20;

fn turned([cosine, sine]: [f64; 2], p: f64, q: f64) -> (f64, f64) {
    (cosine * p - sine * q, sine * p + cosine * q)
}

/// Rotates rows p < q.
fn rotate_rows(matrix: &mut Square, [p, q]: [usize; 2], turn: [f64; 2]) {
    let n = matrix.size;
    let (head, tail) = matrix.values.split_at_mut(q * n);
    for (p, q) in head[p * n..][..n].iter_mut().zip(&mut tail[..n]) {
        (*p, *q) = turned(turn, *p, *q);
    }
}

/// The sum of the products of two rows, in eight parts that are summed side by side.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, rest_of_a), (b, rest_of_b)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut parts = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for (part, (a, b)) in parts.iter_mut().zip(a.iter().zip(b)) {
            *part += a * b;
        }
    }
    let rest = rest_of_a.iter().zip(rest_of_b).map(|(a, b)| a * b);
    parts.into_iter().chain(rest).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Minus the second difference of n values between zeros: 2 - 2 cos(k pi / (n + 1)).
    fn second_difference(n: usize) -> Square {
        Square::new(n, |r, c| [2.0, -1.0, 0.0][r.abs_diff(c).min(2)])
    }

    #[test]
    fn eigenvalues_of_the_second_difference() {
        for n in [1, 2, 3, 17, 40] {
            for (k, (eigenvalue, v)) in second_difference(n).eigenvectors().iter().enumerate() {
                let angle = std::f64::consts::PI * (k + 1) as f64 / (n + 1) as f64;
                assert!((eigenvalue - (2.0 - 2.0 * angle.cos())).abs() < 1e-13, "{n} {k}");
                assert!((dot(v, v) - 1.0).abs() < 1e-13, "{n} {k}");
                let form = second_difference(n).form(v);
                assert!((form - eigenvalue).abs() < 1e-13, "{n} {k}");
            }
        }
    }

    #[test]
    fn condensed_springs_in_a_row_are_one_softer_spring() {
        // n springs of stiffness 1 in a row from a wall to the last node: 1/n.
        for n in [2, 3, 10] {
            let mut row = second_difference(n);
            row.values[n * n - 1] = 1.0;
            let one = row.condense(1);
            assert!((one.at(0, 0) - 1.0 / n as f64).abs() < 1e-14, "{n}");
        }
    }
}
