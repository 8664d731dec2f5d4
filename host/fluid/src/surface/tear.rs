//! Where the surface breaks, and how what falls comes back to it.
//!
//! A node tears where it rises faster than [`SurfaceParams::tear_speed_m_s`], or stands above a
//! neighbour by more than [`SurfaceParams::tear_slope`] allows: Stokes' steepest wave has a slope
//! of tan 30 degrees at its crest (Stokes 1880). What leaves is the layer that is too fast or too
//! high, and leaves along the normal, if the surface has the energy that it takes along. Together
//! drops may be heavier than the liquid that gives or takes their momentum at once: so what they
//! give up to the surface is bounded by its energy, which is never more than it was, with what fell
//! in and without what left; the vessel bears the rest of the vertical momentum, as it bears the
//! weight. So, but for rounding and [`crate::splash::SplashBooks::lent_j`], of all that drops do
//!
//! ```text
//! E(surface) + E(level) + E(drops) + E(flow) does not grow,   E(level) = rho g A y^2 / 2
//! ```

use glam::Vec3;

use super::Surface;
use crate::splash::Droplet;

/// Thickest layer that leaves a node in a step, in spacings: where it is too fast, and too high.
const THICKEST: [f32; 2] = [0.2, 4.0];

/// Thinner layers do not leave: drops would be dust.
const THINNEST: f32 = 0.002;

/// What makes a volume heavy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Density of the liquid.
    pub density_kg_m3: f64,
    /// Gravity, downwards.
    pub gravity_m_s2: f64,
}

/// What drops change, until it is settled; empty before the first.
#[derive(Default)]
pub struct Change {
    height_m: Vec<f32>,
    impulse_n_s: Vec<f32>,
    volume_m3: f64,
    /// What drops brought, without what they took, and what the level and the flow took of it.
    energy_j: f64,
    is_open: bool,
}

impl Change {
    fn open(&mut self, nodes: usize) -> &mut Self {
        if !self.is_open {
            self.height_m.clear();
            self.height_m.resize(nodes, 0.0);
            self.impulse_n_s.clear();
            self.impulse_n_s.resize(nodes, 0.0);
            (self.is_open, self.volume_m3, self.energy_j) = (true, 0.0, 0.0);
        }
        self
    }
}

impl Surface {
    /// Finds where the surface breaks in a step, at most `most` places: `torn` are the drops that
    /// would leave there. Those that do are to be told by [`Surface::part`].
    pub fn tear(&self, dt_s: f32, most: usize, torn: &mut Vec<Droplet>) {
        torn.clear();
        let [fastest_m_s, highest_m] = self.extremes;
        let steepest_m = self.params.tear_slope * self.lattice.spacing_m;
        let may_tear = fastest_m_s > self.params.tear_speed_m_s || 2.0 * highest_m > steepest_m;
        if self.asleep || !may_tear {
            return;
        }
        for node in 0..self.lattice.len() {
            if torn.len() == most {
                return;
            }
            torn.extend(self.torn_at(node, dt_s, steepest_m));
        }
    }

    fn torn_at(&self, node: usize, dt_s: f32, steepest_m: f32) -> Option<Droplet> {
        if !self.lattice.wet[node] {
            return None;
        }
        let (height_m, speed_m_s) = (self.height_m[node], self.speed_m_s[node]);
        let [x, z] = self.lattice.beside(node).map(|pair| pair.map(|n| self.height_m[n]));
        let lowest_m = [x, z].as_flattened().iter().fold(height_m, |low, y| low.min(*y));
        let too_fast_m = (speed_m_s - self.params.tear_speed_m_s).max(0.0) * dt_s;
        // Only a crest falls off: in a slope the liquid beside holds it.
        let is_crest = [x, z].iter().all(|[before, after]| height_m >= before.max(*after));
        let too_high_m = if is_crest { height_m - lowest_m - steepest_m } else { 0.0 };
        let spacing_m = self.lattice.spacing_m;
        let [of_speed_m, of_height_m] = THICKEST.map(|most| most * spacing_m);
        let thick_m = too_fast_m.min(of_speed_m).max((0.5 * too_high_m).min(of_height_m));
        if thick_m < THINNEST * spacing_m {
            return None;
        }
        let slope = [x, z].map(|[before, after]| 0.5 * (after - before) / spacing_m);
        let normal = Vec3::new(-slope[0], 1.0, -slope[1]);
        let steep = 1.0 + slope[0] * slope[0] + slope[1] * slope[1];
        // What a rising surface moves by is its speed along the normal.
        let velocity_m_s = normal * (speed_m_s.max(0.0) / steep);
        let at_in_world_m =
            self.lattice.in_world_m(node) + (self.level_m() + height_m + thick_m) * Vec3::Y;
        let volume_m3 = f64::from(thick_m * self.lattice.node_m2());
        Some(Droplet { at_in_world_m, velocity_m_s, volume_m3 })
    }

