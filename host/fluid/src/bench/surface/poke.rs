//! A poke, and what has become of it 2 s later: error over the time that it takes.
//!
//! The exact height is a sum of modes in f64 that knows nothing of nodes: the cosines of the hump
//! by quadrature, each let go by the root of its wave number ([`law`]). Springs are held against
//! the sheet that infinitely many of them are (`poke`), and against water (`poke-water`).

use std::f64::consts::PI;

use super::{
    FOUNDING, Session, WAVE,
    law::{self, Root},
    sheet::{self, EDGE_M, WATER_M2_S},
    steps_of,
};
use crate::{
    bench::{
        Row,
        measure::{Spent, median},
        row::Params,
    },
    solver::SetupError,
    surface::SurfaceParams,
};

/// Simulated time.
const LASTS_S: f64 = 2.0;

/// Steps of the ladder.
const DTS_S: [f64; 4] = [50e-3, 10e-3, 5e-3, 1e-3];

/// Middle of the hump, its width, and its height.
const AT_M: [f64; 2] = [0.41 * EDGE_M, 0.56 * EDGE_M];
const WIDTH_M: f64 = 0.02;
const HEIGHT_M: f64 = 2e-3;

/// Modes along an edge: of the next there is less than f64 can tell.
const MODES: usize = 48;

/// Points of the quadrature, exact for what fades before the walls.
const POINTS: usize = 512;

/// A run is repeated only while all of them took less than this.
const ENOUGH_S: f64 = 1.5;

/// Runs it.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    let of_water = |params: &SurfaceParams, k| law::of_water(params, k, WATER_M2_S);
    for n in session.sizes("poke") {
        let waves = exact(n, |k| of_water(&sheet::of_model(WAVE), k));
        let springs = exact(n, |k| law::of_sheet(&sheet::of_model(FOUNDING), k));
        for dt_s in DTS_S {
            session.tell(&format!("poke n={n} dt={dt_s} s"));
            let mut runs = [Vec::new(), Vec::new()];
            let mut last = [Vec::new(), Vec::new()];
            let (mut taken_s, mut turn) = (0.0, 0);
            while turn == 0 || (turn < session.options.repetitions && taken_s < ENOUGH_S) {
                for (place, model) in [FOUNDING, WAVE].into_iter().enumerate() {
                    let (height_m, ms) = poke(model, n, dt_s, session)?;
                    runs[place].push(ms);
                    last[place] = height_m;
                    taken_s += ms * 1e-3 * LASTS_S / dt_s;
                }
                turn += 1;
            }
            let ratio = median(runs[1].iter().zip(&runs[0]).map(|(own, its)| own / its).collect());
            let params = || {
                let mut params: Params = steps_of(dt_s);
                params.insert("steps", (LASTS_S / dt_s).round().into());
                params
            };
            for (place, model, truth, ratio) in
                [(0, FOUNDING, &springs, None), (1, WAVE, &waves, Some(ratio))]
            {
                let row = session.row(["poke", model], n, "rel_l2", off(&last[place], truth));
                let ms = Some(median(runs[place].clone()));
                session.keep(Row { params: params(), ms, ratio_to_founding: ratio, ..row });
            }
            let row = session.row(["poke-water", FOUNDING], n, "rel_l2", off(&last[0], &waves));
            session.keep(Row { params: params(), ..row });
        }
    }
    Ok(())
}

/// Heights of all nodes in the end, and CPU time of a step.
fn poke(
    model: &'static str,
    n: usize,
    dt_s: f64,
    session: &Session<'_>,
) -> Result<(Vec<f32>, f64), SetupError> {
    let params = sheet::of_model(model);
    let mut surface = sheet::over_box(params, n, [n; 2], WATER_M2_S, session.options.simd)?;
    surface.set(|x, z| (HEIGHT_M * hump(0, x.into()) * hump(1, z.into())) as f32, |_, _| 0.0);
    let (mut spent, steps) = (Spent::default(), (LASTS_S / dt_s).round() as usize);
    spent.on(|| {
        for _ in 0..steps {
            surface.step(dt_s as f32);
        }
    });
    Ok((surface.height_m().to_vec(), spent.cpu.as_secs_f64() * 1e3 / steps as f64))
}

/// The hump along x or z.
fn hump(axis: usize, at_m: f64) -> f64 {
    (-0.5 * ((at_m - AT_M[axis]) / WIDTH_M).powi(2)).exp()
}

/// Heights of n x n nodes in the end, of waves with these roots by wave number.
pub fn exact(n: usize, root: impl Fn(f64) -> Root) -> Vec<f64> {
    let wave = |p: usize| PI * p as f64 / EDGE_M;
    let parts = |axis: usize, p: usize| {
        let points = (0..POINTS).map(|at| (at as f64 + 0.5) * EDGE_M / POINTS as f64);
        let sum: f64 = points.map(|at_m| hump(axis, at_m) * (wave(p) * at_m).cos()).sum();
        sum * if p == 0 { 1.0 } else { 2.0 } / POINTS as f64
    };
    let [x, z] = [0, 1].map(|axis| (0..MODES).map(|p| parts(axis, p)).collect::<Vec<_>>());
    let shape = |p: usize, at: usize| (wave(p) * (at as f64 + 0.5) * EDGE_M / n as f64).cos();
    let shapes: Vec<f64> = (0..n * MODES).map(|i| shape(i % MODES, i / MODES)).collect();
    let shapes = |at: usize| &shapes[at * MODES..(at + 1) * MODES];
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Modes of z, row by row, with those of x summed up at each node of x.
    let rows: Vec<Vec<f64>> = (0..MODES)
        .map(|q| {
            let row: Vec<f64> = (0..MODES)
                .map(|p| match wave(p).hypot(wave(q)) {
                    // The mean is left out: the volume stays.
                    0.0 => 0.0,
                    k => HEIGHT_M * x[p] * z[q] * law::let_go(root(k), LASTS_S)[0],
                })
                .collect();
            (0..n).map(|i| sum(&row, shapes(i))).collect()
        })
        .collect();
    let node = |i: usize, k: usize| (0..MODES).map(|q| rows[q][i] * shapes(k)[q]).sum();
    (0..n * n).map(|at| node(at % n, at / n)).collect()
}

/// Root of the mean squared difference over that of the mean squared truth.
fn off(height_m: &[f32], truth_m: &[f64]) -> f64 {
    let squares: f64 = truth_m.iter().map(|y| y * y).sum();
    let pairs = height_m.iter().zip(truth_m);
    (pairs.map(|(y, truth)| (f64::from(*y) - truth).powi(2)).sum::<f64>() / squares).sqrt()
}
