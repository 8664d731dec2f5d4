//! Time of one step of one substance that fills the box, and of one in a small part of it, at a
//! courant number just below 1, on one thread and on two.

use std::{f64::consts::PI, sync::Arc};

use cauldron_fluid::{
    Grid, Vessel,
    pool::Pool,
    solver::{Setup, Solver, flow::Flow},
    substance::{Properties, Substances},
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};

fn roll(p: DVec3) -> DVec3 {
    let p = PI * p;
    let (s, c) = (p.map(f64::sin), p.map(f64::cos));
    0.5 * DVec3::new(s.x * c.y * c.z, c.x * s.y * c.z, -2.0 * c.x * c.y * s.z)
}

fn steps(criterion: &mut Criterion) {
    let full = |p: Vec3| 0.5 + 0.4 * (9.0 * p.x).sin() * (7.0 * p.y).cos() * (8.0 * p.z).cos();
    let plume = |p: Vec3| if p.x < 0.3 && p.z < 0.3 { 0.5 } else { 0.0 };
    let shapes: [(&str, &dyn Fn(Vec3) -> f32); 2] = [("full", &full), ("plume", &plume)];
    let mut group = criterion.benchmark_group("substance");
    group.sample_size(20);
    for (n, threads) in [(32, 1), (64, 1), (64, 2), (128, 2)] {
        let pool = Arc::new(Pool::new(threads, true));
        let setup = Setup { pool, ..Setup::new(Grid::unit_cube(n), Vessel::Box) };
        let mut flow = Flow::new(&setup).expect("a flow");
        flow.set_velocity(&roll).expect("finite");
        flow.project();
        for (name, shape) in shapes {
            let mut substances = Substances::new(&setup, &[Properties::of_liquid(&setup)]);
            substances.set_fraction(0, shape).expect("in range");
            group.throughput(Throughput::Elements(setup.grid.len() as u64));
            group.bench_function(BenchmarkId::new(name, format!("{n}/{threads}")), |bencher| {
                bencher.iter(|| substances.step(&flow, 0.95 / n as f64).expect("in range"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
