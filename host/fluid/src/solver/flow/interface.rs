//! What benchmarks and tests know of a flow: [`Solver`].

use glam::Vec3;

use crate::solver::{
    Refused, Solver, StepReport, VectorField, VisitVelocity,
    flow::{
        Flow, Force, MAX_ACCELERATION_M_S2, MAX_SPEED_M_S, engine::Engine, field::components,
        ghosts::Fill, pressure::Telling, trace::Tracer,
    },
    within,
};

impl Solver for Flow {
    fn set_velocity(&mut self, velocity_m_s: &VectorField<'_>) -> Result<(), Refused> {
        let mut sampled = [self.layout.zeros(), self.layout.zeros(), self.layout.zeros()];
        let limit = f64::from(MAX_SPEED_M_S);
        self.sample("velocity_m_s", velocity_m_s, limit, &mut sampled)?;
        self.velocity = sampled;
        self.faces.hold(&mut self.velocity);
        self.ghosts.fill(&mut self.velocity, Fill::Unprojected);
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
        let Self { faces, ghosts, velocity, pool, simd, projection, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        let density = self.mixture.as_ref().and_then(|mixture| mixture.weight());
        projection.project(on, ghosts, velocity, Telling::Nothing, density, false);
        self.survey = None;
    }

    fn visit(&self, visit: &mut VisitVelocity<'_>) {
        let mut visit =
            |c: usize, at: usize, point| visit(point, c, f64::from(self.velocity[c][at]));
        self.visit_open(&self.faces.open, &mut visit);
        self.visit_open_above(&self.faces, &mut visit);
    }

    fn divergence_l2_per_s(&self) -> f64 {
        let [_, squares, cells] = self.outflow();
        (squares / cells.max(1.0)).sqrt() / f64::from(self.grid.spacing_m)
    }

    fn divergence_max_per_s(&self) -> f64 {
        let [largest, ..] = self.outflow();
        largest / f64::from(self.grid.spacing_m)
    }

    fn velocity_at(&self, point_in_world_m: Vec3) -> Vec3 {
        let tracer = Tracer::new(&self.layout, &self.ghosts);
        tracer.velocity_at(components(&self.velocity), self.in_cells(point_in_world_m))
    }

    fn kinetic_energy_j(&self) -> f64 {
        self.surveyed().energy_m2_s2 * self.cell_mass_kg()
    }
}
