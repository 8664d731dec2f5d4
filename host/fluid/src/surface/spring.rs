//! The mass-spring sheet of Mora 2008: masses that move up and down over a regular grid, held by
//! structural, shear and bend springs, gravity and drag, integrated by the classical RK4.
//!
//! For the height y of a node of mass m:
//!
//! ```text
//! m y'' = -k_g y + k_st sum4 (y' - y) + k_sh sum4 (y' - y) + k_b sum4 (y' - y) - b y' + F
//! ```
//!
//! where the sums run over the neighbours beside, across the corner, and two away. By Gershgorin
//! no frequency is above omega^2 = (k_g + 2 * 4 (k_st + k_sh + k_b)) / m, and no eigenvalue is
//! larger than max(omega, b / m). RK4 is stable in a half disc of radius 2.6 (Hairer & Wanner
//! 1996, fig. IV.2.1), so sub-steps of 2.5 / max(omega, b / m) are, always.

use glam::Vec3;

use super::{
    motion::Motion,
    params::{MOST_SUBSTEPS, STABLE, SurfaceParams},
};
use crate::{grid::Grid, snapshot::SurfaceView, vessel::Vessel};

/// A probe presses on the nodes around it, however small it is.
const LEAST_RADIUS_NODES: f32 = 1.5;
/// Heights and speeds below this are rest, so that rest costs nothing.
const REST_M: f32 = 1e-8;

/// The sheet.
#[derive(Clone, Debug)]
pub struct SpringSheet {
    params: SurfaceParams,
    nodes: [usize; 2],
    spacing_m: f32,
    origin_in_world_m: Vec3,
    /// Nodes over the liquid; the others do not move and pull at nothing.
    wet: Vec<bool>,
    wet_count: usize,
    motion: Motion,
    force_n: Vec<f32>,
    damping_n_s_per_m: Vec<f32>,
    /// Nodes under the probe and their weights; kept for its room.
    under: Vec<(usize, f32)>,
    asleep: bool,
    stage: Motion,
    slope: Motion,
    sum: Motion,
}

