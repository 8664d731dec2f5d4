//! How long one projection of a closed box takes: the direct solve, which takes its right-hand
//! side from the velocities, and a pass over these after it.
//!
//! Per cell the solve does about 2 (t(nx) + t(ny)) + 8 flops, t(n) = 2 n (1/4 + 1/8 + ...) being
//! those of a transform. That along x folds once below 64 points, twice from there, three times
//! from 128; that along y begins a fold earlier. The right-hand side takes 6 flops more, and the
//! pass after the solve 15. All of it reads and writes 64 bytes: velocities (three times), modes
//! (four times), half a table of pivots twice, solution (twice). The case names state the flops of
//! the solve, to be set against the measured peak of the machine.

use std::{hint::black_box, sync::Arc, time::Duration};

use cauldron_fluid::{
    Grid, Vessel,
    pool::Pool,
    solver::{Setup, Solver, flow::Flow},
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;

/// Flops of one transform per value: the odd half of what is left is a dense product at each
/// fold, and so is the even one after the last, which has less than `least` points to fold.
fn transform_flops(n: usize, least: usize) -> usize {
    let half = n / 2;
    let even = if half >= least { transform_flops(half, least) * half } else { 2 * half * half };
    (even + 2 * half * half) / n
}

fn project(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("projection");
    group.measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(300));
    for n in [16, 32, 48, 64, 128] {
        group.throughput(Throughput::Elements((n * n * n) as u64));
        for threads in [1, 2] {
            let setup = Setup {
                pool: Arc::new(Pool::new(threads, true)),
                ..Setup::new(Grid::unit_cube(n), Vessel::Box)
            };
            let mut flow = Flow::new(&setup).expect("a flow");
            let flops = 2 * (transform_flops(n, 32) + transform_flops(n, 16)) + 8;
            let case = format!("{n} x{threads}, {flops} flops per cell");
            let swirl = |p: DVec3| DVec3::new((7.0 * p.y).sin(), (5.0 * p.z).cos(), p.x * p.y);
            flow.set_velocity(&swirl).expect("finite");
            // What rounding leaves of the divergence costs as much to project as any other.
            group.bench_function(BenchmarkId::from_parameter(case), |bencher| {
                bencher.iter(|| black_box(&mut flow).project());
            });
        }
    }
    group.finish();
}

criterion_group!(benches, project);
criterion_main!(benches);
