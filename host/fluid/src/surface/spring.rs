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
//! 1996, fig. IV.2.1), so sub-steps of 2.5 / max(omega, b / m) are, always. Where that were too
//! many, a single implicit step is taken instead ([`implicit`]), which is stable whatever it is.

mod implicit;
mod springs;

use self::{
    implicit::Implicit,
    springs::{Motion, Part, Springs},
};
use super::{Answer, Basin, Lattice, Load, Model, ModelRow, SurfaceParams};
use crate::{simd::SimdClass, solver::SetupError};

pub(super) const ROW: ModelRow = ModelRow {
    name: "spring",
    about: "masses and springs, RK4 (Mora 2008)",
    fits: |_, _| Ok(()),
    make: |params, lattice, basin| Ok(Box::new(SpringSheet::new(params, lattice, basin)?)),
};

/// RK4 is stable for |lambda| dt below this, with a margin.
const STABLE: f32 = 2.5;

/// More sub-steps than this are not taken.
const MOST_SUBSTEPS: f32 = 64.0;

/// The sheet.
pub(super) struct SpringSheet {
    springs: Springs,
    simd: SimdClass,
    motion: Motion,
    /// Acceleration by what acts.
    load_m_s2: Vec<f32>,
    stage: Motion,
    next: Motion,
    sum: Motion,
    /// Work space of implicit steps, if there has been one.
    implicit: Option<Box<Implicit>>,
}

impl SpringSheet {
    fn new(
        params: &SurfaceParams,
        lattice: &Lattice,
        basin: &Basin<'_>,
    ) -> Result<Self, SetupError> {
        let springs = Springs::new(params, lattice)?;
        let zeros = || Motion::zeros(springs.len());
        Ok(Self {
            simd: basin.simd,
            motion: zeros(),
            load_m_s2: vec![0.0; springs.len()],
            stage: zeros(),
            next: zeros(),
            sum: zeros(),
            implicit: None,
            springs,
        })
    }

    /// Sets accelerations; kicks and dampers act at once.
    fn take(&mut self, dt_s: f32, load: Load<'_>) {
        let Self { springs, motion, load_m_s2, .. } = self;
        load_m_s2.fill(0.0);
        let per_kg = springs.per_kg;
        // What impulses gave to the mean speed: the volume does not let it be.
        let mut mean_m_s = 0.0;
        for touch in load.touches {
            // A push on all nodes alike would move nothing. If it is on all of them, what is not
            // alike may be so small a part of it that it is told here, before it is rounded.
            let level = springs.common_share(&touch.under);
            let beside = if level > 0.0 { 0.0 } else { springs.all_per_kg() };
            let mean_m_s_there = if level > 0.0 { 0.0 } else { mean_m_s };
            let mut answer = Answer { speed_m_s: -mean_m_s_there, per_kg: -beside };
            for &(node, share) in &touch.under {
                let (share, speed) = (f64::from(share) - level, motion.speed_m_s[springs.at(node)]);
                answer.speed_m_s += share * f64::from(speed);
                answer.per_kg += share * share * f64::from(per_kg);
            }
            let act = touch.act(answer, dt_s);
            mean_m_s += act.impulse_n_s * beside;
            for &(node, share) in &touch.under {
                let at = springs.at(node);
                let per_kg = (f64::from(share) - level) * f64::from(per_kg);
                motion.speed_m_s[at] += (act.impulse_n_s * per_kg) as f32;
                load_m_s2[at] += (act.force_n * per_kg) as f32;
            }
        }
        for (node, force_n) in load.force_n.unwrap_or_default().iter().enumerate() {
            load_m_s2[springs.at(node)] += force_n * per_kg;
        }
        springs.keep_volume(load_m_s2);
        springs.keep_volume(&mut motion.speed_m_s);
    }

    /// Kutta 1901: the slope at the begin, twice in the middle, at the end.
    fn runge_kutta(&mut self, dt_s: f32) {
        let Self { springs, simd, motion, load_m_s2, stage, next, sum, .. } = self;
        sum.copy(motion);
        stage.copy(motion);
        for (weight, reach) in
            [(1.0 / 6.0, 0.5), (1.0 / 3.0, 0.5), (1.0 / 3.0, 1.0), (1.0 / 6.0, 0.0)]
        {
            let part = Part { sum_s: weight * dt_s, next_s: reach * dt_s };
            springs.follow_slope(*simd, [stage, motion], load_m_s2, part, [sum, next]);
            std::mem::swap(stage, next);
        }
        std::mem::swap(motion, sum);
    }
}

impl Model for SpringSheet {
    fn step(&mut self, dt_s: f32, load: Load<'_>) -> u32 {
        self.take(dt_s, load);
        let substeps = (dt_s * self.springs.fastest_per_s() / STABLE).ceil().max(1.0);
        if substeps <= MOST_SUBSTEPS {
            for _ in 0..substeps as u32 {
                self.runge_kutta(dt_s / substeps);
            }
        } else {
            let len = self.springs.len();
            let implicit = self.implicit.get_or_insert_with(|| Box::new(Implicit::new(len)));
            implicit.step(&self.springs, self.simd, &mut self.motion, &self.load_m_s2, dt_s);
        }
        self.springs.keep_volume(&mut self.motion.height_m);
        self.springs.keep_volume(&mut self.motion.speed_m_s);
        if substeps <= MOST_SUBSTEPS { substeps as u32 } else { 1 }
    }

    fn read(&mut self, height_m: &mut [f32], speed_m_s: &mut [f32]) {
        self.springs.copy_out(&self.motion.height_m, height_m);
        self.springs.copy_out(&self.motion.speed_m_s, speed_m_s);
    }

    fn state(&mut self) -> [&mut Vec<f32>; 2] {
        [&mut self.motion.height_m, &mut self.motion.speed_m_s]
    }

    fn add(&mut self, height_m: &[f32], speed_m_s: &[f32]) {
        let Motion { height_m: own_m, speed_m_s: own_m_s } = &mut self.motion;
        for (own, more) in [(own_m, height_m), (own_m_s, speed_m_s)] {
            for (node, more) in more.iter().enumerate() {
                own[self.springs.at(node)] += more * f32::from(u8::from(self.springs.is_wet(node)));
            }
            self.springs.keep_volume(own);
        }
    }

    fn raise(&mut self, height_m: &[f32]) {
        for (node, height_m) in height_m.iter().enumerate().filter(|(n, _)| self.springs.is_wet(*n))
        {
            self.motion.height_m[self.springs.at(node)] += height_m;
        }
        self.springs.keep_volume(&mut self.motion.height_m);
    }

    fn strike(&mut self, impulse_n_s: &[f32], times: f32) {
        let per_kg = times * self.springs.per_kg;
        let nodes = impulse_n_s.iter().enumerate();
        for (node, impulse_n_s) in nodes.filter(|(node, _)| self.springs.is_wet(*node)) {
            self.motion.speed_m_s[self.springs.at(node)] += impulse_n_s * per_kg;
        }
        self.springs.keep_volume(&mut self.motion.speed_m_s);
    }

    fn energy_j(&self) -> f64 {
        self.springs.energy_j(&self.motion)
    }

    fn bytes(&self) -> usize {
        let motions = [&self.motion, &self.stage, &self.next, &self.sum];
        let implicit = self.implicit.as_ref().map_or(0, |implicit| implicit.bytes());
        self.springs.bytes()
            + motions.map(Motion::bytes).iter().sum::<usize>()
            + implicit
            + size_of_val(self.load_m_s2.as_slice())
    }
}

#[cfg(test)]
mod tests;
