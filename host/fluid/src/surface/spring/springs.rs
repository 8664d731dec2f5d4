//! Springs and masses: what pulls at a node, over rows padded so that no node lacks a neighbour.

use super::{Lattice, SurfaceParams};
use crate::{
    lanes::each,
    simd::SimdClass,
    solver::{SetupError, within},
};

/// Values that are computed together.
const BLOCK: usize = 16;
type Block = [f32; BLOCK];

/// Bend springs reach so far.
const PAD: usize = 2;

/// Heights and speeds, padded.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    pub height_m: Vec<f32>,
    pub speed_m_s: Vec<f32>,
}

impl Motion {
    pub fn zeros(len: usize) -> Self {
        Self { height_m: vec![0.0; len], speed_m_s: vec![0.0; len] }
    }

    pub fn copy(&mut self, from: &Self) {
        self.height_m.copy_from_slice(&from.height_m);
        self.speed_m_s.copy_from_slice(&from.speed_m_s);
    }

    pub fn bytes(&self) -> usize {
        2 * size_of_val(self.height_m.as_slice())
    }
}

/// How far a stage of RK4 goes along its slope: for the sum, and to where the next slope is taken.
#[derive(Clone, Copy)]
pub struct Part {
    pub sum_s: f32,
    pub next_s: f32,
}

/// The sheet without its motion.
pub struct Springs {
    /// Values from one padded row to the next, and of all.
    row: usize,
    len: usize,
    nodes: [usize; 2],
    /// Inverse mass of a node.
    pub per_kg: f32,
    /// Drag of a node over its mass.
    pub drag_per_s: f32,
    /// Springs beside, across and two away, over the mass of a node.
    springs_per_s2: [f32; 3],
    /// All springs of a node, and gravity, over its mass; 0 where it is dry.
    hold_per_s2: Vec<f32>,
    /// 1 for wet nodes, else 0.
    wet: Vec<f32>,
    wet_count: usize,
}

impl Springs {
    pub fn new(params: &SurfaceParams, lattice: &Lattice) -> Result<Self, SetupError> {
        let [nx, nz] = lattice.nodes;
        let row = nx + 2 * PAD;
        let len = row * (nz + 2 * PAD) + BLOCK;
        let m2 = lattice.node_m2();
        let per_kg = 1.0 / (params.areal_mass_kg_m2 * m2);
        let tension = params.tension_n_per_m + params.sheet_tension_n_per_m;
        let parts = [2.0 / 3.0, 1.0 / 6.0, params.bend];
        let mut springs = Self {
            row,
            len,
            nodes: lattice.nodes,
            per_kg,
            drag_per_s: params.drag_n_s_per_m3 / params.areal_mass_kg_m2,
            springs_per_s2: parts.map(|part| part * tension * per_kg),
            hold_per_s2: vec![0.0; len],
            wet: vec![0.0; len],
            wet_count: lattice.wet_count(),
        };
        for node in 0..lattice.len() {
            let at = springs.at(node);
            springs.wet[at] = f32::from(u8::from(lattice.wet[node]));
        }
        let gravity_per_s2 = params.gravity_n_per_m3 / params.areal_mass_kg_m2;
        for node in (0..lattice.len()).filter(|node| lattice.wet[*node]) {
            let at = springs.at(node);
            let held = springs.springs_per_s2.iter().zip(springs.reach());
            let springs_per_s2: f32 = held
                .map(|(spring, ways)| {
                    spring * ways.map(|to| springs.wet[at + to - 2 * row]).iter().sum::<f32>()
                })
                .sum();
            springs.hold_per_s2[at] = gravity_per_s2 + springs_per_s2;
        }
        for (what, value) in [
            ("surface.areal_mass_kg_m2", 1.0 / per_kg),
            ("surface.tension_n_per_m", springs.fastest_per_s()),
            ("surface.drag_n_s_per_m3", springs.drag_per_s),
        ] {
            within(what, f64::from(value), 1e12)?;
        }
        Ok(springs)
    }

