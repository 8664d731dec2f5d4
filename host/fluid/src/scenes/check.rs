//! What a scene may say: every number finite and in its range, checked once, where it enters.

use std::fmt;

use glam::Vec3;

use super::{Act, Gas, Scene};
use crate::{force::Floating, surface::SurfaceParams, vessel::Vessel};

/// The range of a number, both ends in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Least.
    pub least: f32,
    /// Most.
    pub most: f32,
}

impl Bound {
    /// From `least` to `most`.
    #[must_use]
    pub const fn new(least: f32, most: f32) -> Self {
        Self { least, most }
    }

    /// True if `value` is a number in the range.
    #[must_use]
    pub fn holds(&self, value: f32) -> bool {
        value >= self.least && value <= self.most
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "must be from {} to {}", self.least, self.most)
    }
}

/// A value that a scene may not have.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrong {
    /// Which, by the name it has in a scene file.
    pub key: String,
    /// What it is.
    pub value: String,
    /// What it must be.
    pub must: String,
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}: {}", self.key, self.value, self.must)
    }
}

/// What a spring that the device renders of a liquid may have at the hand.
const STIFFEST_N_PER_M: f32 = 2000.0;

/// Cells along an axis, and in all: a step of more would not fit into any frame.
const CELLS: Bound = Bound::new(1.0, 512.0);
const MOST_CELLS: usize = 128 * 128 * 128;

/// Nodes of a surface in all.
const MOST_NODES: usize = 512 * 512;

impl Scene {
    /// Checks every number.
    ///
    /// # Errors
    /// [`Wrong`]: the first that is not finite, out of its range, or does not fit the others.
    pub fn check(&self) -> Result<(), Wrong> {
        self.check_space()?;
        self.check_matter()?;
        self.surface.as_ref().map_or(Ok(()), |s| check_surface(s, self))?;
        self.gas.as_ref().map_or(Ok(()), |gas| self.check_gas(gas))?;
        self.check_feel()?;
        self.check_floating()?;
        self.check_story()
    }

    fn check_space(&self) -> Result<(), Wrong> {
        for cells in self.grid.cells {
            number("grid.cells", cells as f32, CELLS)?;
        }
        let all = self.grid.cells.iter().product::<usize>();
        if all > MOST_CELLS {
            return Err(wrong("grid.cells", &all, format!("at most {MOST_CELLS} in all")));
        }
        number("grid.spacing_m", self.grid.spacing_m, Bound::new(1e-4, 1.0))?;
        place("grid.origin_m", self.grid.origin_in_world_m)?;
        self.check_vessel()?;
        number("step_s", self.step_s, Bound::new(1e-3, 0.1))
    }

    fn check_vessel(&self) -> Result<(), Wrong> {
        let (low, high) =
            (self.grid.origin_in_world_m, self.grid.origin_in_world_m + self.grid.extent_m());
        match self.vessel {
            Vessel::Box => return Ok(()),
            Vessel::Pot { centre_in_world_m, radius_m } => {
                place("vessel.centre_m", centre_in_world_m)?;
                let widest = 0.5 * self.grid.extent_m().max_element();
                number("vessel.radius_m", radius_m, Bound::new(1e-3, widest))?;
                let inside = centre_in_world_m.clamp(low, high) == centre_in_world_m;
                if !inside {
                    let must = format!("must be in the grid's box, from {low} to {high}");
                    return Err(wrong("vessel.centre_m", &centre_in_world_m, must));
                }
                return Ok(());
            }
            Vessel::Bowl { centre_in_world_m, radius_m } => {
                place("vessel.centre_m", centre_in_world_m)?;
                number("vessel.radius_m", radius_m, Bound::new(1e-3, 100.0))?;
            }
            Vessel::Cylinder { centre_in_world_m, axis, radius_m } => {
                place("vessel.centre_m", centre_in_world_m)?;
                place("vessel.axis", axis)?;
                number("vessel.axis", axis.length(), Bound::new(1e-3, 200.0))?;
                number("vessel.radius_m", radius_m, Bound::new(1e-3, 100.0))?;
            }
            Vessel::Distance(_) => {}
        }
        let top = |at: &Vec3| at.y > high.y - 0.5 * self.grid.spacing_m;
        if self.grid.corners().filter(top).all(|at| self.vessel.depth_inside_m(at) <= 0.0) {
            let must = "must reach up to the rest surface, the top of the grid's box".to_string();
            return Err(wrong("vessel", &format!("no liquid at y = {} m", high.y), must));
        }
        Ok(())
    }

