//! The gas above the liquid: smoke that rises from it, and the warmth that carries the smoke.
//!
//! It is a second flow, in a box of its own that stands on the rest surface and is open on all
//! other sides. It sticks to the liquid, which carries it along; the liquid, a thousand times as
//! heavy, takes no notice. How waves lift the gas is part of the picture alone: as the layers
//! below, those above move with the surface, and nothing comes through it. Two things go with it:
//! smoke, which is seen and weighs nothing, and warmth, the fraction of a cell that is gas as hot
//! as it comes from the vents. At one pressure the density of an ideal gas goes as 1/T, and mixes
//! by volume:
//! ```text
//! rho = rho_0 (1 - w (1 - T_0 / T_1))        for warmth w of gas at T_1 in gas at T_0
//! ```
//! That is what [`crate::substance::mixture`] makes of a substance, and the flow of its weight.
//! Vents open at random places of the liquid's surface and ride on it (Mora 2008).

use std::sync::Arc;

use glam::{DVec3, Vec3};
use oorandom::Rand64;

use crate::{
    SmokeView,
    grid::Grid,
    plan::Item,
    pool::Pool,
    scenes::Gas,
    simd::SimdClass,
    solver::{Refused, Setup, SetupError, Side, Sides, Solver, StepReport, flow::Flow},
    substance::{Properties, Substances},
    vessel::Vessel,
};

/// How long a vent stays open before another opens elsewhere.
const VENT_S: f64 = 0.4;

/// Places that are tried for a vent: beside a narrow vessel none may be found.
const TRIES: usize = 16;

/// The same vents open in every run.
const SEED: u128 = 2008;

/// The gas above the liquid of one scene.
pub struct Air {
    gas: Gas,
    grid: Grid,
    vessel: Vessel,
    flow: Flow,
    smoke: Substances,
    /// `None` if what rises is no warmer than the rest.
    warmth: Option<Substances>,
    draws: Rand64,
    /// Where smoke comes from, on the surface at rest.
    vents_in_world_m: Vec<Vec3>,
    until_next_s: f64,
    is_carried: bool,
}

impl Air {
    /// Gas at rest above the liquid in `vessel`, whose box is `below`.
    ///
    /// # Errors
    /// [`SetupError`] if the gas makes no sense; one that has passed the check of its scene does.
    pub fn new(
        gas: &Gas,
        (below, vessel): (&Grid, &Vessel),
        gravity_m_s2: f32,
        pool: Arc<Pool>,
        simd: SimdClass,
    ) -> Result<Self, SetupError> {
        let grid = gas.grid_over(below);
        let setup = Setup {
            density_kg_m3: gas.density_kg_m3,
            viscosity_m2_s: gas.viscosity_m2_s,
            gravity_m_s2: Vec3::NEG_Y * gravity_m_s2,
            sides: Sides::all(Side::Outflow).with(1, [Side::Moving(Vec3::ZERO), Side::Outflow]),
            pool,
            simd,
            ..Setup::new(grid, Vessel::Box)
        };
        let mut flow = Flow::new(&setup)?;
        let like_gas =
            Properties { diffusivity_m2_s: gas.diffusivity_m2_s, ..Properties::of_liquid(&setup) };
        let ratio = gas.ambient_k / (gas.ambient_k + gas.hotter_k);
        let hot = Properties { density_kg_m3: gas.density_kg_m3 * ratio, ..like_gas };
        let warmth = (gas.hotter_k > 0.0).then(|| Substances::new(&setup, &[hot]));
        if let Some(warmth) = &warmth {
            flow.make_room_for(warmth);
        }
        Ok(Self {
            gas: *gas,
            grid,
            vessel: vessel.clone(),
            flow,
            smoke: Substances::new(&setup, &[like_gas]),
            warmth,
            draws: Rand64::new(SEED),
            vents_in_world_m: Vec::with_capacity(gas.vents),
            until_next_s: 0.0,
            is_carried: false,
        })
    }

    /// Its box of cells.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// How it moves.
    #[must_use]
    pub fn flow(&self) -> &Flow {
        &self.flow
    }

    /// The smoke in it: one substance.
    #[must_use]
    pub fn smoke(&self) -> &Substances {
        &self.smoke
    }

