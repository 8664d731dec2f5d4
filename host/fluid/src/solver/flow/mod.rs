//! Our flow solver: a staggered grid in a box or a pot, f32 throughout, deterministic for any
//! number of threads and for 256 as for 512 bits, allocation-free after construction.
//!
//! It chooses scheme and number of sub-steps from the step it is given, so that it is
//! accurate where that is cheap and stable always.

pub(super) mod carry;
mod coupling;
mod density;
pub(crate) mod engine;
mod exchange;
pub(crate) mod faces;
pub(crate) mod field;
mod ghosts;
mod inlets;
mod interface;
mod inventory;
mod krylov;
mod lid;
mod looks;
mod medium;
mod mixture;
mod momentum;
mod obstacles;
mod openings;
mod outflow;
mod poisson;
mod pressure;
mod reaction;
mod schedule;
mod solids;
mod stages;
mod step;
mod stress;
mod survey;
mod thick;
mod trace;
mod viscous;
mod walls;

pub use self::{coupling::Drag, inlets::SideVelocity, looks::Looks, medium::Medium};

use std::sync::Arc;

use glam::{DVec3, Vec3};

use self::{
    coupling::Coupling,
    engine::Engine,
    faces::{Faces, cells},
    field::{Layout, Vector, components, cut},
    ghosts::{Fill, Ghosts},
    lid::Lid,
    looks::Looking,
    medium::sound_gravity,
    mixture::{Mixture, working},
    obstacles::Obstacles,
    openings::{Openings, survey_sides, visit_above},
    pressure::{Prediction, Projection},
    stages::History,
    survey::Survey,
    trace::Tracer,
    viscous::Viscous,
};
use crate::{
    grid::Grid,
    pool::Pool,
    simd::SimdClass,
    solver::{Refused, Scheme, Setup, SetupError, Sides, VectorField, Walls, not_negative, within},
    vessel::Vessel,
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
    vessel: Vessel,
    sides: Sides,
    walls: Walls,
    layout: Layout,
    faces: Faces,
    ghosts: Ghosts,
    openings: Openings,
    obstacles: Option<Box<Obstacles>>,
    /// True if a side can put energy in.
    is_driven: bool,
    /// Largest speed that a side imposes.
    side_speed_m_s: f64,
    /// Room for velocities of sides; empty until they differ from place to place.
    sampled_sides: Vec<inlets::Sampled>,
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
    /// Two stages of a step; of a multistep one, the result and the rates of the last.
    stage: [Vector; 2],
    /// What the rates are good for; `None` if there are none.
    history: Option<History>,
    /// What solves for thick liquid; `None` as long as it is inviscid.
    viscous: Option<Viscous>,
    pressure: Prediction,
    /// Length of the part of a step that left it; 0 if it predicts nothing.
    pressure_dt_s: f64,
    projection: Projection,
    force: Option<Force>,
    looks: Option<Box<Looking>>,
    /// What drags it along; `None` if nothing does.
    coupling: Option<Box<Coupling>>,
    /// What the top is pressed with; `None` unless somebody watches.
    lid: Option<Lid>,
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
            vessel: setup.vessel.clone(),
            sides: setup.sides,
            walls: setup.walls,
            obstacles: None,
            is_driven: setup.sides.drive(),
            side_speed_m_s: setup.sides.largest_speed_m_s(),
            sampled_sides: Vec::new(),
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
            stage: [vector(), vector()],
            history: None,
            viscous: None,
            pressure: Prediction { next: layout.zeros(), trend: layout.zeros(), share: 0.0 },
            pressure_dt_s: 0.0,
            projection: Projection::new(&layout, &faces, &ghosts, &setup.pool),
            force: None,
            looks: None,
            coupling: None,
            lid: None,
            force_scale: [1.0; 2],
            survey: None,
            excess_m2_s2: 0.0,
            forced: None,
            may_sleep: true,
            openings: Openings::new(&layout, &faces),
            layout,
            faces,
            ghosts,
        };
        flow.ghosts.fill(&mut flow.velocity, Fill::Projected);
        if viscosity_m2_s > 0.0 {
            flow.make_viscous();
        }
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

    /// Velocity at a point on straight lines between the stored ones: a fifth of the work of
    /// [`Solver::velocity_at`](crate::solver::Solver::velocity_at), and within their range.
    #[must_use]
    pub fn velocity_linear_at(&self, point_in_world_m: Vec3) -> Vec3 {
        let tracer = Tracer::new(&self.layout, &self.ghosts);
        tracer.linear_velocity_at(components(&self.velocity), self.in_cells(point_in_world_m))
    }

    /// True if a step has found that nothing moves, nor does an obstacle.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.survey.is_some_and(|survey| survey.speed_m_s == 0.0) && !self.is_stirred()
    }

    /// Number of liquid cells.
    #[must_use]
    pub fn liquid_cells(&self) -> usize {
        self.faces.liquid_cells
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

    /// What passes the faces per area of a whole one, for what is carried with the flow: it is as
    /// free of divergence as the flow is. In a box it is the velocity, elsewhere it is written
    /// to `room`, which is made for it once.
    pub(crate) fn fluxes<'a>(&'a self, room: &'a mut Option<Vector>) -> [&'a [f32]; 3] {
        let (layout, Some(vessel)) = (&self.layout, &self.faces.vessel) else {
            return components(&self.velocity);
        };
        let fluxes = room.get_or_insert_with(|| self.velocity.each_ref().map(|_| layout.zeros()));
        for ((flux, area), u) in fluxes.iter_mut().zip(&vessel.area).zip(&self.velocity) {
            self.pool.planes([&mut **flux], [layout.plane], |k, [flux]| {
                let at = k * layout.plane;
                let [area, u] = [area, u].map(|field| cut(field, at, flux.len()));
                for (flux, (area, u)) in flux.iter_mut().zip(area.iter().zip(u)) {
                    *flux = area * u;
                }
            });
        }
        if let Some(solids) = &vessel.solids {
            solids.add_fluxes(layout, &self.ghosts, fluxes);
        }
        components(fluxes)
    }

    /// If anything can pass a side of the box: which axes are periodic.
    pub(crate) fn periodic_if_open(&self) -> Option<[bool; 3]> {
        let is_periodic = [0, 1, 2].map(|axis| self.ghosts.is_periodic(axis));
        let is_open = self.ghosts.is_any_free() || self.side_speed_m_s > 0.0;
        (is_open || is_periodic.contains(&true)).then_some(is_periodic)
    }

    /// How its arrays lie.
    pub(crate) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// A point in cells from the grid's corner.
    fn in_cells(&self, point_in_world_m: Vec3) -> Vec3 {
        (point_in_world_m - self.grid.origin_in_world_m) / self.grid.spacing_m
    }

    /// The faces as the vessel alone leaves them.
    fn bare(&self) -> &Faces {
        self.obstacles.as_ref().map_or(&self.faces, |obstacles| &obstacles.bare)
    }

    /// Where the flow is computed.
    pub(crate) fn engine(&self) -> Engine<'_> {
        Engine { pool: &self.pool, simd: self.simd, faces: &self.faces }
    }

    /// The same for what is carried with the flow by [`Flow::fluxes`]: in these, obstacles are
    /// liquid that moves as they do, so that what they cover is kept and carried along.
    pub(crate) fn carrier(&self) -> Engine<'_> {
        Engine { faces: self.bare(), ..self.engine() }
    }

    fn surveyed(&self) -> Survey {
        self.survey.unwrap_or_else(|| {
            let force = working(self.force.as_ref(), self.mixture.as_deref());
            let velocity = components(&self.velocity);
            let (on, mass) = (self.engine(), self.masses());
            let on_sides = survey_sides(&self.layout, on.faces, velocity, force, mass);
            Survey::new(on, &self.layout, velocity, force, mass, on_sides)
        })
    }

    /// Position of face `c` of cell (i, j, k) in world metres.
    fn face_in_world_m(&self, c: usize, [i, j, k]: [usize; 3]) -> DVec3 {
        let mut cells = DVec3::new(i as f64, j as f64, k as f64) + 0.5;
        cells[c] -= 0.5;
        self.grid.origin_in_world_m.as_dvec3() + f64::from(self.grid.spacing_m) * cells
    }

    /// Calls `visit(component, index, position)` for every face that is open in `open`.
    fn visit_open(&self, open: &Vector, mut visit: impl FnMut(usize, usize, DVec3)) {
        for (i, j, k) in cells(self.layout.cells) {
            let at = self.layout.index(i, j, k);
            for c in (0..3).filter(|c| open[*c][at] > 0.0) {
                visit(c, at, self.face_in_world_m(c, [i, j, k]));
            }
        }
    }

    /// The same for those on upper sides that let out what comes.
    fn visit_open_above(&self, faces: &Faces, visit: &mut impl FnMut(usize, usize, DVec3)) {
        visit_above(&self.layout, faces, |c, at, face| {
            if faces.open[c][at] > 0.0 {
                visit(c, at, self.face_in_world_m(c, face));
            }
        });
    }

    /// Samples `field` into `out` on the faces that are open once no obstacle covers them; returns
    /// the largest magnitude.
    fn sample(
        &self,
        what: &'static str,
        field: &VectorField<'_>,
        limit: f64,
        out: &mut Vector,
    ) -> Result<f64, Refused> {
        let mut largest = Ok(0.0f64);
        out.iter_mut().for_each(|out| out.fill(0.0));
        let mut set = |c: usize, at: usize, point: DVec3| {
            let value = field(point)[c];
            out[c][at] = value as f32;
            largest = largest
                .and_then(|so_far| within(what, value, limit).map(|value| so_far.max(value.abs())));
        };
        let faces = self.bare();
        self.visit_open(&faces.open, &mut set);
        self.visit_open_above(faces, &mut set);
        largest
    }
}