    /// Inverse mass of the whole sheet.
    pub fn all_per_kg(&self) -> f64 {
        f64::from(self.per_kg) / self.wet_count.max(1) as f64
    }

    /// What the shares of a push on all nodes have in common; 0 if it leaves any out.
    pub fn common_share(&self, under: &[(usize, f32)]) -> f64 {
        let sum: f64 = under.iter().map(|(_, share)| f64::from(*share)).sum();
        if under.len() == self.wet_count { sum / self.wet_count.max(1) as f64 } else { 0.0 }
    }

    /// Number of values of a padded array.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Where a node of the lattice is in padded arrays.
    pub fn at(&self, node: usize) -> usize {
        let [nx, _] = self.nodes;
        node % nx + PAD + self.row * (node / nx + PAD)
    }

    /// True for nodes that move.
    pub fn is_wet(&self, node: usize) -> bool {
        self.wet[self.at(node)] > 0.0
    }

    pub fn bytes(&self) -> usize {
        2 * size_of_val(self.wet.as_slice())
    }

    /// The largest eigenvalue.
    pub fn fastest_per_s(&self) -> f32 {
        let [beside, across, two_away] = self.springs_per_s2.map(|spring| 4.0 * spring);
        let held = self.hold_per_s2.iter().fold(0.0, |most: f32, hold| most.max(*hold));
        (held + beside + across + two_away).sqrt().max(self.drag_per_s)
    }

    /// Offsets of the neighbours, counted from two rows before.
    fn reach(&self) -> [[usize; 4]; 3] {
        let (row, here) = (self.row, 2 * self.row);
        [
            [here - 1, here + 1, here - row, here + row],
            [here - row - 1, here - row + 1, here + row - 1, here + row + 1],
            [here - 2, here + 2, here - 2 * row, here + 2 * row],
        ]
    }

    /// Calls `body(at)` for each block of nodes.
    #[inline(always)]
    fn blocks(&self, mut body: impl FnMut(usize)) {
        let [nx, nz] = self.nodes;
        let first = PAD + self.row * PAD;
        let end = first + self.row * (nz - 1) + nx;
        let mut at = first;
        while at < end {
            body(at);
            at += BLOCK;
        }
    }

    /// What springs and gravity pull a block of nodes with, over their mass.
    #[inline(always)]
    fn pull(&self, x: &[f32], reach: &[[usize; 4]; 3], at: usize) -> Block {
        let from = &x[at - 2 * self.row..];
        let sum = |[a, b, c, d]: [usize; 4]| {
            let [a, b, c, d] = [block(from, a), block(from, b), block(from, c), block(from, d)];
            each(
                #[inline(always)]
                |i| (a[i] + b[i]) + (c[i] + d[i]),
            )
        };
        let [beside, across, two_away]: [Block; 3] = [sum(reach[0]), sum(reach[1]), sum(reach[2])];
        let [k_beside, k_across, k_two] = self.springs_per_s2;
        let (here, hold, wet) = (block(x, at), block(&self.hold_per_s2, at), block(&self.wet, at));
        each(
            #[inline(always)]
            |i| {
                let springs = k_beside * beside[i] + k_across * across[i] + k_two * two_away[i];
                wet[i] * springs - hold[i] * here[i]
            },
        )
    }

    /// The slope of `at`: adds it to `sum`, and to `base` for `next`.
    pub fn follow_slope(
        &self,
        simd: SimdClass,
        [at, base]: [&Motion; 2],
        load_m_s2: &[f32],
        part: Part,
        [sum, next]: [&mut Motion; 2],
    ) {
        let reach = self.reach();
        simd.vectorize(
            #[inline(always)]
            || {
                self.blocks(
                    #[inline(always)]
                    |n| {
                        let pull = self.pull(&at.height_m, &reach, n);
                        let (speed, load) = (block(&at.speed_m_s, n), block(load_m_s2, n));
                        let gain: Block = each(
                            #[inline(always)]
                            |i| pull[i] + load[i] - self.drag_per_s * speed[i],
                        );
                        follow(&mut sum.height_m, n, None, part.sum_s, speed);
                        follow(&mut sum.speed_m_s, n, None, part.sum_s, gain);
                        follow(&mut next.height_m, n, Some(&base.height_m), part.next_s, speed);
                        follow(&mut next.speed_m_s, n, Some(&base.speed_m_s), part.next_s, gain);
                    },
                );
            },
        );
    }

