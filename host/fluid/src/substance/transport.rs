//! Carrying one volume fraction with the flow: see the module above.

use crate::solver::flow::{
    engine::Engine,
    field::{FaceRuns, Field, Largest, Layout, Run, Vector, components, cut, cut_mut},
};

/// What a cell may lose in one part, of what it holds, with the limiter ...
const LIMITED_SHARE: f64 = 0.5;

/// ... and by plain upwind.
const UPWIND_SHARE: f64 = 0.9;

/// Beyond this number of limited parts the transport is plain upwind.
const MAX_LIMITED_PARTS: f64 = 32.0;

/// Beyond this number of upwind parts the substance lags behind the flow.
const MAX_UPWIND_PARTS: f64 = 256.0;

/// Less than this in a cell is nothing: the tail of a cloud would fade into subnormal numbers,
/// which the processor computes a hundred times slower.
const TRACE: f32 = 1e-12;

/// How substances were carried through one step, best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Carrying {
    /// There was nothing to carry, or it did not move.
    Nothing,
    /// Third order, limited.
    Limited,
    /// First order: the step crossed very many cells.
    Upwind,
    /// First order and slower than the flow: the step crossed more cells than can be paid for.
    Lagging,
}

/// What a step of the substances did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransportReport {
    /// Parts that the step was cut into.
    pub substeps: u32,
    /// How it was computed.
    pub carrying: Carrying,
}

/// How to carry one substance through a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The scheme.
    pub carrying: Carrying,
    /// Number of equal parts.
    pub parts: u32,
    /// Part of the step's length that is carried: 1 unless the substance lags.
    share: f64,
    /// Diffusion number kappa dt / h^2 of the whole step.
    spread: f64,
}

/// Plans a step in which a cell loses `courant` times what it holds to the flow, and has
/// diffusion number `spread`.
pub fn plan(courant: f64, spread: f64) -> Plan {
    let loss = courant + 6.0 * spread;
    let parts = |share: f64| (loss / share).ceil();
    let with = |carrying, parts: f64, share| Plan { carrying, parts: parts as u32, share, spread };
    if loss <= 0.0 {
        with(Carrying::Nothing, 0.0, 1.0)
    } else if parts(LIMITED_SHARE) <= MAX_LIMITED_PARTS {
        with(Carrying::Limited, parts(LIMITED_SHARE), 1.0)
    } else if parts(UPWIND_SHARE) <= MAX_UPWIND_PARTS {
        with(Carrying::Upwind, parts(UPWIND_SHARE), 1.0)
    } else {
        let share = MAX_UPWIND_PARTS * UPWIND_SHARE / loss;
        with(Carrying::Lagging, MAX_UPWIND_PARTS, share)
    }
}

/// Largest sum of what leaves a cell, in m/s: times dt / h the part of its content it loses.
pub fn largest_outflow(on: Engine<'_>, layout: &Layout, velocity: [&[f32]; 3]) -> f64 {
    on.pool.max(layout.cells[2], |k| {
        let mut largest = Largest::default();
        on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, len, .. }, _| {
                let FaceRuns { x, y, z } = FaceRuns::new(layout, velocity, at, len);
                largest.raise(
                    len,
                    #[inline(always)]
                    |i| leaving(x.0[i], x.1[i]) + leaving(y.0[i], y.1[i]) + leaving(z.0[i], z.1[i]),
                );
            },
        );
        largest.get()
    })
}

#[inline(always)]
fn leaving(below: f32, above: f32) -> f32 {
    (if above > 0.0 { above } else { 0.0 }) - (if below < 0.0 { below } else { 0.0 })
}

/// Work space of the transport.
pub struct Transport {
    layout: Layout,
    /// What passes each face, in units of its area.
    flux: Vector,
    stage: Field,
}

/// One part of a step.
#[derive(Clone, Copy)]
struct Part {
    dt_per_spacing_s_m: f32,
    /// kappa / h.
    diffusion_m_s: f32,
}

impl Transport {
    /// Work space for arrays of this layout.
    pub fn new(layout: &Layout) -> Self {
        let flux = [layout.zeros(), layout.zeros(), layout.zeros()];
        Self { layout: *layout, flux, stage: layout.zeros() }
    }

    /// Carries `fraction` as planned; `dt_per_spacing_s_m` is that of the whole step.
    pub fn carry(
        &mut self,
        on: Engine<'_>,
        fraction: &mut Field,
        velocity: [&[f32]; 3],
        plan: Plan,
        dt_per_spacing_s_m: f64,
    ) {
        let part = Part {
            dt_per_spacing_s_m: (plan.share * dt_per_spacing_s_m / f64::from(plan.parts)) as f32,
            diffusion_m_s: (plan.spread / dt_per_spacing_s_m) as f32,
        };
        let Self { layout, flux, stage } = self;
        for _ in 0..plan.parts {
            if plan.carrying == Carrying::Limited {
                set_flux::<true>(on, layout, flux, fraction, velocity, part);
                advance(on, layout, components(flux), part, fraction, stage, 0.0);
                set_flux::<true>(on, layout, flux, stage, velocity, part);
                advance(on, layout, components(flux), part, stage, fraction, 0.5);
            } else {
                set_flux::<false>(on, layout, flux, fraction, velocity, part);
                advance(on, layout, components(flux), part, fraction, stage, 0.0);
                std::mem::swap(fraction, stage);
            }
        }
    }
}

