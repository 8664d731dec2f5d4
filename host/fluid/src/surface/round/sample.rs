//! The shapes of the waves, taken at the wet nodes of a lattice.
//!
//! They are freed of their mean and made orthonormal there in their order, the slowest first,
//! each node standing for a square of the lattice. So a sum of shapes keeps the sum of the
//! heights, and is found again from its values; and shapes change by no more than the lattice
//! blurs them. Their number is limited by what the nodes can tell apart.

use super::{
    RadialMode,
    dense::dot,
    mirrors::{Mirrors, share},
    modes,
    profile::Profile,
    zernike,
};
use crate::{simd::SimdClass, solver::Refused, surface::Lattice};

/// More shapes than these are not kept: a step takes a time that is proportional to them.
const MOST_SHAPES: usize = 400;
/// Nodes that the shortest wave has at least: with fewer, shapes lose what tells them apart.
const NODES_A_WAVE: f64 = 3.0;
/// A shape of which less than this part is left without those before it is none by itself.
const LEAST_LEFT: f64 = 0.3;

/// A wave of a [`super::Table`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wave {
    /// Waves along a circle about the axis.
    pub waves_around: u32,
    /// Whether it goes with the sine of the angle from x to z, or with the cosine.
    pub is_sine: bool,
    /// As [`RadialMode::lambda_per_m`].
    pub lambda_per_m: f64,
    /// As [`RadialMode::wavenumber_per_m`].
    pub wavenumber_per_m: f64,
    /// As [`RadialMode::wavenumber_below_per_m`].
    pub wavenumber_below_per_m: f64,
}

/// A wave, and its shape in 1/m at the first of the images each.
type Sampled = (Wave, Vec<f64>);

/// The waves of each class of [`super::mirrors::SIGNS`], the slowest first.
///
/// # Errors
/// [`Refused`] if the spacing is not positive.
pub fn sample(
    profile: &Profile,
    lattice: &Lattice,
    mirrors: &Mirrors,
    simd: SimdClass,
) -> Result<[Vec<Sampled>; 4], Refused> {
    let spacing_m = f64::from(lattice.spacing_m);
    let modes = modes(profile, MOST_SHAPES, NODES_A_WAVE * spacing_m)?;
    // Shapes times the root of the area that a node stands for have plain products.
    let root_m = |images| 2.0 * f64::from(share(images)).sqrt() * spacing_m;
    let roots_m: Vec<f64> = mirrors.images.iter().map(root_m).collect();
    let mut constant = roots_m.clone();
    orthonormalise(&mut constant, &[], simd);
    let mut classes: [Vec<Sampled>; 4] = Default::default();
    for (mode, both) in modes.iter().zip(shapes_per_m(&modes, profile, lattice, mirrors)) {
        for (is_sine, mut shape) in [false, true].into_iter().zip(both).take(mode.shapes()) {
            let class = mirrors.class([(mode.waves_around % 2 == 1) != is_sine, is_sine]);
            let mut others: Vec<&[f64]> =
                classes[class].iter().map(|(_, other)| &other[..]).collect();
            if class == 0 {
                others.push(&constant);
            }
            scale(&mut shape, &roots_m);
            if orthonormalise(&mut shape, &others, simd) > LEAST_LEFT {
                let wave = Wave {
                    waves_around: mode.waves_around,
                    is_sine,
                    lambda_per_m: mode.lambda_per_m,
                    wavenumber_per_m: mode.wavenumber_per_m,
                    wavenumber_below_per_m: mode.wavenumber_below_per_m(profile.depth_m()),
                };
                classes[class].push((wave, shape));
            }
        }
    }
    let per_root: Vec<f64> = roots_m.iter().map(|root_m| 1.0 / root_m).collect();
    for (_, shape) in classes.iter_mut().flatten() {
        scale(shape, &per_root);
    }
    Ok(classes)
}

/// f cos(m theta) and f sin(m theta) of each mode at the first of the images each.
fn shapes_per_m(
    modes: &[RadialMode],
    profile: &Profile,
    lattice: &Lattice,
    mirrors: &Mirrors,
) -> Vec<[Vec<f64>; 2]> {
    let mut all: Vec<[Vec<f64>; 2]> = vec![Default::default(); modes.len()];
    let most_around = modes.iter().map(|mode| mode.waves_around).max().unwrap_or(0);
    for m in 0..=most_around {
        // Those of one m have as many coefficients, so that one set of polynomials does for all.
        let of_m = |(_, mode): &(_, &RadialMode)| mode.waves_around == m;
        let Some(count) =
            modes.iter().enumerate().find(of_m).map(|(_, mode)| mode.coefficients_per_m.len())
        else {
            continue;
        };
        for images in &mirrors.images {
            let [x_m, z_m] = mirrors.offset_m(lattice, images[0] as usize);
            let (sine, cosine) = (f64::from(m) * z_m.atan2(x_m)).sin_cos();
            let z = zernike::values(m, count, x_m.hypot(z_m) / profile.radius_m());
            for (n, mode) in modes.iter().enumerate().filter(of_m) {
                let shape_per_m = mode.combined(&z);
                all[n][0].push(shape_per_m * cosine);
                all[n][1].push(shape_per_m * sine);
            }
        }
    }
    all
}

fn scale(values: &mut [f64], by: &[f64]) {
    for (value, by) in values.iter_mut().zip(by) {
        *value *= by;
    }
}

/// Takes from a vector what it has of others, which are orthonormal, and makes its length 1;
/// returns what that was. (Gram and Schmidt, one after the other, as rounding asks for.)
fn orthonormalise(vector: &mut [f64], others: &[&[f64]], simd: SimdClass) -> f64 {
    simd.vectorize(
        #[inline(always)]
        || {
            for other in others {
                let part = dot(vector, other);
                for (value, other) in vector.iter_mut().zip(*other) {
                    *value -= part * other;
                }
            }
            let length = dot(vector, vector).sqrt();
            vector.iter_mut().for_each(|value| *value /= length);
            length
        },
    )
}
