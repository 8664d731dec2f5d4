//! The solvers that ours is compared with, by their textbooks: velocities traced back along the
//! flow, on our staggered grid and with our projection, so that what differs is the tracing.
//!
//! Each takes any step in one part and has no guard over its energy, only over its speed.

use glam::Vec3;

use crate::{
    solver::{
        KnownMiss, Refused, Scheme, Setup, SetupError, Solver, StepReport, VectorField,
        VisitVelocity,
        flow::{Flow, carry::Carriage},
    },
    vessel::Vessel,
};

/// What linear interpolation loses.
pub const KNOWN_MISSES_SEMI_LAGRANGIAN: &[KnownMiss] = &[
    KnownMiss { case: "taylor-green", n: 32, at_least: 0.0977, at_most: 0.1017 },
    KnownMiss { case: "mms", n: 32, at_least: 0.1315, at_most: 0.1369 },
];

/// What is left of that once it is corrected.
pub const KNOWN_MISSES_MACCORMACK: &[KnownMiss] = &[
    KnownMiss { case: "taylor-green", n: 32, at_least: 0.0577, at_most: 0.0602 },
    KnownMiss { case: "mms", n: 32, at_least: 0.0442, at_most: 0.0462 },
];

/// What is left of reflection with cubic interpolation.
pub const KNOWN_MISSES_REFLECTION: &[KnownMiss] = &[
    KnownMiss { case: "taylor-green", n: 32, at_least: 0.00136, at_most: 0.00143 },
    KnownMiss { case: "mms", n: 32, at_least: 0.00428, at_most: 0.00446 },
];

/// A flow that is traced whatever the step.
pub struct Traced {
    carriage: Carriage,
    flow: Flow,
}

impl Traced {
    /// Stable fluids (Stam 1999) on a staggered grid: linear interpolation.
    ///
    /// # Errors
    /// As [`Flow::new`], and [`SetupError::Unsupported`] for a vessel that is not a box.
    pub fn semi_lagrangian(setup: &Setup) -> Result<Self, SetupError> {
        Self::new(setup, Carriage::SemiLagrangian)
    }

    /// MacCormack's correction of it (Selle, Fedkiw, Kim, Liu, Rossignac 2008), limited.
    ///
    /// # Errors
    /// As [`Traced::semi_lagrangian`].
    pub fn maccormack(setup: &Setup) -> Result<Self, SetupError> {
        Self::new(setup, Carriage::MacCormack)
    }

    /// Advection and reflection (Zehnder, Narain, Thomaszewski 2018) with limited cubic
    /// interpolation.
    ///
    /// # Errors
    /// As [`Traced::semi_lagrangian`].
    pub fn reflection(setup: &Setup) -> Result<Self, SetupError> {
        Self::new(setup, Carriage::Reflection)
    }

    fn new(setup: &Setup, carriage: Carriage) -> Result<Self, SetupError> {
        if setup.vessel != Vessel::Box {
            return Err(SetupError::Unsupported("the traced solvers know no vessel but a box"));
        }
        Ok(Self { carriage, flow: Flow::new(setup)? })
    }
}

impl Solver for Traced {
    fn set_velocity(&mut self, velocity_m_s: &VectorField<'_>) -> Result<(), Refused> {
        self.flow.set_velocity(velocity_m_s)
    }

    fn set_force(&mut self, acceleration_m_s2: &VectorField<'_>) -> Result<(), Refused> {
        self.flow.set_force(acceleration_m_s2)
    }

    fn scale_force(&mut self, start: f64, end: f64) -> Result<(), Refused> {
        self.flow.scale_force(start, end)
    }

    fn step(&mut self, dt_s: f64) -> Result<StepReport, Refused> {
        let mut report =
            StepReport { substeps: 1, scheme: Scheme::Traced, ..StepReport::at_rest() };
        self.flow.carry_alone(self.carriage, dt_s, &mut report)?;
        report.kinetic_energy_j = self.flow.kinetic_energy_j();
        report.asleep = false;
        Ok(report)
    }

    fn project(&mut self) {
        self.flow.project();
    }

    fn visit(&self, visit: &mut VisitVelocity<'_>) {
        self.flow.visit(visit);
    }

    fn divergence_l2_per_s(&self) -> f64 {
        self.flow.divergence_l2_per_s()
    }

    fn divergence_max_per_s(&self) -> f64 {
        self.flow.divergence_max_per_s()
    }

    fn velocity_at(&self, point_in_world_m: Vec3) -> Vec3 {
        self.flow.velocity_at(point_in_world_m)
    }

    fn kinetic_energy_j(&self) -> f64 {
        self.flow.kinetic_energy_j()
    }
}
