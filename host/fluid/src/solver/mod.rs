//! Flow solvers behind one small interface, and the index of them.
//!
//! A new solver is one file and one row in [`INDEX`]; the shared conformance tests and the
//! benchmarks then run on it.
//!
//! The driven cavity of Ghia, Ghia, Shin (1982) at Re 100 in twenty lines, and how fast the liquid
//! flows back through its middle:
//! ```
//! use cauldron_fluid::{
//!     Grid, Vessel,
//!     solver::{Setup, Side, Sides, Solver, flow::Flow},
//! };
//! use glam::Vec3;
//!
//! let n = 32;
//! let lid = [Side::NoSlip, Side::Moving(Vec3::X)];
//! let setup = Setup {
//!     viscosity_m2_s: 0.01,
//!     sides: Sides::all(Side::NoSlip).with(1, lid).with(2, [Side::FreeSlip; 2]),
//!     ..Setup::new(Grid { cells: [n, n, 1], ..Grid::unit_cube(n) }, Vessel::Box)
//! };
//! let mut flow = Flow::new(&setup)?;
//! for _ in 0..20 * n {
//!     flow.step(1.0 / n as f64)?;
//! }
//! let middle = Vec3::new(0.5, 0.5, 0.5 / n as f32);
//! let back_m_s = flow.velocity_at(middle).x;
//! assert!((back_m_s - -0.20581).abs() < 2e-3, "{back_m_s}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod flow;
pub mod founding;
pub mod obstacle;
pub mod sides;
pub mod traced;

pub use obstacle::{Motion, Obstacle, ObstacleId, Shape};
pub use sides::{Side, Sides};

use std::{fmt, sync::Arc};

use glam::{DVec3, Vec3};

use crate::{grid::Grid, pool::Pool, simd::SimdClass, vessel::Vessel};

/// How a flow meets a solid: the walls of a vessel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Walls {
    /// It slides along them.
    FreeSlip,
    /// It sticks to them.
    NoSlip,
}

/// What a solver is made for.
#[derive(Clone)]
pub struct Setup {
    /// The box of cells.
    pub grid: Grid,
    /// What holds the liquid in it.
    pub vessel: Vessel,
    /// Density of the liquid.
    pub density_kg_m3: f32,
    /// Kinematic viscosity of the liquid, 0 or more.
    pub viscosity_m2_s: f32,
    /// Acceleration of gravity: it acts where densities differ (see [`flow::Flow::set_medium`]).
    pub gravity_m_s2: Vec3,
    /// What happens at the six sides of the grid's box.
    pub sides: Sides,
    /// What happens at the walls of a vessel that stands in the box.
    pub walls: Walls,
    /// The threads to work with.
    pub pool: Arc<Pool>,
    /// The vector width to work at.
    pub simd: SimdClass,
}

impl Setup {
    /// Inviscid water without gravity between walls that it slides along, on the calling thread
    /// alone, at the processor's vector width.
    #[must_use]
    pub fn new(grid: Grid, vessel: Vessel) -> Self {
        Self {
            grid,
            vessel,
            density_kg_m3: 1000.0,
            viscosity_m2_s: 0.0,
            gravity_m_s2: Vec3::ZERO,
            sides: Sides::all(Side::FreeSlip),
            walls: Walls::FreeSlip,
            pool: Arc::new(Pool::inline()),
            simd: SimdClass::detect(),
        }
    }
}

/// An input that was refused because it is not finite or out of range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refused {
    /// Name of the input, with its unit.
    pub what: &'static str,
    /// The value it had.
    pub value: f64,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {} is not a value that a flow can take", self.what, self.value)
    }
}

impl std::error::Error for Refused {}

/// Why a flow cannot be set up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetupError {
    /// A value is not finite or out of range.
    Refused(Refused),
    /// The solver cannot do what is asked for.
    Unsupported(&'static str),
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refused) => refused.fmt(f),
            Self::Unsupported(what) => f.write_str(what),
        }
    }
}

impl std::error::Error for SetupError {}

