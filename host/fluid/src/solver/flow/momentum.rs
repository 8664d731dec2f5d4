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
//! It neither makes nor loses kinetic energy, whatever the divergence. What it makes of closed
//! faces and ghosts is set right afterwards.

use crate::{
    lanes::{add, each, multiply_add, subtract, times},
    simd::SimdClass,
    solver::flow::field::{Block, Layout, Run, Star, blocks, blocks_mut},
};

/// What a stage reads.
#[derive(Clone, Copy)]
pub struct Stage<'a> {
    /// How the arrays lie.
    pub layout: Layout,
    /// Velocity that the rate of change is taken of.
    pub velocity: [&'a [f32]; 3],
    /// Acceleration to add, if any.
    pub force: Option<[&'a [f32]; 3]>,
    /// Factors of the terms.
    pub terms: Terms,
}

/// Factors of the terms of the rate of change.
#[derive(Clone, Copy)]
pub struct Terms {
    /// -1 / (4 h): turns products of doubled velocities into an acceleration.
    pub advection_per_m: f32,
    /// nu / h^2; 0 leaves viscosity out.
    pub viscous_per_s: f32,
    /// Scale of the force.
    pub force: f32,
}

/// `out = velocity + new_s * rate + old_s * history`, and the rate becomes the history.
#[derive(Clone, Copy)]
pub struct Multistep {
    /// Weight of the new rate.
    pub new_s: f32,
    /// Weight of the last one.
    pub old_s: f32,
}

impl Multistep {
    /// When in the part its force is taken: a part without history takes that of its middle.
    pub fn force_at(&self) -> f64 {
        if self.old_s == 0.0 { 0.5 } else { 0.0 }
    }
}

/// `out = start_share * start + own_share * (velocity + dt * (rate - grad p))`.
#[derive(Clone, Copy)]
pub struct RungeKutta<'a> {
    /// Velocity at the start of the step.
    pub start: [&'a [f32]; 3],
    /// Pressure per density and spacing.
    pub pressure: &'a [f32],
    /// Share of the velocity at the start of the step.
    pub start_share: f32,
    /// Share of the advanced velocity.
    pub own_share: f32,
    /// Length of the step.
    pub dt_s: f32,
}

/// `change = new_s * rate + old_s * history + dt * (viscous rate - grad p)`, and the rate, which
/// is to be without viscosity, becomes the history.
#[derive(Clone, Copy)]
pub struct Semi<'a> {
    /// Weights of the rates.
    pub rates: Multistep,
    /// Pressure per density and spacing.
    pub pressure: &'a [f32],
    /// Length of the step.
    pub dt_s: f32,
    /// nu dt / h^2.
    pub viscous: f32,
}

