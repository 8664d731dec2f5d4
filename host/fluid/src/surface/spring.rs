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

use crate::{grid::Grid, snapshot::SurfaceView, vessel::Vessel};

/// RK4 is stable for |lambda| dt below this, with a margin.
const STABLE: f32 = 2.5;
/// More sub-steps than this in a step of 10 ms are refused when a scene is read.
pub(crate) const MOST_SUBSTEPS: f32 = 64.0;
/// Heights and speeds below this are rest, so that rest costs nothing.
const REST_M: f32 = 1e-8;

/// What the sheet is made of, by area, so that a finer grid is the same sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceParams {
    /// Mass that moves with the surface.
    pub areal_mass_kg_m2: f32,
    /// What gravity gives back for a height: density times g for a liquid.
    pub gravity_n_per_m3: f32,
    /// Tension of structural and shear springs together; two thirds and one third of it.
    pub tension_n_per_m: f32,
    /// Part of the tension that the bend springs add.
    pub bend: f32,
    /// Drag by area.
    pub drag_n_s_per_m3: f32,
    /// Depth at which a layer below moves 1/e as far as the surface.
    pub layer_decay_m: f32,
    /// Stiffness of the surface under the probe.
    pub contact_stiffness_n_per_m: f32,
    /// Force at which the probe breaks through.
    pub break_force_n: f32,
}

impl SurfaceParams {
    /// Largest eigenvalue of the sheet at a node spacing, in 1/s.
    #[must_use]
    pub fn fastest_per_s(&self, spacing_m: f32) -> f32 {
        let area_m2 = spacing_m * spacing_m;
        let springs = self.tension_n_per_m * (2.0 / 3.0 + 1.0 / 6.0 + self.bend);
        let omega2 =
            (self.gravity_n_per_m3 * area_m2 + 8.0 * springs) / (self.areal_mass_kg_m2 * area_m2);
        omega2.sqrt().max(self.drag_n_s_per_m3 / self.areal_mass_kg_m2)
    }

    /// Sub-steps that a step of `dt_s` needs, as a number that may be large.
    #[must_use]
    pub fn substeps(&self, spacing_m: f32, dt_s: f32) -> f32 {
        (self.fastest_per_s(spacing_m) * dt_s / STABLE).ceil().max(1.0)
    }
}

/// Heights and speeds of the nodes; both in the sheet and in the four slopes of RK4.
#[derive(Clone, Debug, Default)]
struct Motion {
    height_m: Vec<f32>,
    speed_m_s: Vec<f32>,
}

impl Motion {
    fn zeros(len: usize) -> Self {
        Self { height_m: vec![0.0; len], speed_m_s: vec![0.0; len] }
    }

    /// self = base + factor * slope
    fn set(&mut self, base: &Self, factor: f32, slope: &Self) {
        let pairs = [
            (&mut self.height_m, &base.height_m, &slope.height_m),
            (&mut self.speed_m_s, &base.speed_m_s, &slope.speed_m_s),
        ];
        for (to, from, by) in pairs {
            for ((to, from), by) in to.iter_mut().zip(from).zip(by) {
                *to = from + factor * by;
            }
        }
    }

    /// self += factor * slope
    fn add(&mut self, factor: f32, slope: &Self) {
        let pairs =
            [(&mut self.height_m, &slope.height_m), (&mut self.speed_m_s, &slope.speed_m_s)];
        for (to, by) in pairs {
            for (to, by) in to.iter_mut().zip(by) {
                *to += factor * by;
            }
        }
    }
}

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
    asleep: bool,
    stage: Motion,
    slope: Motion,
    sum: Motion,
}

impl SpringSheet {
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