    /// Temperature of the cell that contains a point, in kelvin; beyond the box, that of the room.
    #[must_use]
    pub fn temperature_k(&self, point_in_world_m: Vec3) -> f32 {
        let Gas { ambient_k, hotter_k, .. } = self.gas;
        let warmth = self.warmth.as_ref().map_or(0.0, |w| w.fraction_at(0, point_in_world_m));
        // Of a mixture at one pressure, 1/T is what mixes by volume.
        ambient_k / (1.0 - warmth * (1.0 - ambient_k / (ambient_k + hotter_k)))
    }

    /// What is computed in each step that has any smoke or warmth, and what it takes.
    #[must_use]
    pub fn plan(&self) -> Vec<Item> {
        let bytes = |items: Vec<Item>| items.iter().map(|item| item.bytes).sum::<usize>();
        let [nx, ny, nz] = self.grid.cells;
        let warmth = self.warmth.as_ref().map(|w| ("lightens the gas", bytes(w.plan())));
        vec![
            Item::on("gas", format!("a flow of {nx} x {ny} x {nz} cells"), bytes(self.flow.plan())),
            Item::on("smoke", format!("{} vents", self.gas.vents), bytes(self.smoke.plan())),
            Item::if_any("warmth", warmth),
        ]
    }

    /// From now on the liquid carries the gas along that touches it, by its velocity in m/s at
    /// places of the border in world metres; `None` if it is at rest.
    ///
    /// # Errors
    /// [`Refused`] if a velocity is not finite, or above 1000 m/s; it goes on as it did.
    pub fn carry(&mut self, liquid_m_s: Option<&dyn Fn(DVec3) -> DVec3>) -> Result<(), Refused> {
        if liquid_m_s.is_none() && !self.is_carried {
            return Ok(());
        }
        let velocity_m_s = |at| liquid_m_s.map_or(DVec3::ZERO, |velocity| velocity(at));
        self.flow.set_side_velocities(&|_, _, at| velocity_m_s(at))?;
        self.is_carried = liquid_m_s.is_some();
        Ok(())
    }

    /// One step: vents breathe out, warm gas rises, smoke goes with it. `risen_m` tells how far
    /// the liquid's surface has risen at a place.
    ///
    /// # Errors
    /// [`Refused`] if `dt_s` is negative, not finite, or above 1000 s.
    pub fn step(
        &mut self,
        dt_s: f64,
        risen_m: impl Fn(Vec3) -> f32,
    ) -> Result<StepReport, Refused> {
        self.move_vents(dt_s);
        let Gas { vent_radius_m, smoke_per_s, .. } = self.gas;
        let floor_m = self.grid.origin_in_world_m.y;
        for vent in &self.vents_in_world_m {
            let at = vent.with_y((vent.y + risen_m(*vent)).max(floor_m));
            self.smoke.pour(0, at, vent_radius_m, smoke_per_s, dt_s)?;
            if let Some(warmth) = &mut self.warmth {
                warmth.pour(0, at, vent_radius_m, smoke_per_s, dt_s)?;
            }
        }
        if let Some(warmth) = &self.warmth {
            self.flow.set_mixture(warmth);
        }
        let report = self.flow.step(dt_s)?;
        self.smoke.step(&self.flow, dt_s)?;
        if let Some(warmth) = &mut self.warmth {
            warmth.step(&self.flow, dt_s)?;
        }
        Ok(report)
    }

    /// What is drawn.
    #[must_use]
    pub fn view(&self) -> SmokeView {
        let mut fraction = vec![0.0; self.grid.len()];
        self.smoke.copy_fraction(0, &mut fraction);
        SmokeView { grid: self.grid, colour: self.gas.colour, fraction }
    }

    fn move_vents(&mut self, dt_s: f64) {
        self.until_next_s -= dt_s;
        if self.until_next_s > 0.0 {
            return;
        }
        self.until_next_s = VENT_S;
        self.vents_in_world_m.clear();
        for _ in 0..self.gas.vents {
            let vent = (0..TRIES).find_map(|_| self.place_of_vent());
            self.vents_in_world_m.extend(vent);
        }
    }

    /// A random place of the liquid's surface at rest; `None` if there is no liquid below it.
    fn place_of_vent(&mut self) -> Option<Vec3> {
        let (low, extent) = (self.grid.origin_in_world_m, self.grid.extent_m());
        let share = [(); 2].map(|()| self.draws.rand_float() as f32);
        let place = low + Vec3::new(share[0] * extent.x, 0.0, share[1] * extent.z);
        let below = place - 0.5 * self.grid.spacing_m * Vec3::Y;
        let is_clear = self.vessel.depth_inside_m(below) > 0.5 * self.gas.vent_radius_m;
        is_clear.then_some(place)
    }
}