    /// Energy that the surface has to spare for drops: all of its own, and what others brought
    /// since it settled.
    #[must_use]
    pub fn spare_j(&self) -> f64 {
        let brought_j = if self.change.is_open { self.change.energy_j } else { 0.0 };
        self.model.energy_j() + brought_j
    }

    /// Energy that a drop of some density brings to the surface, or, with `times` -1, takes from
    /// it: what it moves and stands with, less what raises the level.
    #[must_use]
    pub fn brought_j(&self, drop: &Droplet, times: f64, weight: Weight) -> f64 {
        let Weight { density_kg_m3, gravity_m_s2 } = weight;
        let above_m = f64::from(drop.at_in_world_m.y - self.rest_height_in_world_m());
        let moving = 0.5 * drop.velocity_m_s.as_dvec3().length_squared();
        let volume_m3 = times * drop.volume_m3;
        let rise_m = volume_m3 / self.wet_m2;
        let changed_m3 = if self.change.is_open { self.change.volume_m3 } else { 0.0 };
        let level_m = self.level_m + changed_m3 / self.wet_m2 + 0.5 * rise_m;
        density_kg_m3 * volume_m3 * (moving + gravity_m_s2 * (above_m - level_m))
    }

    /// A drop falls into the surface; what it brings is there after [`Surface::settle`].
    pub fn merge(&mut self, drop: &Droplet, weight: Weight) {
        let mut under = std::mem::take(&mut self.under);
        self.lattice.find_under(drop.at_in_world_m, drop.radius_m(), &mut under);
        self.bring(&under, drop, 1.0, weight);
        self.under = under;
    }

    /// A drop leaves the surface; what it takes is gone after [`Surface::settle`].
    pub fn part(&mut self, drop: &Droplet, weight: Weight) {
        let node = self.lattice.nearest(drop.at_in_world_m);
        self.bring(&[(node, 1.0)], drop, -1.0, weight);
    }

    /// Something else takes of what the surface has, with drops that merge or part.
    pub fn spend(&mut self, energy_j: f64) {
        self.change.open(self.lattice.len()).energy_j -= energy_j;
    }

    /// Adds a drop, or takes it away, at some nodes.
    fn bring(&mut self, under: &[(usize, f32)], drop: &Droplet, times: f64, weight: Weight) {
        let brought_j = self.brought_j(drop, times, weight);
        let volume_m3 = times * drop.volume_m3;
        let rise_m = (volume_m3 / f64::from(self.lattice.node_m2())) as f32;
        let speed_m_s = f64::from(drop.velocity_m_s.y);
        let impulse_n_s = (weight.density_kg_m3 * volume_m3 * speed_m_s) as f32;
        let change = self.change.open(self.lattice.len());
        for &(node, share) in under {
            change.height_m[node] += share * rise_m;
            change.impulse_n_s[node] += share * impulse_n_s;
        }
        change.volume_m3 += volume_m3;
        change.energy_j += brought_j;
    }

    /// Makes what drops changed true. Returns the energy in joules that they were lent, as the
    /// surface had less than was spent.
    pub fn settle(&mut self) -> f64 {
        if !self.change.is_open {
            return 0.0;
        }
        let lent_j = (-self.spare_j()).max(0.0);
        self.exchange();
        self.change.is_open = false;
        self.level_m += self.change.volume_m3 / self.wet_m2;
        self.asleep = false;
        self.look();
        lent_j
    }

    /// Changes heights, and gives as much of the impulses as leaves the energy within what there
    /// is: E(c) = E(0) + B c + A c^2 for a share c of them.
    fn exchange(&mut self) {
        let most_j = self.spare_j().max(0.0);
        let Self { model, change, .. } = self;
        model.raise(&change.height_m);
        let none_j = model.energy_j();
        model.strike(&change.impulse_n_s, 1.0);
        let all_j = model.energy_j();
        let mut left_j = all_j;
        if all_j > most_j {
            model.strike(&change.impulse_n_s, -2.0);
            let back_j = model.energy_j();
            let [a, b] = [0.5 * (all_j + back_j) - none_j, 0.5 * (all_j - back_j)];
            let least = if a > 0.0 { (-0.5 * b / a).clamp(0.0, 1.0) } else { 0.0 };
            let inside = b * b - 4.0 * a * (none_j - most_j);
            let share =
                if a > 0.0 && inside > 0.0 { (inside.sqrt() - b) / (2.0 * a) } else { least };
            let share = share.clamp(least, 1.0);
            model.strike(&change.impulse_n_s, (1.0 + share) as f32);
            left_j = model.energy_j();
        }
        if left_j > most_j {
            model.scale((most_j / left_j).sqrt() as f32);
        }
    }
}
