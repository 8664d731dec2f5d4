//! Obstacles of a [`Flow`]: where they are, and what they do to its faces when they move.

mod place;

use glam::{DVec3, Vec3};

use self::place::{Place, Span, united};
use crate::{
    solver::{
        Motion, Obstacle, ObstacleId, Refused, Walls,
        flow::{
            Flow,
            faces::{Faces, Section},
            field::Layout,
            ghosts::Fill,
            pressure::{Prediction, Projection},
            reaction::{Account, Wrench},
            solids::{Covered, Solids, balance::Balance},
            walls::{Depth, WallFaces},
        },
    },
    vessel::cut::{CellBox, Cut, each},
};

/// An obstacle in the grid.
pub struct Body {
    pub id: u32,
    pub obstacle: Obstacle,
    /// The cells that it has to do with.
    span: Span,
    /// The way that it has come since the last step, and the share of what its velocity says.
    came_m: f32,
    share: f32,
    /// What the liquid gave it.
    pub account: Account,
}

impl Body {
    fn new(id: u32, obstacle: Obstacle, span: Span) -> Self {
        Self { id, obstacle, span, came_m: 0.0, share: 0.0, account: Account::default() }
    }
}

/// All obstacles of a flow, and what they have to know of it.
pub struct Obstacles {
    pub bodies: Vec<Body>,
    pub place: Place,
    cut: Cut,
    depth: Option<Depth>,
    /// The faces as the vessel alone leaves them.
    pub bare: Faces,
    balance: Balance,
    /// Velocities at faces beside bodies, before and after an implicit part.
    pub beside: [[Vec<f32>; 3]; 2],
    next_id: u32,
    /// What pressure met so far in what bodies displaced.
    pub displacing_m2_s2: f64,
}

impl Obstacles {
    fn index_of(&self, id: ObstacleId) -> Result<usize, Refused> {
        let index = self.bodies.iter().position(|body| body.id == id.0);
        index.ok_or(Refused { what: "obstacle", value: f64::from(id.0) })
    }

    /// Largest |u| + |v| + |w| of a point of an obstacle.
    pub fn speed_m_s(&self) -> f64 {
        let speed = |body: &Body| {
            let Motion { velocity_m_s, angular_velocity_rad_s, .. } = body.obstacle.motion;
            let turning = angular_velocity_rad_s.length() * body.obstacle.shape.reach_m();
            f64::from(velocity_m_s.abs().element_sum() + 1.8 * turning)
        };
        self.bodies.iter().map(speed).fold(0.0, f64::max)
    }

    /// The solid's velocity at a face, and the way to it from the solid's centre.
    pub fn wall_at(&self, layout: &Layout, c: usize, at: usize, body: &Body) -> (Vec3, Vec3) {
        let point = self.place.face_in_world_m(c, layout.cell_of(at));
        let from_centre_m = self.place.way_to_m(&body.obstacle.motion, point);
        (body.obstacle.motion.velocity_at(from_centre_m), from_centre_m)
    }

    /// The obstacle of that number.
    pub fn body(&self, id: u32) -> Option<&Body> {
        self.bodies.iter().find(|body| body.id == id)
    }

    /// Cuts cells and faces anew where obstacles were or are.
    fn reshape(&mut self, flow: &mut Flow, changed: &[Span]) {
        let Self { bodies, place, cut, depth, .. } = self;
        for part in changed.iter().flat_map(|span| place.parts(span)) {
            cut.obstruct(&part, |point| place.nearest(bodies, point).1);
        }
        for part in changed.iter().flat_map(|span| place.parts(span)) {
            let section = Section { layout: &flow.layout, sides: &flow.sides, cut };
            flow.faces.refresh(section, depth.as_mut(), &part);
            if let Some(vessel) = &mut flow.faces.vessel {
                let owner = |c, at| {
                    let point = place.face_in_world_m(c, flow.layout.cell_of(at));
                    let (body, distance_m) = place.nearest(bodies, point);
                    let is_nearer = distance_m < flow.vessel.depth_inside_m(point);
                    body.filter(|_| is_nearer).map(|body| body.id)
                };
                vessel.walls.own(&flow.layout, &part, owner);
            }
            flow.fill_pressure_in(&part);
        }
        flow.refit_mixture();
    }

