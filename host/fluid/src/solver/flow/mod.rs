//! Our flow solver: a staggered grid in a box or a pot, f32 throughout, deterministic for any
//! number of threads and for 256 as for 512 bits, allocation-free after construction.
//!
//! It chooses scheme and number of sub-steps from the step it is given, so that it is
//! accurate where that is cheap and stable always.

pub(super) mod carry;
mod density;
pub(crate) mod engine;
mod exchange;
pub(crate) mod faces;
pub(crate) mod field;
mod ghosts;
mod krylov;
mod medium;
mod mixture;
mod momentum;
mod poisson;
mod pressure;
mod schedule;
mod stages;
mod step;
mod stress;
mod survey;
mod thick;
mod trace;
mod viscous;
mod walls;

pub use self::medium::Medium;

use std::sync::Arc;

use glam::{DVec3, Vec3};

use self::{
    engine::Engine,
    exchange::Kernel,
    faces::{Faces, cells},
    field::{FaceRuns, Layout, Vector, components, cut},
    ghosts::{Fill, Ghosts},
    medium::sound_gravity,
    mixture::{Mixture, working},
    pressure::{Prediction, Projection, masses},
    stages::History,
    survey::Survey,
    trace::Tracer,
    viscous::Viscous,
};
use crate::{
    grid::Grid,
    pool::Pool,
    simd::SimdClass,
    solver::{
        Refused, Scheme, Setup, SetupError, Solver, StepReport, VectorField, VisitVelocity,
        not_negative, within,
    },
};

/// No velocity is accepted or kept above this.
const MAX_SPEED_M_S: f32 = 1e4;

/// No acceleration is accepted above this.
const MAX_ACCELERATION_M_S2: f64 = 1e6;

/// Narrowest and widest cell that is accepted: between them no power of it leaves f32.
const SPACING_M: std::ops::RangeInclusive<f32> = 1e-9..=1e6;

fn check_grid(grid: &Grid) -> Result<(), Refused> {
    if !SPACING_M.contains(&grid.spacing_m) {
        return Err(Refused { what: "spacing_m", value: f64::from(grid.spacing_m) });
    }
    if grid.is_empty() {
        return Err(Refused { what: "cells of the grid", value: 0.0 });
    }
    for value in grid.origin_in_world_m.to_array() {
        within("origin_in_world_m", f64::from(value), 1e9)?;
    }
    Ok(())
}

/// Incompressible flow in a vessel.
pub struct Flow {
    grid: Grid,
    layout: Layout,
    faces: Faces,
    ghosts: Ghosts,
    /// True if a side can put energy in.
    is_driven: bool,
    /// Largest speed that a side imposes.
    side_speed_m_s: f64,
    density_kg_m3: f64,
    viscosity_m2_s: f64,
    gravity_m_s2: DVec3,
    /// The liquid without anything in it.
    pure: Medium,
    /// What is not the same everywhere; `None` if all is.
    mixture: Option<Box<Mixture>>,
    /// Room for it, once it has been needed.
    spare_mixture: Option<Box<Mixture>>,
    /// The stamp of the substances that it was made of.
    mixed: Option<u64>,
    pool: Arc<Pool>,
    simd: SimdClass,
    velocity: Vector,
    /// What passes each face, per area of a whole one; `None` in a box, where it is the velocity.
    fluxes: Option<Vector>,
    /// Two stages of a step; of a multistep one, the result and the rates of the last.
    stage: [Vector; 2],
    /// What the rates are good for; `None` if there are none.
    history: Option<History>,
    viscous: Viscous,
    pressure: Prediction,
    /// Length of the part of a step that left it; 0 if it predicts nothing.
    pressure_dt_s: f64,
    projection: Projection,
    force: Option<Force>,
    force_scale: [f64; 2],
    /// What is known of `velocity`; `None` once it was changed from outside.
    survey: Option<Survey>,
    /// Energy that the scheme has made from nothing so far, per density and cell volume.
    excess_m2_s2: f64,
    /// The scheme that steps are to take, if not the one that suits them.
    forced: Option<Scheme>,
    /// Off only to prove that skipping changes no bits.
    may_sleep: bool,
}

/// An acceleration on open faces.
struct Force {
    acceleration_m_s2: Vector,
    largest_m_s2: f64,
}

