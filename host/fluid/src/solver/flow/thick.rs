//! The implicit step of friction that differs from place to place.
//!
//! ```text
//! (M + s V) change = rhs
//! ```
//! with M and V of [`super::stress`]. Both are symmetric and positive, so conjugate gradients
//! (Hestenes, Stiefel 1952) solve it, for the three components at once, preconditioned by the diagonal
//! (Jacobi): a contrast of viscosities is a contrast of diagonals.

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

    /// Makes of a change of velocity, if any, the right side that adds to it what friction takes in
    /// `dt_s`.
    pub fn prepare(&mut self, on: Engine<'_>, velocity: &Vector, dt_s: f32, rhs: &mut Vector) {
        self.stress.apply(on, components(velocity), &mut self.product, [0.0, 1.0]);
        self.mix(
            on,
            rhs,
            #[inline(always)]
            |change, inertia, friction| inertia * change - dt_s * friction,
        );
        let stress = &self.stress;
        visit_pulled(on, |c, at, wall_m_s| {
            if stress.inertia[c][at] > 0.0 {
                rhs[c][at] += dt_s * stress.drag(c, at) * wall_m_s;
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

    /// Adds the solution for this right side to `velocity`, and fills its ghosts; the right side is
    /// used up. Returns the number of iterations.
    pub fn solve(
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