    /// Lets the flow know of all that moves.
    fn set_motion(&mut self, flow: &mut Flow) {
        let Some(mut solids) = flow.faces.vessel.as_mut().and_then(|vessel| vessel.solids.take())
        else {
            return;
        };
        let Flow { layout, ghosts, faces, velocity, .. } = flow;
        if flow.walls == Walls::FreeSlip {
            solids.uncover(layout, &faces.open, velocity);
        }
        if let Some(vessel) = &faces.vessel {
            for c in 0..3 {
                solids.cover(c, self.covered(layout, c, &vessel.area[c]));
            }
            solids.set_swell(layout, ghosts, &faces.liquid);
            if solids.is_moving || flow.is_driven {
                solids.balance(&mut self.balance, layout, ghosts, faces, velocity);
            }
            ghosts.wrap_cells(&mut solids.swell);
            self.set_beside(layout, &vessel.walls, &mut solids);
        }
        solids.hold(velocity);
        if let Some(vessel) = &mut faces.vessel {
            vessel.solids = Some(solids);
        }
        flow.touched();
    }

    fn set_beside(&self, layout: &Layout, walls: &WallFaces, solids: &mut Solids) {
        solids.set_beside(layout, walls, |c, at, owner| {
            let body = self.body(owner);
            body.map_or((0.0, 0.0), |body| (self.wall_at(layout, c, at, body).0[c], body.share))
        });
    }

    /// Takes note of how far bodies have come for a step of this length.
    pub fn sweep(&mut self, layout: &Layout, faces: &mut Faces, dt_s: f64) {
        let mut has_changed = false;
        for body in &mut self.bodies {
            let said_m = body.obstacle.motion.velocity_m_s.length() * dt_s as f32;
            let came_m = std::mem::take(&mut body.came_m);
            let share = if said_m > 0.0 { (came_m / said_m).min(1.0) } else { 0.0 };
            has_changed |= std::mem::replace(&mut body.share, share) != share;
        }
        if let (Some(vessel), true) = (&mut faces.vessel, has_changed)
            && let Some(solids) = &mut vessel.solids
        {
            self.set_beside(layout, &vessel.walls, solids);
        }
    }

    /// The faces of component `c` that solids cover.
    fn covered(&self, layout: &Layout, c: usize, area: &[f32]) -> Vec<Covered> {
        let mut covered = Vec::new();
        for body in &self.bodies {
            for mut part in self.place.parts(&body.span) {
                let is_end = part[c].end == layout.cells[c] && !self.place.is_periodic[c];
                part[c].end += usize::from(is_end);
                each(&part, |face| {
                    let at = layout.index(face[0], face[1], face[2]);
                    let part = self.bare.mass(c, at) as f32 - area[at];
                    if part <= 0.0 {
                        return;
                    }
                    let point = self.place.face_in_world_m(c, face);
                    let nearest = self.place.nearest(&self.bodies, point).0;
                    if nearest.is_some_and(|nearest| nearest.id == body.id) {
                        let velocity_m_s = self.wall_at(layout, c, at, body).0[c];
                        let is_side = !self.place.is_periodic[c]
                            && (face[c] == 0 || face[c] == layout.cells[c]);
                        let is_closed = area[at] == 0.0 && !is_side;
                        let at = at as u32;
                        let owner = body.id;
                        covered.push(Covered { at, owner, part, velocity_m_s, is_closed, is_side });
                    }
                });
            }
        }
        covered
    }
}

