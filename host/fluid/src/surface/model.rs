//! What moves a surface: the trait of all models, and their index.

use super::{Fading, Lattice, SurfaceParams, Touch, spring, wave};
use crate::{grid::Grid, simd::SimdClass, solver::SetupError, vessel::Vessel};

/// What a surface lies on.
#[derive(Clone, Copy)]
pub struct Basin<'a> {
    /// The box of cells below.
    pub grid: &'a Grid,
    /// What holds the liquid.
    pub vessel: &'a Vessel,
    /// Density of the liquid.
    pub density_kg_m3: f32,
    /// Kinematic viscosity of the liquid.
    pub viscosity_m2_s: f32,
    /// Gravity, downwards.
    pub gravity_m_s2: f32,
    /// The vector width to work at.
    pub simd: SimdClass,
}

impl<'a> Basin<'a> {
    /// Water at 20 C, under gravity of the earth.
    #[must_use]
    pub fn of_water(grid: &'a Grid, vessel: &'a Vessel) -> Self {
        Self {
            grid,
            vessel,
            density_kg_m3: 1000.0,
            viscosity_m2_s: 1e-6,
            gravity_m_s2: 9.81,
            simd: SimdClass::detect(),
        }
    }
}

/// What acts on a surface during a step.
#[derive(Clone, Copy, Default)]
pub struct Load<'a> {
    /// Bodies.
    pub touches: &'a [Touch],
    /// Upward force on each node, if there is any.
    pub force_n: Option<&'a [f32]>,
}

/// How a surface moves. Its arrays have a value for each node of the lattice it was made for;
/// those of dry nodes are 0.
pub trait Model: Send {
    /// Moves on by `dt_s`. Returns the number of steps it took.
    fn step(&mut self, dt_s: f32, load: Load<'_>) -> u32;

    /// Writes heights above rest in metres and vertical speeds in m/s, both without a mean.
    fn read(&mut self, height_m: &mut [f32], speed_m_s: &mut [f32]);

    /// Heights and speeds in the model's own terms. They move linearly: what acts on a sum of two
    /// may act on one of them, and their sum is the same.
    fn state(&mut self) -> [&mut Vec<f32>; 2];

    /// Writes the potential in m^2/s of what moves below along with the surface, and its vertical
    /// speed, in a layer of cells counted from the surface. False for a model that has no below.
    fn orbit(&mut self, _layer: usize, _potential: &mut [f32], _rising_m_s: &mut [f32]) -> bool {
        false
    }

    /// Writes how what it computes fades, into fields that have a value for each node. False for a
    /// model that has no below.
    fn fade(&mut self, _fading: &mut Fading) -> bool {
        false
    }

    /// What the stress that is made of [`Model::fade`] is surely not above, over density and in
    /// m^2/s^2, where no height is above `highest_m`; 0 for a model that has no below.
    fn most_drift_m2_s2(&self, _highest_m: f32) -> f32 {
        0.0
    }

    /// Adds to heights and speeds, as far as it can tell: their mean is left out.
    fn add(&mut self, height_m: &[f32], speed_m_s: &[f32]);

    /// Adds to heights, their mean left out.
    fn raise(&mut self, height_m: &[f32]);

    /// Gives `times` an upward impulse to each node.
    fn strike(&mut self, impulse_n_s: &[f32], times: f32);

    /// Multiplies heights and speeds, by 0 to be at rest.
    fn scale(&mut self, factor: f32) {
        // What is no number is to be 0 where all is.
        let scaled = |v: &mut f32| *v = if factor == 0.0 { 0.0 } else { *v * factor };
        self.state().into_iter().flatten().for_each(scaled);
    }

    /// Energy in joules: of motion, of height, and of tension.
    fn energy_j(&self) -> f64;

    /// Memory that it takes.
    fn bytes(&self) -> usize;
}

/// A row of the index.
#[derive(Clone, Copy)]
pub struct ModelRow {
    /// Name in scenes and on the command line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Says whether it knows of a vessel in the box of a grid; [`SetupError`] if it does not.
    pub fits: fn(&Vessel, &Grid) -> Result<(), SetupError>,
    /// Makes it.
    pub make: Make,
}

/// Makes a model at rest; [`SetupError`] if it knows nothing of such a vessel.
pub type Make = fn(&SurfaceParams, &Lattice, &Basin<'_>) -> Result<Box<dyn Model>, SetupError>;

/// Every model, the best first.
pub const INDEX: &[ModelRow] = &[wave::ROW, spring::ROW];

/// Stands for the best model that knows of the vessel.
pub const AUTO: &str = "auto";

/// What a model may be called.
pub fn names() -> impl Iterator<Item = &'static str> {
    std::iter::once(AUTO).chain(INDEX.iter().map(|row| row.name))
}

/// The model of a name for a vessel in the box of a grid.
///
/// # Errors
/// [`SetupError`] if there is no such model, or it does not know of such a vessel.
pub fn choose(name: &str, vessel: &Vessel, grid: &Grid) -> Result<&'static ModelRow, SetupError> {
    let mut refusal = SetupError::Unsupported("surface.model: there is no such model");
    for row in INDEX.iter().filter(|row| name == AUTO || name == row.name) {
        match (row.fits)(vessel, grid) {
            Ok(()) => return Ok(row),
            Err(why) => refusal = why,
        }
    }
    Err(refusal)
}
