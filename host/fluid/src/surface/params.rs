//! What a surface is made of.

use super::AUTO;

/// What a surface is made of, by area, so that a finer grid is the same sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceParams {
    /// How it moves: a name of [`super::INDEX`], or [`AUTO`].
    pub model: &'static str,
    /// Nodes along the edge of a cell of the grid.
    pub nodes_per_cell: usize,
    /// Mass that moves with the surface: of springs only, waves have that of the liquid.
    pub areal_mass_kg_m2: f32,
    /// What gravity gives back for a height: of springs only, waves have that of the liquid.
    pub gravity_n_per_m3: f32,
    /// Tension: of structural springs two thirds, of shear springs one third; of waves the
    /// surface tension.
    pub tension_n_per_m: f32,
    /// Tension beside that: of springs only, which have no liquid below them to carry waves on.
    pub sheet_tension_n_per_m: f32,
    /// Part of the tension that the bend springs add: of springs only.
    pub bend: f32,
    /// Drag by area; of waves beside their viscous damping.
    pub drag_n_s_per_m3: f32,
    /// Faster than this it breaks and drops leave.
    pub tear_speed_m_s: f32,
    /// Steeper than this its crests break.
    pub tear_slope: f32,
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
    /// Clean water at 20 C (tension: IAPWS 1994), touched by a finger's tip. Of springs, which
    /// have no liquid below them, the mass is that of 2 cm of it.
    pub const WATER: Self = Self {
        model: AUTO,
        nodes_per_cell: 1,
        areal_mass_kg_m2: 20.0,
        gravity_n_per_m3: 9810.0,
        tension_n_per_m: 0.0728,
        sheet_tension_n_per_m: 0.0,
        bend: 0.0,
        drag_n_s_per_m3: 0.0,
        tear_speed_m_s: 0.6,
        tear_slope: 0.577,
        layer_decay_m: 0.05,
        contact_stiffness_n_per_m: 30.0,
        break_force_n: 0.1,
        pull_force_n: 0.1,
    };
}
