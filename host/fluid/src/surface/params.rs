//! What a sheet is made of, and how fast that makes it.

/// RK4 is stable for |lambda| dt below this, with a margin.
pub(super) const STABLE: f32 = 2.5;
/// More sub-steps than this in a step of 10 ms are refused when a scene is read.
pub(crate) const MOST_SUBSTEPS: f32 = 64.0;

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
    /// Force at which the surface lets go of a probe that comes out.
    pub pull_force_n: f32,
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
