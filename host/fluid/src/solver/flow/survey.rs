//! All that a step decides on and reports, in one pass over the velocity.

use crate::solver::flow::{
    engine::Engine,
    field::{Largest, Layout, Run, Vector, cut},
};

/// What a survey found. Energies are per density and cell volume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Survey {
    /// Sum of u^2 / 2 over all faces, by their mass.
    pub energy_m2_s2: f64,
    /// Largest |u| + |v| + |w| over the lower faces of a cell.
    pub speed_m_s: f64,
    /// Sum of f . u over all faces, by their mass.
    pub power_m2_s3: f64,
}

impl Survey {
    /// Surveys `velocity`; `force` is the acceleration that works on it, `mass` that of faces,
    /// unless all are whole and alike.
    pub fn new(
        on: Engine<'_>,
        layout: &Layout,
        velocity: [&[f32]; 3],
        force: Option<[&[f32]; 3]>,
        mass: Option<&Vector>,
    ) -> Self {
        let body = |k: usize, _: [&mut [f32]; 0]| {
            let velocity = velocity.map(|u| cut(u, (k + 1) * layout.plane, layout.plane));
            let force = force.map(|f| f.map(|f| cut(f, (k + 1) * layout.plane, layout.plane)));
            survey_plane(on, layout, velocity, force, mass, k)
        };
        Self::from_parts(on.pool.fold(Some(layout.cells[2]), [], [], body, Self::combine))
    }

    /// The survey of the whole from that of all planes.
    pub fn from_parts([squares, speed, power, _]: [f64; 4]) -> Self {
        Self { energy_m2_s2: 0.5 * squares, speed_m_s: speed, power_m2_s3: power }
    }

    /// Two parts together.
    pub fn combine(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] + b[0], a[1].max(b[1]), a[2] + b[2], 0.0]
    }
}

/// Surveys plane `k` of a velocity and a force.
pub fn survey_plane(
    on: Engine<'_>,
    layout: &Layout,
    [x, y, z]: [&[f32]; 3],
    force: Option<[&[f32]; 3]>,
    mass: Option<&Vector>,
    k: usize,
) -> [f64; 4] {
    let mut speed = Largest::default();
    let [squares, power, ..] = match mass {
        None => on.run(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, [squares, power]| {
                // Beyond the sides there are ghosts, which are not to be counted.
                let is_inside = cut(&on.faces.liquid, at, len);
                let [u, v, w] = [cut(x, to, len), cut(y, to, len), cut(z, to, len)];
                speed.raise(
                    len,
                    #[inline(always)]
                    |i| is_inside[i] * (u[i].abs() + v[i].abs() + w[i].abs()),
                );
                for u in [u, v, w] {
                    squares.add_shared_product(is_inside, u, u);
                }
                if let Some(force) = force {
                    for (u, f) in [u, v, w].into_iter().zip(force) {
                        power.add_shared_product(is_inside, u, cut(f, to, len));
                    }
                }
            },
        ),
        Some(mass) => on.rows(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, [squares, power]| {
                let [u, v, w] = [cut(x, to, len), cut(y, to, len), cut(z, to, len)];
                speed.raise(
                    len,
                    #[inline(always)]
                    |i| u[i].abs() + v[i].abs() + w[i].abs(),
                );
                for (c, u) in [u, v, w].into_iter().enumerate() {
                    let mass = cut(&mass[c], at, len);
                    squares.add_weighted(mass, u, u);
                    if let Some(force) = force {
                        power.add_weighted(mass, u, cut(force[c], to, len));
                    }
                }
            },
        ),
    };
    [squares, speed.get(), power, 0.0]
}
