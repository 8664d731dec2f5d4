//! One explicit stage of the momentum equation.
//!
//! ```text
//! du/dt = -(u . grad) u - grad p + nu lap u + s f
//! ```
//! on the staggered grid of Harlow and Welch (1965). Advection is the skew-symmetric mean of
//! its divergence and its advective form (Morinishi, Lund, Vasilyev, Moin 1998): with q the
//! velocity through the sides of a face's own control volume,
//! ```text
//! (adv u_c) = 1/(4 h) sum over axes d of [ q+ u_c(+d) - q- u_c(-d) ]
//! q+ = u_d(+d) + u_d(+d - c),   q- = u_d + u_d(-c)
//! ```
//! It neither makes nor loses kinetic energy, whatever the divergence; closed faces need no
//! special case, as they hold 0. The pressure is in units of p / h and that of the step before:
//! what it is wrong by is corrected by the projection at the end of the step.

use crate::solver::flow::{
    faces::Faces,
    field::{Layout, Run, Star, cut, cut_mut},
};

/// What a stage reads.
pub struct Stage<'a> {
    /// How the arrays lie.
    pub layout: Layout,
    /// Open faces and viscous weights.
    pub faces: &'a Faces,
    /// Velocity at the start of the step.
    pub start: [&'a [f32]; 3],
    /// Velocity that the rate of change is taken of.
    pub velocity: [&'a [f32]; 3],
    /// Pressure per density and spacing.
    pub pressure: &'a [f32],
    /// Acceleration to add, if any.
    pub force: Option<[&'a [f32]; 3]>,
    /// Weights of the stage.
    pub weights: Weights,
}

/// `out = start_share * start + own_share * (velocity + dt * rate)`.
#[derive(Clone, Copy)]
pub struct Weights {
    /// Share of the velocity at the start of the step.
    pub start_share: f32,
    /// Share of the advanced velocity.
    pub own_share: f32,
    /// Length of the step.
    pub dt_s: f32,
    /// dt / (4 h): turns products of doubled velocities into a change of velocity.
    pub advection_s_m: f32,
    /// nu dt / h^2; 0 leaves viscosity out.
    pub viscous: f32,
    /// dt times the scale of the force.
    pub force_s: f32,
}

impl<'a> Stage<'a> {
    /// Computes a run of the three components.
    #[inline(always)]
    pub fn compute(&self, run: Run, out: [&mut [f32]; 3]) {
        match (self.weights.viscous > 0.0, self.force.is_some()) {
            (false, false) => self.compute_kind::<false, false>(run, out),
            (false, true) => self.compute_kind::<false, true>(run, out),
            (true, false) => self.compute_kind::<true, false>(run, out),
            (true, true) => self.compute_kind::<true, true>(run, out),
        }
    }

    #[inline(always)]
    fn compute_kind<const VISCOUS: bool, const FORCED: bool>(
        &self,
        run: Run,
        [x, y, z]: [&mut [f32]; 3],
    ) {
        self.component::<0, VISCOUS, FORCED>(run, cut_mut(x, run.to, run.len));
        self.component::<1, VISCOUS, FORCED>(run, cut_mut(y, run.to, run.len));
        self.component::<2, VISCOUS, FORCED>(run, cut_mut(z, run.to, run.len));
    }

    /// Component `C` of a run.
    #[inline(always)]
    fn component<const C: usize, const VISCOUS: bool, const FORCED: bool>(
        &self,
        Run { at, .. }: Run,
        out: &mut [f32],
    ) {
        let (layout, w, len) = (&self.layout, self.weights, out.len());
        let behind = layout.strides()[C];
        let own = Star::new(layout, self.velocity[C], at, len);
        let [x, y, z] = Through::all(self.velocity, layout, at, behind, len);
        let pressure = (cut(self.pressure, at, len), cut(self.pressure, at - behind, len));
        let (open, start) = (cut(&self.faces.open[C], at, len), cut(self.start[C], at, len));
        let weight = if VISCOUS { cut(&self.faces.weight[C], at, len) } else { open };
        let force = if FORCED { self.force.map_or(open, |f| cut(f[C], at, len)) } else { open };
        for i in 0..len {
            let here = own.here[i];
            let advection = x.carry(i, own.x) + y.carry(i, own.y) + z.carry(i, own.z);
            let push = w.dt_s * (pressure.0[i] - pressure.1[i]);
            let mut next = here - w.advection_s_m * advection - push;
            if VISCOUS {
                next += w.viscous * (own.around(i) - weight[i] * here);
            }
            if FORCED {
                next += w.force_s * force[i];
            }
            out[i] = open[i] * (w.start_share * start[i] + w.own_share * next);
        }
    }
}

/// The velocities through both sides of a run of control volumes, along one axis.
struct Through<'a> {
    high: (&'a [f32], &'a [f32]),
    low: (&'a [f32], &'a [f32]),
}

impl<'a> Through<'a> {
    /// Along x, y and z, for control volumes that reach back by `behind`.
    #[inline(always)]
    fn all(
        [x, y, z]: [&'a [f32]; 3],
        layout: &Layout,
        at: usize,
        behind: usize,
        len: usize,
    ) -> [Self; 3] {
        let [sx, sy, sz] = layout.strides();
        [
            Self::new(x, at, at + sx, behind, len),
            Self::new(y, at, at + sy, behind, len),
            Self::new(z, at, at + sz, behind, len),
        ]
    }

    #[inline(always)]
    fn new(u: &'a [f32], low: usize, high: usize, behind: usize, len: usize) -> Self {
        Self {
            high: (cut(u, high, len), cut(u, high - behind, len)),
            low: (cut(u, low, len), cut(u, low - behind, len)),
        }
    }

    /// q+ above - q- below.
    #[inline(always)]
    fn carry(&self, i: usize, (below, above): (&[f32], &[f32])) -> f32 {
        let Self { high, low } = self;
        (high.0[i] + high.1[i]) * above[i] - (low.0[i] + low.1[i]) * below[i]
    }
}
