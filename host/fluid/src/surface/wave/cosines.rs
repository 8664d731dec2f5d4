//! The modes of a box: products of cosines with a crest or a trough at each wall.

use std::{f64::consts::PI, ops::Range};

use super::{Lattice, Mode};
use crate::{
    simd::SimdClass,
    spectral::{
        Part, Rows, Transform,
        basis::{End, Ends},
        multiply,
    },
};

/// The columns of a product come in as many.
const PAD: usize = 8;

const WALLS: Ends = Ends::Between([End::Closed; 2]);

/// The way between nodes and modes.
pub struct Cosines {
    nodes: [usize; 2],
    spacing_m: f32,
    simd: SimdClass,
    x: Transform,
    z: Transform,
    /// Mode l of node i along x at `[i * x.len + l]`, and mode m of node k along z at
    /// `[m * nz + k]`: for what is at a few nodes only.
    at_x: Vec<f32>,
    at_z: Vec<f32>,
    /// Work space: folded values, and rows of modes.
    folded: Vec<f32>,
    rows: Vec<f32>,
}

impl Cosines {
    pub fn new(lattice: &Lattice, simd: SimdClass) -> Self {
        let [nx, nz] = lattice.nodes;
        let (x, z) = (Transform::new(nx, WALLS, PAD), Transform::new(nz, WALLS, 1));
        let room = vec![0.0; nz * x.len];
        // The first mode is constant; of the others the squares' mean is half.
        let value = |eigenvalue: f64, at: usize, n: usize| {
            let angle = 2.0 * (0.5 * eigenvalue.sqrt()).asin();
            let norm = if eigenvalue < 1e-12 { 1.0 } else { 2.0_f64 };
            ((norm / n as f64).sqrt() * (angle * (at as f64 + 0.5)).cos()) as f32
        };
        let of_x = |i, l| if x.is_mode(l) { value(x.eigenvalues[l], i, nx) } else { 0.0 };
        let at_x = (0..nx * x.len).map(|n| of_x(n / x.len, n % x.len)).collect();
        let at_z = (0..nz * nz).map(|n| value(z.eigenvalues[n / nz], n % nz, nz)).collect();
        Self {
            nodes: lattice.nodes,
            spacing_m: lattice.spacing_m,
            simd,
            at_x,
            at_z,
            folded: room.clone(),
            rows: room,
            x,
            z,
        }
    }

    pub fn bytes(&self) -> usize {
        let arrays = [&self.rows, &self.folded, &self.at_x, &self.at_z];
        arrays.map(|a| size_of_val(a.as_slice())).iter().sum()
    }

    /// What no mode is above: cos cos over the root of its mean square, which is a quarter.
    pub fn peak_per_m(&self) -> f32 {
        let nodes: usize = self.nodes.iter().product();
        2.0 / (self.spacing_m * (nodes as f32).sqrt())
    }

    /// All modes of liquid of a depth, in their order; the constant one and pads have lambda 0.
    pub fn modes(&self, depth_m: f64) -> impl Iterator<Item = Mode> {
        // The eigenvalue of a cosine of angle t a node is 2 - 2 cos t = 4 sin^2(t/2).
        let per_m = 2.0 / f64::from(self.spacing_m);
        let wavenumber = move |eigenvalue: f64| per_m * (0.5 * eigenvalue.sqrt()).asin();
        (0..self.nodes[1]).flat_map(move |m| {
            (0..self.x.len).map(move |l| {
                let [x, z] = [self.x.eigenvalues[l], self.z.eigenvalues[m]].map(wavenumber);
                let wavenumber_per_m = if self.x.is_mode(l) { x.hypot(z) } else { 0.0 };
                let lambda_per_m = wavenumber_per_m * (wavenumber_per_m * depth_m).tanh();
                Mode { lambda_per_m, wavenumber_per_m, wavenumber_below_per_m: wavenumber_per_m }
            })
        })
    }

