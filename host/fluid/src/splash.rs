//! What the surface cannot hold: drops leave where it rises too fast or stands too steep, fly, and
//! fall back into the liquid or over the rim (Mora 2008 names splashes and spills as missing).
//!
//! ```text
//! surface.tear -> drops -> fly -> surface.merge, flow.push, substances.give_back, or spilled
//! ```
//! A drop takes its volume, momentum and colour from where it leaves, and brings them to where it
//! falls. Of momentum the flow below has the horizontal part; the vertical one acts on the surface,
//! as the vessel bears it. While nothing breaks, this costs a look at the fastest and the highest
//! node, no more.

use glam::{DVec3, Vec3};

use crate::{
    solver::flow::Flow,
    substance::Substances,
    surface::{Surface, Weight},
    vessel::RIM_M,
};

/// Drops in the air at most: more do not leave.
const MOST: usize = 4096;

/// A drop in the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Droplet {
    /// Its middle.
    pub at_in_world_m: Vec3,
    /// Its velocity.
    pub velocity_m_s: Vec3,
    /// Its volume.
    pub volume_m3: f64,
}

impl Droplet {
    /// Radius of the ball that it is.
    #[must_use]
    pub fn radius_m(&self) -> f32 {
        (self.volume_m3 * 3.0 / (4.0 * std::f64::consts::PI)).cbrt() as f32
    }
}

/// What left, what came back, and how exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SplashBooks {
    /// Drops that left so far.
    pub drops: u64,
    /// Volume that left so far.
    pub left_m3: f64,
    /// Volume that fell back.
    pub merged_m3: f64,
    /// Volume that fell over the rim, or beyond all measure.
    pub spilled_m3: f64,
    /// Sum of |J| that drops took from the flow and brought to it.
    pub exchanged_n_s: f64,
    /// What all changes of the flow's momentum, measured, lack of all J: f32 kept it back, and the
    /// next drop brings it.
    pub open_n_s: f64,
    /// Energy that went over the rim: of motion, and of height above the surface at rest.
    pub spilled_j: f64,
    /// Energy that came from nowhere, as the surface had less than a drop lacked: below the
    /// surface at rest, where a surface that was set anew rose over it, or in what streamed faster
    /// than it fell in.
    pub lent_j: f64,
}

impl SplashBooks {
    /// What the books of momentum are open by, as a part of all that was exchanged.
    #[must_use]
    pub fn residual_rel(&self) -> f64 {
        if self.exchanged_n_s > 0.0 { self.open_n_s / self.exchanged_n_s } else { 0.0 }
    }
}

/// The drops of one pot.
pub struct Splash {
    weight: Weight,
    drops: Vec<Droplet>,
    /// Volumes of the substances in each drop, drop after drop.
    content_m3: Vec<f64>,
    /// Volume of each substance that was spilled.
    spilled_m3: Vec<f64>,
    /// Momentum that f32 kept back from the flow, given with the next.
    carried_n_s: DVec3,
    books: SplashBooks,
    torn: Vec<Droplet>,
}

/// What drops leave and fall into.
pub struct Below<'a> {
    /// The surface.
    pub surface: &'a mut Surface,
    /// The liquid.
    pub flow: &'a mut Flow,
    /// What is in it.
    pub substances: &'a mut Substances,
}

impl Splash {
    /// No drops, of a liquid of this density, under gravity downwards.
    #[must_use]
    pub fn new(density_kg_m3: f32, gravity_m_s2: f32) -> Self {
        Self {
            weight: Weight {
                density_kg_m3: density_kg_m3.into(),
                gravity_m_s2: gravity_m_s2.into(),
            },
            drops: Vec::new(),
            content_m3: Vec::new(),
            spilled_m3: Vec::new(),
            carried_n_s: DVec3::ZERO,
            books: SplashBooks::default(),
            torn: Vec::new(),
        }
    }

    /// The drops in the air.
    #[must_use]
    pub fn drops(&self) -> &[Droplet] {
        &self.drops
    }

    /// The books so far.
    #[must_use]
    pub fn books(&self) -> &SplashBooks {
        &self.books
    }

    /// Energy of a drop: of motion, and of height above the surface at rest.
    #[must_use]
    pub fn energy_j(&self, surface: &Surface, drop: &Droplet) -> f64 {
        let above_m = f64::from(drop.at_in_world_m.y - surface.rest_height_in_world_m());
        let moving = 0.5 * drop.velocity_m_s.as_dvec3().length_squared();
        let Weight { density_kg_m3, gravity_m_s2 } = self.weight;
        density_kg_m3 * drop.volume_m3 * (moving + gravity_m_s2 * above_m)
    }

    /// Volume in the air.
    #[must_use]
    pub fn airborne_m3(&self) -> f64 {
        self.drops.iter().map(|drop| drop.volume_m3).sum()
    }

    /// Volume of one substance in the air.
    #[must_use]
    pub fn content_m3(&self, substance: usize) -> f64 {
        let kinds = self.content_m3.len() / self.drops.len().max(1);
        self.content_m3.iter().skip(substance).step_by(kinds.max(1)).sum()
    }

    /// Volume of one substance that was spilled so far.
    #[must_use]
    pub fn spilled_m3(&self, substance: usize) -> f64 {
        self.spilled_m3.get(substance).copied().unwrap_or(0.0)
    }

    /// The volumes of all substances in a drop.
    #[must_use]
    pub fn content_of(&self, drop: usize) -> &[f64] {
        let kinds = self.content_m3.len() / self.drops.len().max(1);
        self.content_m3.get(drop * kinds..(drop + 1) * kinds).unwrap_or_default()
    }

