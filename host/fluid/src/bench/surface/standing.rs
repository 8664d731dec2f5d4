//! Standing waves: how far frequency and decay are off, of modes that nodes resolve.

use std::f64::consts::PI;

use super::{
    FOUNDING, Session, WAVE,
    law::{self, Root},
    sheet::{self, EDGE_M, WATER_M2_S},
    steps_of,
    swing::Swing,
};
use crate::{
    simd::SimdClass,
    solver::SetupError,
    surface::{Surface, SurfaceParams},
};

/// Steps of the ladder.
const DTS_S: [f64; 4] = [50e-3, 10e-3, 5e-3, 1e-3];

/// Simulated time: five periods of the slowest wave.
const LASTS_S: f64 = 4.0;

/// Modes are looked at so many times.
const LOOKS: usize = 400;

/// Height of each mode.
const HEIGHT_M: f64 = 1e-4;

/// A drag that halves the height of springs in .28 s.
const DRAG_N_S_PER_M3: f32 = 100.0;

/// Decay that no one can tell from none is not judged: a mode has to lose this part.
const LOST: f64 = 0.01;

/// What swings, and the root that each mode is to have by its wave number.
pub struct Standing<'a> {
    pub params: SurfaceParams,
    pub viscosity_m2_s: f64,
    pub n: usize,
    /// Modes have at least so many nodes a wave.
    pub nodes_a_wave: usize,
    pub law: &'a dyn Fn(&SurfaceParams, f64) -> Root,
}

/// Runs both cases.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for n in session.sizes("frequency") {
        for (model, dt_s) in [WAVE, FOUNDING].into_iter().flat_map(|m| DTS_S.map(|dt| (m, dt))) {
            session.tell(&format!("frequency {model} n={n} dt={dt_s} s"));
            let params = sheet::of_model(model);
            let worst = follow(session, params, n, 4, WATER_M2_S, dt_s)?;
            let worst = worst.iter().map(|mode| mode.frequency_error().abs());
            let row = session.row(["frequency", model], n, "worst_rel", largest(worst));
            session.keep(crate::bench::Row { params: steps_of(dt_s), ..row });
        }
    }
    for n in session.sizes("decay") {
        for (model, viscosity_m2_s, dt_s) in
            [(WAVE, WATER_M2_S, 10e-3), (WAVE, 1e-4, 10e-3), (FOUNDING, WATER_M2_S, 1e-3)]
        {
            session.tell(&format!("decay {model} n={n} nu={viscosity_m2_s} m^2/s"));
            let drag_n_s_per_m3 = if model == FOUNDING { DRAG_N_S_PER_M3 } else { 0.0 };
            let params = SurfaceParams { drag_n_s_per_m3, ..sheet::of_model(model) };
            let modes = follow(session, params, n, 8, viscosity_m2_s, dt_s)?;
            let told = modes.iter().filter(|mode| mode.lost() > LOST);
            let worst = largest(told.map(|mode| mode.decay_error().abs()));
            let mut row = session.row(["decay", model], n, "worst_rel", worst);
            row.params = steps_of(dt_s);
            row.params.insert("viscosity_m2_s", viscosity_m2_s.into());
            session.keep(row);
        }
    }
    Ok(())
}

fn follow(
    session: &Session<'_>,
    params: SurfaceParams,
    n: usize,
    nodes_a_wave: usize,
    viscosity_m2_s: f64,
    dt_s: f64,
) -> Result<Vec<Swing>, SetupError> {
    let of_water = |params: &SurfaceParams, k| law::of_water(params, k, viscosity_m2_s);
    let of_strip = |params: &SurfaceParams, k| law::of_strip(params, k, n);
    let law: &dyn Fn(&SurfaceParams, f64) -> Root =
        if params.model == WAVE { &of_water } else { &of_strip };
    let standing = Standing { params, viscosity_m2_s, n, nodes_a_wave, law };
    standing.follow(dt_s, session.options.simd)
}

/// The largest; what is no number is larger than any.
pub fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| if value.is_nan() || value > most { value } else { most })
}

impl Standing<'_> {
    /// Lets all modes swing together and follows each: along x and z where waves do, else along x
    /// on a strip.
    pub fn follow(&self, dt_s: f64, simd: SimdClass) -> Result<Vec<Swing>, SetupError> {
        let n = self.n;
        let halves = self.half_waves();
        let width = if self.params.model == WAVE { n } else { 2 };
        let mut surface = sheet::over_box(self.params, n, [n, width], self.viscosity_m2_s, simd)?;
        let shape = |half: usize, at_m: f64| (PI * half as f64 * at_m / EDGE_M).cos();
        let height_m = |x: f32, z: f32| {
            let [x, z] = [x, z].map(f64::from);
            halves.iter().map(|[p, q]| HEIGHT_M * shape(*p, x) * shape(*q, z)).sum::<f64>() as f32
        };
        surface.set(height_m, |_, _| 0.0);
        let wave = |half: usize| PI * half as f64 / EDGE_M;
        let mut modes: Vec<Swing> = halves
            .iter()
            .map(|[p, q]| Swing::new((self.law)(&self.params, wave(*p).hypot(wave(*q)))))
            .collect();
        let steps = (LASTS_S / dt_s).round() as usize;
        for step in 0..=steps {
            if step.is_multiple_of(steps.div_ceil(LOOKS)) {
                for (mode, halves) in modes.iter_mut().zip(&halves) {
                    mode.enter(step as f64 * f64::from(dt_s as f32), seen(&surface, *halves));
                }
            }
            surface.step(dt_s as f32);
        }
        Ok(modes)
    }

    /// Half waves along x and z of each mode: along x alone, and where waves swing some across.
    fn half_waves(&self) -> Vec<[usize; 2]> {
        let most = 2 * self.n / self.nodes_a_wave;
        let along = (0..).map(|power| 1 << power).take_while(|half| *half <= most);
        let across = if self.params.model == WAVE { 2 } else { 1 };
        along
            .flat_map(|half| [[half, 0], [half, half.div_ceil(2)]].into_iter().take(across))
            .collect()
    }
}

/// Amplitude and speed of a mode, up to a factor.
fn seen(surface: &Surface, [p, q]: [usize; 2]) -> [f64; 2] {
    let [nx, nz] = surface.lattice().nodes;
    let shape =
        |half: usize, at: usize, n: usize| (PI * half as f64 * (at as f64 + 0.5) / n as f64).cos();
    let along: Vec<f64> = (0..nx).map(|i| shape(p, i, nx)).collect();
    [surface.height_m(), surface.speed_m_s()].map(|field| {
        let rows = field.chunks_exact(nx).enumerate().map(|(k, row)| {
            let row = row.iter().zip(&along).map(|(v, along)| f64::from(*v) * along);
            row.sum::<f64>() * if q == 0 { 1.0 } else { shape(q, k, nz) }
        });
        rows.sum()
    })
}
