//! The modes of a vessel: cosines in a box, and tables of shapes in what is round.

use super::{Mode, cosines::Cosines};
use crate::{
    grid::Grid,
    solver::SetupError,
    surface::{
        Basin, Lattice,
        round::{Profile, Table},
    },
    vessel::Vessel,
};

/// The way between nodes and modes. Modes psi are such that the integral of psi^2 is 1; arrays of
/// modes have pads, whose lambda is 0 as that of the constant mode.
pub enum Basis {
    Box(Box<Cosines>),
    Round(Box<Table>),
}

/// Whether the modes of a vessel in the box of a grid are known.
pub fn fits(vessel: &Vessel, grid: &Grid) -> Result<(), SetupError> {
    if *vessel == Vessel::Box { Ok(()) } else { Profile::of_vessel(vessel, grid).map(|_| ()) }
}

impl Basis {
    /// The modes of what holds the liquid, and its greatest depth in metres.
    pub fn new(lattice: &Lattice, basin: &Basin<'_>) -> Result<(Self, f64), SetupError> {
        if *basin.vessel == Vessel::Box {
            let depth_m = basin.grid.cells[1] as f64 * f64::from(basin.grid.spacing_m);
            return Ok((Self::Box(Box::new(Cosines::new(lattice, basin.simd))), depth_m));
        }
        let profile = Profile::of_vessel(basin.vessel, basin.grid)?;
        let table = Table::new(&profile, lattice, basin.simd)?;
        Ok((Self::Round(Box::new(table)), profile.depth_m()))
    }

    pub fn bytes(&self) -> usize {
        match self {
            Self::Box(cosines) => cosines.bytes(),
            Self::Round(table) => table.bytes(),
        }
    }

    /// What no mode is above at any node.
    pub fn peak_per_m(&self) -> f32 {
        match self {
            Self::Box(cosines) => cosines.peak_per_m(),
            Self::Round(table) => table.peak_per_m(),
        }
    }

    /// All modes, in the order of arrays of them.
    pub fn modes(&self, depth_m: f64) -> Vec<Mode> {
        match self {
            Self::Box(cosines) => cosines.modes(depth_m).collect(),
            Self::Round(table) => table
                .waves()
                .iter()
                .map(|wave| Mode {
                    lambda_per_m: wave.lambda_per_m,
                    wavenumber_per_m: wave.wavenumber_per_m,
                    wavenumber_below_per_m: wave.wavenumber_below_per_m,
                })
                .collect(),
        }
    }

    /// Values at nodes times the area that each stands for.
    pub fn weigh(&self, values: &[f32], weighed: &mut [f32]) {
        match self {
            Self::Box(cosines) => cosines.weigh(values, weighed),
            Self::Round(table) => table.weigh(values, weighed),
        }
    }

    /// The sum over nodes of each value times each mode there.
    pub fn analyse(&mut self, nodal: &[f32], modes: &mut [f32]) {
        match self {
            Self::Box(cosines) => cosines.analyse(nodal, modes),
            Self::Round(table) => table.analyse(nodal, modes),
        }
    }

    /// As [`Basis::analyse`], of values at a few nodes.
    pub fn analyse_few(&mut self, few: &[(usize, f32)], modes: &mut [f32]) {
        match self {
            Self::Box(cosines) => cosines.analyse_few(few, modes),
            Self::Round(table) => table.analyse_few(few, modes),
        }
    }

    /// Of each array of modes the sum of all at each node.
    pub fn synthesise<const N: usize>(&mut self, modes: [&[f32]; N], nodal: [&mut [f32]; N]) {
        self.synthesise_long(modes, nodal, f64::INFINITY);
    }

    /// The same of modes that are 0 above a wavenumber.
    pub fn synthesise_long<const N: usize>(
        &mut self,
        modes: [&[f32]; N],
        nodal: [&mut [f32]; N],
        reach_per_m: f64,
    ) {
        match self {
            Self::Box(cosines) => {
                let pairs = modes.into_iter().zip(nodal);
                pairs.for_each(|(modes, nodal)| cosines.synthesise(modes, nodal, reach_per_m));
            }
            Self::Round(table) => table.synthesise(modes, nodal),
        }
    }
}
