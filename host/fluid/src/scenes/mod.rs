//! Scenes: what is in the pot, how it is felt, and what the hand does with it.
//!
//! A scene is one file here and one row in [`INDEX`], or a TOML file that starts from one of
//! them ([`read`]).

mod cauldron;
mod check;
mod empty;
mod file;
mod fumes;
mod gas;
mod keys;
mod pond;
mod start;
mod taylor_green;
mod whirl;

pub(crate) use check::number;
pub use check::{Bound, Wrong};
pub use file::{SceneError, find, read};
pub use gas::Gas;
pub use start::{Start, Whirl};

use cauldron_protocol::{WorldFromDevice, message::Modes};
use glam::Vec3;

use crate::{grid::Grid, solver::Walls, surface::SurfaceParams, vessel::Vessel};

/// A row of the index.
#[derive(Clone, Copy)]
pub struct SceneRow {
    /// Name on the command line.
    pub name: &'static str,
    /// What it shows and what it switches on.
    pub about: &'static str,
    /// Makes it.
    pub make: fn() -> Scene,
}

/// Every scene that ships.
pub const INDEX: &[SceneRow] =
    &[cauldron::ROW, empty::ROW, fumes::ROW, pond::ROW, taylor_green::ROW, whirl::ROW];

/// A scene: plain data, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name.
    pub name: String,
    /// One line for people.
    pub about: String,
    /// The box of cells.
    pub grid: Grid,
    /// What holds the liquid.
    pub vessel: Vessel,
    /// The liquid, if there is any.
    pub liquid: Option<Liquid>,
    /// What can be poured in.
    pub substances: Vec<Substance>,
    /// The surface, if there is one.
    pub surface: Option<SurfaceParams>,
    /// The gas above the liquid, if it is to be computed.
    pub gas: Option<Gas>,
    /// How the liquid moves at first.
    pub start: Start,
    /// What the hand holds.
    pub probe: Probe,
    /// How it is felt.
    pub feel: Feel,
    /// Length of a step; a field is sent after each.
    pub step_s: f32,
    /// What the hand does.
    pub story: Story,
}

impl Scene {
    /// Cuts the same box into `n` cells along its longest edge, and as many along the others as
    /// keep them cubes.
    pub fn regrid(&mut self, n: usize) {
        let longest = self.grid.cells.into_iter().max().unwrap_or(1);
        let cells = |cells: usize| ((cells * n + longest / 2) / longest).max(1);
        self.grid.spacing_m *= longest as f32 / n as f32;
        self.grid.cells = self.grid.cells.map(cells);
    }
}

/// Standard gravity (CGPM 1901).
pub const GRAVITY_M_S2: f32 = 9.806_65;

/// A liquid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Liquid {
    /// Density.
    pub density_kg_m3: f32,
    /// Kinematic viscosity.
    pub viscosity_m2_s: f32,
    /// Gravity, downwards: it acts on what is denser or lighter.
    pub gravity_m_s2: f32,
    /// What happens at the vessel's wall.
    pub walls: Walls,
    /// Linear RGB, 0 to 1.
    pub colour: Vec3,
}

/// Something that can be poured in.
#[derive(Clone, Debug, PartialEq)]
pub struct Substance {
    /// Name.
    pub name: String,
    /// Linear RGB, 0 to 1.
    pub colour: Vec3,
    /// Density; `None` if it is the liquid's.
    pub density_kg_m3: Option<f32>,
    /// Kinematic viscosity; `None` if it is the liquid's.
    pub viscosity_m2_s: Option<f32>,
    /// Molecular diffusivity.
    pub diffusivity_m2_s: f32,
    /// Where it is poured, in world metres.
    pub pour_at_m: Vec3,
    /// How wide the jet is.
    pub pour_radius_m: f32,
    /// Volume fraction that a second of pouring adds in the jet's middle.
    pub pour_per_s: f32,
}

/// What the hand holds in the medium: a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Its radius in world metres.
    pub radius_m: f32,
    /// Its density, which gives it weight and lets it float; `None` if it is weightless and
    /// nothing buoys it up.
    pub density_kg_m3: Option<f32>,
}

/// How the pot is felt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feel {
    /// Felt newtons for a physical one. It multiplies the hand's force and nothing else: the
    /// books of the fluid are in physical units.
    pub felt_scale: f32,
    /// Where the hand's space lies in the world.
    pub world_from_device: WorldFromDevice,
    /// Which force modes act.
    pub modes: Modes,
    /// Stiffness of the vessel, at the hand.
    pub wall_stiffness_n_per_m: f32,
    /// Damping of the vessel, at the hand.
    pub wall_damping_n_s_per_m: f32,
}

/// What the hand does, in world metres; afterwards it stays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Story {
    /// Where it begins.
    pub start_m: Vec3,
    /// One thing after the other.
    pub acts: Vec<Act>,
    /// What is poured when: button i pours substance i.
    pub pours: Vec<Pour>,
    /// What else presses on the surface.
    pub pokes: Vec<Poke>,
}

/// Something beside the hand that presses on the surface from one moment to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Poke {
    /// Where, in world metres; its height does not matter.
    pub at_m: Vec3,
    /// How wide it is.
    pub radius_m: f32,
    /// Its force upwards, in physical newtons: below zero it presses.
    pub force_n: f32,
    /// When it begins.
    pub from_s: f32,
    /// When it ends.
    pub to_s: f32,
}

/// One thing a hand does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// Goes there in a straight line.
    Reach {
        /// World metres.
        to_m: Vec3,
        /// Duration.
        seconds: f32,
    },
    /// Stays.
    Rest {
        /// Duration.
        seconds: f32,
    },
    /// Lets go of the handle, and takes hold of it again at the end.
    LetGo {
        /// Duration.
        seconds: f32,
    },
    /// Draws circles as a person drew them.
    Stir {
        /// Middle of the circles in world metres.
        centre_m: Vec3,
        /// Their mean radius.
        radius_m: f32,
        /// Duration.
        seconds: f32,
    },
}

impl Act {
    /// How long it takes.
    #[must_use]
    pub fn seconds(&self) -> f32 {
        match *self {
            Self::Reach { seconds, .. }
            | Self::Rest { seconds }
            | Self::LetGo { seconds }
            | Self::Stir { seconds, .. } => seconds,
        }
    }
}

/// A substance poured from one moment to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pour {
    /// Which, by its place in the scene.
    pub substance: usize,
    /// When the pouring begins.
    pub from_s: f32,
    /// When it ends.
    pub to_s: f32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_that_ships_passes_its_own_checks() {
        for row in INDEX {
            let scene = (row.make)();
            assert_eq!(scene.name, row.name);
            assert_eq!(scene.check(), Ok(()), "{}", row.name);
        }
    }

    #[test]
    fn a_finer_grid_is_the_same_box() {
        let coarse = (INDEX[0].make)();
        let mut fine = coarse.clone();
        fine.regrid(48);
        assert_eq!(fine.grid.cells, [48; 3]);
        assert!((fine.grid.extent_m() - coarse.grid.extent_m()).length() < 1e-6);
        assert_eq!(fine.check(), Ok(()));
    }

    #[test]
    fn names_differ() {
        for (i, a) in INDEX.iter().enumerate() {
            assert!(INDEX.iter().skip(i + 1).all(|b| a.name != b.name));
        }
    }
}
