//! What every solver of the index has to keep to. Where one does not, the index says so, and by
//! how much: a miss is bracketed from both sides, so that it can neither grow nor heal unseen.

use std::{f64::consts::PI, panic::catch_unwind, sync::Arc};

use cauldron_fluid::{
    Grid, Vessel,
    pool::Pool,
    solver::{INDEX, Setup, Side, Sides, Solver, SolverRow},
};
use glam::{DVec3, Vec3};

const N: usize = 16;

/// Share of its energy that a flow may gain: what the energy guard lets gather, and rounding.
const GUARD_SLACK: f64 = 1.1e-3;

/// What is measured, at most how much of it is allowed, and how it is measured.
type Bound = (&'static str, f64, fn(&SolverRow) -> f64);

/// What is bracketed in the index: name of the test, and what it may come to at most.
const BOUNDS: &[Bound] = &[
    ("projection", 1e-5, divergence_left),
    ("decay", 5e-3, error_of_decay),
    ("impulse", 1e-2, error_of_impulse),
    ("energy-of-vortices", GUARD_SLACK, |row| energy_gained(row, vortices, 0.02)),
    ("energy-of-turmoil", GUARD_SLACK, |row| energy_gained(row, turmoil, 0.02)),
    ("energy-of-jerks", GUARD_SLACK, |row| energy_gained(row, turmoil, 0.5)),
];

fn cube(n: usize) -> Setup {
    Setup::new(Grid::unit_cube(n), Vessel::Box)
}

fn make(row: &SolverRow, setup: &Setup) -> Box<dyn Solver> {
    (row.make)(setup).unwrap_or_else(|error| panic!("{}: {error}", row.name))
}

/// Vortices in planes (Taylor, Green 1937), at most 1 m/s.
fn vortices(p: DVec3) -> DVec3 {
    let (x, y) = (PI * p.x, PI * p.y);
    DVec3::new(x.sin() * y.cos(), -x.cos() * y.sin(), 0.0)
}

/// Nothing in particular, some 1 m/s.
fn turmoil(p: DVec3) -> DVec3 {
    DVec3::new((9.0 * p.y).sin(), (7.0 * p.z).cos(), (8.0 * p.x).sin())
}

fn values(solver: &dyn Solver) -> Vec<f64> {
    let mut values = Vec::new();
    solver.visit(&mut |_, _, value| values.push(value));
    values
}

fn divergence_left(row: &SolverRow) -> f64 {
    let mut solver = make(row, &cube(N));
    let smooth = |p: DVec3| vortices(p) + DVec3::new((PI * p.x).sin(), 0.0, 0.0);
    solver.set_velocity(&smooth).expect("finite");
    let before = solver.divergence_l2_per_s();
    solver.project();
    solver.divergence_l2_per_s() / before
}

/// Vortices too slow to carry themselves decay as viscosity alone makes them.
fn error_of_decay(row: &SolverRow) -> f64 {
    let mut solver = make(row, &Setup { viscosity_m2_s: 0.02, ..cube(N) });
    solver.set_velocity(&|p| 1e-3 * vortices(p)).expect("finite");
    let before = solver.kinetic_energy_j();
    (0..50).for_each(|_| {
        solver.step(0.02).expect("finite");
    });
    let kept = (solver.kinetic_energy_j() / before).sqrt();
    (kept / (-2.0 * PI * PI * 0.02f64).exp() - 1.0).abs()
}

/// A short push from rest leaves push times force, whatever the scale at its ends.
fn error_of_impulse(row: &SolverRow) -> f64 {
    let errors = [(1.0, 1.0), (2.0, 0.0), (0.5, 3.5), (-1.0, -3.0)].map(|(start, end)| {
        let mut solver = make(row, &cube(N));
        solver.set_force(&|p| 10.0 * vortices(p)).expect("finite");
        solver.scale_force(start, end).expect("finite");
        solver.step(1e-3).expect("finite");
        let (mut error, mut norm) = (0.0, 0.0);
        solver.visit(&mut |p, c, value| {
            let exact = 0.5 * (start + end) * 1e-2 * vortices(p)[c];
            error += (value - exact).powi(2);
            norm += exact * exact;
        });
        (error / norm).sqrt()
    });
    errors.into_iter().fold(0.0, f64::max)
}

/// Largest share by which the energy of a flow that nothing drives ever exceeds its first.
fn energy_gained(row: &SolverRow, velocity: fn(DVec3) -> DVec3, dt_s: f64) -> f64 {
    let mut solver = make(row, &cube(N));
    solver.set_velocity(&velocity).expect("finite");
    solver.project();
    let before = solver.kinetic_energy_j();
    let after = (0..20).map(|_| solver.step(dt_s).expect("finite").kinetic_energy_j);
    (after.fold(0.0, f64::max) / before - 1.0).max(0.0)
}

#[test]
fn every_bound_is_kept_or_the_miss_is_declared() {
    let mut wrong = Vec::new();
    for row in INDEX {
        for (name, bound, measure) in BOUNDS {
            let declared = row.conformance_misses.iter().find(|miss| miss.case == *name);
            let range = declared.map_or(0.0..=*bound, |miss| miss.at_least..=miss.at_most);
            let value = measure(row);
            if !range.contains(&value) {
                wrong.push(format!("{}: {name} {value:e} is not in {range:?}", row.name));
            }
        }
        for miss in row.conformance_misses {
            let bound = BOUNDS.iter().find(|(name, ..)| *name == miss.case);
            let bound = bound.map_or(f64::INFINITY, |bound| bound.1);
            assert!(miss.n == N && miss.at_least > bound, "{}: {miss:?} is none", row.name);
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn a_velocity_that_is_set_is_visited() {
    let bent = |p: DVec3| DVec3::new(p.x + 2.0 * p.y, 3.0 * p.z - 0.1, (5.0 * p.x).sin());
    for row in INDEX {
        let mut solver = make(row, &cube(8));
        solver.set_velocity(&bent).expect("finite");
        let mut visited = [0; 3];
        solver.visit(&mut |p, c, value| {
            visited[c] += 1;
            assert_eq!(value, f64::from(bent(p)[c] as f32), "{} {p} {c}", row.name);
        });
        assert!(visited.iter().all(|count| *count >= 7 * 64), "{} {visited:?}", row.name);
        let centre = solver.velocity_at(Vec3::splat(0.5)).as_dvec3();
        assert!((centre - bent(DVec3::splat(0.5))).length() < 0.1, "{} {centre}", row.name);
    }
}

#[test]
fn rest_stays_rest() {
    for row in INDEX {
        for viscosity_m2_s in [0.0, 0.1] {
            let mut solver = make(row, &Setup { viscosity_m2_s, ..cube(8) });
            (0..3).for_each(|_| {
                solver.step(0.1).expect("finite");
            });
            assert!(values(&*solver).iter().all(|value| *value == 0.0), "{}", row.name);
            assert_eq!(solver.kinetic_energy_j(), 0.0, "{}", row.name);
        }
    }
}

#[test]
fn what_is_not_finite_is_refused_by_name_and_changes_nothing() {
    for row in INDEX {
        let mut solver = make(row, &cube(8));
        solver.set_velocity(&vortices).expect("finite");
        let before = values(&*solver);
        let far = |p: DVec3| p.x > 0.7 && p.y > 0.7 && p.z > 0.7;
        for bad in [f64::NAN, f64::INFINITY, -1e300] {
            let field = |p| if far(p) { DVec3::splat(bad) } else { vortices(p) };
            let name = row.name;
            let refused = solver.set_velocity(&field).expect_err(name);
            assert_eq!(refused.what, "velocity_m_s", "{name}");
            assert!(refused.value == bad || bad.is_nan(), "{name} {refused}");
            assert_eq!(solver.set_force(&field).expect_err(name).what, "acceleration_m_s2");
            assert_eq!(solver.scale_force(bad, 1.0).expect_err(name).what, "force scale");
            assert_eq!(solver.scale_force(1.0, bad).expect_err(name).what, "force scale");
            assert_eq!(solver.step(bad).expect_err(name).what, "dt_s");
        }
        assert_eq!(solver.step(-1.0).expect_err(row.name).value, -1.0);
        assert_eq!(before, values(&*solver), "{}", row.name);
        // Neither is the force there now.
        let mut other = make(row, &cube(8));
        other.set_velocity(&vortices).expect("finite");
        let ends = [&mut solver, &mut other].map(|solver| {
            solver.step(0.01).expect("finite");
            values(&**solver)
        });
        assert_eq!(ends[0], ends[1], "{}", row.name);
    }
}

#[test]
fn steps_across_a_hundred_cells_stay_finite() {
    for row in INDEX {
        for viscosity_m2_s in [0.0, 1e-3, 1e4] {
            let mut solver = make(row, &Setup { viscosity_m2_s, ..cube(8) });
            solver.set_velocity(&|p| 10.0 * turmoil(p)).expect("finite");
            solver.set_force(&|p| turmoil(1.0 - p)).expect("finite");
            for _ in 0..6 {
                let report = solver.step(100.0 / 8.0 / 10.0).expect("finite");
                assert!(report.kinetic_energy_j.is_finite(), "{} {viscosity_m2_s}", row.name);
            }
            assert!(values(&*solver).iter().all(|value| value.is_finite()), "{}", row.name);
        }
    }
}

#[test]
fn the_same_flow_has_the_same_bits_again_and_on_two_threads() {
    for row in INDEX {
        let run = |threads| {
            let pool = Arc::new(Pool::new(threads, false));
            let mut solver = make(row, &Setup { pool, viscosity_m2_s: 1e-3, ..cube(N) });
            solver.set_velocity(&turmoil).expect("finite");
            solver.set_force(&vortices).expect("finite");
            for dt_s in [0.01, 0.02, 0.3, 1.5] {
                solver.step(dt_s).expect("finite");
            }
            values(&*solver).into_iter().map(f64::to_bits).collect::<Vec<_>>()
        };
        let one = run(1);
        assert!(one == run(1), "{}: not the same twice", row.name);
        assert!(one == run(2), "{}: not the same on two threads", row.name);
    }
}

#[test]
fn a_setup_is_taken_or_refused_with_a_reason() {
    let grid = |cells| Grid { cells, spacing_m: 0.1, origin_in_world_m: Vec3::ZERO };
    let boxed = |cells| Setup::new(grid(cells), Vessel::Box);
    let pot = Vessel::Pot { centre_in_world_m: Vec3::splat(0.4), radius_m: 0.35 };
    let sided = |sides| Setup { sides, ..boxed([6; 3]) };
    let free = Sides::all(Side::FreeSlip);
    let flowing = [Side::Inflow(Vec3::X), Side::Outflow];
    let fine = [
        boxed([1; 3]),
        boxed([1, 5, 1]),
        boxed([7, 2, 1]),
        boxed([2, 3, 9]),
        Setup::new(grid([8; 3]), pot),
        sided(Sides::all(Side::NoSlip)),
        sided(Sides::all(Side::Periodic)),
        sided(free.with(1, [Side::NoSlip, Side::Moving(Vec3::X)])),
        sided(free.with(0, flowing)),
    ];
    let nonsense = [
        Setup { viscosity_m2_s: -1.0, ..boxed([6; 3]) },
        Setup { viscosity_m2_s: f32::NAN, ..boxed([6; 3]) },
        Setup { density_kg_m3: f32::INFINITY, ..boxed([6; 3]) },
        sided(free.with(0, [Side::Periodic, Side::NoSlip])),
        sided(free.with(2, [Side::Inflow(Vec3::Z), Side::NoSlip])),
        sided(free.with(2, [Side::Moving(Vec3::NAN), Side::NoSlip])),
    ];
    let try_it = |row: &SolverRow, setup: &Setup| match (row.make)(setup) {
        Err(error) => Some(error.to_string()),
        Ok(mut solver) => {
            solver.set_velocity(&turmoil).expect("finite");
            for dt_s in [0.05, 1.0] {
                solver.step(dt_s).expect("finite");
            }
            assert!(values(&*solver).iter().all(|value| value.is_finite()));
            None
        }
    };
    for row in INDEX {
        for setup in &fine {
            let what = (row.name, setup.grid.cells, setup.sides);
            let result = catch_unwind(std::panic::AssertUnwindSafe(|| try_it(row, setup)));
            let refusal = result.unwrap_or_else(|_| panic!("{what:?}"));
            assert!(refusal.is_none_or(|reason| reason.len() > 10), "{what:?}");
        }
        for setup in &nonsense {
            let refusal = (row.make)(setup).err().unwrap_or_else(|| panic!("{} took it", row.name));
            assert!(refusal.to_string().len() > 10, "{}: {refusal}", row.name);
        }
    }
}
