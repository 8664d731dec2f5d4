//! Waves that die drag the liquid along: of the momentum rho eta grad phi that they carry by area,
//! what viscosity takes goes to the flow below, as a stress on it (Longuet-Higgins 1969)
//!
//! ```text
//! tau = rho (eta_f grad phi + eta grad phi_f),    eta_f = sum of gamma_j a_j psi_j, phi_f likewise
//! ```

use glam::Vec2;

use super::Surface;

/// What the model tells of its fading at the nodes.
#[derive(Default)]
pub struct Fading {
    /// How fast heights fade, in m/s.
    pub height_m_s: Vec<f32>,
    /// Potential, in m^2/s.
    pub potential: Vec<f32>,
    /// How fast that fades, in m^2/s^2.
    pub potential_per_s: Vec<f32>,
    /// How much energy fades, in watts.
    pub power_w: f64,
    /// Stress over density at each node, in m^2/s^2.
    stress: Vec<Vec2>,
}

impl Fading {
    fn resize(&mut self, nodes: usize) {
        for field in [&mut self.height_m_s, &mut self.potential, &mut self.potential_per_s] {
            field.resize(nodes, 0.0);
        }
        self.stress.resize(nodes, Vec2::ZERO);
    }
}

impl Surface {
    /// Finds the stress that fading waves put on what is below, over its density and along x and
    /// z. Returns the largest magnitude; 0 at rest, for a model that has no below, and, as it is
    /// not looked for then, if it is surely not above `least_m2_s2`: what was found before stays.
    pub fn find_drift(&mut self, least_m2_s2: f32) -> f32 {
        if self.asleep || self.model.most_drift_m2_s2(self.extremes[1]) <= least_m2_s2 {
            return 0.0;
        }
        let Self { fading, lattice, model, height_m, .. } = self;
        fading.resize(lattice.len());
        if !model.fade(fading) {
            return 0.0;
        }
        let mut largest: f32 = 0.0;
        for (node, here_m) in height_m.iter().enumerate().filter(|(n, _)| lattice.wet[*n]) {
            let beside = lattice.beside(node);
            let slope = |field: &[f32]| {
                let [x, z] = beside.map(|[before, after]| field[after] - field[before]);
                Vec2::new(x, z) / (2.0 * lattice.spacing_m)
            };
            let stress = fading.height_m_s[node] * slope(&fading.potential)
                + *here_m * slope(&fading.potential_per_s);
            fading.stress[node] = stress;
            largest = largest.max(stress.abs().max_element());
        }
        largest
    }

    /// The power that fades, as was found last: what drifts gets no more of it.
    #[must_use]
    pub fn drift_w(&self) -> f64 {
        self.fading.power_w
    }

    /// The stress that was found last, at a place; 0 before.
    #[must_use]
    pub fn drift_m2_s2(&self, at_in_world_m: glam::Vec3) -> Vec2 {
        if self.fading.stress.is_empty() {
            return Vec2::ZERO;
        }
        self.lattice.between(&self.fading.stress, at_in_world_m)
    }
}
