//! A body that drags the liquid along, solved for together with it.
//!
//! A push that is known beforehand (see [`super::exchange`]) swings once the drag takes the liquid
//! beyond the body's velocity within a step: c dt > m of what it moves, as in honey. Here the force
//! is what it is at the end of each part of a step,
//! ```text
//! J = c dt (v - g),   g = g_free + R J,   so that   (1/(c dt) + R) J = v - g_free
//! R = W' Z,           Z = P (M + s V)^-1 P' W
//! ```
//! g being the gathered velocity, W the weights of the kernel, P the projection, and (M + s V)^-1
//! the implicit friction of the part, if that has any: what liquid at rest does with a unit push.
//! As the part is linear in a push, its result changes by Z J: a change of its matrix by one row
//! and column for each component (Sherman, Morrison 1950; Woodbury 1950). R is symmetric and
//! positive, so g is between g_free and v, whatever c and dt. Conjugate gradients (Hestenes,
//! Stiefel 1952) find the three components of J: one response Z suffices where all directions are
//! alike, three always do.

mod response;

use glam::{DVec3, Vec3};

use crate::solver::{
    Refused, Scheme, StepReport,
    flow::{
        Flow, MAX_SPEED_M_S,
        field::{Field, Layout, Vector, components, vector_bytes},
        ghosts::Fill,
        step::Part,
        survey::Survey,
        viscous::implicit_share,
    },
    not_negative, within,
};

/// What the gathered velocity may miss of that which the drag asks for, as a part of what it
/// missed without.
const TOLERANCE: f64 = 1e-3;

/// Mean velocity of a response as it is computed: far above what counts as rest ...
const RESPONSE_M_S: f64 = 1e3;

/// ... also where friction takes most of it; this much at most, or squares leave f32.
const MOST_FRICTION: f64 = 1e9;

/// A body of linear drag that moves as it is told to: the liquid gets c (v - u), u being its
/// velocity around the body as [`Flow::gather`] has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// Where the body is during the next steps.
    pub centre_in_world_m: Vec3,
    /// How far around it liquid is dragged; at least two cells.
    pub radius_m: f32,
    /// The coefficient c, 0 to 10^6.
    pub drag_n_s_per_m: f32,
    /// Its velocity v, at most 10 km/s along each axis.
    pub velocity_m_s: Vec3,
}

/// The drag, what it did, and room for that.
pub(super) struct Coupling {
    drag: Drag,
    /// What it gave in the step so far.
    impulse_n_s: DVec3,
    work_m2_s2: f64,
    /// What the liquid does with a push.
    response: Vector,
    /// The part of nu dt / h^2 that acted on it, or of dt where friction differs from place to
    /// place; 0 if none did.
    friction: f64,
    /// The pressure that took the divergence out of the push before that, times the step.
    pressure: Field,
}

impl Drag {
    fn check(self) -> Result<Self, Refused> {
        let Self { centre_in_world_m, radius_m, drag_n_s_per_m, velocity_m_s } = self;
        for value in centre_in_world_m.to_array() {
            within("centre_in_world_m", f64::from(value), f64::from(f32::MAX))?;
        }
        not_negative("radius_m", radius_m)?;
        not_negative("drag_n_s_per_m", drag_n_s_per_m)?;
        for value in velocity_m_s.to_array() {
            within("velocity_m_s", f64::from(value), f64::from(MAX_SPEED_M_S))?;
        }
        Ok(self)
    }

    fn moves(&self) -> bool {
        self.drag_n_s_per_m > 0.0 && self.velocity_m_s != Vec3::ZERO
    }
}