impl Flow {
    /// Puts a solid into the liquid. Its wall is like [`Setup::walls`](crate::solver::Setup) say,
    /// and cuts cells as a vessel's does. What it covers is liquid no more.
    ///
    /// In a box without a vessel, the pressure is solved for iteratively from the first obstacle
    /// on, until the last is removed.
    ///
    /// # Errors
    /// [`Refused`] if [`Obstacle::check`] says so; nothing is changed.
    ///
    /// Drag on a ball in a slow stream, which by Stokes' law would be 6 pi mu a u if there were
    /// no other balls beside it:
    /// ```
    /// use std::f64::consts::PI;
    ///
    /// use cauldron_fluid::{
    ///     Grid, Vessel,
    ///     solver::{Obstacle, Setup, Side, Sides, Solver, Walls, flow::Flow},
    /// };
    /// use glam::{DVec3, Vec3};
    ///
    /// let stream = [Side::Inflow(Vec3::X), Side::Outflow];
    /// let sides = Sides::all(Side::FreeSlip).with(0, stream);
    /// let setup = Setup {
    ///     viscosity_m2_s: 1.0,
    ///     sides,
    ///     walls: Walls::NoSlip,
    ///     ..Setup::new(Grid::unit_cube(16), Vessel::Box)
    /// };
    /// let mut flow = Flow::new(&setup)?;
    /// let ball = flow.add_obstacle(Obstacle::sphere(Vec3::splat(0.5), 0.1))?;
    /// for _ in 0..20 {
    ///     flow.step(0.02)?;
    /// }
    /// let stokes_n = 6.0 * PI * 1000.0 * 0.1;
    /// let drag = flow.force_on_n(ball)?.x / stokes_n;
    /// assert!(1.0 < drag && drag < 2.0, "{drag}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add_obstacle(&mut self, mut obstacle: Obstacle) -> Result<ObstacleId, Refused> {
        obstacle.check()?;
        obstacle.motion.rotation = obstacle.motion.rotation.normalize();
        let mut obstacles = match self.obstacles.take() {
            Some(obstacles) => obstacles,
            None => Box::new(self.make_room()),
        };
        obstacles.next_id += 1;
        let (id, span) = (obstacles.next_id, obstacles.place.span(&obstacle));
        obstacles.bodies.push(Body::new(id, obstacle, span.clone()));
        obstacles.reshape(self, &[span]);
        self.forget();
        obstacles.set_motion(self);
        self.obstacles = Some(obstacles);
        Ok(ObstacleId(id))
    }

    /// Says where an obstacle is from now on, and how fast it moves there. The flow does not move
    /// it by itself: a moving obstacle is to be told where it is at the end of each step, before
    /// that step. It may be anywhere, also beyond the sides (where it has no effect) or in the
    /// place of another, and come there at once: what it leaves is liquid with its last velocity
    /// (or, where walls slide, with that of the liquid around). Through a periodic side it comes
    /// in again. Where liquid that is shut in is asked to give way, it is taken to shrink or swell.
    ///
    /// The cost is that of the cells about it, and of looking at all to see which are shut in; in a
    /// medium that is not the same everywhere, of setting anew what that makes of all.
    ///
    /// # Errors
    /// [`Refused`] if there is no such obstacle, or [`Obstacle::check`] says so; nothing is
    /// changed.
    pub fn move_obstacle(&mut self, id: ObstacleId, motion: Motion) -> Result<(), Refused> {
        let index = self.index_of(id)?;
        let Some(mut obstacles) = self.obstacles.take() else { return Ok(()) };
        let body = &mut obstacles.bodies[index];
        let moved = Obstacle { motion, ..body.obstacle.clone() };
        let checked = moved.check();
        if checked.is_ok() {
            let before = std::mem::replace(&mut body.obstacle, moved).motion;
            let after = &mut body.obstacle.motion;
            after.rotation = motion.rotation.normalize();
            let way_m = after.centre_in_world_m.distance(before.centre_in_world_m);
            body.came_m += way_m;
            if way_m > 0.0 || after.rotation != before.rotation {
                let span = obstacles.place.span(&body.obstacle);
                let left = std::mem::replace(&mut body.span, span.clone());
                obstacles.reshape(self, &united(left, span));
            }
            if way_m > self.grid.spacing_m {
                self.forget();
            }
            obstacles.set_motion(self);
        }
        self.obstacles = Some(obstacles);
        checked
    }

    /// Takes an obstacle out: liquid with its last velocity is left in its place.
    ///
    /// # Errors
    /// [`Refused`] if there is no such obstacle.
    pub fn remove_obstacle(&mut self, id: ObstacleId) -> Result<(), Refused> {
        let index = self.index_of(id)?;
        let Some(mut obstacles) = self.obstacles.take() else { return Ok(()) };
        let body = obstacles.bodies.remove(index);
        self.forget();
        if obstacles.bodies.is_empty() {
            self.faces = obstacles.bare;
            self.remake_solvers();
            self.touched();
            return Ok(());
        }
        obstacles.reshape(self, &[body.span]);
        obstacles.set_motion(self);
        self.obstacles = Some(obstacles);
        Ok(())
    }

    /// The force of the liquid on an obstacle: the mean over the last step, with its lift in what
    /// [`Solver::set_force`](crate::solver::Solver::set_force) pulls. It is what pressure and
    /// friction took from the momentum of the liquid; in steps that were traced
    /// ([`Scheme::Traced`](crate::solver::Scheme)), without what tracing lost beside the
    /// obstacle. Forces on an obstacle that moves vary by some per cent as it passes from cell to
    /// cell: take means over a cell's length.
    ///
    /// What gravity lifts it by is in the force as far as the liquid around it is denser or lighter
    /// than what the flow counts by ([`Flow::cell_mass_kg`]): in liquid that is the same everywhere
    /// gravity does nothing, and lifts nothing. Where densities weigh and differ beside the
    /// obstacle, its share of the momentum that flows carry is by the density at each face.
    ///
    /// # Errors
    /// [`Refused`] if there is no such obstacle.
    pub fn force_on_n(&self, id: ObstacleId) -> Result<DVec3, Refused> {
        self.mean_of(id).map(|mean| mean.force)
    }

    /// The torque of the liquid on an obstacle about its centre, as [`Flow::force_on_n`].
    ///
    /// # Errors
    /// [`Refused`] if there is no such obstacle.
    pub fn torque_on_n_m(&self, id: ObstacleId) -> Result<DVec3, Refused> {
        self.mean_of(id).map(|mean| mean.torque)
    }

    /// What passes sides has changed, and with it what liquid beside obstacles can give.
    pub(super) fn sides_have_changed(&mut self) {
        self.touched();
        if let Some(mut obstacles) = self.obstacles.take() {
            obstacles.set_motion(self);
            self.obstacles = Some(obstacles);
        }
    }

    fn mean_of(&self, id: ObstacleId) -> Result<Wrench, Refused> {
        let index = self.index_of(id)?;
        Ok(self.obstacles.as_ref().map_or(Wrench::ZERO, |all| all.bodies[index].account.mean))
    }

    fn index_of(&self, id: ObstacleId) -> Result<usize, Refused> {
        let unknown = Refused { what: "obstacle", value: f64::from(id.0) };
        self.obstacles.as_ref().ok_or(unknown)?.index_of(id)
    }

    /// Room for obstacles, and faces that they can cut.
    fn make_room(&mut self) -> Obstacles {
        let (layout, sides) = (&self.layout, &self.sides);
        let cut = Cut::new(&self.grid, &self.vessel);
        let mut depth = (self.walls == Walls::NoSlip).then(|| Depth::new(layout));
        let mut faces = Faces::of_section(Section { layout, sides, cut: &cut }, depth.as_mut());
        if let Some(vessel) = &mut faces.vessel {
            vessel.solids = Some(Solids::new(layout));
        }
        let balance = Balance::new(layout);
        let bare = std::mem::replace(&mut self.faces, faces);
        self.remake_solvers();
        Obstacles {
            bodies: Vec::new(),
            place: Place {
                grid: self.grid,
                is_periodic: [0, 1, 2].map(|axis| self.sides.is_periodic(axis)),
            },
            cut,
            depth,
            bare,
            balance,
            beside: Default::default(),
            next_id: 0,
            displacing_m2_s2: 0.0,
        }
    }

    /// Makes what solves for pressure and friction, once the faces are others.
    fn remake_solvers(&mut self) {
        self.projection = Projection::new(&self.layout, &self.faces, &self.ghosts, &self.pool);
        self.viscous = None;
        if self.viscosity_m2_s > 0.0 {
            self.make_viscous();
        }
        self.remake_mixture();
    }

    /// Nothing that was extrapolated from the last step holds any more.
    fn forget(&mut self) {
        self.pressure_dt_s = 0.0;
        self.history = None;
    }

    /// Brings up to date what follows from the velocity, once it was changed.
    fn touched(&mut self) {
        self.ghosts.fill(&mut self.velocity, Fill::Projected);
        self.survey = None;
    }

    /// No pressure in cells that hold no liquid, that of their neighbours in those that do again.
    fn fill_pressure_in(&mut self, part: &CellBox) {
        let strides = self.layout.strides();
        let (liquid, Prediction { next, trend, .. }) = (&self.faces.liquid, &mut self.pressure);
        each(part, |[i, j, k]| {
            let at = self.layout.index(i, j, k);
            if liquid[at] == 0.0 {
                (next[at], trend[at]) = (0.0, 0.0);
            } else if next[at] == 0.0 {
                let around = strides.into_iter().flat_map(|stride| [at - stride, at + stride]);
                let known = around.map(|at| next[at]).filter(|next| *next != 0.0);
                let (sum, count) = known.fold((0.0, 0.0), |(s, n), next| (s + next, n + 1.0));
                next[at] = if count > 0.0 { sum / count } else { 0.0 };
            }
        });
    }
}
