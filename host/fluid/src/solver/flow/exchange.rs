//! Momentum between a small body and the flow.
//!
//! What the body gives to the flow is spread over the open faces around it, and what it feels
//! of the flow is gathered from them, with one and the same weights, which sum to 1 for each
//! component whatever walls cut off. So nothing is lost at a wall, and the power that the body
//! spends is the power that the flow gets.
//! ```text
//! w_f = m_f (1 - r^2/R^2)^2 / sum,   R = max(radius, 2 h)
//! u_f += J w_f / (m_f rho h^3),   gathered u = sum w_f u_f
//! ```
//! m_f is the part of the face that walls leave open, times its density where that differs.

use glam::{DVec3, Vec3};

use crate::solver::{
    Refused,
    flow::{
        Flow, MAX_SPEED_M_S,
        faces::Faces,
        field::{Layout, Vector, components},
        ghosts::Fill,
        pressure::masses,
        trace::face_in_cells,
    },
    not_negative, within,
};

/// Narrower than this many cells a kernel would fall between the faces.
const MIN_RADIUS_CELLS: f32 = 2.0;

/// The spreading kernel of a body; all lengths in cells from the grid's corner.
pub struct Kernel<'a> {
    layout: &'a Layout,
    faces: &'a Faces,
    mass: Option<&'a Vector>,
    centre: Vec3,
    radius: f32,
}

impl<'a> Kernel<'a> {
    /// The kernel of a body of `radius` cells at `centre`, among faces of these masses, or all
    /// whole and alike.
    pub fn new(
        layout: &'a Layout,
        faces: &'a Faces,
        mass: Option<&'a Vector>,
        centre: Vec3,
        radius: f32,
    ) -> Self {
        // The whole grid is as wide as a kernel ever needs to be.
        let widest = layout.cells.iter().sum::<usize>() as f32;
        let radius = radius.max(MIN_RADIUS_CELLS).min(widest.max(MIN_RADIUS_CELLS));
        Self { layout, faces, mass, centre, radius }
    }

    /// Calls `visit(index, mass in cells, weight / mass)` for the open faces of component `c`;
    /// weights sum to 1. Nothing is visited if no open face is within reach.
    fn visit(&self, c: usize, mut visit: impl FnMut(usize, f64, f64)) {
        let mut sum = 0.0;
        self.visit_raw(c, |_, mass, shape| sum += mass * shape);
        if sum > 0.0 {
            self.visit_raw(c, |at, mass, shape| visit(at, mass, shape / sum));
        }
    }

    fn visit_raw(&self, c: usize, mut visit: impl FnMut(usize, f64, f64)) {
        let range = |d: usize| {
            let [low, high] = [-1.0, 1.0].map(|side| self.centre[d] + side * self.radius);
            let last = self.layout.cells[d];
            (low.floor().max(0.0) as usize).min(last)..((high.ceil() + 1.0) as usize).min(last)
        };
        for k in range(2) {
            for j in range(1) {
                for i in range(0) {
                    let at = self.layout.index(i, j, k);
                    let from_centre = face_in_cells(c, i, j, k) - self.centre;
                    let inside = 1.0 - from_centre.length_squared() / (self.radius * self.radius);
                    if inside > 0.0 && self.faces.open[c][at] > 0.0 {
                        let shape = f64::from(inside) * f64::from(inside);
                        let mass = self.mass.map_or(1.0, |mass| f64::from(mass[c][at]));
                        visit(at, mass, shape);
                    }
                }
            }
        }
    }

    /// Adds `impulse` to the velocity, in units of cell mass times velocity, and returns the
    /// change that the rounded velocities made of it. No speed is raised above `limit`.
    pub fn push(&self, velocity: [&mut [f32]; 3], impulse: DVec3, limit: f32) -> DVec3 {
        let mut change = DVec3::ZERO;
        for (c, u) in velocity.into_iter().enumerate() {
            self.visit(c, |at, mass, per_mass| {
                let before = u[at];
                let after = (f64::from(before) + impulse[c] * per_mass) as f32;
                u[at] = after.clamp(-limit, limit);
                change[c] += mass * (f64::from(u[at]) - f64::from(before));
            });
        }
        change
    }

    /// The energy that [`Kernel::push`] gives, in units of cell mass times velocity squared.
    pub fn work(&self, velocity: [&[f32]; 3], impulse: DVec3) -> f64 {
        let mut work = 0.0;
        for (c, u) in velocity.into_iter().enumerate() {
            self.visit(c, |at, mass, per_mass| {
                let gain = impulse[c] * per_mass;
                work += mass * gain * (f64::from(u[at]) + 0.5 * gain);
            });
        }
        work
    }

    /// 1 for each component that has an open face within reach, else 0.
    pub fn reach(&self) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|c| {
            let mut weight = 0.0;
            self.visit(c, |_, mass, per_mass| weight += mass * per_mass);
            weight.round()
        }))
    }

    /// The weighted mean of the velocity.
    pub fn gather(&self, velocity: [&[f32]; 3]) -> DVec3 {
        let mut mean = DVec3::ZERO;
        for (c, u) in velocity.into_iter().enumerate() {
            self.visit(c, |at, mass, per_mass| mean[c] += mass * per_mass * f64::from(u[at]));
        }
        mean
    }

    /// The mass that an impulse moves before the pressure spreads it, in cells, as a mean over
    /// the components: 1 / sum w^2/m. Infinite out of reach of the liquid.
    pub fn mass_in_cells(&self) -> f64 {
        let mut squares = 0.0;
        (0..3)
            .for_each(|c| self.visit(c, |_, m, per_mass| squares += m * per_mass * per_mass / 3.0));
        1.0 / squares
    }
}

impl Flow {
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
        let radius_m = not_negative("radius_m", radius_m)? as f32;
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
        self.survey = None;
        Ok(change * mass_kg)
    }

    /// Energy in joules that [`Flow::push`] would bring to the liquid with an impulse, but for
    /// rounding: J . u + |J|^2 / 2m, of the mass m that it moves at once.
    #[must_use]
    pub fn push_work_j(&self, centre_in_world_m: Vec3, radius_m: f32, impulse_n_s: DVec3) -> f64 {
        let mass_kg = self.cell_mass_kg();
        if mass_kg <= 0.0 {
            return 0.0;
        }
        let kernel = self.kernel(centre_in_world_m, radius_m);
        mass_kg * kernel.work(components(&self.velocity), impulse_n_s / mass_kg)
    }

    /// Mean velocity of the liquid around a point, weighted as [`Flow::push`] spreads; zero
    /// where no liquid is in reach.
    #[must_use]
    pub fn gather(&self, centre_in_world_m: Vec3, radius_m: f32) -> Vec3 {
        self.kernel(centre_in_world_m, radius_m).gather(components(&self.velocity)).as_vec3()
    }

    /// The mass that an impulse at a point moves at once, before the pressure has spread it:
    /// rho h^3 / sum of squared weights. Infinite where no liquid is in reach.
    #[must_use]
    pub fn effective_mass_kg(&self, centre_in_world_m: Vec3, radius_m: f32) -> f64 {
        self.cell_mass_kg() * self.kernel(centre_in_world_m, radius_m).mass_in_cells()
    }

    pub(super) fn kernel(&self, centre_in_world_m: Vec3, radius_m: f32) -> Kernel<'_> {
        let radius = radius_m / self.grid.spacing_m;
        let centre = self.in_cells(centre_in_world_m);
        Kernel::new(&self.layout, &self.faces, self.masses(), centre, radius)
    }
}
