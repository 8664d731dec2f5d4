//! Functions that come out as the same bits everywhere, since they are made of nothing but IEEE
//! additions, products and quotients.

const FRAC_2_PI: f32 = core::f32::consts::FRAC_2_PI;
// pi/2 in two parts (Cody & Waite 1980): the first has so few bits that a product with a small
// integer is exact.
const HALF_PI_HIGH: f32 = 1.570_312_5;
const HALF_PI_LOW: f32 = 4.838_268e-4;

/// Sine and cosine of an angle in radians, for |angle| <= 50; error at most 2e-7.
///
/// Quarter turns are taken off, and the Taylor series of what is left, |r| <= pi/4, is cut where
/// its next term is below 3e-9 (sine) and 2e-9 (cosine).
#[must_use]
pub fn sin_cos(angle_rad: f32) -> (f32, f32) {
    let quarters = round_to_int(angle_rad * FRAC_2_PI);
    let k = quarters as f32;
    let r = (angle_rad - k * HALF_PI_HIGH) - k * HALF_PI_LOW;
    let s = r * r;
    let sin =
        r + r * s * (-1.0 / 6.0 + s * (1.0 / 120.0 + s * (-1.0 / 5040.0 + s * (1.0 / 362_880.0))));
    let cos = 1.0
        + s * (-0.5
            + s * (1.0 / 24.0
                + s * (-1.0 / 720.0 + s * (1.0 / 40_320.0 - s * (1.0 / 3_628_800.0)))));
    match quarters & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Square root of `x` to the last two bits; 0 for what has none.
///
/// Heron's iteration from an estimate that halves the exponent; its error falls from 4 % to
/// 8e-4, 3e-7 and then rounding.
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    if (f32::MIN_POSITIVE..=f32::MAX).contains(&x) {
        let estimate = f32::from_bits((x.to_bits() >> 1) + 0x1fbb_4f2e);
        let once = 0.5 * (estimate + x / estimate);
        let twice = 0.5 * (once + x / once);
        0.5 * (twice + x / twice)
    } else {
        0.0
    }
}

/// `x` held between `low` and `high`; NaN becomes `low`.
#[must_use]
pub fn clamp(x: f32, low: f32, high: f32) -> f32 {
    if x > low { if x < high { x } else { high } } else { low }
}

/// `x` without its sign.
#[must_use]
pub fn abs(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & 0x7fff_ffff)
}

/// `a` at 0, `b` at 1.
#[must_use]
pub fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

fn round_to_int(x: f32) -> i32 {
    (if x >= 0.0 { x + 0.5 } else { x - 0.5 }) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sin_cos_follow_the_exact_ones() {
        for i in -50_000..=50_000 {
            let x = i as f32 * 1e-3;
            let (s, c) = sin_cos(x);
            let exact = f64::from(x).sin_cos();
            assert!((f64::from(s) - exact.0).abs() < 2e-7, "sin {x}: {s}");
            assert!((f64::from(c) - exact.1).abs() < 2e-7, "cos {x}: {c}");
        }
    }

    #[test]
    fn sqrt_follows_the_exact_one_over_all_exponents() {
        let mut x = 1.2e-38_f32;
        while x < 3e38 {
            let exact = f64::from(x).sqrt();
            assert!((f64::from(sqrt(x)) / exact - 1.0).abs() < 1.5e-7, "{x}");
            x *= 1.0137;
        }
        for none in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(sqrt(none), 0.0);
        }
    }

    #[test]
    fn clamp_stops_what_is_not_a_number() {
        assert_eq!(clamp(f32::NAN, -1.0, 1.0), -1.0);
        assert_eq!(clamp(2.0, -1.0, 1.0), 1.0);
        assert_eq!(clamp(0.5, -1.0, 1.0), 0.5);
    }
}