impl SpringSheet {
    /// Memory that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let motions = [&self.motion, &self.stage, &self.slope, &self.sum];
        let values = motions.map(|m| m.height_m.len() + m.speed_m_s.len()).iter().sum::<usize>();
        let nodes = values + self.force_n.len() + self.damping_n_s_per_m.len();
        nodes * size_of::<f32>() + self.wet.len()
    }

    /// A sheet at rest on the top of the grid's box, one node on each cell corner.
    #[must_use]
    pub fn new(params: SurfaceParams, grid: &Grid, vessel: &Vessel) -> Self {
        let [nx, ny, nz] = grid.cells;
        let nodes = [nx + 1, nz + 1];
        let len = nodes[0] * nodes[1];
        let rise = Vec3::Y * (ny as f32 * grid.spacing_m);
        let origin = grid.origin_in_world_m + rise;
        let wet: Vec<bool> = (0..len)
            .map(|n| {
                let (i, k) = (n % nodes[0], n / nodes[0]);
                let at = origin + grid.spacing_m * Vec3::new(i as f32, 0.0, k as f32);
                vessel.depth_inside_m(at) > 0.0
            })
            .collect();
        Self {
            params,
            nodes,
            spacing_m: grid.spacing_m,
            origin_in_world_m: origin,
            wet_count: wet.iter().filter(|w| **w).count(),
            wet,
            motion: Motion::zeros(len),
            force_n: vec![0.0; len],
            damping_n_s_per_m: vec![0.0; len],
            under: Vec::with_capacity(len),
            asleep: true,
            stage: Motion::zeros(len),
            slope: Motion::zeros(len),
            sum: Motion::zeros(len),
        }
    }

    /// What the sheet is made of.
    #[must_use]
    pub fn params(&self) -> &SurfaceParams {
        &self.params
    }

    /// True while nothing moves, and a step costs nothing.
    #[must_use]
    pub fn is_asleep(&self) -> bool {
        self.asleep
    }

    /// World y of the surface at rest.
    #[must_use]
    pub fn rest_height_in_world_m(&self) -> f32 {
        self.origin_in_world_m.y
    }

    /// What a probe of some radius does to the surface at a world place during the next step: it
    /// pushes by a vertical force in newtons, and damps what is under it. Nodes under the probe
    /// share both, most in its middle; what is not finite, or beside the liquid, is left out.
    pub fn touch(
        &mut self,
        at_in_world_m: Vec3,
        radius_m: f32,
        force_n: f32,
        damping_n_s_per_m: f32,
    ) {
        let finite = force_n.is_finite() && damping_n_s_per_m.is_finite() && radius_m.is_finite();
        let idle = force_n == 0.0 && self.asleep;
        if !finite || idle || !at_in_world_m.is_finite() {
            return;
        }
        self.find_under(at_in_world_m, radius_m);
        let total: f32 = self.under.iter().map(|(_, weight)| weight).sum();
        for &(node, weight) in &self.under {
            self.force_n[node] += force_n * weight / total;
            self.damping_n_s_per_m[node] += damping_n_s_per_m.max(0.0) * weight / total;
            self.asleep = false;
        }
    }

    /// Wet nodes under a probe and their weights, which fall from 1 in its middle to 0.
    fn find_under(&mut self, at_in_world_m: Vec3, radius_m: f32) {
        let at = (at_in_world_m - self.origin_in_world_m) / self.spacing_m;
        let radius = (radius_m / self.spacing_m).max(LEAST_RADIUS_NODES);
        self.under.clear();
        for k in near(at.z, radius, self.nodes[1]) {
            for i in near(at.x, radius, self.nodes[0]) {
                let (x, z) = (i as f32 - at.x, k as f32 - at.z);
                let weight = 1.0 - (x * x + z * z) / (radius * radius);
                let node = i + self.nodes[0] * k;
                if weight > 0.0 && self.wet[node] {
                    self.under.push((node, weight));
                }
            }
        }
    }

    /// Height above rest and vertical speed at a world place, in m and m/s.
    #[must_use]
    pub fn at(&self, at_in_world_m: Vec3) -> (f32, f32) {
        if self.asleep {
            return (0.0, 0.0);
        }
        self.around(at_in_world_m).into_iter().fold((0.0, 0.0), |(y, v), (node, share)| {
            let motion = &self.motion;
            (y + share * motion.height_m[node], v + share * motion.speed_m_s[node])
        })
    }

    /// The four nodes around a place and their bilinear shares; of a place beside the sheet,
    /// those at its edge.
    fn around(&self, at_in_world_m: Vec3) -> [(usize, f32); 4] {
        let from = (at_in_world_m - self.origin_in_world_m) / self.spacing_m;
        let along = |x: f32, n: usize| {
            let held = x.max(0.0).min((n - 1) as f32);
            let node = (held as usize).min(n - 2);
            (node, held - node as f32)
        };
        let (i, x) = along(from.x, self.nodes[0]);
        let (k, z) = along(from.z, self.nodes[1]);
        let first = i + self.nodes[0] * k;
        let row = self.nodes[0];
        [
            (first, (1.0 - x) * (1.0 - z)),
            (first + 1, x * (1.0 - z)),
            (first + row, (1.0 - x) * z),
            (first + row + 1, x * z),
        ]
    }

    /// One step of `dt_s`; the sub-steps it took, none while asleep. A step that would need
    /// more than the scene was checked for moves the sheet for a shorter time instead.
    pub fn step(&mut self, dt_s: f32) -> u32 {
        if self.asleep {
            return 0;
        }
        let most_s = STABLE / self.fastest_per_s();
        let substeps = (dt_s / most_s).ceil().clamp(1.0, 8.0 * MOST_SUBSTEPS);
        let sub_s = (dt_s / substeps).min(most_s);
        for _ in 0..substeps as u32 {
            self.runge_kutta(sub_s);
        }
        self.keep_volume();
        self.force_n.fill(0.0);
        self.damping_n_s_per_m.fill(0.0);
        self.rest_if_still();
        substeps as u32
    }

    /// The largest eigenvalue with what a probe damps.
    fn fastest_per_s(&self) -> f32 {
        let area_m2 = self.spacing_m * self.spacing_m;
        let damping = self.damping_n_s_per_m.iter().fold(0.0, |most: f32, d| most.max(*d));
        let drag = self.params.drag_n_s_per_m3 + damping / area_m2;
        self.params.fastest_per_s(self.spacing_m).max(drag / self.params.areal_mass_kg_m2)
    }

    /// Kutta 1901: the slope at the begin, twice in the middle, at the end.
    fn runge_kutta(&mut self, dt_s: f32) {
        self.sum.set(&self.motion, 0.0, &self.motion);
        self.slope_at(Stage::Begin);
        for (weight, reach, next) in [
            (1.0 / 6.0, 0.5, true),
            (1.0 / 3.0, 0.5, true),
            (1.0 / 3.0, 1.0, true),
            (1.0 / 6.0, 0.0, false),
        ] {
            self.sum.add(weight * dt_s, &self.slope);
            if next {
                self.stage.set(&self.motion, reach * dt_s, &self.slope);
                self.slope_at(Stage::Within);
            }
        }
        std::mem::swap(&mut self.motion, &mut self.sum);
    }

    fn slope_at(&mut self, stage: Stage) {
        let at = match stage {
            Stage::Begin => &self.motion,
            Stage::Within => &self.stage,
        };
        let area_m2 = self.spacing_m * self.spacing_m;
        let per_mass = 1.0 / (self.params.areal_mass_kg_m2 * area_m2);
        let gravity = self.params.gravity_n_per_m3 * area_m2;
        let drag = self.params.drag_n_s_per_m3 * area_m2;
        for k in 0..self.nodes[1] {
            for i in 0..self.nodes[0] {
                let n = i + self.nodes[0] * k;
                if !self.wet[n] {
                    continue;
                }
                let force_n = self.force_n[n] + self.springs_n(&at.height_m, i, k)
                    - gravity * at.height_m[n]
                    - (drag + self.damping_n_s_per_m[n]) * at.speed_m_s[n];
                self.slope.height_m[n] = at.speed_m_s[n];
                self.slope.speed_m_s[n] = force_n * per_mass;
            }
        }
    }

    /// The pull of a node's springs.
    fn springs_n(&self, height_m: &[f32], i: usize, k: usize) -> f32 {
        let tension = self.params.tension_n_per_m;
        let own = height_m[i + self.nodes[0] * k];
        let mut pull = 0.0;
        for (stiffness, way) in [
            (tension * (2.0 / 3.0), BESIDE),
            (tension / 6.0, ACROSS),
            (tension * self.params.bend, TWO_AWAY),
        ] {
            let mut sum = 0.0;
            for (di, dk) in way {
                if let Some(n) = self.neighbour(i, k, di, dk) {
                    sum += height_m[n] - own;
                }
            }
            pull += stiffness * sum;
        }
        pull
    }

    fn neighbour(&self, i: usize, k: usize, di: isize, dk: isize) -> Option<usize> {
        let i = i.checked_add_signed(di).filter(|i| *i < self.nodes[0])?;
        let k = k.checked_add_signed(dk).filter(|k| *k < self.nodes[1])?;
        let n = i + self.nodes[0] * k;
        self.wet[n].then_some(n)
    }

    /// The liquid under the sheet cannot be compressed: what sinks here rises there.
    fn keep_volume(&mut self) {
        let wet_count = self.wet_count as f64;
        for values in [&mut self.motion.height_m, &mut self.motion.speed_m_s] {
            let sum: f64 = values.iter().map(|v| f64::from(*v)).sum();
            let mean = (sum / wet_count) as f32;
            for (value, wet) in values.iter_mut().zip(&self.wet) {
                if *wet {
                    *value -= mean;
                }
            }
        }
    }

    fn rest_if_still(&mut self) {
        let still = |values: &[f32]| values.iter().all(|v| v.abs() < REST_M);
        if still(&self.motion.height_m) && still(&self.motion.speed_m_s) {
            self.motion.height_m.fill(0.0);
            self.motion.speed_m_s.fill(0.0);
            self.asleep = true;
        }
    }

    /// Energy of the sheet in joules: of motion, of height, and of its springs.
    #[must_use]
    pub fn energy_j(&self) -> f64 {
        let area = f64::from(self.spacing_m) * f64::from(self.spacing_m);
        let heights = &self.motion.height_m;
        let mut sum = 0.0;
        for k in 0..self.nodes[1] {
            for i in 0..self.nodes[0] {
                let n = i + self.nodes[0] * k;
                let (y, v) = (f64::from(heights[n]), f64::from(self.motion.speed_m_s[n]));
                let kinetic = f64::from(self.params.areal_mass_kg_m2) * area * v * v;
                let lifted = f64::from(self.params.gravity_n_per_m3) * area * y * y;
                // Each spring is met from both its ends: half of y times its pull, summed.
                let stretched = -y * f64::from(self.springs_n(heights, i, k));
                sum += if self.wet[n] { 0.5 * (kinetic + lifted + stretched) } else { 0.0 };
            }
        }
        sum
    }

    /// What is drawn.
    #[must_use]
    pub fn view(&self) -> SurfaceView {
        SurfaceView {
            nodes: self.nodes,
            spacing_m: self.spacing_m,
            origin_in_world_m: [self.origin_in_world_m.x, self.origin_in_world_m.z],
            rest_height_in_world_m: self.origin_in_world_m.y,
            height_m: self.motion.height_m.clone(),
            layer_decay_m: self.params.layer_decay_m,
        }
    }
}

/// Nodes along an axis within `radius` of a place, all in node spacings.
fn near(at: f32, radius: f32, nodes: usize) -> std::ops::Range<usize> {
    // A float to integer cast saturates.
    let first = (at - radius).ceil().max(0.0) as usize;
    let end = ((at + radius).floor() + 1.0).max(0.0) as usize;
    first.min(nodes)..end.min(nodes)
}

#[derive(Clone, Copy)]
enum Stage {
    Begin,
    Within,
}

const BESIDE: [(isize, isize); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];
const ACROSS: [(isize, isize); 4] = [(-1, -1), (1, -1), (-1, 1), (1, 1)];
const TWO_AWAY: [(isize, isize); 4] = [(-2, 0), (2, 0), (0, -2), (0, 2)];

#[cfg(test)]
mod tests;