impl Flow {
    /// Liquid at rest.
    ///
    /// # Errors
    /// [`SetupError`] if the grid has no cell or one narrower than a nanometre or wider than
    /// 1000 km, its origin is not finite, density or viscosity are negative, not finite or above
    /// 10^6, gravity is not finite or above 10^6, or the sides make no sense together.
    pub fn new(setup: &Setup) -> Result<Self, SetupError> {
        check_grid(&setup.grid)?;
        let [nx, ny, nz] = setup.grid.cells;
        setup.sides.check([ny * nz, nx * nz, nx * ny])?;
        let density_kg_m3 = not_negative("density_kg_m3", setup.density_kg_m3)?;
        let viscosity_m2_s = not_negative("viscosity_m2_s", setup.viscosity_m2_s)?;
        let layout = Layout::new(setup.grid.cells);
        let faces = Faces::new(&layout, &setup.grid, &setup.vessel, &setup.sides, setup.walls);
        let ghosts = Ghosts::new(&layout, &setup.sides);
        let vector = || [layout.zeros(), layout.zeros(), layout.zeros()];
        let mut flow = Self {
            grid: setup.grid,
            is_driven: setup.sides.drive(),
            side_speed_m_s: setup.sides.largest_speed_m_s(),
            density_kg_m3,
            viscosity_m2_s,
            gravity_m_s2: sound_gravity(setup.gravity_m_s2)?,
            pure: Medium { density_kg_m3, viscosity_m2_s },
            mixture: None,
            spare_mixture: None,
            mixed: None,
            pool: Arc::clone(&setup.pool),
            simd: setup.simd,
            velocity: vector(),
            fluxes: faces.vessel.is_some().then(vector),
            stage: [vector(), vector()],
            history: None,
            viscous: Viscous::new(&layout),
            pressure: Prediction { next: layout.zeros(), trend: layout.zeros(), share: 0.0 },
            pressure_dt_s: 0.0,
            projection: Projection::new(&layout, &faces, &ghosts, &setup.pool),
            force: None,
            force_scale: [1.0; 2],
            survey: None,
            excess_m2_s2: 0.0,
            forced: None,
            may_sleep: true,
            layout,
            faces,
            ghosts,
        };
        flow.ghosts.fill(&mut flow.velocity, Fill::Projected);
        Ok(flow)
    }

    /// Liquid at rest that moves by one scheme only. Beyond the scheme's bounds a step is cut into
    /// more parts; only one that would take more than 10 000 goes by the scheme that suits it, as
    /// its report says.
    ///
    /// # Errors
    /// As [`Flow::new`], and [`SetupError::Unsupported`] if there is no such way to move.
    pub fn with_scheme(setup: &Setup, scheme: Scheme) -> Result<Self, SetupError> {
        match scheme {
            Scheme::Rest | Scheme::Founding => {
                Err(SetupError::Unsupported("no flow moves by the schemes rest and founding"))
            }
            _ => Ok(Self { forced: Some(scheme), ..Self::new(setup)? }),
        }
    }

    /// The grid that the flow is computed on.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of liquid cells.
    #[must_use]
    pub fn liquid_cells(&self) -> usize {
        self.faces.liquid_cells
    }

    /// Gives the liquid `impulse_n_s` around a point, spread over the faces within `radius_m`
    /// (at least two cells) by the kernel of [`Flow::gather`]. Returns the change of
    /// [`Flow::momentum_n_s`] that rounding made of it, for the caller to carry the rest; it is
    /// zero where no liquid is in reach. The divergence that this causes goes in the next step.
    ///
    /// # Errors
    /// [`Refused`] if an argument is not finite, or the radius negative; nothing is changed.
    pub fn push(
        &mut self,
        centre_in_world_m: Vec3,
        radius_m: f32,
        impulse_n_s: DVec3,
    ) -> Result<DVec3, Refused> {
        let worst = impulse_n_s.abs().max_element();
        within("impulse_n_s", if impulse_n_s.is_nan() { f64::NAN } else { worst }, f64::MAX)?;
        let centre = self.in_cells(centre_in_world_m);
        within("centre_in_world_m", f64::from(centre.dot(Vec3::ONE)), f64::MAX)?;
        within("radius_m", f64::from(radius_m), f64::MAX)?;
        let mass_kg = self.cell_mass_kg();
        if mass_kg <= 0.0 || impulse_n_s == DVec3::ZERO {
            return Ok(DVec3::ZERO);
        }
        let radius = radius_m / self.grid.spacing_m;
        let mass = masses(&self.faces, self.mixture.as_ref().and_then(|mixture| mixture.weight()));
        let kernel = Kernel::new(&self.layout, &self.faces, mass, centre, radius);
        let velocity = self.velocity.each_mut().map(|u| &mut **u);
        let change = kernel.push(velocity, impulse_n_s / mass_kg, MAX_SPEED_M_S);
        self.ghosts.fill(&mut self.velocity, Fill::Projected);
        self.set_fluxes();
        self.survey = None;
        Ok(change * mass_kg)
    }

