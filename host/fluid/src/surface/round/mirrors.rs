//! The wet nodes of a lattice, and which of them mirror each other.
//!
//! Across a line through the axis a shape of the surface is even or odd. Where the lattice is the
//! same on both sides, sums and differences of mirrored values are all that a shape needs: a
//! quarter of the nodes for each shape, where both axes of the lattice have a mirror.

use std::array::from_fn;

use crate::surface::Lattice;

/// A node and its images: itself, mirrored along x, along z, and along both. Where there is no
/// mirror, or a node on it, they are the same.
pub type Images = [u32; 4];

/// Signs of the values at the images of a shape that is even along both, odd along x, along z,
/// and along both.
pub const SIGNS: [[f32; 4]; 4] =
    [[1.0; 4], [1.0, -1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0]];

/// Part of a spacing that the axis may be beside a mirror.
const SLACK: f64 = 1e-3;

/// The wet nodes, each once, by their images.
pub struct Mirrors {
    /// Whether there is a mirror along x and along z.
    pub mirrored: [bool; 2],
    /// x and z of the axis, moved into the mirrors.
    pub axis_in_world_m: [f64; 2],
    /// One node of those that mirror each other, with the others.
    pub images: Vec<Images>,
}

impl Mirrors {
    /// The mirrors through a point at `axis_in_world_m`.
    pub fn new(lattice: &Lattice, axis_in_world_m: [f64; 2]) -> Self {
        let [nx, nz] = lattice.nodes;
        let is_wet = |[i, k]: [usize; 2]| i < nx && k < nz && lattice.wet[i + nx * k];
        let wet: Vec<_> = (0..nx * nz).map(|n| [n % nx, n / nx]).filter(|at| is_wet(*at)).collect();
        let (first_m, spacing_m) = (first_in_world_m(lattice), f64::from(lattice.spacing_m));
        let twice: [f64; 2] =
            from_fn(|axis| 2.0 * (axis_in_world_m[axis] - first_m[axis]) / spacing_m);
        // What is mirrored to before the first node goes where nothing is wet.
        let mirror = |mut at: [usize; 2], axis: usize| {
            let to = twice[axis].round() as i64 - at[axis] as i64;
            at[axis] = usize::try_from(to).unwrap_or(usize::MAX);
            at
        };
        let mirrored = from_fn(|axis| {
            (twice[axis] - twice[axis].round()).abs() < 2.0 * SLACK
                && wet.iter().all(|at| is_wet(mirror(*at, axis)))
        });
        let image = |at, axis: usize| if mirrored[axis] { mirror(at, axis) } else { at };
        let index = |[i, k]: [usize; 2]| (i + nx * k) as u32;
        let images = wet.iter().filter_map(|at| {
            let [x, z] = [image(*at, 0), image(*at, 1)];
            let is_first = x[0] >= at[0] && z[1] >= at[1];
            is_first.then(|| [*at, x, z, [x[0], z[1]]].map(index))
        });
        let images = images.collect();
        let moved = |axis: usize| {
            let to_m = 0.5 * twice[axis].round() * spacing_m + first_m[axis];
            if mirrored[axis] { to_m } else { axis_in_world_m[axis] }
        };
        Self { mirrored, axis_in_world_m: from_fn(moved), images }
    }

    /// x and z of a node, from the axis.
    pub fn offset_m(&self, lattice: &Lattice, node: usize) -> [f64; 2] {
        let first_m = first_in_world_m(lattice);
        let at = [node % lattice.nodes[0], node / lattice.nodes[0]].map(|i| i as f64);
        from_fn(|axis| {
            first_m[axis] + at[axis] * f64::from(lattice.spacing_m) - self.axis_in_world_m[axis]
        })
    }

    /// Class of a shape in [`SIGNS`] that is odd along x and z or not.
    pub fn class(&self, is_odd: [bool; 2]) -> usize {
        let [x, z] = from_fn(|axis| usize::from(is_odd[axis] && self.mirrored[axis]));
        x + 2 * z
    }
}

fn first_in_world_m(lattice: &Lattice) -> [f64; 2] {
    [lattice.origin_in_world_m.x, lattice.origin_in_world_m.z].map(f64::from)
}

/// How many nodes the images are, over their number.
pub fn share(images: &Images) -> f32 {
    let [a, x, z, _] = images;
    let [x, z] = [x, z].map(|image| if image == a { 0.5 } else { 1.0 });
    x * z
}

/// The values of some nodes in each class: sums and differences over the images.
#[inline(always)]
pub fn fold<const L: usize>(values: &[[f32; L]; 4]) -> [[f32; L]; 4] {
    let [a, x, z, xz] = values;
    let mut folded = [[0.0; L]; 4];
    for l in 0..L {
        let ([near, far], [near_odd, far_odd]) =
            ([a[l] + x[l], z[l] + xz[l]], [a[l] - x[l], z[l] - xz[l]]);
        folded[0][l] = near + far;
        folded[1][l] = near_odd + far_odd;
        folded[2][l] = near - far;
        folded[3][l] = near_odd - far_odd;
    }
    folded
}