    /// The sum over nodes of each value times each mode there.
    pub fn analyse(&mut self, nodal: &[f32], modes: &mut [f32]) {
        let Self { nodes: [nx, nz], x, z, folded, rows, .. } = self;
        let per_m = 1.0 / self.spacing_m;
        self.simd.vectorize_as(
            #[inline(always)]
            |class| {
                for (values, folded) in nodal.chunks_exact(*nx).zip(folded.chunks_exact_mut(x.len))
                {
                    x.fold(values, folded);
                }
                z.fold_rows(folded, x.len);
                for part in &x.parts {
                    let (a, b) = (&folded[part.from..], &part.by_value);
                    let size = [*nz, part.count, part.padded];
                    let (a, b) = (Rows(a, x.len), Rows(b, part.padded));
                    multiply(class, size, a, b, &mut rows[part.start..], x.len);
                }
                for part in &z.parts {
                    let (a, b) = (&part.by_mode, &rows[part.from * x.len..]);
                    let size = [part.count, part.count, x.len];
                    let (a, b) = (Rows(a, part.padded), Rows(b, x.len));
                    multiply(class, size, a, b, &mut modes[part.start * x.len..], x.len);
                }
                modes.iter_mut().for_each(|mode| *mode *= per_m);
            },
        );
    }

    /// As [`Cosines::analyse`], of values at a few nodes.
    pub fn analyse_few(&mut self, few: &[(usize, f32)], modes: &mut [f32]) {
        let Self { nodes: [nx, nz], x, folded, rows, at_x, at_z, .. } = self;
        let per_m = 1.0 / self.spacing_m;
        let columns = range_of(few.iter().map(|(node, _)| node % *nx));
        let lines = range_of(few.iter().map(|(node, _)| node / *nx));
        let patch = &mut folded[..columns.len() * lines.len()];
        patch.fill(0.0);
        for &(node, value) in few {
            let [i, k] = [node % *nx - columns.start, node / *nx - lines.start];
            patch[k * columns.len() + i] += per_m * value;
        }
        self.simd.vectorize_as(
            #[inline(always)]
            |class| {
                let size = [lines.len(), columns.len(), x.len];
                let (a, b) =
                    (Rows(patch, columns.len()), Rows(&at_x[columns.start * x.len..], x.len));
                multiply(class, size, a, b, rows, x.len);
                let (a, b) = (Rows(&at_z[lines.start..], *nz), Rows(rows, x.len));
                multiply(class, [*nz, lines.len(), x.len], a, b, modes, x.len);
            },
        );
    }

    /// The sum at each node of the modes whose wavenumbers along x and z are up to `reach_per_m`;
    /// of others too, which are to be 0.
    pub fn synthesise(&mut self, modes: &[f32], nodal: &mut [f32], reach_per_m: f64) {
        let Self { nodes: [nx, nz], x, z, folded, rows, .. } = self;
        let per_m = 1.0 / self.spacing_m;
        // As in `modes`. The modes of a part go up.
        let angle = (reach_per_m * f64::from(self.spacing_m)).min(PI);
        let is_whole = angle == PI;
        let highest = 4.0 * (0.5 * angle).sin().powi(2);
        let count = |axis: &Transform, part: &Part| {
            let modes = &axis.eigenvalues[part.start..][..part.count];
            if is_whole { part.count } else { modes.partition_point(|e| *e <= highest).max(1) }
        };
        self.simd.vectorize_as(
            #[inline(always)]
            |class| {
                for part in &z.parts {
                    let size = [part.count, count(z, part)];
                    for n in 0..if is_whole { 1 } else { x.parts.len() } {
                        let (from, columns) = if is_whole {
                            (0, x.len)
                        } else {
                            (x.parts[n].start, count(x, &x.parts[n]).next_multiple_of(PAD))
                        };
                        let b = Rows(&modes[part.start * x.len + from..], x.len);
                        let a = Rows(&part.by_value, part.padded);
                        let to = &mut rows[part.from * x.len + from..];
                        multiply(class, [size[0], size[1], columns], a, b, to, x.len);
                    }
                }
                for part in &x.parts {
                    let (a, b) = (&rows[part.start..], &part.by_mode);
                    let size = [*nz, count(x, part), part.padded];
                    let (a, b) = (Rows(a, x.len), Rows(b, part.padded));
                    multiply(class, size, a, b, &mut folded[part.from..], x.len);
                }
                z.unfold_rows(folded, x.len);
                for (folded, values) in
                    folded.chunks_exact_mut(x.len).zip(nodal.chunks_exact_mut(*nx))
                {
                    x.unfold(folded, values);
                }
                nodal.iter_mut().for_each(|value| *value *= per_m);
            },
        );
    }

