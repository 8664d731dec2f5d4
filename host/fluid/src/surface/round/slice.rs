//! The liquid from the bottom up, slice by slice.
//!
//! With x = r/a(y), a the radius of the wall at the height y, a slice is a cylinder, and the
//! potential in it a sum of (a/a_top)^e Z_j(x) N_p(y) cos(m theta), e = 0, 1 or 2, even with m,
//! so that it is smooth where a vessel ends on its axis. Written Z L for one of them, twice its
//! energy by the density is
//!
//! ```text
//! int [ (phi_r^2 + m^2 phi^2 / r^2) + phi_y^2 ] r dr dy,   phi_y = Z L' - x Z' L a'/a
//! ```
//!
//! which falls into integrals over the disc times integrals over the height. No flux through
//! wall and bottom is its natural condition. What is inside a slice takes the values that make
//! it least and is condensed away: a form of the values at the top of the slice is left, to
//! which the next slice adds its own, and that of the last is the surface's.

use super::{
    dense::Square,
    jacobi::{gauss, polynomials},
    profile::{Piece, Profile},
    zernike::Products,
};

/// Degree of the polynomials across a slice.
const DEGREE: usize = 6;
/// Functions of the height in a slice: the bottom's, those that are 0 at both ends, the top's.
const FUNCTIONS: usize = DEGREE + 1;
/// Points of Gauss across a slice.
const POINTS: usize = 10;

/// A slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    top_depth_m: f64,
    bottom_depth_m: f64,
    piece: Piece,
}

/// Slices from the bottom up for waves of wavenumbers up to k, which fade within 1/k of the
/// surface and of its rim: each is as thick as it is deep, since what is left there is as long.
pub fn slices(profile: &Profile, wavenumber_per_m: f64) -> Vec<Slice> {
    let mut all = Vec::new();
    let mut depth_m = 0.0f64;
    let [square_m2, by_depth] = profile.pieces[0].square_and_slope(0.0);
    let slant = 0.5 * by_depth.abs() / square_m2.sqrt();
    let first_m = 2.0 / (wavenumber_per_m * (1.0 + slant));
    for piece in &profile.pieces {
        while depth_m < piece.down_to_m {
            let thickness_m = depth_m.max(first_m);
            let rest_m = piece.down_to_m - depth_m;
            let is_last = rest_m < 1.5 * thickness_m;
            let bottom_depth_m = if is_last { piece.down_to_m } else { depth_m + thickness_m };
            all.push(Slice { top_depth_m: depth_m, bottom_depth_m, piece: *piece });
            depth_m = bottom_depth_m;
        }
    }
    all.reverse();
    all
}

/// The form of the values at the surface, in m: twice the energy by the density and by pi, or by
/// 2 pi for m = 0.
pub fn stiffness(slices: &[Slice], waves_around: u32, disc: &Products) -> Square {
    let count = disc.gradient.size;
    slices.iter().fold(Square::zeros(count), |below, slice| {
        slice.stiffness(&slice.sums(waves_around), disc, &below)
    })
}

/// Integrals over the height of products of two functions L_p and L_q.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// L_p L_q, in m.
    value: [[f64; FUNCTIONS]; FUNCTIONS],
    /// a^2 L_p' L_q', in m.
    slope: [[f64; FUNCTIONS]; FUNCTIONS],
    /// a a' L_p' L_q, in m.
    mixed: [[f64; FUNCTIONS]; FUNCTIONS],
    /// a'^2 L_p L_q, in m.
    stretched: [[f64; FUNCTIONS]; FUNCTIONS],
    /// (a/a_top)^e at the bottom.
    bottom: f64,
}

impl Slice {
    fn sums(&self, waves_around: u32) -> Sums {
        let exponent = if waves_around == 0 { 0 } else { 2 - waves_around as i32 % 2 };
        let thickness_m = self.bottom_depth_m - self.top_depth_m;
        let top_m2 = self.piece.square_and_slope(self.top_depth_m)[0];
        let bottom_m2 = self.piece.square_and_slope(self.bottom_depth_m)[0].max(0.0);
        let factor = |a2: f64| (a2 / top_m2).sqrt().powi(exponent);
        let mut sums = Sums { bottom: factor(bottom_m2), ..Sums::default() };
        for [u, w] in gauss(POINTS) {
            let depth_m = self.top_depth_m + 0.5 * (1.0 - u) * thickness_m;
            let [a2, by_depth] = self.piece.square_and_slope(depth_m);
            let (aa, w) = (-0.5 * by_depth, 0.5 * thickness_m * w);
            let (scale, growth) = (factor(a2), f64::from(exponent) * aa / a2);
            let functions = functions(u).map(|[value, slope]| {
                [scale * value, scale * (slope * 2.0 / thickness_m + growth * value)]
            });
            for (p, [value_p, slope_p]) in functions.into_iter().enumerate() {
                for (q, [value_q, slope_q]) in functions.into_iter().enumerate() {
                    sums.value[p][q] += w * value_p * value_q;
                    sums.slope[p][q] += w * a2 * slope_p * slope_q;
                    sums.mixed[p][q] += w * aa * slope_p * value_q;
                    sums.stretched[p][q] += w * aa * aa / a2 * value_p * value_q;
                }
            }
        }
        sums
    }

    /// The form of the values at the top, in m, from that of the values at the bottom.
    fn stiffness(&self, sums: &Sums, disc: &Products, below: &Square) -> Square {
        let count = below.size;
        let mut whole = Square::zeros(FUNCTIONS * count);
        for (p, i) in (0..FUNCTIONS).flat_map(|p| (0..count).map(move |i| (p, i))) {
            let (gradient, stretched) = (disc.gradient.row(i), disc.stretched.row(i));
            let (stretch, stretch_back) = (disc.stretch.row(i), disc.stretch_back.row(i));
            let row = &mut whole.values[(p * count + i) * FUNCTIONS * count..];
            for (q, block) in row.chunks_exact_mut(count).enumerate().take(FUNCTIONS).skip(p) {
                block[i] = sums.slope[p][q];
                for (j, at) in block.iter_mut().enumerate() {
                    *at += sums.value[p][q] * gradient[j] + sums.stretched[p][q] * stretched[j]
                        - sums.mixed[p][q] * stretch[j]
                        - sums.mixed[q][p] * stretch_back[j];
                }
            }
            if p == 0 {
                for (at, below) in row.iter_mut().zip(below.row(i)) {
                    *at += sums.bottom * sums.bottom * below;
                }
            }
        }
        whole.condense(count)
    }
}

/// Values and slopes at u, from -1 at the bottom to 1 at the top: of two lines, and between them
/// of the integrals of Legendre's polynomials.
fn functions(u: f64) -> [[f64; 2]; FUNCTIONS] {
    let legendre = polynomials(FUNCTIONS + 1, 0.0, u);
    std::array::from_fn(|p| match p {
        0 => [0.5 * (1.0 - u), -0.5],
        DEGREE => [0.5 * (1.0 + u), 0.5],
        _ => {
            let rise = legendre[p + 1][0] - legendre[p - 1][0];
            [rise / (2.0 * p as f64 + 1.0), legendre[p][0]]
        }
    })
}