/// A run of a semi-implicit stage, with the rows of its history and its result.
pub struct SemiRun<'a, 'b> {
    /// What it reads.
    pub stage: Stage<'a>,
    /// How it advances.
    pub advance: Semi<'a>,
    /// Where.
    pub run: Run,
    /// The planes of the history, by component.
    pub history: [&'b mut [f32]; 3],
    /// The planes of the change.
    pub out: [&'b mut [f32]; 3],
}

/// A run of a multistep stage, with the rows of its history and its result.
pub struct MultistepRun<'a, 'b> {
    /// What it reads.
    pub stage: Stage<'a>,
    /// How it advances.
    pub advance: Multistep,
    /// Where.
    pub run: Run,
    /// The planes of the history, by component.
    pub history: [&'b mut [f32]; 3],
    /// The planes of the result.
    pub out: [&'b mut [f32]; 3],
}

/// A run of a Runge-Kutta stage, with the rows of its result.
pub struct RungeKuttaRun<'a, 'b> {
    /// What it reads.
    pub stage: Stage<'a>,
    /// How it advances.
    pub advance: RungeKutta<'a>,
    /// Where.
    pub run: Run,
    /// The planes of the result.
    pub out: [&'b mut [f32]; 3],
}

impl MultistepRun<'_, '_> {
    /// Computes it with the arithmetic of `class`.
    #[inline(always)]
    pub fn compute(self, class: SimdClass) {
        let Self { stage, advance, run: Run { at, to, len }, history, out } = self;
        let ([gx, gy, gz], [x, y, z]) = (history, out);
        macro_rules! component {
            ($c:literal, $history:ident, $out:ident) => {{
                let here = blocks(stage.velocity[$c], at, len);
                let (history, out) = (blocks_mut($history, to, len), blocks_mut($out, to, len));
                stage.rates::<$c>(
                    class,
                    at,
                    len,
                    #[inline(always)]
                    |b, rate| {
                        let start = grown(class, here[b], advance.old_s, history[b]);
                        out[b] = grown(class, start, advance.new_s, rate);
                        history[b] = rate;
                    },
                );
            }};
        }
        component!(0, gx, x);
        component!(1, gy, y);
        component!(2, gz, z);
    }
}

impl SemiRun<'_, '_> {
    /// Computes it with the arithmetic of `class`.
    #[inline(always)]
    pub fn compute(self, class: SimdClass) {
        let Self { stage, advance, run: Run { at, to, len }, history, out } = self;
        let ([gx, gy, gz], [x, y, z]) = (history, out);
        let strides = stage.layout.strides();
        macro_rules! component {
            ($c:literal, $history:ident, $out:ident) => {{
                let own = Star::new(&stage.layout, stage.velocity[$c], at, len).blocks();
                let (history, out) = (blocks_mut($history, to, len), blocks_mut($out, to, len));
                let above = blocks(advance.pressure, at, len);
                let below = blocks(advance.pressure, at - strides[$c], len);
                stage.rates::<$c>(
                    class,
                    at,
                    len,
                    #[inline(always)]
                    |b, rate| {
                        let push = scaled(advance.dt_s, subtract(below[b], above[b]));
                        let change = grown(class, push, advance.viscous, laplacian(class, own, b));
                        let change = grown(class, change, advance.rates.old_s, history[b]);
                        out[b] = grown(class, change, advance.rates.new_s, rate);
                        history[b] = rate;
                    },
                );
            }};
        }
        component!(0, gx, x);
        component!(1, gy, y);
        component!(2, gz, z);
    }
}

impl RungeKuttaRun<'_, '_> {
    /// Computes it with the arithmetic of `class`.
    #[inline(always)]
    pub fn compute(self, class: SimdClass) {
        let Self { stage, advance, run: Run { at, to, len }, out: [x, y, z] } = self;
        let strides = stage.layout.strides();
        macro_rules! component {
            ($c:literal, $out:ident) => {{
                let (here, out) = (blocks(stage.velocity[$c], at, len), blocks_mut($out, to, len));
                let start = blocks(advance.start[$c], at, len);
                let above = blocks(advance.pressure, at, len);
                let below = blocks(advance.pressure, at - strides[$c], len);
                stage.rates::<$c>(
                    class,
                    at,
                    len,
                    #[inline(always)]
                    |b, rate| {
                        let rate = subtract(rate, subtract(above[b], below[b]));
                        let next = grown(class, here[b], advance.dt_s, rate);
                        let kept = scaled(advance.start_share, start[b]);
                        out[b] = grown(class, kept, advance.own_share, next);
                    },
                );
            }};
        }
        component!(0, x);
        component!(1, y);
        component!(2, z);
    }
}

impl Stage<'_> {
    /// Calls `advance(b, rate)` for the rates of component `C` at `len` faces from index `at`,
    /// block by block.
    #[inline(always)]
    fn rates<const C: usize>(
        &self,
        class: SimdClass,
        at: usize,
        len: usize,
        advance: impl FnMut(usize, Block),
    ) {
        match (self.terms.viscous_per_s > 0.0, self.force) {
            (false, None) => self.rates_of::<C, false, false>(class, at, len, advance),
            (false, Some(_)) => self.rates_of::<C, false, true>(class, at, len, advance),
            (true, None) => self.rates_of::<C, true, false>(class, at, len, advance),
            (true, Some(_)) => self.rates_of::<C, true, true>(class, at, len, advance),
        }
    }

    #[inline(always)]
    fn rates_of<const C: usize, const VISCOUS: bool, const FORCED: bool>(
        &self,
        class: SimdClass,
        at: usize,
        len: usize,
        mut advance: impl FnMut(usize, Block),
    ) {
        let (layout, terms) = (&self.layout, self.terms);
        let behind = layout.strides()[C];
        let own = Star::new(layout, self.velocity[C], at, len).blocks();
        let [x, y, z] = Through::all(self.velocity, layout, at, behind, len);
        let force =
            if FORCED { self.force.map_or(own.here, |f| blocks(f[C], at, len)) } else { own.here };
        for (b, force) in force.iter().enumerate() {
            let sum = x.carry(class, b, own.x, None);
            let sum = y.carry(class, b, own.y, Some(sum));
            let sum = z.carry(class, b, own.z, Some(sum));
            let mut rate = scaled(terms.advection_per_m, sum);
            if VISCOUS {
                rate = grown(class, rate, terms.viscous_per_s, laplacian(class, own, b));
            }
            if FORCED {
                rate = grown(class, rate, terms.force, *force);
            }
            advance(b, rate);
        }
    }
}

/// start + factor growth.
#[inline(always)]
fn grown(class: SimdClass, start: Block, factor: f32, growth: Block) -> Block {
    each(
        #[inline(always)]
        |i| class.multiply_add(factor, growth[i], start[i]),
    )
}

#[inline(always)]
fn scaled(factor: f32, values: Block) -> Block {
    times([factor; _], values)
}

/// The sum of the six neighbours of each value of block `b`, less 6 times itself.
#[inline(always)]
fn laplacian(class: SimdClass, Star { here, x, y, z }: Star<'_, Block>, b: usize) -> Block {
    let sides = add(add(x.0[b], x.1[b]), add(y.0[b], y.1[b]));
    grown(class, add(sides, add(z.0[b], z.1[b])), -6.0, here[b])
}

/// The velocities through both sides of a run of control volumes, along one axis.
struct Through<'a> {
    high: (&'a [Block], &'a [Block]),
    low: (&'a [Block], &'a [Block]),
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
            high: (blocks(u, high, len), blocks(u, high - behind, len)),
            low: (blocks(u, low, len), blocks(u, low - behind, len)),
        }
    }

    /// sum + q+ above - q- below, in block `b`.
    #[inline(always)]
    fn carry(
        &self,
        class: SimdClass,
        b: usize,
        (below, above): (&[Block], &[Block]),
        sum: Option<Block>,
    ) -> Block {
        let high = add(self.high.0[b], self.high.1[b]);
        let low = add(self.low.0[b], self.low.1[b]);
        let in_front = match sum {
            Some(sum) => multiply_add(class, high, above[b], sum),
            None => times(high, above[b]),
        };
        let below = below[b];
        each(
            #[inline(always)]
            |i| class.multiply_add(-low[i], below[i], in_front[i]),
        )
    }
}