/// to = kept to + (1 - kept) (from - dt/h sum of fluxes out).
fn advance(
    on: Engine<'_>,
    layout: &Layout,
    flux: [&[f32]; 3],
    part: Part,
    from: &[f32],
    to: &mut Field,
    kept: f32,
) {
    on.pool.planes([layout.planes(to)], [layout.plane], |k, [out]| {
        on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, _| {
                let out = cut_mut(out, to, len);
                let flux = FaceRuns::new(layout, flux, at, out.len());
                let from = cut(from, at, out.len());
                for i in 0..out.len() {
                    let next = from[i] - part.dt_per_spacing_s_m * flux.outflow(i);
                    let mixed = kept * out[i] + (1.0 - kept) * next;
                    out[i] = if mixed.abs() < TRACE { 0.0 } else { mixed };
                }
            },
        );
    });
}

/// Sets the flux through all faces.
fn set_flux<const LIMITED: bool>(
    on: Engine<'_>,
    layout: &Layout,
    flux: &mut Vector,
    fraction: &[f32],
    velocity: [&[f32]; 3],
    part: Part,
) {
    let outs = flux.each_mut().map(|flux| layout.planes(flux));
    on.pool.planes(outs, [layout.plane; 3], |k, [x, y, z]| {
        on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, _| {
                let [sx, sy, sz] = layout.strides();
                let [open_x, open_y, open_z] = components(&on.faces.open);
                let x = Faces { flux: cut_mut(x, to, len), open: open_x, stride: sx };
                let y = Faces { flux: cut_mut(y, to, len), open: open_y, stride: sy };
                let z = Faces { flux: cut_mut(z, to, len), open: open_z, stride: sz };
                flux_run::<LIMITED>(x, velocity[0], fraction, at, part);
                flux_run::<LIMITED>(y, velocity[1], fraction, at, part);
                // The faces below the first plane are walls: there is nothing to read below.
                if k > 0 {
                    flux_run::<LIMITED>(z, velocity[2], fraction, at, part);
                }
            },
        );
    });
}

/// The lower faces of a run of cells along one axis.
struct Faces<'a> {
    flux: &'a mut [f32],
    open: &'a [f32],
    stride: usize,
}

#[inline(always)]
fn flux_run<const LIMITED: bool>(
    Faces { flux, open, stride }: Faces<'_>,
    velocity: &[f32],
    fraction: &[f32],
    at: usize,
    part: Part,
) {
    let len = flux.len();
    let (below, above) = (cut(fraction, at - stride, len), cut(fraction, at, len));
    let u = cut(velocity, at, len);
    let two_below = cut(fraction, at - 2 * stride, len);
    let two_above = cut(fraction, at + stride, len);
    let open_below = cut(open, at - stride, len);
    let open_above = cut(open, at + stride, len);
    let open = cut(open, at, len);
    for i in 0..len {
        let step = above[i] - below[i];
        let is_upwards = u[i] > 0.0;
        let carried = if LIMITED {
            let step_below = open_below[i] * (below[i] - two_below[i]);
            let step_above = open_above[i] * (two_above[i] - above[i]);
            let upwind_step = if is_upwards { step_below } else { step_above };
            let half = 0.5 * limited(upwind_step, step);
            if is_upwards { below[i] + half } else { above[i] - half }
        } else if is_upwards {
            below[i]
        } else {
            above[i]
        };
        flux[i] = u[i] * carried - part.diffusion_m_s * open[i] * step;
    }
}

/// The limiter of Koren, in differences: 0 at an extremum, else the third-order mean
/// (d_upwind + 2 d) / 3, at most twice the smaller of both.
#[inline(always)]
fn limited(upwind_step: f32, step: f32) -> f32 {
    let (a, b) = (upwind_step.abs(), step.abs());
    let smaller = if a < b { a } else { b };
    let mean = (a + 2.0 * b) * (1.0 / 3.0);
    let size = if mean < 2.0 * smaller { mean } else { 2.0 * smaller };
    let signed = if step > 0.0 { size } else { -size };
    if upwind_step * step > 0.0 { signed } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_step_is_cut_as_finely_as_its_scheme_needs() {
        assert_eq!(plan(0.0, 0.0).carrying, Carrying::Nothing);
        assert_eq!((plan(0.7, 0.0).carrying, plan(0.7, 0.0).parts), (Carrying::Limited, 2));
        assert_eq!((plan(20.0, 0.0).carrying, plan(20.0, 0.0).parts), (Carrying::Upwind, 23));
        assert_eq!((plan(1e9, 0.0).carrying, plan(1e9, 0.0).parts), (Carrying::Lagging, 256));
        assert_eq!(plan(0.0, 0.25).parts, 3);
    }

    #[test]
    fn smooth_steps_give_the_third_order_mean_and_extrema_none() {
        assert!((limited(1.0, 1.2) - 3.4 / 3.0).abs() < 1e-6);
        assert!((limited(-1.0, -1.2) + 3.4 / 3.0).abs() < 1e-6);
        assert_eq!(limited(1.0, -1.0), 0.0);
        assert_eq!(limited(0.0, 1.0), 0.0);
    }

    proptest! {
        #[test]
        fn the_limiter_stays_within_twice_both_steps(a in -2f32..2.0, b in -2f32..2.0) {
            let limited = limited(a, b);
            prop_assert!(limited.abs() <= 2.0 * a.abs().min(b.abs()) + 1e-6);
            prop_assert!(limited * a >= 0.0 && limited * b >= 0.0);
        }
    }
}