    /// Mean velocity of the liquid around a point, weighted as [`Flow::push`] spreads; zero
    /// where no liquid is in reach.
    #[must_use]
    pub fn gather(&self, centre_in_world_m: Vec3, radius_m: f32) -> Vec3 {
        self.kernel(centre_in_world_m, radius_m).gather(components(&self.velocity))
    }

    /// The mass that an impulse at a point moves at once, before the pressure has spread it:
    /// rho h^3 / sum of squared weights. Infinite where no liquid is in reach.
    #[must_use]
    pub fn effective_mass_kg(&self, centre_in_world_m: Vec3, radius_m: f32) -> f64 {
        self.cell_mass_kg() * self.kernel(centre_in_world_m, radius_m).mass_in_cells()
    }

    /// Momentum of the liquid: the sum of rho u h^3 over the open parts of all faces,
    /// in f64.
    #[must_use]
    pub fn momentum_n_s(&self) -> DVec3 {
        let [nx, _, nz] = self.layout.cells;
        let rows =
            |k| self.layout.rows_in_plane().map(move |row| (k + 1) * self.layout.plane + row);
        let masses = self.masses();
        let total = |c: usize| {
            let faces = (0..nz).flat_map(rows).flat_map(|row| row..row + nx);
            let mass = |at: usize| masses.map_or(1.0, |mass| f64::from(mass[c][at]));
            faces.fold(0.0, |sum, at| sum + mass(at) * f64::from(self.velocity[c][at]))
        };
        DVec3::from_array([0, 1, 2].map(total)) * self.cell_mass_kg()
    }

    /// What passes the faces per area of a whole one, and its layout, for what is carried with
    /// the flow: it is as free of divergence as the flow is.
    pub(crate) fn face_fluxes(&self) -> (&Layout, [&[f32]; 3]) {
        (&self.layout, components(self.fluxes.as_ref().unwrap_or(&self.velocity)))
    }

    /// Brings the fluxes up to date.
    fn set_fluxes(&mut self) {
        if let (Some(fluxes), Some(vessel)) = (&mut self.fluxes, &self.faces.vessel) {
            for (flux, (area, u)) in fluxes.iter_mut().zip(vessel.area.iter().zip(&self.velocity)) {
                for (flux, (area, u)) in flux.iter_mut().zip(area.iter().zip(u.iter())) {
                    *flux = area * u;
                }
            }
        }
    }

    /// A point in cells from the grid's corner.
    fn in_cells(&self, point_in_world_m: Vec3) -> Vec3 {
        (point_in_world_m - self.grid.origin_in_world_m) / self.grid.spacing_m
    }

    fn kernel(&self, centre_in_world_m: Vec3, radius_m: f32) -> Kernel<'_> {
        let radius = radius_m / self.grid.spacing_m;
        let centre = self.in_cells(centre_in_world_m);
        Kernel::new(&self.layout, &self.faces, self.masses(), centre, radius)
    }

    /// Where the flow is computed, for what is carried with it.
    pub(crate) fn engine(&self) -> Engine<'_> {
        Engine { pool: &self.pool, simd: self.simd, faces: &self.faces }
    }

    fn surveyed(&self) -> Survey {
        self.survey.unwrap_or_else(|| {
            let force = working(self.force.as_ref(), self.mixture.as_deref());
            let velocity = components(&self.velocity);
            Survey::new(self.engine(), &self.layout, velocity, force, self.masses())
        })
    }

    /// Position of face `c` of cell (i, j, k) in world metres.
    fn face_in_world_m(&self, c: usize, [i, j, k]: [usize; 3]) -> DVec3 {
        let mut cells = DVec3::new(i as f64, j as f64, k as f64) + 0.5;
        cells[c] -= 0.5;
        self.grid.origin_in_world_m.as_dvec3() + f64::from(self.grid.spacing_m) * cells
    }

    /// Calls `visit(component, index, position)` for every open face.
    fn visit_open(&self, mut visit: impl FnMut(usize, usize, DVec3)) {
        for (i, j, k) in cells(self.layout.cells) {
            let at = self.layout.index(i, j, k);
            for c in (0..3).filter(|c| self.faces.open[*c][at] > 0.0) {
                visit(c, at, self.face_in_world_m(c, [i, j, k]));
            }
        }
    }

    /// Calls `visit(outflow)` for what flows out of every liquid cell, in units of face area.
    fn visit_outflow(&self, mut visit: impl FnMut(f32)) {
        let [nx, _, nz] = self.layout.cells;
        let rows =
            |k| self.layout.rows_in_plane().map(move |row| (k + 1) * self.layout.plane + row);
        for row in (0..nz).flat_map(rows) {
            let faces = FaceRuns::new(&self.layout, components(&self.velocity), row, nx);
            let liquid = cut(&self.faces.liquid, row, nx);
            let area = self
                .faces
                .vessel
                .as_ref()
                .map(|vessel| FaceRuns::new(&self.layout, components(&vessel.area), row, nx));
            let cells = (0..nx).filter(|i| liquid[*i] > 0.0);
            cells.for_each(|i| {
                visit(
                    area.map_or_else(|| faces.outflow(i), |area| faces.outflow_through(&area, i)),
                );
            });
        }
    }

    /// Samples `field` on the open faces into `out`; returns the largest magnitude.
    fn sample(
        &self,
        what: &'static str,
        field: &VectorField<'_>,
        limit: f64,
        out: &mut Vector,
    ) -> Result<f64, Refused> {
        let mut largest = Ok(0.0f64);
        out.iter_mut().for_each(|out| out.fill(0.0));
        self.visit_open(|c, at, point| {
            let value = field(point)[c];
            out[c][at] = value as f32;
            largest = largest
                .and_then(|so_far| within(what, value, limit).map(|value| so_far.max(value.abs())));
        });
        largest
    }
}

