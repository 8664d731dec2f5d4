//! The shapes of the waves at the nodes of a lattice, and the way there and back.
//!
//! The table is read once for each way. It lies in tiles of as many nodes as sums fit registers,
//! all shapes of a tile together.

use std::{array::from_fn, ops::Range};

use super::{
    mirrors::{Images, Mirrors, SIGNS, fold, share},
    profile::Profile,
    sample::{Wave, sample},
};
use crate::{lanes::multiply_add, simd::SimdClass, solver::Refused, surface::Lattice};

/// Values that kernels take at once.
const LANES: usize = 16;
/// Their number in a tile.
const VECTORS: usize = 4;

type Block = [f32; LANES];
type Tile = [Block; VECTORS];

/// The waves of a vessel at the nodes of a lattice.
pub(crate) struct Table {
    simd: SimdClass,
    node_m2: f32,
    mirrors: Mirrors,
    waves: Vec<Wave>,
    /// Waves of each class of [`SIGNS`].
    classes: [Range<usize>; 4],
    /// psi in 1/m of wave w at the nodes of tile t at `[t * waves + w]`.
    psi_per_m: Vec<Tile>,
    /// Node of the lattice to its place in `mirrors` and among the images there.
    places: Vec<Option<(u32, u8)>>,
    /// Work space: of each wave the sums in lanes.
    sums: Vec<Block>,
}

impl Table {
    /// The waves of a round vessel at the nodes of a lattice: all that these resolve, but no more
    /// than 400.
    ///
    /// # Errors
    /// [`Refused`] if the spacing is not positive.
    pub fn new(profile: &Profile, lattice: &Lattice, simd: SimdClass) -> Result<Self, Refused> {
        let mirrors = Mirrors::new(lattice, profile.axis_in_world_m);
        let sampled = sample(profile, lattice, &mirrors, simd)?;
        let count = sampled.iter().map(Vec::len).sum::<usize>();
        let mut waves = Vec::with_capacity(count);
        let tiles = mirrors.images.len().div_ceil(LANES * VECTORS);
        let mut psi_per_m = vec![[[0.0; LANES]; VECTORS]; tiles * count];
        let classes = sampled.map(|class| {
            let from = waves.len();
            for (wave, shape_per_m) in class {
                for (n, value) in shape_per_m.into_iter().enumerate() {
                    let (tile, at) = (n / (LANES * VECTORS), n % (LANES * VECTORS));
                    let tile = &mut psi_per_m[tile * count + waves.len()];
                    tile[at / LANES][at % LANES] = value as f32;
                }
                waves.push(wave);
            }
            from..waves.len()
        });
        let mut places = vec![None; lattice.len()];
        for (n, images) in mirrors.images.iter().enumerate() {
            for (image, node) in images.iter().enumerate().rev() {
                places[*node as usize] = Some((n as u32, image as u8));
            }
        }
        let sums = vec![[0.0; LANES]; waves.len()];
        Ok(Self {
            simd,
            node_m2: lattice.node_m2(),
            mirrors,
            waves,
            classes,
            psi_per_m,
            places,
            sums,
        })
    }

    /// The waves, in the order of all arrays of them.
    pub fn waves(&self) -> &[Wave] {
        &self.waves
    }

