//! All that a step decides on and reports, in one pass over the velocity.

use crate::{
    lanes::{add, multiply_add, times},
    simd::SimdClass,
    solver::flow::{
        engine::Engine,
        field::{BLOCK, Block, Largest, Layout, Run, Vector, blocks, cut},
    },
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
    /// unless all are whole and alike; `on_sides` the survey of
    /// what no cell has.
    pub fn new(
        on: Engine<'_>,
        layout: &Layout,
        velocity: [&[f32]; 3],
        force: Option<[&[f32]; 3]>,
        mass: Option<&Vector>,
        on_sides: [f64; 4],
    ) -> Self {
        let body = |k: usize, _: [&mut [f32]; 0]| {
            let velocity = velocity.map(|u| cut(u, (k + 1) * layout.plane, layout.plane));
            let force = force.map(|f| f.map(|f| cut(f, (k + 1) * layout.plane, layout.plane)));
            survey_plane(on, layout, velocity, force, mass, k)
        };
        let parts = on.pool.fold(Some(layout.cells[2]), [], [], body, Self::combine);
        Self::from_parts(Self::combine(parts, on_sides))
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

/// What a survey adds up block by block, ghosts and all.
#[derive(Default)]
struct Tally {
    squares: Block,
    power: Block,
    /// As bits: those of positive floats are in their order.
    speeds: [u32; BLOCK],
}

impl Tally {
    /// Adds one block; what `is_inside` is 0 for is not counted.
    #[inline(always)]
    fn count(
        &mut self,
        class: SimdClass,
        is_inside: Block,
        [u, v, w]: [Block; 3],
        force: Option<[Block; 3]>,
    ) {
        let (u, v, w) = (times(is_inside, u), times(is_inside, v), times(is_inside, w));
        let squares = multiply_add(class, w, w, multiply_add(class, v, v, times(u, u)));
        self.squares = add(self.squares, squares);
        for i in 0..BLOCK {
            self.speeds[i] = self.speeds[i].max((u[i].abs() + v[i].abs() + w[i].abs()).to_bits());
        }
        if let Some([x, y, z]) = force {
            let power = multiply_add(class, w, z, multiply_add(class, v, y, times(u, x)));
            self.power = add(self.power, power);
        }
    }

    /// The part of a survey that it makes.
    #[inline(always)]
    fn part(&self) -> [f64; 4] {
        let sum = |block: &Block| block.iter().fold(0.0, |sum, lane| sum + f64::from(*lane));
        let speed = self.speeds.iter().fold(0, |largest, speed| largest.max(*speed));
        [sum(&self.squares), f64::from(f32::from_bits(speed)), sum(&self.power), 0.0]
    }
}

/// Surveys a run, block by block, of the velocity that `velocity(b)` gives; `is_inside` is 1 in
/// cells, 0 in the ghosts beyond the sides, which are not to be counted.
#[inline(always)]
pub fn survey_blocks(
    class: SimdClass,
    is_inside: &[Block],
    force: Option<[&[Block]; 3]>,
    mut velocity: impl FnMut(usize) -> [Block; 3],
) -> [f64; 4] {
    let mut tally = Tally::default();
    match force {
        None => {
            for (b, is_inside) in is_inside.iter().enumerate() {
                tally.count(class, *is_inside, velocity(b), None);
            }
        }
        Some([x, y, z]) => {
            for b in 0..is_inside.len() {
                tally.count(class, is_inside[b], velocity(b), Some([x[b], y[b], z[b]]));
            }
        }
    }
    tally.part()
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
    let Some(mass) = mass else {
        let Some(Run { at, to, len }) = on.live_run(layout, k) else { return [0.0; 4] };
        return on.simd.vectorize_as(
            #[inline(always)]
            |class| {
                let (x, y, z) = (blocks(x, to, len), blocks(y, to, len), blocks(z, to, len));
                let force = force.map(|force| force.map(|f| blocks(f, to, len)));
                survey_blocks(
                    class,
                    blocks(&on.faces.liquid, at, len),
                    force,
                    #[inline(always)]
                    |b| [x[b], y[b], z[b]],
                )
            },
        );
    };
    let mut speed = Largest::default();
    let [squares, power, ..] = on.rows(
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
    );
    [squares, speed.get(), power, 0.0]
}