    fn check_matter(&self) -> Result<(), Wrong> {
        if let Some(liquid) = &self.liquid {
            number("liquid.density_kg_m3", liquid.density_kg_m3, Bound::new(0.1, 2e4))?;
            number("liquid.viscosity_m2_s", liquid.viscosity_m2_s, Bound::new(0.0, 1e4))?;
            number("liquid.gravity_m_s2", liquid.gravity_m_s2, Bound::new(0.0, 1e3))?;
            colour("liquid.colour", liquid.colour)?;
        }
        for substance in &self.substances {
            if let Some(density) = substance.density_kg_m3 {
                number("substance.density_kg_m3", density, Bound::new(0.1, 2e4))?;
            }
            if let Some(viscosity) = substance.viscosity_m2_s {
                number("substance.viscosity_m2_s", viscosity, Bound::new(0.0, 1e4))?;
            }
            colour("substance.colour", substance.colour)?;
            let diffusivity = substance.diffusivity_m2_s;
            number("substance.diffusivity_m2_s", diffusivity, Bound::new(0.0, 1.0))?;
            place("substance.pour_at_m", substance.pour_at_m)?;
            number("substance.pour_radius_m", substance.pour_radius_m, Bound::new(1e-4, 1.0))?;
            number("substance.pour_per_s", substance.pour_per_s, Bound::new(0.0, 1e3))?;
        }
        Ok(())
    }

    fn check_gas(&self, gas: &Gas) -> Result<(), Wrong> {
        gas.check()?;
        let all = gas.grid_over(&self.grid).cells.iter().product::<usize>();
        let must = format!("at most {MOST_CELLS} cells in all: as high as these are few");
        if all > MOST_CELLS { Err(wrong("gas.height_m", &gas.height_m, must)) } else { Ok(()) }
    }

    fn check_feel(&self) -> Result<(), Wrong> {
        let feel = &self.feel;
        let half_edge_m = 0.5 * self.grid.extent_m().min_element();
        let room_m = match self.vessel {
            Vessel::Box => half_edge_m,
            Vessel::Pot { radius_m, .. } => radius_m.min(half_edge_m),
            _ => self.vessel.greatest_depth_m(&self.grid).min(half_edge_m),
        };
        number("probe.radius_m", self.probe.radius_m, Bound::new(1e-4, 0.8 * room_m))?;
        let density = self.probe.density_kg_m3.unwrap_or(1.0);
        number("probe.density_kg_m3", density, Bound::new(0.1, 2e4))?;
        number("feel.felt_scale", feel.felt_scale, Bound::new(1e-3, 1e3))?;
        number("feel.scale", feel.world_from_device.scale, Bound::new(1e-2, 1e2))?;
        place("feel.offset_m", feel.world_from_device.offset_m.into())?;
        number("feel.wall_stiffness_n_per_m", feel.wall_stiffness_n_per_m, Bound::new(0.0, 1e4))?;
        number("feel.wall_damping_n_s_per_m", feel.wall_damping_n_s_per_m, Bound::new(0.0, 100.0))
    }

    /// A probe that floats is a spring at the hand, and the device renders only so stiff a one.
    fn check_floating(&self) -> Result<(), Wrong> {
        let Some(density_kg_m3) = self.probe.density_kg_m3 else { return Ok(()) };
        let floating = Floating::of(self).map_or(0.0, |f| f.stiffness_n_per_m() as f32);
        let at_the_hand = floating * self.feel.felt_scale * self.feel.world_from_device.scale;
        if at_the_hand <= STIFFEST_N_PER_M {
            return Ok(());
        }
        let must = format!(
            "what has a density floats too stiffly: {at_the_hand} N/m at the hand, at most \
             {STIFFEST_N_PER_M}; lower feel.felt_scale or probe.radius_m"
        );
        Err(wrong("probe.density_kg_m3", &density_kg_m3, must))
    }

