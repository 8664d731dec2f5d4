//! The pot: liquid, substances and surface of one scene, a step at a time. What the scene lacks
//! is not there, and costs nothing.

use glam::{DVec3, Vec3};
use std::sync::Arc;

use crate::{
    DropView, Snapshot, SubstanceView,
    air::Air,
    force::{Drag, Exchange, Floating},
    grid::Grid,
    plan::Item,
    pool::Pool,
    scenes::{GRAVITY_M_S2, Poke, Scene, Substance},
    simd::SimdClass,
    solver::{Setup, SetupError, Sides, Solver, flow::Flow},
    splash::{Below, Droplet, Splash},
    substance::{Properties, Substances},
    surface::{Basin, Surface},
    vessel::Vessel,
};

/// Extremes and counts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Steps taken.
    pub steps: u64,
    /// Steps in which there was no liquid, or it was at rest and was skipped.
    pub steps_asleep: u64,
    /// Largest kinetic energy of the liquid.
    pub kinetic_energy_max_j: f64,
    /// Largest |div u| left in a cell after a step.
    pub divergence_max_per_s: f64,
    /// Times that the energy guard acted.
    pub guard_actions: u64,
    /// Values that were refused because they were not finite.
    pub refused: u64,
    /// Energy that the surface let go of where the probe broke through or came off.
    pub released_j: f64,
}

/// A probe that cuts the surface damps it by its contact stiffness times this: what it gives to
/// the liquid presses on the surface too, and comes back to a ball that floats some 30 ms later. A
/// fourth of it keeps such a ball from swinging; without any it swings up.
const PROBE_DAMPING_S: f32 = 0.02;

/// What waves change the liquid by in a step is left out below this: it rests at ten times that.
const LEAST_DRIFT_M_S: f32 = 1e-7;

/// A pot.
pub struct Pot {
    grid: Grid,
    vessel: Vessel,
    liquid_colour: Option<Vec3>,
    palette: Vec<Substance>,
    flow: Option<Flow>,
    substances: Option<Substances>,
    surface: Option<Surface>,
    splash: Option<Splash>,
    air: Option<Air>,
    drag: Drag,
    floating: Option<Floating>,
    pokes: Vec<Poke>,
    probe_radius_m: f32,
    probe_in_world_m: Vec3,
    exchange: Exchange,
    time_s: f64,
    totals: Totals,
}

impl Pot {
    /// The pot of a scene, as it is at first.
    ///
    /// # Errors
    /// [`SetupError`] if the scene's liquid makes no sense; one that has passed its check does.
    pub fn new(scene: &Scene, pool: Arc<Pool>, simd: SimdClass) -> Result<Self, SetupError> {
        let gravity_m_s2 = scene.liquid.map_or(GRAVITY_M_S2, |liquid| liquid.gravity_m_s2);
        let air = scene.gas.as_ref().map(|gas| {
            Air::new(gas, (&scene.grid, &scene.vessel), gravity_m_s2, pool.clone(), simd)
        });
        let air = air.transpose()?;
        let setup = scene.liquid.map(|liquid| Setup {
            density_kg_m3: liquid.density_kg_m3,
            viscosity_m2_s: liquid.viscosity_m2_s,
            gravity_m_s2: Vec3::NEG_Y * liquid.gravity_m_s2,
            sides: Sides::of_vessel(liquid.walls),
            walls: liquid.walls,
            pool,
            simd,
            ..Setup::new(scene.grid, scene.vessel.clone())
        });
        let mut flow = setup.as_ref().map(Flow::new).transpose()?;
        let mut surface = surface_of(scene, simd)?;
        if let Some(flow) = &mut flow {
            scene.start(flow, surface.as_mut());
        }
        let substances = setup.as_ref().map(|setup| pourable(scene, setup));
        if let (Some(flow), Some(substances)) = (&mut flow, &substances) {
            flow.make_room_for(substances);
        }
        if let (Some(flow), Some(_)) = (&mut flow, &scene.surface) {
            flow.watch_lid();
        }
        let drag = scene.liquid.map_or(Drag::default(), |liquid| {
            Drag::of_sphere(
                f64::from(scene.probe.radius_m),
                f64::from(liquid.density_kg_m3),
                f64::from(liquid.viscosity_m2_s),
            )
        });
        Ok(Self {
            grid: scene.grid,
            vessel: scene.vessel.clone(),
            liquid_colour: scene.liquid.map(|liquid| liquid.colour),
            palette: scene.substances.clone(),
            substances,
            flow,
            surface,
            splash: scene
                .surface
                .zip(scene.liquid)
                .map(|(_, liquid)| Splash::new(liquid.density_kg_m3, liquid.gravity_m_s2)),
            air,
            drag,
            floating: Floating::of(scene),
            pokes: scene.story.pokes.clone(),
            probe_radius_m: scene.probe.radius_m,
            probe_in_world_m: scene.story.start_m,
            exchange: Exchange::default(),
            time_s: 0.0,
            totals: Totals::default(),
        })
    }

