//! The polynomials of Jacobi whose weight is (1 + u)^beta, and the quadrature of Gauss.
//!
//! Those of beta = 0 are Legendre's. (Abramowitz & Stegun 1964, 22.7.1 with alpha = 0.)

/// Values and slopes at `u` of the polynomials of degree 0, 1, ... `count` - 1.
pub fn polynomials(count: usize, beta: f64, u: f64) -> Vec<[f64; 2]> {
    let mut all = Vec::with_capacity(count.max(2));
    all.push([1.0, 0.0]);
    all.push([0.5 * ((beta + 2.0) * u - beta), 0.5 * (beta + 2.0)]);
    for n in 2..count {
        let ([p, slope], [p_before, slope_before]) = (all[n - 1], all[n - 2]);
        let n = n as f64;
        let s = 2.0 * n + beta;
        let lead = 2.0 * n * (n + beta) * (s - 2.0);
        let (stretch, shift) = ((s - 1.0) * s * (s - 2.0) / lead, (s - 1.0) * beta * beta / lead);
        let back = 2.0 * (n - 1.0) * (n + beta - 1.0) * s / lead;
        all.push([
            (stretch * u - shift) * p - back * p_before,
            stretch * p + (stretch * u - shift) * slope - back * slope_before,
        ]);
    }
    all.truncate(count);
    all
}

/// Points and weights of Gauss on -1 to 1, exact for polynomials of degree 2 `points` - 1. The
/// points are Legendre's zeros, found by Newton's method from the guess of Tricomi 1950.
pub fn gauss(points: usize) -> Vec<[f64; 2]> {
    let n = points as f64;
    (0..points)
        .map(|i| {
            let mut u = -(std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..6 {
                let [p, at] = polynomials(points + 1, 0.0, u)[points];
                (u, slope) = (u - p / at, at);
            }
            [u, 2.0 / ((1.0 - u * u) * slope * slope)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_integrates_powers_up_to_its_degree_and_no_further() {
        for points in [1, 2, 5, 16, 40] {
            let error = |power: i32| {
                let sum: f64 = gauss(points).iter().map(|[u, w]| w * u.powi(power)).sum();
                (sum - if power % 2 == 0 { 2.0 / f64::from(power + 1) } else { 0.0 }).abs()
            };
            let last = 2 * points as i32 - 1;
            assert!((0..=last).all(|power| error(power) < 1e-14), "{points}");
            assert!(points > 5 || error(last + 1) > 1e-4, "{points}");
        }
    }

    #[test]
    fn polynomials_are_orthogonal_and_slopes_are_theirs() {
        let (count, beta) = (9, 5.0);
        for (i, j) in (0..count).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let product = gauss(20).iter().fold(0.0, |sum, [u, w]| {
                let p = polynomials(count, beta, *u);
                sum + w * (1.0 + u).powi(5) * p[i][0] * p[j][0]
            });
            let norm = 64.0 / (2.0 * i as f64 + 6.0);
            assert!((product - if i == j { norm } else { 0.0 }).abs() < 1e-12, "{i} {j}");
        }
        let [low, at, high] = [0.3 - 1e-6, 0.3, 0.3 + 1e-6].map(|u| polynomials(count, beta, u));
        for n in 0..count {
            let slope = (high[n][0] - low[n][0]) / 2e-6;
            assert!((slope - at[n][1]).abs() < 1e-7 * at[n][1].abs().max(1.0), "{n}");
        }
    }
}
