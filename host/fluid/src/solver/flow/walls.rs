//! What the walls of a vessel do to a stage of the momentum equation.

use crate::solver::flow::{
    engine::Engine,
    field::{Run, cut, cut_mut},
};

/// Corrects a stage that was computed as if there were liquid everywhere: the viscous stencil
/// of a face beside a wall has another weight than 6 (see [`super::faces::Faces::weight`]), and
/// nothing passes a closed face. `viscous` is the weight of the stencil in `out`.
pub fn hold(on: Engine<'_>, velocity: [&[f32]; 3], run: Run, viscous: f32, out: [&mut [f32]; 3]) {
    for (c, out) in out.into_iter().enumerate() {
        let out = cut_mut(out, run.to, run.len);
        hold_component(on, c, velocity, run, viscous, out, true);
    }
}

/// The same for rates of change that are kept; closed faces are left as they are.
pub fn hold_rates(
    on: Engine<'_>,
    velocity: [&[f32]; 3],
    run: Run,
    viscous_per_s: f32,
    rates: [&mut [f32]; 3],
) {
    for (c, rates) in rates.into_iter().enumerate() {
        let rates = cut_mut(rates, run.to, run.len);
        hold_component(on, c, velocity, run, viscous_per_s, rates, false);
    }
}

fn hold_component(
    on: Engine<'_>,
    c: usize,
    velocity: [&[f32]; 3],
    Run { at, len, .. }: Run,
    viscous: f32,
    out: &mut [f32],
    closes: bool,
) {
    let (open, weight) = (cut(&on.faces.open[c], at, len), cut(&on.faces.weight[c], at, len));
    let here = cut(velocity[c], at, len);
    on.simd.vectorize(
        #[inline(always)]
        || {
            for i in 0..out.len() {
                out[i] += viscous * (6.0 - weight[i]) * here[i];
            }
            if closes {
                out.iter_mut().zip(open).for_each(|(out, open)| *out *= open);
            }
        },
    );
}