    /// The box.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The liquid, if the scene has one.
    #[must_use]
    pub fn flow(&self) -> Option<&Flow> {
        self.flow.as_ref()
    }

    /// The surface, if the scene has one.
    #[must_use]
    pub fn surface(&self) -> Option<&Surface> {
        self.surface.as_ref()
    }

    /// The drops, if the scene has a surface.
    #[must_use]
    pub fn splash(&self) -> Option<&Splash> {
        self.splash.as_ref()
    }

    /// The substances, if the scene has a liquid to pour them into.
    #[must_use]
    pub fn substances(&self) -> Option<&Substances> {
        self.substances.as_ref()
    }

    /// The gas above the liquid, if the scene has one.
    #[must_use]
    pub fn air(&self) -> Option<&Air> {
        self.air.as_ref()
    }

    /// What is computed in each step, and what it takes.
    #[must_use]
    pub fn plan(&self) -> Vec<Item> {
        let liquid = self.flow.as_ref().map_or_else(|| vec![Item::off("liquid")], Flow::plan);
        let substances = self.substances.as_ref().map(Substances::plan).unwrap_or_default();
        let sheet = self.surface.as_ref().map(|sheet| {
            let [nx, nz] = sheet.lattice().nodes;
            (
                format!("{}, {nx} x {nz} nodes, drops where it breaks", sheet.params().model),
                sheet.bytes(),
            )
        });
        let surface = Item::if_any("surface", sheet);
        let air = self.air.as_ref().map_or_else(|| vec![Item::off("gas")], Air::plan);
        liquid.into_iter().chain(substances).chain([surface]).chain(air).collect()
    }

    /// Drag of the probe in the liquid.
    #[must_use]
    pub fn drag(&self) -> Drag {
        self.drag
    }

    /// Weight and buoyancy of the probe, if it has any.
    #[must_use]
    pub fn floating(&self) -> Option<Floating> {
        self.floating
    }

    /// Mass of liquid that the probe's impulse moves at once: where it is now, or in the middle
    /// of the pot if that is less, since it may be there before the next field is.
    #[must_use]
    pub fn moved_mass_kg(&self) -> Option<f64> {
        let flow = self.flow.as_ref()?;
        let middle = self.grid.origin_in_world_m + 0.5 * self.grid.extent_m();
        let mass_kg = |at| flow.effective_mass_kg(at, self.probe_radius_m);
        Some(mass_kg(self.probe_in_world_m).min(mass_kg(middle)))
    }

    /// Radius of the probe.
    #[must_use]
    pub fn probe_radius_m(&self) -> f32 {
        self.probe_radius_m
    }

    /// The books of what the probe gave to the liquid.
    #[must_use]
    pub fn exchange(&self) -> &Exchange {
        &self.exchange
    }

    /// Extremes and counts so far.
    #[must_use]
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Says where the probe is, in world metres; a place that is not finite is left out.
    pub fn place_probe(&mut self, at_in_world_m: Vec3) {
        if at_in_world_m.is_finite() {
            self.probe_in_world_m = at_in_world_m;
        }
    }

