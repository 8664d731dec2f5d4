//! The pressure under a lid: what a rigid top holds down. A free surface on the same liquid would
//! stand higher by its height (Lamb 1932), so this is what the surface is pressed with from below;
//! the flow itself goes on under its lid, and no inertia is counted twice.

use glam::{DVec3, Vec2, Vec3};

use super::{
    Flow, MAX_SPEED_M_S, faces::Faces, field::Layout, ghosts::Fill, pressure::masses,
    trace::face_in_cells,
};

/// What the top layer of cells was pressed with in a step.
pub(super) struct Lid {
    /// Time integral of the pressure per density and spacing in each cell, in m/s, x fastest.
    pressed_m_s: Vec<f32>,
    /// Length of the step.
    step_s: f64,
}

impl Lid {
    /// Begins a step.
    pub(super) fn open(&mut self, step_s: f64) {
        self.pressed_m_s.fill(0.0);
        self.step_s = step_s;
    }

    /// Counts a pressure field times `times`.
    pub(super) fn press(&mut self, layout: &Layout, field: &[f32], times: f64) {
        let ([nx, ny, _], times) = (layout.cells, times as f32);
        for (k, row) in self.pressed_m_s.chunks_exact_mut(nx).enumerate() {
            let field = &field[layout.index(0, ny - 1, k)..][..nx];
            row.iter_mut().zip(field).for_each(|(sum, p)| *sum += times * p);
        }
    }

    /// The value between cells that hold liquid: linear, and that of the nearest beyond them.
    fn at(&self, layout: &Layout, faces: &Faces, at: Vec3) -> f32 {
        let [nx, ny, nz] = layout.cells;
        let along = |x: f32, n: usize| {
            let held = (x - 0.5).max(0.0).min((n - 1) as f32);
            let cell = (held as usize).min(n.saturating_sub(2));
            [(cell, 1.0 - (held - cell as f32)), ((cell + 1).min(n - 1), held - cell as f32)]
        };
        let [mut sum, mut shares] = [0.0; 2];
        for (k, z_share) in along(at.z, nz) {
            for (i, x_share) in along(at.x, nx) {
                let is_liquid = faces.liquid[layout.index(i, ny - 1, k)] > 0.0;
                let share = if is_liquid { x_share * z_share } else { 0.0 };
                sum += share * self.pressed_m_s[i + nx * k];
                shares += share;
            }
        }
        if shares > 0.0 { sum / shares } else { 0.0 }
    }
}

impl Flow {
    /// From now on notes what the top of the box is pressed with in each step: what was found of
    /// the pressure is stored then, where it need not be otherwise.
    pub fn watch_lid(&mut self) {
        let [nx, _, nz] = self.layout.cells;
        self.lid.get_or_insert_with(|| Lid { pressed_m_s: vec![0.0; nx * nz], step_s: 0.0 });
    }

    /// Mean pressure in pascal over the last step under the top of the box, above or below that at
    /// an unknown level, at the x and z of a point; 0 if nobody watches it, or nothing moved.
    #[must_use]
    pub fn lid_pressure_pa(&self, point_in_world_m: Vec3) -> f32 {
        let Some(lid) = self.lid.as_ref().filter(|lid| lid.step_s > 0.0) else { return 0.0 };
        let pressed_m_s = lid.at(&self.layout, &self.faces, self.in_cells(point_in_world_m));
        let scale = self.density_kg_m3 * f64::from(self.grid.spacing_m) / lid.step_s;
        scale as f32 * pressed_m_s
    }

    /// Drags the top layer of cells along by a stress over density, given for x and z at places in
    /// world metres, held for `dt_s`; less of it if that brought more energy than `most_j`. Returns
    /// the change of [`Flow::momentum_n_s`].
    pub fn drag_lid(
        &mut self,
        stress_m2_s2: impl Fn(Vec3) -> Vec2,
        dt_s: f32,
        most_j: f64,
    ) -> DVec3 {
        let per_m = dt_s / self.grid.spacing_m;
        // The energy by a share s of it: a s^2 + b s.
        let [mut a, mut b] = [0.0; 2];
        self.visit_lid(&stress_m2_s2, |_, u, stress, mass| {
            let gain = f64::from(per_m * stress);
            (a, b) = (a + 0.5 * mass * gain * gain, b + mass * gain * f64::from(*u));
        });
        let most = most_j / self.cell_mass_kg();
        let share = if a + b > most {
            (((b * b + 4.0 * a * most).max(0.0).sqrt() - b) / (2.0 * a)).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let per_m = per_m * share as f32;
        let mut change = DVec3::ZERO;
        self.visit_lid(&stress_m2_s2, |c, u, stress, mass| {
            let before = *u;
            *u = (*u + per_m * stress).clamp(-MAX_SPEED_M_S, MAX_SPEED_M_S);
            change[c] += mass * (f64::from(*u) - f64::from(before));
        });
        self.ghosts.fill(&mut self.velocity, Fill::Projected);
        self.survey = None;
        change * self.cell_mass_kg()
    }

    /// Calls `visit(axis, velocity, stress along it, mass in cells)` for the open faces across x
    /// and z of the top layer.
    fn visit_lid(
        &mut self,
        stress_m2_s2: &impl Fn(Vec3) -> Vec2,
        mut visit: impl FnMut(usize, &mut f32, f32, f64),
    ) {
        let [nx, ny, nz] = self.layout.cells;
        let mass = masses(&self.faces, self.mixture.as_ref().and_then(|mixture| mixture.weight()));
        for c in [0, 2] {
            for (k, i) in (0..nz).flat_map(|k| (0..nx).map(move |i| (k, i))) {
                let at = self.layout.index(i, ny - 1, k);
                if self.faces.open[c][at] > 0.0 {
                    let in_cells = face_in_cells(c, i, ny - 1, k);
                    let place = self.grid.origin_in_world_m + self.grid.spacing_m * in_cells;
                    let stress = stress_m2_s2(place);
                    let along = if c == 0 { stress.x } else { stress.y };
                    let mass = mass.map_or(1.0, |mass| f64::from(mass[c][at]));
                    visit(c, &mut self.velocity[c][at], along, mass);
                }
            }
        }
    }

    /// Counts what the last projection found, for who watches the lid.
    pub(super) fn press_lid(&mut self, times: f64) {
        if let Some(lid) = &mut self.lid {
            lid.press(&self.layout, self.projection.found(), times);
        }
    }
}
