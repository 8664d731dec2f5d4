//! The implicit step of friction that differs from place to place.
//!
//! ```text
//! (M + s V) change = rhs
//! ```
//! with M and V of [`super::stress`]. Both are symmetric and positive, so conjugate gradients
//! (Hestenes, Stiefel 1952) solve it, for the three components at once, preconditioned by the
//! diagonal (Jacobi): a contrast of viscosities is a contrast of diagonals.

use crate::solver::flow::{
    engine::Engine,
    faces::Faces,
    field::{Layout, Run, Vector, components, cut, cut_mut},
    ghosts::{Fill, Ghosts},
    inventory::bytes,
    openings,
    stress::Stress,
};

/// The residual falls to this part of the right side, both measured by what the diagonal makes
/// of them.
const TOLERANCE: f64 = 1e-4;

/// Iterations at most.
const MAX_ITERATIONS: u32 = 200;

/// The friction of a liquid, and the work space to solve with it.
pub struct Thick {
    /// The friction.
    pub stress: Stress,
    layout: Layout,
    direction: Vector,
    /// The matrix times the direction.
    product: Vector,
    inverse: Vector,
}

impl Thick {
    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        let work = self.direction.iter().chain(&self.product).chain(&self.inverse);
        self.stress.bytes() + bytes(work)
    }

    /// For the liquid in these faces.
    pub fn new(layout: &Layout, faces: &Faces) -> Self {
        let vector = || [layout.zeros(), layout.zeros(), layout.zeros()];
        Self {
            stress: Stress::new(layout, faces.vessel.as_ref()),
            layout: *layout,
            direction: vector(),
            product: vector(),
            inverse: vector(),
        }
    }

    /// Takes from `rates` what friction takes from `velocity`, in m/s^2.
    pub fn slow(&mut self, on: Engine<'_>, velocity: [&[f32]; 3], rates: &mut Vector) {
        self.stress.apply(on, velocity, &mut self.product, [0.0, 1.0]);
        self.mix(
            on,
            rates,
            #[inline(always)]
            |rate, inertia, friction| rate - friction / inertia,
        );
        let stress = &self.stress;
        visit_pulled(on, |c, at, wall_m_s| {
            if stress.inertia[c][at] > 0.0 {
                rates[c][at] += stress.drag(c, at) * wall_m_s / stress.inertia[c][at];
            }
        });
    }

    /// Friction of a face in the velocity that was asked for last, and the drag of resting walls in
    /// it; none where nothing moves by itself.
    pub fn friction(&self, c: usize, at: usize) -> [f32; 2] {
        let is_moved = self.stress.inertia[c][at] > 0.0;
        if is_moved { [self.product[c][at], self.stress.drag(c, at)] } else { [0.0; 2] }
    }

    /// out = mixed(out, inertia, product) where anything moves, 0 elsewhere.
    #[inline(always)]
    fn mix(&self, on: Engine<'_>, out: &mut Vector, mixed: impl Fn(f32, f32, f32) -> f32 + Sync) {
        let layout = &self.layout;
        let outs = out.each_mut().map(|field| layout.planes(field));
        on.pool.planes(outs, [layout.plane; 3], |k, outs| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    for (c, out) in outs.into_iter().enumerate() {
                        let out = cut_mut(out, to, len);
                        let inertia = cut(&self.stress.inertia[c], at, len);
                        let product = cut(&self.product[c], at, len);
                        for i in 0..len {
                            let value = mixed(out[i], inertia[i], product[i]);
                            out[i] = if inertia[i] > 0.0 { value } else { 0.0 };
                        }
                    }
                },
            );
        });
    }

    /// Adds to `velocity` a change, which is used up, and what friction takes in `dt_s`, of which s
    /// acts on the outcome; fills its ghosts. Returns the number of iterations.
    pub fn advance(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        [dt_s, s]: [f32; 2],
        change: &mut Vector,
        velocity: &mut Vector,
    ) -> u32 {
        if on.faces.solids().is_some() {
            // What a face on an open side has of its own would push what follows within without
            // end.
            openings::extend(&self.layout, on.faces, velocity);
        }
        self.stress.apply(on, components(velocity), &mut self.product, [0.0, 1.0]);
        if self.is_rest_nearer(on, ghosts, [dt_s, s], change, velocity) {
            self.start_from_rest([dt_s, s], change, velocity);
            openings::extend(&self.layout, on.faces, velocity);
        } else {
            self.mix(
                on,
                change,
                #[inline(always)]
                |change, inertia, friction| inertia * change - dt_s * friction,
            );
        }
        let stress = &self.stress;
        visit_pulled(on, |c, at, wall_m_s| {
            if stress.inertia[c][at] > 0.0 {
                change[c][at] += dt_s * stress.drag(c, at) * wall_m_s;
            }
        });
        self.solve(on, ghosts, s, change, velocity)
    }

    /// True if rest is a better guess of the outcome than the velocity: of what gradients make
    /// smaller in every iteration,
    /// ```text
    /// J = v (M + s V) v / 2 - v . b,     0 at rest, -(u (M + s V) u / 2 + u . rhs) at u
    /// ```
    /// Below 0 it bounds the energy of v: a solution that is not at its end when the iterations are
    /// has at worst lost too much. Liquid into which an obstacle comes has a velocity of which
    /// friction leaves next to nothing, and of which the change has no bound. Leaves V u, without
    /// what sides do, in `inverse`.
    fn is_rest_nearer(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        [dt_s, s]: [f32; 2],
        change: &Vector,
        velocity: &Vector,
    ) -> bool {
        let Self { stress, layout, direction, product, inverse } = self;
        for c in 0..3 {
            let pairs = velocity[c].iter().zip(stress.inertia[c].iter());
            let moved = |(u, inertia): (&f32, &f32)| if *inertia > 0.0 { *u } else { 0.0 };
            direction[c].iter_mut().zip(pairs).for_each(|(out, pair)| *out = moved(pair));
        }
        openings::extend(layout, on.faces, direction);
        ghosts.fill(direction, Fill::Difference);
        let rubbed = f64::from(s) * stress.apply(on, components(direction), inverse, [0.0, 1.0]);
        let sums = on.pool.sum(layout.cells[2], |k| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, len, .. }, [sum, lost]| {
                    for c in 0..3 {
                        let [u, change] = [&velocity[c], &change[c]].map(|v| cut(v, at, len));
                        let inertia = cut(&stress.inertia[c], at, len);
                        sum.add_weighted(inertia, u, u);
                        sum.add_weighted(inertia, u, change);
                        sum.add_weighted(inertia, u, change);
                        lost.add_product(u, cut(&product[c], at, len));
                    }
                },
            )
            .iter()
            .zip([0.5, -f64::from(dt_s)])
            .map(|(sum, weight)| sum * weight)
            .sum()
        });
        let mut pulled = 0.0;
        visit_pulled(on, |c, at, wall_m_s| {
            pulled += f64::from(dt_s * stress.drag(c, at) * wall_m_s * velocity[c][at]);
        });
        0.5 * rubbed + sums + pulled < 0.0
    }

    /// Makes of a change the right side for the velocity itself, which is at rest then.
    fn start_from_rest(&self, [dt_s, s]: [f32; 2], change: &mut Vector, velocity: &mut Vector) {
        let (stress, within) = (&self.stress, &self.inverse);
        for c in 0..3 {
            let rhs = change[c].iter_mut().zip(velocity[c].iter_mut());
            let friction = self.product[c].iter().zip(within[c].iter());
            for ((rhs, u), ((all, within), inertia)) in
                rhs.zip(friction.zip(stress.inertia[c].iter()))
            {
                if *inertia > 0.0 {
                    // What is implicit of friction cancels exactly, or rounding were all that is
                    // left.
                    *rhs = inertia * (*rhs + *u) - (dt_s - s) * within - dt_s * (all - within);
                    *u = 0.0;
                } else {
                    *rhs = 0.0;
                }
            }
        }
    }

    /// Adds the solution for this right side to `velocity`, and fills its ghosts; the right side is
    /// used up. Returns the number of iterations.
    fn solve(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        s: f32,
        residual: &mut Vector,
        velocity: &mut Vector,
    ) -> u32 {
        self.stress.invert_diagonal(on, s, &mut self.inverse);
        self.direction.iter_mut().for_each(|field| field.fill(0.0));
        let mut square = self.turn(on, 0.0, residual);
        let small = square * TOLERANCE * TOLERANCE;
        let mut iterations = 0;
        while square > small && iterations < MAX_ITERATIONS {
            openings::extend(&self.layout, on.faces, &mut self.direction);
            ghosts.fill(&mut self.direction, Fill::Difference);
            let shares = [1.0, s];
            let Self { stress, direction, product, .. } = &mut *self;
            let curvature = stress.apply(on, components(direction), product, shares);
            if !(curvature > 0.0 && curvature.is_finite()) {
                break;
            }
            let next = self.descend(on, (square / curvature) as f32, velocity, residual);
            self.turn(on, (next / square) as f32, residual);
            square = next;
            iterations += 1;
        }
        ghosts.fill(velocity, Fill::Inside);
        iterations
    }

    /// velocity += alpha direction, residual -= alpha product; returns the square of the residual.
    fn descend(
        &self,
        on: Engine<'_>,
        alpha: f32,
        velocity: &mut Vector,
        residual: &mut Vector,
    ) -> f64 {
        let layout = &self.layout;
        let [u, v, w] = velocity.each_mut().map(|field| layout.planes(field));
        let [x, y, z] = residual.each_mut().map(|field| layout.planes(field));
        on.pool.planes_sum([u, v, w, x, y, z], [layout.plane; 6], |k, [u, v, w, x, y, z]| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, [sum, _]| {
                    for (c, (u, r)) in [(u, x), (v, y), (w, z)].into_iter().enumerate() {
                        let (u, r) = (cut_mut(u, to, len), cut_mut(r, to, len));
                        let direction = cut(&self.direction[c], at, len);
                        let product = cut(&self.product[c], at, len);
                        for i in 0..len {
                            u[i] += alpha * direction[i];
                            r[i] -= alpha * product[i];
                        }
                        sum.add_weighted(cut(&self.inverse[c], at, len), r, r);
                    }
                },
            )[0]
        })
    }

    /// direction = residual / diagonal + beta direction; returns the square of the residual.
    fn turn(&mut self, on: Engine<'_>, beta: f32, residual: &Vector) -> f64 {
        let (layout, inverse) = (&self.layout, &self.inverse);
        let outs = self.direction.each_mut().map(|field| layout.planes(field));
        on.pool.planes_sum(outs, [layout.plane; 3], |k, outs| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, [sum, _]| {
                    for (c, out) in outs.into_iter().enumerate() {
                        let out = cut_mut(out, to, len);
                        let (r, inverse) = (cut(&residual[c], at, len), cut(&inverse[c], at, len));
                        for i in 0..len {
                            out[i] = inverse[i] * r[i] + beta * out[i];
                        }
                        sum.add_weighted(inverse, r, r);
                    }
                },
            )[0]
        })
    }
}

/// Calls `visit(component, index, velocity)` for all faces that moving walls pull.
fn visit_pulled(on: Engine<'_>, visit: impl FnMut(usize, usize, f32)) {
    if let Some(solids) = on.faces.solids() {
        solids.visit_beside(visit);
    }
}