    /// Takes the impulse that the probe gave, in physical newton seconds: to the liquid around
    /// it, and, vertically, to the surface over the next `dt_s`.
    pub fn take(&mut self, to_liquid_n_s: DVec3, to_surface_n_s: f64, dt_s: f32) {
        let at = self.probe_in_world_m;
        if let Some(flow) = &mut self.flow {
            let given = self.exchange.give(flow, at, self.probe_radius_m, to_liquid_n_s);
            self.totals.refused += u64::from(given.is_err());
        }
        if let Some(surface) = &mut self.surface {
            let depth_m = surface.rest_height_in_world_m() + surface.ahead(at).0 - at.y;
            if to_surface_n_s != 0.0 || depth_m.abs() < self.probe_radius_m {
                let push_n = (to_surface_n_s / f64::from(dt_s)) as f32;
                let damping = PROBE_DAMPING_S * surface.params().contact_stiffness_n_per_m;
                surface.lean(at, self.probe_radius_m, push_n, damping);
            }
        }
    }

    /// Takes the energy, in joules, that the surface held under the probe when it broke: it leaves
    /// as a wave, with the next step; upwards, or downwards if it is below zero. What is not a
    /// number is left out.
    pub fn release(&mut self, energy_j: f64) {
        let Some(surface) = self.surface.as_mut().filter(|_| energy_j.is_finite()) else { return };
        surface.kick(self.probe_in_world_m, self.probe_radius_m, energy_j as f32);
        self.totals.released_j += energy_j.abs();
    }

    /// Pours the substances whose bit is set for `dt_s`.
    pub fn pour(&mut self, buttons: u8, dt_s: f32) {
        let Some(substances) = &mut self.substances else { return };
        for (place, jet) in self.palette.iter().enumerate().take(8) {
            if buttons >> place & 1 == 1 {
                let (at, radius, rate) = (jet.pour_at_m, jet.pour_radius_m, jet.pour_per_s);
                let poured = substances.pour(place, at, radius, rate, f64::from(dt_s));
                self.totals.refused += u64::from(poured.is_err());
            }
        }
    }

    /// Looks ahead: the surface tells the field how it will stand `ahead_s` from now, and how the
    /// liquid around the probe moves along with it.
    pub fn look_ahead(&mut self, ahead_s: f32) {
        if let Some(surface) = &mut self.surface {
            surface.look_ahead(ahead_s);
            surface.look_below(self.probe_in_world_m);
        }
    }

    /// One step: the liquid, what it carries, its surface, and what rises from that.
    pub fn step(&mut self, dt_s: f32) {
        self.totals.steps += 1;
        self.time_s += f64::from(dt_s);
        self.totals.steps_asleep += u64::from(self.flow.is_none());
        if let Some(flow) = &mut self.flow {
            if let Some(substances) = &self.substances {
                flow.set_mixture(substances);
            }
            match flow.step(f64::from(dt_s)) {
                Ok(report) => {
                    let totals = &mut self.totals;
                    totals.steps_asleep += u64::from(report.asleep);
                    totals.guard_actions += u64::from(report.guard_actions);
                    totals.kinetic_energy_max_j =
                        totals.kinetic_energy_max_j.max(report.kinetic_energy_j);
                    if !report.asleep {
                        totals.divergence_max_per_s =
                            totals.divergence_max_per_s.max(flow.divergence_max_per_s());
                    }
                }
                Err(_) => self.totals.refused += 1,
            }
            if let Some(substances) = &mut self.substances {
                let carried = substances.step(flow, f64::from(dt_s));
                self.totals.refused += u64::from(carried.is_err());
            }
        }
        if let Some(surface) = &mut self.surface {
            if let Some(flow) = self.flow.as_ref().filter(|flow| !flow.is_at_rest()) {
                surface.press(|at| flow.lid_pressure_pa(at));
            }
            let (from_s, to_s) = (self.time_s - f64::from(dt_s), self.time_s);
            for poke in &self.pokes {
                let lasts_s = f64::from(poke.to_s).min(to_s) - f64::from(poke.from_s).max(from_s);
                if lasts_s > 0.0 {
                    let share = (lasts_s / f64::from(dt_s)) as f32;
                    surface.touch(poke.at_m, poke.radius_m, share * poke.force_n, 0.0);
                }
            }
            let report = surface.step(dt_s);
            self.totals.guard_actions += u64::from(report.guard_actions);
        }
        self.drift(dt_s);
        let below = (&mut self.surface, &mut self.flow, &mut self.substances);
        if let (Some(splash), (Some(surface), Some(flow), Some(substances))) =
            (&mut self.splash, below)
        {
            splash.step(Below { surface, flow, substances }, dt_s);
        }
        if let Some(air) = &mut self.air {
            let surface = self.surface.as_ref();
            let risen_m = |at| surface.map_or(0.0, |surface| surface.at(at).0);
            let moving = self.flow.as_ref().filter(|flow| !flow.is_at_rest());
            let liquid_m_s =
                moving.map(|flow| |at: DVec3| flow.velocity_at(at.as_vec3()).as_dvec3());
            let carried = air.carry(liquid_m_s.as_ref().map(|f| f as &dyn Fn(DVec3) -> DVec3));
            self.totals.refused += u64::from(carried.is_err());
            match air.step(f64::from(dt_s), risen_m) {
                Ok(report) => self.totals.guard_actions += u64::from(report.guard_actions),
                Err(_) => self.totals.refused += 1,
            }
        }
    }