    /// A vertical force in newtons on the surface at a world place, for the next step. It is
    /// shared by the four nodes around, so that it moves smoothly from one to the next; what is
    /// not finite, or beside the liquid, is left out.
    pub fn press(&mut self, at_in_world_m: Vec3, force_n: f32) {
        if !force_n.is_finite() || force_n == 0.0 {
            return;
        }
        for (node, share) in self.around(at_in_world_m) {
            if self.wet[node] {
                self.force_n[node] += share * force_n;
                self.asleep = false;
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
        let substeps = self.params.substeps(self.spacing_m, dt_s).min(8.0 * MOST_SUBSTEPS);
        let most_s = STABLE / self.params.fastest_per_s(self.spacing_m);
        let sub_s = (dt_s / substeps).min(most_s);
        for _ in 0..substeps as u32 {
            self.runge_kutta(sub_s);
        }
        self.keep_volume();
        self.force_n.fill(0.0);
        self.rest_if_still();
        substeps as u32
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
                    - drag * at.speed_m_s[n];
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

#[derive(Clone, Copy)]
enum Stage {
    Begin,
    Within,
}

const BESIDE: [(isize, isize); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];
const ACROSS: [(isize, isize); 4] = [(-1, -1), (1, -1), (-1, 1), (1, 1)];
const TWO_AWAY: [(isize, isize); 4] = [(-2, 0), (2, 0), (0, -2), (0, 2)];

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: SurfaceParams = SurfaceParams {
        areal_mass_kg_m2: 20.0,
        gravity_n_per_m3: 9810.0,
        tension_n_per_m: 5.0,
        bend: 0.0,
        drag_n_s_per_m3: 0.0,
        layer_decay_m: 0.05,
        contact_stiffness_n_per_m: 30.0,
        break_force_n: 0.1,
    };

    fn sheet(params: SurfaceParams) -> SpringSheet {
        let grid = Grid { cells: [16, 8, 16], spacing_m: 0.01, origin_in_world_m: Vec3::ZERO };
        SpringSheet::new(params, &grid, &Vessel::Box)
    }

    /// Sets the standing wave cos(pi i / 16) that the free edges allow as a sine of twice the
    /// length, and the frequency that the discrete sheet gives it by its own law.
    fn tilted(params: SurfaceParams) -> SpringSheet {
        let mut sheet = sheet(params);
        for n in 0..sheet.motion.height_m.len() {
            sheet.motion.height_m[n] = 1e-3 * (0.5 - (n % 17) as f32 / 16.0);
        }
        sheet.asleep = false;
        sheet
    }

    #[test]
    fn gravity_alone_swings_every_node_at_its_frequency() {
        let mut sheet = tilted(SurfaceParams { tension_n_per_m: 0.0, ..WATER });
        let omega = (9810.0_f64 / 20.0).sqrt();
        let start = f64::from(sheet.motion.height_m[0]);
        for step in 1..=50 {
            sheet.step(4e-3);
            let exact = start * (omega * 4e-3 * f64::from(step)).cos();
            let error = f64::from(sheet.motion.height_m[0]) - exact;
            assert!(error.abs() < 2e-3 * start, "step {step}: {error}");
        }
    }

    #[test]
    fn halving_the_step_divides_the_error_by_sixteen() {
        let params = SurfaceParams { tension_n_per_m: 0.0, ..WATER };
        let omega = (9810.0_f64 / 20.0).sqrt();
        let error = |dt_s: f32, steps: u32| {
            let mut sheet = tilted(params);
            (0..steps).for_each(|_| sheet.runge_kutta(dt_s));
            let (sin, cos) = (omega * f64::from(dt_s) * f64::from(steps)).sin_cos();
            let height = f64::from(sheet.motion.height_m[0]) - 5e-4 * cos;
            let speed = f64::from(sheet.motion.speed_m_s[0]) + 5e-4 * omega * sin;
            height.hypot(speed / omega)
        };
        let order = (error(0.02, 16) / error(0.01, 32)).log2();
        assert!((3.8..4.2).contains(&order), "{order}");
    }

    #[test]
    fn energy_never_grows_and_drag_brings_rest() {
        let mut sheet = tilted(SurfaceParams { drag_n_s_per_m3: 60.0, bend: 0.1, ..WATER });
        let mut energy = sheet.energy_j();
        assert!(energy > 0.0);
        for _ in 0..4000 {
            sheet.step(10e-3);
            let now = sheet.energy_j();
            assert!(now <= energy * (1.0 + 1e-5), "{now} after {energy}");
            energy = now;
        }
        assert!(sheet.is_asleep());
        assert_eq!(sheet.step(10e-3), 0, "sleep costs nothing");
    }

    #[test]
    fn volume_stays_whatever_presses() {
        let mut sheet = sheet(WATER);
        for step in 0..100 {
            sheet.press(Vec3::new(0.05 + 1e-4 * step as f32, 0.0, 0.07), -0.3);
            sheet.step(10e-3);
            let volume: f64 = sheet.motion.height_m.iter().map(|y| f64::from(*y)).sum();
            assert!(volume.abs() < 1e-6, "{volume}");
        }
        assert!(sheet.at(Vec3::new(0.06, 0.0, 0.07)).0 < -1e-4, "pressed in");
    }

    #[test]
    fn nothing_blows_up() {
        for (tension, dt_s, force) in [(1e7, 1.0, 1e4), (5.0, 1.0, 1e4), (0.0, 1e-5, 1e-9)] {
            let mut sheet = sheet(SurfaceParams { tension_n_per_m: tension, ..WATER });
            for _ in 0..20 {
                sheet.press(Vec3::splat(0.08), force);
                sheet.press(Vec3::splat(f32::NAN), f32::NAN);
                sheet.step(dt_s);
            }
            assert!(sheet.motion.height_m.iter().all(|y| y.is_finite()), "{tension} {dt_s}");
        }
    }

    #[test]
    fn beside_the_pot_nothing_moves() {
        let grid = Grid {
            cells: [16, 8, 16],
            spacing_m: 0.01,
            origin_in_world_m: Vec3::new(-0.08, -0.08, -0.08),
        };
        let pot = Vessel::Pot { centre_in_world_m: Vec3::ZERO, radius_m: 0.07 };
        let mut sheet = SpringSheet::new(WATER, &grid, &pot);
        for _ in 0..30 {
            sheet.press(Vec3::ZERO, -0.2);
            sheet.step(10e-3);
        }
        assert_eq!(sheet.motion.height_m[0], 0.0);
        assert!(sheet.at(Vec3::ZERO).0 < 0.0);
    }
}