    /// One step: drops fly on, some fall, others leave.
    pub fn step(&mut self, mut below: Below<'_>, dt_s: f32) {
        if !self.drops.is_empty() {
            self.fly(&mut below, dt_s);
        }
        let room = MOST - self.drops.len();
        below.surface.tear(dt_s, room, &mut self.torn);
        if !self.torn.is_empty() {
            self.leave(&mut below);
        }
        self.books.lent_j += below.surface.settle();
    }

    /// Lets those drops go that the surface has the energy for.
    fn leave(&mut self, below: &mut Below<'_>) {
        let mut spare_j = below.surface.spare_j();
        for n in 0..self.torn.len() {
            let drop = self.torn[n];
            let inside = self.inside(below, &drop);
            let taken_n_s = -self.momentum_n_s(&drop);
            let taken_j = below.flow.push_work_j(inside, 0.0, taken_n_s)
                - below.surface.brought_j(&drop, -1.0, self.weight);
            if taken_j <= spare_j {
                spare_j -= taken_j;
                below.substances.scoop(inside, drop.volume_m3, &mut self.content_m3);
                self.drops.push(drop);
                self.books.drops += 1;
                self.books.left_m3 += drop.volume_m3;
                below.surface.part(&drop, self.weight);
                self.push(below, inside, taken_n_s);
            }
        }
    }

    /// The part of its momentum that the flow has to do with.
    fn momentum_n_s(&self, drop: &Droplet) -> DVec3 {
        self.weight.density_kg_m3 * drop.volume_m3 * drop.velocity_m_s.with_y(0.0).as_dvec3()
    }

    /// Moves all drops; takes out what fell.
    fn fly(&mut self, below: &mut Below<'_>, dt_s: f32) {
        let kinds = self.content_m3.len() / self.drops.len();
        let mut n = 0;
        while n < self.drops.len() {
            match self.fall(below, n, dt_s) {
                Fate::Flies => n += 1,
                fate => {
                    let drop = self.drops.swap_remove(n);
                    let content = n * kinds..(n + 1) * kinds;
                    self.land(below, &drop, content.clone(), fate);
                    let last = self.content_m3.len() - kinds;
                    self.content_m3.copy_within(last.., content.start);
                    self.content_m3.truncate(last);
                }
            }
        }
    }

    /// Moves one drop, and says what becomes of it.
    fn fall(&mut self, below: &Below<'_>, n: usize, dt_s: f32) -> Fate {
        let drop = &mut self.drops[n];
        let (from, surface) = (drop.at_in_world_m, &below.surface);
        let fallen_m_s = self.weight.gravity_m_s2 as f32 * dt_s;
        drop.at_in_world_m += dt_s * (drop.velocity_m_s - 0.5 * fallen_m_s * Vec3::Y);
        drop.velocity_m_s.y -= fallen_m_s;
        if !drop.at_in_world_m.is_finite() {
            return Fate::Spills;
        }
        let rest_m = surface.rest_height_in_world_m();
        let lattice = surface.lattice();
        let is_below_rim = drop.at_in_world_m.y < rest_m + RIM_M;
        if lattice.is_over(drop.at_in_world_m) {
            let level_m = rest_m + surface.at(drop.at_in_world_m).0;
            let is_falling = drop.velocity_m_s.y <= 0.0;
            return if is_falling && drop.at_in_world_m.y <= level_m {
                Fate::Merges
            } else {
                Fate::Flies
            };
        }
        if !is_below_rim {
            return Fate::Flies;
        }
        if lattice.is_over(from) {
            // The wall takes what goes against it.
            (drop.at_in_world_m.x, drop.at_in_world_m.z) = (from.x, from.z);
            drop.velocity_m_s = drop.velocity_m_s.y * Vec3::Y;
            return Fate::Flies;
        }
        Fate::Spills
    }

    fn land(
        &mut self,
        below: &mut Below<'_>,
        drop: &Droplet,
        content: std::ops::Range<usize>,
        fate: Fate,
    ) {
        if fate == Fate::Spills {
            self.books.spilled_m3 += drop.volume_m3;
            self.books.spilled_j += self.energy_j(below.surface, drop);
            self.spilled_m3.resize(content.len(), 0.0);
            let spilled = self.spilled_m3.iter_mut().zip(&self.content_m3[content]);
            spilled.for_each(|(sum, content)| *sum += content);
            return;
        }
        self.books.merged_m3 += drop.volume_m3;
        let inside = self.inside(below, drop);
        below.surface.merge(drop, self.weight);
        below.substances.give_back(inside, &self.content_m3[content]);
        self.push(below, inside, self.momentum_n_s(drop));
    }

    /// Gives the flow what it is owed, at the cost of the surface; what it took is measured from
    /// the grid.
    fn push(&mut self, below: &mut Below<'_>, at: Vec3, impulse_n_s: DVec3) {
        let owed = impulse_n_s + self.carried_n_s;
        below.surface.spend(below.flow.push_work_j(at, 0.0, owed));
        let Ok(change) = below.flow.push(at, 0.0, owed) else { return };
        self.carried_n_s = owed - change;
        self.books.exchanged_n_s += impulse_n_s.length();
        self.books.open_n_s = self.carried_n_s.length();
    }

    /// The middle of the topmost cell below a drop.
    fn inside(&self, below: &Below<'_>, drop: &Droplet) -> Vec3 {
        let half_m = 0.5 * below.flow.grid().spacing_m;
        drop.at_in_world_m.with_y(below.surface.rest_height_in_world_m() - half_m)
    }
}

/// What becomes of a drop in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Flies,
    Merges,
    Spills,
}

#[cfg(test)]
mod tests;
