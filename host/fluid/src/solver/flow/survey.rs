//! One pass over the velocity for all that a step decides on or reports.

use crate::solver::flow::{
    engine::Engine,
    field::{FaceRuns, Largest, Layout, Run, cut},
};

/// What a survey found. Energies are per density and cell volume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Survey {
    /// Sum of u^2 / 2 over all faces.
    pub energy_m2_s2: f64,
    /// Largest |u| + |v| + |w| over the lower faces of a cell.
    pub speed_m_s: f64,
    /// Largest sum of a cell's face velocities: h |div u|.
    pub outflow_m_s: f64,
    /// Sum of f . u over all faces.
    pub power_m2_s3: f64,
}

/// Surveys `velocity`; `force` is the acceleration that works on it.
pub fn survey(
    on: Engine<'_>,
    layout: &Layout,
    velocity: [&[f32]; 3],
    force: Option<[&[f32]; 3]>,
) -> Survey {
    let body = |k, _: [&mut [f32]; 0]| plane(on, layout, velocity, force, k);
    let [energy, speed, outflow, power] =
        on.pool.fold(Some(layout.cells[2]), [], [], body, combine);
    Survey {
        energy_m2_s2: 0.5 * energy,
        speed_m_s: speed,
        outflow_m_s: outflow,
        power_m2_s3: power,
    }
}

fn combine(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [a[0] + b[0], a[1].max(b[1]), a[2].max(b[2]), a[3] + b[3]]
}

fn plane(
    on: Engine<'_>,
    layout: &Layout,
    velocity: [&[f32]; 3],
    force: Option<[&[f32]; 3]>,
    k: usize,
) -> [f64; 4] {
    let (mut speed, mut outflow) = (Largest::default(), Largest::default());
    let [squares, power, ..] = on.run(
        layout,
        k,
        #[inline(always)]
        |Run { at, len, .. }, sums| {
            let faces = FaceRuns::new(layout, velocity, at, len);
            let liquid = cut(&on.faces.liquid, at, len);
            speed.raise(
                len,
                #[inline(always)]
                |i| faces.speed(i),
            );
            outflow.raise(
                len,
                #[inline(always)]
                |i| liquid[i] * faces.outflow(i),
            );
            faces.add_squares(&mut sums[0]);
            if let Some([x, y, z]) = force {
                sums[1].add_product(cut(x, at, len), faces.x.0);
                sums[1].add_product(cut(y, at, len), faces.y.0);
                sums[1].add_product(cut(z, at, len), faces.z.0);
            }
        },
    );
    [squares, speed.get(), outflow.get(), power]
}