    /// What no wave is above at any node.
    pub fn peak_per_m(&self) -> f32 {
        let all = self.psi_per_m.as_flattened().as_flattened();
        all.iter().fold(0.0, |most, psi| most.max(psi.abs()))
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.psi_per_m.as_slice())
            + size_of_val(self.places.as_slice())
            + size_of_val(self.mirrors.images.as_slice())
            + size_of_val(self.sums.as_slice())
    }

    /// Values at nodes times the area that each stands for.
    pub fn weigh(&self, values: &[f32], weighed: &mut [f32]) {
        values.iter().zip(weighed).for_each(|(value, weighed)| *weighed = self.node_m2 * value);
    }

    /// Of each wave the sum over the wet nodes of a value times the wave there, in 1/m.
    pub fn analyse(&mut self, nodal: &[f32], modal: &mut [f32]) {
        self.sums.fill([0.0; LANES]);
        let Self { mirrors, psi_per_m, classes, sums, .. } = self;
        let tiles = psi_per_m.chunks_exact(sums.len().max(1));
        self.simd.vectorize_as(
            #[inline(always)]
            |class| {
                for (tile, images) in tiles.zip(mirrors.images.chunks(LANES * VECTORS)) {
                    let values = gather(images, nodal);
                    for (folded, waves) in fold(&values).iter().zip(classes.iter()) {
                        let (tile, sums) = (&tile[waves.clone()], &mut sums[waves.clone()]);
                        match class {
                            SimdClass::Avx512 => add_products::<8>(class, tile, folded, sums),
                            SimdClass::Avx2 => add_products::<4>(class, tile, folded, sums),
                            SimdClass::Portable => add_products::<2>(class, tile, folded, sums),
                        }
                    }
                }
            },
        );
        for (modal, sums) in modal.iter_mut().zip(sums) {
            *modal = sums.iter().sum();
        }
    }

    /// As [`Table::analyse`], of values at a few nodes; those of dry ones count for nothing.
    pub fn analyse_few(&self, few: &[(usize, f32)], modal: &mut [f32]) {
        modal.fill(0.0);
        for (node, value) in few {
            let Some((n, image)) = self.places[*node] else { continue };
            let (tile, at) = (n as usize / (LANES * VECTORS), n as usize % (LANES * VECTORS));
            let tile = &self.psi_per_m[tile * self.waves.len()..];
            for (waves, signs) in self.classes.iter().zip(SIGNS) {
                let value = value * signs[image as usize];
                for (modal, tile) in modal[waves.clone()].iter_mut().zip(&tile[waves.clone()]) {
                    *modal += value * tile[at / LANES][at % LANES];
                }
            }
        }
    }

    /// Of each array of waves the sum of all at each node, in 1/m; at dry nodes 0.
    pub fn synthesise<const N: usize>(&self, modal: [&[f32]; N], mut nodal: [&mut [f32]; N]) {
        nodal.iter_mut().for_each(|nodal| nodal.fill(0.0));
        let Self { mirrors, psi_per_m, classes, waves, .. } = self;
        let tiles = psi_per_m.chunks_exact(waves.len().max(1));
        self.simd.vectorize_as(
            #[inline(always)]
            |class| {
                for (tile, images) in tiles.zip(mirrors.images.chunks(LANES * VECTORS)) {
                    let mut folded = [[[0.0; LANES * VECTORS]; 4]; N];
                    for (c, waves) in classes.iter().enumerate() {
                        let tile = &tile[waves.clone()];
                        let modal = modal.map(|modal| &modal[waves.clone()]);
                        let sums = match class {
                            SimdClass::Avx512 => add_waves::<N, VECTORS>(class, tile, modal),
                            SimdClass::Avx2 => add_waves::<N, 2>(class, tile, modal),
                            SimdClass::Portable => add_waves::<N, 1>(class, tile, modal),
                        };
                        for (folded, sums) in folded.iter_mut().zip(sums) {
                            folded[c].copy_from_slice(sums.as_flattened());
                        }
                    }
                    for (nodal, folded) in nodal.iter_mut().zip(&folded) {
                        let values = fold(folded);
                        for (n, images) in images.iter().enumerate() {
                            for (values, node) in values.iter().zip(images) {
                                nodal[*node as usize] = values[n];
                            }
                        }
                    }
                }
            },
        );
    }
}

/// The values at the images of the nodes of a tile, those that are there twice by half. (Not
/// inlined: by vectors of indices it would take three times as long.)
#[inline(never)]
fn gather(images: &[Images], nodal: &[f32]) -> [[f32; LANES * VECTORS]; 4] {
    let mut values = [[0.0; LANES * VECTORS]; 4];
    for (n, images) in images.iter().enumerate().take(LANES * VECTORS) {
        let share = share(images);
        for (values, node) in values.iter_mut().zip(images) {
            values[n] = share * nodal[*node as usize];
        }
    }
    values
}

/// Adds to the sums of each wave its products with the values of a tile, lane by lane, `R` waves
/// at a time: as many as there are registers for.
#[inline(always)]
fn add_products<const R: usize>(
    class: SimdClass,
    waves: &[Tile],
    values: &[f32; LANES * VECTORS],
    sums: &mut [Block],
) {
    let values: &[Block] = values.as_chunks().0;
    let ((waves, last), (sums, last_sums)) = (waves.as_chunks::<R>(), sums.as_chunks_mut::<R>());
    for (waves, sums) in waves.iter().zip(sums) {
        *sums = with_products(class, waves, values, *sums);
    }
    for (wave, sum) in last.iter().zip(last_sums) {
        [*sum] = with_products(class, &[*wave], values, [*sum]);
    }
}

/// The sums of `R` waves with their products.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "iterators keep the sums out of registers here")]
fn with_products<const R: usize>(
    class: SimdClass,
    waves: &[Tile; R],
    values: &[Block],
    mut sums: [Block; R],
) -> [Block; R] {
    let rows: [&[Block]; R] = from_fn(|r| &waves[r][..values.len()]);
    for (v, value) in values.iter().enumerate() {
        for r in 0..R {
            sums[r] = multiply_add(class, rows[r][v], *value, sums[r]);
        }
    }
    sums
}

/// The sums of the waves of a tile, each times its own number, `V` vectors at a time: as many as
/// there are registers for.
#[inline(always)]
fn add_waves<const N: usize, const V: usize>(
    class: SimdClass,
    waves: &[Tile],
    modal: [&[f32]; N],
) -> [Tile; N] {
    let mut all = [[[0.0; LANES]; VECTORS]; N];
    for from in (0..VECTORS).step_by(V) {
        let mut sums = [[[0.0; LANES]; V]; N];
        for (w, wave) in waves.iter().enumerate() {
            for n in 0..N {
                for v in 0..V {
                    sums[n][v] =
                        multiply_add(class, wave[from + v], [modal[n][w]; LANES], sums[n][v]);
                }
            }
        }
        for (all, sums) in all.iter_mut().zip(sums) {
            all[from..from + V].copy_from_slice(&sums);
        }
    }
    all
}

#[cfg(test)]
mod tests;