impl Solver for Flow {
    fn set_velocity(&mut self, velocity_m_s: &VectorField<'_>) -> Result<(), Refused> {
        let mut sampled = [self.layout.zeros(), self.layout.zeros(), self.layout.zeros()];
        let limit = f64::from(MAX_SPEED_M_S);
        self.sample("velocity_m_s", velocity_m_s, limit, &mut sampled)?;
        self.velocity = sampled;
        self.ghosts.fill(&mut self.velocity, Fill::Unprojected);
        self.set_fluxes();
        self.excess_m2_s2 = 0.0;
        self.pressure_dt_s = 0.0;
        self.history = None;
        self.survey = None;
        Ok(())
    }

    fn set_force(&mut self, acceleration_m_s2: &VectorField<'_>) -> Result<(), Refused> {
        let mut sampled = [self.layout.zeros(), self.layout.zeros(), self.layout.zeros()];
        let name = "acceleration_m_s2";
        let largest_m_s2 =
            self.sample(name, acceleration_m_s2, MAX_ACCELERATION_M_S2, &mut sampled)?;
        self.force = Some(Force { acceleration_m_s2: sampled, largest_m_s2 });
        self.survey = None;
        Ok(())
    }

    fn scale_force(&mut self, start: f64, end: f64) -> Result<(), Refused> {
        self.force_scale = [within("force scale", start, 1e3)?, within("force scale", end, 1e3)?];
        // The drive of a mixture has the scale in it.
        self.survey = self.survey.filter(|_| self.mixture.is_none());
        Ok(())
    }

    fn step(&mut self, dt_s: f64) -> Result<StepReport, Refused> {
        self.advance(dt_s)
    }

    fn project(&mut self) {
        self.survey = Some(self.clear_divergence().survey);
        self.set_fluxes();
    }

    fn visit(&self, visit: &mut VisitVelocity<'_>) {
        self.visit_open(|c, at, point| visit(point, c, f64::from(self.velocity[c][at])));
    }

    fn divergence_l2_per_s(&self) -> f64 {
        let (mut squares, mut cells) = (0.0, 0);
        self.visit_outflow(|outflow| {
            squares += f64::from(outflow) * f64::from(outflow);
            cells += 1;
        });
        (squares / f64::from(cells.max(1))).sqrt() / f64::from(self.grid.spacing_m)
    }

    fn divergence_max_per_s(&self) -> f64 {
        let mut largest = 0f32;
        self.visit_outflow(|outflow| largest = largest.max(outflow.abs()));
        f64::from(largest) / f64::from(self.grid.spacing_m)
    }

    fn velocity_at(&self, point_in_world_m: Vec3) -> Vec3 {
        let tracer = Tracer::new(&self.layout, &self.ghosts);
        tracer.velocity_at(components(&self.velocity), self.in_cells(point_in_world_m))
    }

    fn kinetic_energy_j(&self) -> f64 {
        self.surveyed().energy_m2_s2 * self.cell_mass_kg()
    }
}