impl From<Refused> for SetupError {
    fn from(refused: Refused) -> Self {
        Self::Refused(refused)
    }
}

/// `value` if its magnitude is at most `limit`.
///
/// # Errors
/// [`Refused`], naming `what`, if it is larger or not a number.
pub fn within(what: &'static str, value: f64, limit: f64) -> Result<f64, Refused> {
    if value.abs() <= limit { Ok(value) } else { Err(Refused { what, value }) }
}

/// A property of a liquid: from 0 to 10^6.
fn not_negative(what: &'static str, value: f32) -> Result<f64, Refused> {
    let value = f64::from(value);
    if value < 0.0 { Err(Refused { what, value }) } else { within(what, value, 1e6) }
}

/// The scheme that a step was computed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Nothing moved and nothing pushed: the step was skipped.
    Rest,
    /// Central energy-conserving fluxes, extrapolated from the last step (Adams, Bashforth).
    Multistep,
    /// The same fluxes in three stages (Runge, Kutta).
    Central,
    /// The same fluxes extrapolated from the last step, with viscosity implicit.
    MultistepImplicit,
    /// Traced back along the flow: for steps across many cells.
    Traced,
    /// The founding thesis's own.
    Founding,
}

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Parts that the step was cut into.
    pub substeps: u32,
    /// How it was computed.
    pub scheme: Scheme,
    /// Iterations of all pressure solves; 0 for a direct solver.
    pub pressure_iterations: u32,
    /// Iterations of all viscous solves; 0 where viscosity is explicit.
    pub viscous_iterations: u32,
    /// Kinetic energy after the step.
    pub kinetic_energy_j: f64,
    /// Times that the energy guard had to act.
    pub guard_actions: u32,
    /// True if the liquid is at rest and was skipped.
    pub asleep: bool,
}

impl StepReport {
    /// The report of a step that had nothing to do.
    #[must_use]
    pub fn at_rest() -> Self {
        Self {
            substeps: 0,
            scheme: Scheme::Rest,
            pressure_iterations: 0,
            viscous_iterations: 0,
            kinetic_energy_j: 0.0,
            guard_actions: 0,
            asleep: true,
        }
    }
}

/// Receives position in world metres, component and value of each velocity that is stored.
pub type VisitVelocity<'a> = dyn FnMut(DVec3, usize, f64) + 'a;

/// A vector field over world positions.
pub type VectorField<'a> = dyn Fn(DVec3) -> DVec3 + 'a;