    /// Values at nodes times the area that each stands for.
    pub fn weigh(&self, values: &[f32], weighed: &mut [f32]) {
        let m2 = self.spacing_m * self.spacing_m;
        values.iter().zip(weighed).for_each(|(value, weighed)| *weighed = m2 * value);
    }
}

/// From the least to the most.
fn range_of(values: impl Iterator<Item = usize> + Clone) -> Range<usize> {
    values.clone().min().unwrap_or(0)..values.max().map_or(0, |most| most + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, Vessel};

    #[test]
    fn few_values_are_analysed_as_all_are() {
        for cells in [[16, 4, 12], [33, 4, 7], [1, 1, 2]] {
            let lattice = Lattice::over(&Grid { cells, ..Grid::unit_cube(4) }, &Vessel::Box, 1);
            let mut cosines = Cosines::new(&lattice, SimdClass::detect());
            let few = [(0, 0.3), (lattice.len() - 1, -2.0), (lattice.len() / 2, 1.0)];
            let mut nodal = vec![0.0; lattice.len()];
            few.iter().for_each(|(node, value)| nodal[*node] += value);
            let [mut all, mut some] = [(); 2].map(|()| vec![9.0; cells[2] * cosines.x.len]);
            // Pads are left alone.
            all.fill(0.0);
            cosines.analyse(&nodal, &mut all);
            cosines.analyse_few(&few, &mut some);
            for (all, some) in all.iter().zip(&some) {
                assert!((all - some).abs() < 2e-5, "{cells:?}: {all} {some}");
            }
            let mut again = vec![0.0; lattice.len()];
            cosines.synthesise(&all, &mut again, f64::INFINITY);
            cosines.weigh(&again.clone(), &mut again);
            for (value, again) in nodal.iter().zip(&again) {
                assert!((value - again).abs() < 1e-5, "{cells:?}: {value} {again}");
            }
        }
    }

    #[test]
    fn long_waves_need_no_look_at_short_ones() {
        for cells in [[64, 4, 48], [33, 4, 7], [256, 4, 32], [2, 4, 1]] {
            let lattice = Lattice::over(&Grid { cells, ..Grid::unit_cube(4) }, &Vessel::Box, 1);
            let mut cosines = Cosines::new(&lattice, SimdClass::detect());
            for reach_per_m in [0.0, 1.0, 5.0, 17.0, 60.0] {
                let mut n = 0.0_f32;
                let modes: Vec<f32> = cosines
                    .modes(1.0)
                    .map(|mode| {
                        n += 1.0;
                        if mode.wavenumber_per_m <= reach_per_m { n.sin() } else { 0.0 }
                    })
                    .collect();
                let [mut all, mut long] = [(); 2].map(|()| vec![9.0; lattice.len()]);
                cosines.synthesise(&modes, &mut all, f64::INFINITY);
                cosines.synthesise(&modes, &mut long, reach_per_m);
                assert_eq!(all, long, "{cells:?} {reach_per_m}");
            }
        }
    }
}