    /// out = x (1 + drag dt/2) + dt^2/4 pull(-x), per mass: what an implicit step has to invert.
    pub fn resist(&self, simd: SimdClass, dt_s: f32, x: &[f32], out: &mut [f32]) {
        let (reach, own) = (self.reach(), 1.0 + 0.5 * dt_s * self.drag_per_s);
        let stiff_s2 = 0.25 * dt_s * dt_s;
        simd.vectorize(
            #[inline(always)]
            || {
                self.blocks(
                    #[inline(always)]
                    |n| {
                        let (pull, here) = (self.pull(x, &reach, n), block(x, n));
                        put(
                            out,
                            n,
                            each(
                                #[inline(always)]
                                |i| own * here[i] - stiff_s2 * pull[i],
                            ),
                        );
                    },
                );
            },
        );
    }

    /// The pull at `x`, over the mass of a node.
    pub fn pull_m_s2(&self, simd: SimdClass, x: &[f32], out: &mut [f32]) {
        let reach = self.reach();
        simd.vectorize(
            #[inline(always)]
            || {
                self.blocks(
                    #[inline(always)]
                    |n| put(out, n, self.pull(x, &reach, n)),
                );
            },
        );
    }

    /// The liquid under the sheet cannot be compressed: what sinks here rises there.
    pub fn keep_volume(&self, values: &mut [f32]) {
        let sum: f64 = values.iter().map(|v| f64::from(*v)).sum();
        let mean = (sum / self.wet_count.max(1) as f64) as f32;
        values.iter_mut().zip(&self.wet).for_each(|(value, wet)| *value -= wet * mean);
    }

    /// The nodes of a padded array as those of the lattice.
    pub fn copy_out(&self, from: &[f32], out: &mut [f32]) {
        for (k, out) in out.chunks_exact_mut(self.nodes[0]).enumerate() {
            out.copy_from_slice(&from[PAD + self.row * (k + PAD)..][..self.nodes[0]]);
        }
    }

    /// Energy in joules: of motion, and half of each height times what pulls there.
    pub fn energy_j(&self, motion: &Motion) -> f64 {
        let mut pull_m_s2 = vec![0.0; self.len];
        self.pull_m_s2(SimdClass::Portable, &motion.height_m, &mut pull_m_s2);
        let speeds = motion.speed_m_s.iter().map(|v| f64::from(*v).powi(2)).sum::<f64>();
        let pairs = motion.height_m.iter().zip(&pull_m_s2);
        let stretched = pairs.map(|(y, pull)| f64::from(*y) * f64::from(*pull)).sum::<f64>();
        0.5 * (speeds - stretched) / f64::from(self.per_kg)
    }
}

/// to = base + part slope, or to += part slope.
#[inline(always)]
fn follow(to: &mut [f32], at: usize, base: Option<&[f32]>, part_s: f32, slope: Block) {
    let base = base.map_or_else(|| block(to, at), |base| block(base, at));
    put(
        to,
        at,
        each(
            #[inline(always)]
            |i| base[i] + part_s * slope[i],
        ),
    );
}

#[inline(always)]
fn block(values: &[f32], at: usize) -> Block {
    *values[at..].first_chunk().expect("padded by a block")
}

#[inline(always)]
fn put(values: &mut [f32], at: usize, block: Block) {
    values[at..at + BLOCK].copy_from_slice(&block);
}