/// What benchmarks and conformance tests know of a solver.
pub trait Solver {
    /// Sets the velocity in m/s at the solver's own points. It is not projected.
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite or above 10 km/s; nothing is changed then.
    fn set_velocity(&mut self, velocity_m_s: &VectorField<'_>) -> Result<(), Refused>;

    /// Sets the shape of an acceleration in m/s^2 that acts in all later steps, times
    /// [`Solver::scale_force`].
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite or above 10^6 m/s^2; nothing is changed then.
    fn set_force(&mut self, acceleration_m_s2: &VectorField<'_>) -> Result<(), Refused>;

    /// Sets the factor of the force at the start and at the end of the next step; 1 and 1 at
    /// first.
    ///
    /// # Errors
    /// [`Refused`] if a factor is not finite or above 1000.
    fn scale_force(&mut self, start: f64, end: f64) -> Result<(), Refused>;

    /// Advances the flow by `dt_s`.
    ///
    /// # Errors
    /// [`Refused`] if `dt_s` is negative, not finite, or above 1000 s.
    fn step(&mut self, dt_s: f64) -> Result<StepReport, Refused>;

    /// Projects the velocity as the solver does within a step.
    fn project(&mut self);

    /// Visits every stored velocity inside the liquid.
    fn visit(&self, visit: &mut VisitVelocity<'_>);

    /// Root mean square of div u over the liquid cells, as the solver's own stencil sees it.
    fn divergence_l2_per_s(&self) -> f64;

    /// Largest |div u| over the liquid cells.
    fn divergence_max_per_s(&self) -> f64;

    /// Velocity at a point, interpolated between the stored ones.
    fn velocity_at(&self, point_in_world_m: Vec3) -> Vec3;

    /// Kinetic energy of the liquid.
    fn kinetic_energy_j(&self) -> f64;
}

/// A result that a solver is known to miss, bracketed from both sides so that neither the
/// solver nor the benchmark can change unseen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownMiss {
    /// Benchmark case.
    pub case: &'static str,
    /// Cells along an edge.
    pub n: usize,
    /// The result is at least this ...
    pub at_least: f64,
    /// ... and at most this.
    pub at_most: f64,
}

/// One row of [`INDEX`].
pub struct SolverRow {
    /// Name on the command line and in rows.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// Makes it, unless the setup makes no sense or is more than it can do.
    pub make: fn(&Setup) -> Result<Box<dyn Solver>, SetupError>,
    /// What it is known to miss.
    pub known_misses: &'static [KnownMiss],
    /// What it misses of the conformance tests that run on every solver, by the name of the test.
    pub conformance_misses: &'static [KnownMiss],
}

/// All solvers.
pub const INDEX: &[SolverRow] = &[
    SolverRow {
        name: "auto",
        about: "staggered grid, energy-conserving fluxes, direct or preconditioned projection; \
                chooses scheme and sub-steps by itself",
        make: |setup| Ok(Box::new(flow::Flow::new(setup)?)),
        known_misses: &[],
        conformance_misses: &[],
    },
    SolverRow {
        name: "adams-bashforth",
        about: "auto's energy-conserving fluxes, always extrapolated from the last step",
        make: |setup| Ok(Box::new(flow::Flow::with_scheme(setup, Scheme::Multistep)?)),
        known_misses: &[],
        conformance_misses: &[],
    },
    SolverRow {
        name: "runge-kutta",
        about: "the same in three stages with one projection, always",
        make: |setup| Ok(Box::new(flow::Flow::with_scheme(setup, Scheme::Central)?)),
        known_misses: &[],
        conformance_misses: &[],
    },
    SolverRow {
        name: "semi-lagrangian",
        about: "stable fluids on a staggered grid, midpoint rule, linear (Stam 1999)",
        make: |setup| Ok(Box::new(traced::Traced::semi_lagrangian(setup)?)),
        known_misses: traced::KNOWN_MISSES_SEMI_LAGRANGIAN,
        conformance_misses: &[],
    },
    SolverRow {
        name: "maccormack",
        about: "the same, corrected by going there and back, limited (Selle et al. 2008)",
        make: |setup| Ok(Box::new(traced::Traced::maccormack(setup)?)),
        known_misses: traced::KNOWN_MISSES_MACCORMACK,
        conformance_misses: &[],
    },
    SolverRow {
        name: "advection-reflection",
        about: "half a step, reflected about its projection, half a step; limited cubic \
                (Zehnder, Narain, Thomaszewski 2018)",
        make: |setup| Ok(Box::new(traced::Traced::reflection(setup)?)),
        known_misses: traced::KNOWN_MISSES_REFLECTION,
        conformance_misses: &[],
    },
    SolverRow {
        name: "founding",
        about: "the founding thesis's stable fluids as printed, faults included (Mora 2008)",
        make: |setup| Ok(Box::new(founding::Founding::new(setup)?)),
        known_misses: founding::KNOWN_MISSES,
        conformance_misses: founding::CONFORMANCE_MISSES,
    },
    SolverRow {
        name: "founding-repaired",
        about: "the same with its constants repaired; 20 sweeps still do not converge",
        make: |setup| Ok(Box::new(founding::Founding::repaired(setup)?)),
        known_misses: founding::KNOWN_MISSES_REPAIRED,
        conformance_misses: founding::CONFORMANCE_MISSES_REPAIRED,
    },
];

/// The solver of that name; `None` if there is none.
#[must_use]
pub fn find(name: &str) -> Option<&'static SolverRow> {
    INDEX.iter().find(|row| row.name == name)
}
