//! The lid-driven cavity, against the velocities on its two middle lines that Ghia, Ghia and
//! Shin computed on 129 x 129 points (J. Comput. Phys. 48, 1982).

use glam::Vec3;

use super::{
    Options, Session,
    measure::{Baseline, Outcome, Spent, Tally, measure},
    row::Param,
};
use crate::{
    grid::Grid,
    solver::{Setup, SetupError, Side, Sides, Solver, SolverRow},
    vessel::Vessel,
};

/// A Reynolds number and what belongs to it.
struct Cavity {
    name: &'static str,
    reynolds: f32,
    /// From rest until nothing changes any more.
    end_s: f64,
    /// u at [`HEIGHTS`] of the upright middle line.
    across_m_s: [f64; 17],
    /// v at [`WIDTHS`] of the level one; NaN where the table has a known outlier.
    upward_m_s: [f64; 17],
}

const HEIGHTS: [f32; 17] = [
    1.0, 0.9766, 0.9688, 0.9609, 0.9531, 0.8516, 0.7344, 0.6172, 0.5, 0.4531, 0.2813, 0.1719,
    0.1016, 0.0703, 0.0625, 0.0547, 0.0,
];

const WIDTHS: [f32; 17] = [
    1.0, 0.9688, 0.9609, 0.9531, 0.9453, 0.9063, 0.8594, 0.8047, 0.5, 0.2344, 0.2266, 0.1563,
    0.0938, 0.0781, 0.0703, 0.0625, 0.0,
];

const CAVITIES: [Cavity; 3] = [
    Cavity {
        name: "cavity-100",
        reynolds: 100.0,
        end_s: 20.0,
        across_m_s: [
            1.0, 0.84123, 0.78871, 0.73722, 0.68717, 0.23151, 0.00332, -0.13641, -0.20581,
            -0.21090, -0.15662, -0.10150, -0.06434, -0.04775, -0.04192, -0.03717, 0.0,
        ],
        upward_m_s: [
            0.0, -0.05906, -0.07391, -0.08864, -0.10313, -0.16914, -0.22445, -0.24533, 0.05454,
            0.17527, 0.17507, 0.16077, 0.12317, 0.10890, 0.10091, 0.09233, 0.0,
        ],
    },
    Cavity {
        name: "cavity-400",
        reynolds: 400.0,
        end_s: 40.0,
        across_m_s: [
            1.0, 0.75837, 0.68439, 0.61756, 0.55892, 0.29093, 0.16256, 0.02135, -0.11477, -0.17119,
            -0.32726, -0.24299, -0.14612, -0.10338, -0.09266, -0.08186, 0.0,
        ],
        upward_m_s: [
            0.0,
            -0.12146,
            -0.15663,
            -0.19254,
            -0.22847,
            f64::NAN,
            -0.44993,
            -0.38598,
            0.05186,
            0.30174,
            0.30203,
            0.28124,
            0.22965,
            0.20920,
            0.19713,
            0.18360,
            0.0,
        ],
    },
    Cavity {
        name: "cavity-1000",
        reynolds: 1000.0,
        end_s: 80.0,
        across_m_s: [
            1.0, 0.65928, 0.57492, 0.51117, 0.46604, 0.33304, 0.18719, 0.05702, -0.06080, -0.10648,
            -0.27805, -0.38289, -0.29730, -0.22220, -0.20196, -0.18109, 0.0,
        ],
        upward_m_s: [
            0.0, -0.21388, -0.27669, -0.33714, -0.39188, -0.51550, -0.42665, -0.31966, 0.02526,
            0.32235, 0.33075, 0.37095, 0.32627, 0.30353, 0.29012, 0.27485, 0.0,
        ],
    },
];

/// Runs them all.
pub fn run(session: &mut Session<'_>) -> Result<(), SetupError> {
    for cavity in &CAVITIES {
        for n in session.sizes(cavity.name) {
            session.tell(&format!("{} n={n}", cavity.name));
            let mut baseline = Baseline::steps(n, session.options)?;
            let solve = |row: &SolverRow| run_cavity(cavity, row, n, session.options);
            let measured = measure(session.options, n, &mut baseline, |_| true, solve)?;
            session.keep(measured, cavity.name, n);
        }
    }
    Ok(())
}

/// From rest, one layer of cells, steps in which the lid crosses one cell.
fn run_cavity(
    cavity: &Cavity,
    row: &SolverRow,
    n: usize,
    options: &Options,
) -> Result<Outcome, SetupError> {
    let walls = [Side::NoSlip; 2];
    let lid = [Side::NoSlip, Side::Moving(Vec3::X)];
    let setup = Setup {
        viscosity_m2_s: 1.0 / cavity.reynolds,
        sides: Sides([walls, lid, [Side::FreeSlip; 2]]),
        pool: options.pool.clone(),
        simd: options.simd,
        ..Setup::new(Grid { cells: [n, n, 1], ..Grid::unit_cube(n) }, Vessel::Box)
    };
    let mut solver = (row.make)(&setup)?;
    let steps = (cavity.end_s * n as f64).ceil() as usize;
    let (mut spent, mut tally) = (Spent::default(), Tally::new());
    for _ in 0..steps {
        tally.count(spent.on(|| solver.step(cavity.end_s / steps as f64))?);
    }
    let mut params = tally.params();
    params.extend([
        ("cfl", Param::Number(1.0)),
        ("steps", Param::Number(steps as f64)),
        ("end_s", Param::Number(cavity.end_s)),
        ("reynolds", Param::Number(f64::from(cavity.reynolds))),
    ]);
    let values = vec![("rms", difference_m_s(cavity, &*solver, n))];
    Ok(Outcome { values, spent, steps, cells: setup.grid.len(), params })
}

/// Root mean square of the difference to the table over the points where the velocity is
/// computed: at the ends of the lines it is given, and the table's outlier is left out.
fn difference_m_s(cavity: &Cavity, solver: &dyn Solver, n: usize) -> f64 {
    let middle = 0.5 / n as f32;
    let across = HEIGHTS.map(|height| solver.velocity_at(Vec3::new(0.5, height, middle)).x);
    let upward = WIDTHS.map(|width| solver.velocity_at(Vec3::new(width, 0.5, middle)).y);
    let (mut squares, mut known) = (0.0, 0);
    for (computed, table) in [(across, cavity.across_m_s), (upward, cavity.upward_m_s)] {
        for place in (1..16).filter(|place| !table[*place].is_nan()) {
            squares += (f64::from(computed[place]) - table[place]).powi(2);
            known += 1;
        }
    }
    (squares / f64::from(known)).sqrt()
}