    fn check_story(&self) -> Result<(), Wrong> {
        place("story.start_m", self.story.start_m)?;
        for act in &self.story.acts {
            number("story.seconds", act.seconds(), Bound::new(0.0, 1e6))?;
            match *act {
                Act::Reach { to_m, .. } => place("story.to_m", to_m)?,
                Act::Stir { centre_m, radius_m, .. } => {
                    place("story.centre_m", centre_m)?;
                    number("story.radius_m", radius_m, Bound::new(0.0, 1.0))?;
                }
                Act::Rest { .. } | Act::LetGo { .. } => {}
            }
        }
        for poke in &self.story.pokes {
            place("story.pokes.at_m", poke.at_m)?;
            number("story.pokes.radius_m", poke.radius_m, Bound::new(1e-4, 1.0))?;
            number("story.pokes.force_n", poke.force_n, Bound::new(-1e4, 1e4))?;
            number("story.pokes.from_s", poke.from_s, Bound::new(0.0, 1e6))?;
            number("story.pokes.to_s", poke.to_s, Bound::new(poke.from_s, 1e6))?;
        }
        for pour in &self.story.pours {
            let substances = self.substances.len();
            if pour.substance >= substances || pour.substance >= 8 {
                let must = format!("the scene has {substances} substances, counted from 0");
                return Err(wrong("story.pours.substance", &pour.substance, must));
            }
            number("story.pours.from_s", pour.from_s, Bound::new(0.0, 1e6))?;
            number("story.pours.to_s", pour.to_s, Bound::new(pour.from_s, 1e6))?;
        }
        Ok(())
    }
}

fn check_surface(surface: &SurfaceParams, scene: &Scene) -> Result<(), Wrong> {
    const STIFF: Bound = Bound::new(0.0, 1e7);
    number("surface.nodes_per_cell", surface.nodes_per_cell as f32, Bound::new(1.0, 16.0))?;
    let [nx, _, nz] = scene.grid.cells.map(|n| n * surface.nodes_per_cell);
    if nx * nz > MOST_NODES {
        let must = format!("{nx} x {nz} nodes: at most {MOST_NODES} in all");
        return Err(wrong("surface.nodes_per_cell", &surface.nodes_per_cell, must));
    }
    number("surface.areal_mass_kg_m2", surface.areal_mass_kg_m2, Bound::new(1e-3, 1e4))?;
    number("surface.gravity_n_per_m3", surface.gravity_n_per_m3, STIFF)?;
    number("surface.tension_n_per_m", surface.tension_n_per_m, STIFF)?;
    number("surface.sheet_tension_n_per_m", surface.sheet_tension_n_per_m, STIFF)?;
    number("surface.bend", surface.bend, Bound::new(0.0, 10.0))?;
    number("surface.drag_n_s_per_m3", surface.drag_n_s_per_m3, STIFF)?;
    number("surface.tear_speed_m_s", surface.tear_speed_m_s, Bound::new(0.01, 1e6))?;
    number("surface.tear_slope", surface.tear_slope, Bound::new(0.05, 1e6))?;
    number("surface.layer_decay_m", surface.layer_decay_m, Bound::new(1e-4, 1e3))?;
    number("surface.contact_stiffness_n_per_m", surface.contact_stiffness_n_per_m, STIFF)?;
    number("surface.break_force_n", surface.break_force_n, STIFF)?;
    number("surface.pull_force_n", surface.pull_force_n, STIFF)?;
    let at_the_hand = scene.feel.felt_scale * scene.feel.world_from_device.scale;
    let stiffest = STIFFEST_N_PER_M / at_the_hand;
    let stiffness = surface.contact_stiffness_n_per_m;
    number("surface.contact_stiffness_n_per_m", stiffness, Bound::new(0.0, stiffest))?;
    if scene.liquid.is_none() {
        return Err(wrong("surface", &"on", "a surface needs a [liquid]".into()));
    }
    if let Err(why) = crate::surface::choose(surface.model, &scene.vessel, &scene.grid) {
        let must = format!("must be auto or spring in this vessel: {why}");
        return Err(wrong("surface.model", &surface.model, must));
    }
    Ok(())
}

pub(crate) fn number(key: &str, value: f32, bound: Bound) -> Result<(), Wrong> {
    if bound.holds(value) { Ok(()) } else { Err(wrong(key, &value, bound.to_string())) }
}

fn place(key: &str, at_m: Vec3) -> Result<(), Wrong> {
    at_m.to_array().into_iter().try_for_each(|x| number(key, x, Bound::new(-100.0, 100.0)))
}

pub(super) fn colour(key: &str, rgb: Vec3) -> Result<(), Wrong> {
    rgb.to_array().into_iter().try_for_each(|c| number(key, c, Bound::new(0.0, 1.0)))
}

fn wrong(key: &str, value: &dyn fmt::Display, must: String) -> Wrong {
    Wrong { key: key.into(), value: value.to_string(), must }
}