    /// Waves that die drag the liquid along, if it would be seen at all.
    fn drift(&mut self, dt_s: f32) {
        let (Some(surface), Some(flow)) = (&mut self.surface, &mut self.flow) else { return };
        let least_m2_s2 = LEAST_DRIFT_M_S * self.grid.spacing_m / dt_s;
        if surface.find_drift(least_m2_s2) > least_m2_s2 {
            let most_j = surface.drift_w() * f64::from(dt_s);
            flow.drag_lid(|at| surface.drift_m2_s2(at), dt_s, most_j);
        }
    }

    fn fraction(&self, place: usize) -> Vec<f32> {
        let mut fraction = vec![0.0; self.grid.len()];
        if let Some(substances) = &self.substances {
            substances.copy_fraction(place, &mut fraction);
        }
        fraction
    }

    /// Drops in the air, coloured by what is in them.
    fn drop_views(&self) -> Vec<DropView> {
        let Some((splash, liquid)) = self.splash.as_ref().zip(self.liquid_colour) else {
            return Vec::new();
        };
        let view = |(n, drop): (usize, &Droplet)| {
            let kinds = splash.content_of(n).iter().zip(&self.palette);
            let colour = kinds.fold(liquid, |colour, (volume_m3, substance)| {
                let share = (volume_m3 / drop.volume_m3) as f32;
                colour + share * (substance.colour - liquid)
            });
            DropView { at_in_world_m: drop.at_in_world_m, radius_m: drop.radius_m(), colour }
        };
        splash.drops().iter().enumerate().map(view).collect()
    }

    /// What is drawn.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let view = |(place, s): (usize, &Substance)| SubstanceView {
            colour: s.colour,
            fraction: self.fraction(place),
        };
        Snapshot {
            time_s: self.time_s,
            grid: self.grid,
            vessel: self.vessel.clone(),
            liquid_colour: self.liquid_colour,
            substances: self.palette.iter().enumerate().map(view).collect(),
            surface: self.surface.as_ref().map(Surface::view),
            drops: self.drop_views(),
            smoke: self.air.as_ref().map(Air::view),
        }
    }
}

/// The surface of a scene that has one: on its liquid.
fn surface_of(scene: &Scene, simd: SimdClass) -> Result<Option<Surface>, SetupError> {
    let Some((params, liquid)) = scene.surface.zip(scene.liquid) else { return Ok(None) };
    let basin = Basin {
        grid: &scene.grid,
        vessel: &scene.vessel,
        density_kg_m3: liquid.density_kg_m3,
        viscosity_m2_s: liquid.viscosity_m2_s,
        gravity_m_s2: liquid.gravity_m_s2,
        simd,
    };
    Surface::new(params, &basin).map(Some)
}

/// The substances of a scene: as the liquid where it does not say otherwise.
fn pourable(scene: &Scene, setup: &Setup) -> Substances {
    let liquid = Properties::of_liquid(setup);
    let properties = |s: &Substance| Properties {
        density_kg_m3: s.density_kg_m3.unwrap_or(liquid.density_kg_m3),
        viscosity_m2_s: s.viscosity_m2_s.unwrap_or(liquid.viscosity_m2_s),
        diffusivity_m2_s: s.diffusivity_m2_s,
    };
    Substances::new(setup, &scene.substances.iter().map(properties).collect::<Vec<_>>())
}
