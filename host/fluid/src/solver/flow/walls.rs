//! What the walls of a vessel do to a stage of the momentum equation.

use crate::solver::flow::{
    engine::Engine,
    field::{Run, cut, cut_mut},
    momentum::Stage,
};

/// Corrects a stage that was computed as if there were liquid everywhere: the viscous stencil
/// of a face beside a wall has another weight than 6 (see [`super::faces::Faces::weight`]), and
/// nothing passes a closed face. `share_s` is the weight of the rate in `out`; `rates`, if kept,
/// are corrected as well.
pub fn hold(
    on: Engine<'_>,
    stage: &Stage<'_>,
    Run { at, to, len }: Run,
    share_s: f32,
    out: [&mut [f32]; 3],
    mut rates: Option<[&mut [f32]; 3]>,
) {
    let per_s = stage.terms.viscous_per_s;
    for (c, out) in out.into_iter().enumerate() {
        let out = cut_mut(out, to, len);
        let open = cut(&on.faces.open[c], at, len);
        let (weight, here) = (cut(&on.faces.weight[c], at, len), cut(stage.velocity[c], at, len));
        let rate = rates.as_mut().map(|rates| cut_mut(rates[c], to, len));
        on.simd.vectorize(
            #[inline(always)]
            || {
                for i in 0..len {
                    let missing = per_s * (6.0 - weight[i]) * here[i];
                    out[i] = open[i] * (out[i] + share_s * missing);
                }
                if let Some(rate) = rate {
                    for i in 0..len {
                        rate[i] += per_s * (6.0 - weight[i]) * here[i];
                    }
                }
            },
        );
    }
}