impl Coupling {
    fn new(layout: &Layout, drag: Drag) -> Self {
        Self {
            drag,
            impulse_n_s: DVec3::ZERO,
            work_m2_s2: 0.0,
            response: layout.zero_vector(),
            friction: 0.0,
            pressure: layout.zeros(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        vector_bytes(&self.response) + self.pressure.bytes()
    }
}

impl Flow {
    /// Lets a body drag the liquid along in all steps from the next one on, in place of the one
    /// before; `None` lets it go. Unlike a [`Flow::push`], the drag is solved for together with
    /// the liquid: however strong it is, and however long the step, the liquid is not dragged
    /// beyond the body's velocity. Where the body is and how it moves may change before each step;
    /// room is made with the first drag, and given back with `None`.
    ///
    /// Each part of a step then takes one to three responses of the liquid to a push: a solution
    /// for the pressure each, and where friction is implicit one for that and another for the
    /// pressure. To the first order in the step it is what pushes of c dt (v - u) do. A body that
    /// moves keeps the liquid awake.
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite or out of range, see [`Drag`]; nothing is changed.
    ///
    /// ```
    /// use cauldron_fluid::{Grid, Vessel, solver::{Setup, Solver, flow::{Drag, Flow}}};
    /// use glam::Vec3;
    ///
    /// let honey = Setup {
    ///     density_kg_m3: 1400.0,
    ///     viscosity_m2_s: 7e-3,
    ///     ..Setup::new(Grid { spacing_m: 0.01, ..Grid::unit_cube(16) }, Vessel::Box)
    /// };
    /// let mut flow = Flow::new(&honey)?;
    /// let spoon = Drag {
    ///     centre_in_world_m: Vec3::splat(0.08),
    ///     radius_m: 0.02,
    ///     drag_n_s_per_m: 100.0,
    ///     velocity_m_s: 0.1 * Vec3::X,
    /// };
    /// flow.couple(Some(spoon))?;
    /// flow.step(0.02)?;
    /// let around_m_s = flow.gather(spoon.centre_in_world_m, spoon.radius_m).x;
    /// let force_n = flow.coupled_impulse_n_s().x / 0.02;
    /// assert!((0.05..0.1).contains(&around_m_s));
    /// assert!((force_n - 100.0 * f64::from(0.1 - around_m_s)).abs() < 1e-2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn couple(&mut self, drag: Option<Drag>) -> Result<(), Refused> {
        let Some(drag) = drag else {
            self.coupling = None;
            return Ok(());
        };
        let (drag, layout) = (drag.check()?, self.layout);
        let room = || Box::new(Coupling::new(&layout, drag));
        self.coupling.get_or_insert_with(room).drag = drag;
        Ok(())
    }

    /// What the body of [`Flow::couple`] gave to the liquid in the last step, in f64: the sum over
    /// the parts of the step of c dt (v - u), and with the sign turned what the liquid gave to the
    /// body. The momentum of the liquid changes by as much, but for what sides, walls and obstacles
    /// take of it meanwhile, and for rounding. Zero where no liquid is in reach.
    #[must_use]
    pub fn coupled_impulse_n_s(&self) -> DVec3 {
        self.coupling.as_ref().map_or(DVec3::ZERO, |coupling| coupling.impulse_n_s)
    }

    /// True if a body drags the liquid, along or to rest.
    pub(super) fn is_coupled(&self) -> bool {
        self.coupling.as_ref().is_some_and(|coupling| coupling.drag.drag_n_s_per_m > 0.0)
    }

    /// True if a body sets the liquid in motion.
    pub(super) fn is_dragged(&self) -> bool {
        self.coupling.as_ref().is_some_and(|coupling| coupling.drag.moves())
    }

    /// Largest |u| + |v| + |w| that a drag can bring about, as a mean around the body.
    pub(super) fn drag_speed_m_s(&self) -> f64 {
        let drag = self.coupling.as_ref().map(|coupling| coupling.drag);
        drag.filter(Drag::moves)
            .map_or(0.0, |drag| f64::from(drag.velocity_m_s.abs().element_sum()))
    }

    /// Nothing has been given in this step yet.
    pub(super) fn open_coupling(&mut self) {
        if let Some(coupling) = &mut self.coupling {
            (coupling.impulse_n_s, coupling.work_m2_s2) = (DVec3::ZERO, 0.0);
        }
    }

    /// The most that a body gave the liquid in this step.
    pub(super) fn coupled_work_m2_s2(&self) -> f64 {
        self.coupling.as_ref().map_or(0.0, |coupling| coupling.work_m2_s2)
    }

    /// Adds to a part that is otherwise done what the drag does in it. Returns what is then known
    /// of the velocity.
    pub(super) fn drag_along(
        &mut self,
        part: Part,
        scheme: Scheme,
        free: Survey,
        report: &mut StepReport,
    ) -> Survey {
        let Some(mut coupling) = self.coupling.take() else { return free };
        let has_dragged = self.exchange(&mut coupling, part, scheme, report);
        self.coupling = Some(coupling);
        if !has_dragged {
            return free;
        }
        self.ghosts.fill(&mut self.velocity, Fill::Projected);
        self.survey = None;
        self.surveyed()
    }

    /// Solves for the impulse, and gives it. Returns false if there is none.
    fn exchange(
        &mut self,
        coupling: &mut Coupling,
        part: Part,
        scheme: Scheme,
        report: &mut StepReport,
    ) -> bool {
        let Drag { centre_in_world_m, radius_m, drag_n_s_per_m, velocity_m_s } = coupling.drag;
        let cell_kg = self.cell_mass_kg();
        let per_drag = cell_kg / (f64::from(drag_n_s_per_m) * part.dt_s);
        let kernel = self.kernel(centre_in_world_m, radius_m);
        let free_m_s = kernel.gather(components(&self.velocity));
        let missed_m_s = kernel.reach() * (velocity_m_s.as_dvec3() - free_m_s);
        let mass = kernel.mass_in_cells();
        let is_sound = per_drag.is_finite() && missed_m_s.is_finite();
        if cell_kg <= 0.0 || !is_sound || missed_m_s == DVec3::ZERO {
            return false;
        }
        let number = self.diffusion_number(part.dt_s);
        // Stages see half of what they take meanwhile, so that a steady drag leaves a steady flow;
        // a multistep part takes it from the next.
        let theta = match scheme {
            Scheme::MultistepImplicit | Scheme::Traced => implicit_share(number),
            Scheme::Central => 0.5,
            _ => 0.0,
        };
        if theta * number > 0.0 {
            self.make_viscous();
        }
        let (mut residual, mut direction) = (missed_m_s, missed_m_s);
        let (mut impulse, mut held, mut reached_m_s) = (DVec3::ZERO, DVec3::ZERO, free_m_s);
        for _ in 0..3 {
            let push = mass * RESPONSE_M_S * (1.0 + theta * number).min(MOST_FRICTION);
            let per_push = direction.length() / push;
            let push = direction / per_push;
            let moved = per_push * self.respond(coupling, push, theta * part.dt_s, report);
            if moved == DVec3::ZERO {
                // What is shut in stands still, whatever rounding has left it of a velocity.
                let way = direction.normalize_or_zero();
                let all = velocity_m_s.as_dvec3().dot(way) / per_drag;
                held = (all - impulse.dot(way)) * way;
                let share = held.dot(way) / direction.length();
                self.take_response(coupling, share * per_push, part, scheme);
                break;
            }
            let product = per_drag * direction + moved;
            let share = residual.length_squared() / direction.dot(product);
            if !(share > 0.0 && share.is_finite()) {
                break;
            }
            self.take_response(coupling, share * per_push, part, scheme);
            impulse += share * direction;
            reached_m_s += share * moved;
            let next = residual - share * product;
            if next.length() <= TOLERANCE * missed_m_s.length() {
                break;
            }
            direction = next + next.length_squared() / residual.length_squared() * direction;
            residual = next;
        }
        coupling.impulse_n_s += cell_kg * (impulse + held);
        // Of what is implicit it is at most that at the end, and no more than the body's own.
        let own = impulse.dot(velocity_m_s.as_dvec3());
        coupling.work_m2_s2 += impulse.dot(reached_m_s).min(own);
        true
    }
}
