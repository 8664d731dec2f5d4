//! How near a step of the flow, and its parts, come to what the machine can do.
//!
//! The roofline (Williams, Waterman, Patterson 2009) of a kernel is the time that its bytes or
//! its flops take at least, whichever is longer. Both rates are measured in the same run, on one
//! thread: bandwidth by a triad over as much memory as the kernel has, flops by fused
//! multiplications and additions in registers. The table, of the shortest times, comes first, then
//! Criterion's of what can be called by itself.
//!
//! Bytes are those of each array once per pass, without what the cache fetches to write; per cell:
//!
//! - `momentum`, one multistep part: velocity, the history twice, the result: 48. Three components
//!   of 22 flops for advection and advance and 9 for viscosity, and 6 of the survey of the
//!   result, which finds it in the cache. It is timed as a step less a projection.
//! - `projection`: the divergence 12, its modes 4, the systems along z 8 and their pivots 2, the
//!   modes again 4, the correction 24; 6 flops, those of four transforms and of a tridiagonal
//!   solve, 8, and 6.
//! - `step`: both.

use std::{
    env,
    hint::black_box,
    time::{Duration, Instant},
};

use cauldron_fluid::{
    Grid, Vessel,
    simd::SimdClass,
    solver::{Scheme, Setup, Solver, flow::Flow},
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;

const SIZES: [usize; 2] = [32, 64];

/// Small enough for a single multistep part, which the table asserts.
const DT_S: f64 = 1e-3;

/// Values that stay in the innermost cache, and operations on each in a row: many values are on
/// their way at once, so that none waits for the last.
const VALUES: usize = 1024;
const DEPTH: usize = 16;

/// What a kernel does per cell.
#[derive(Clone, Copy)]
struct Work {
    name: &'static str,
    bytes: usize,
    flops: usize,
    /// Memory that it returns to each time: the arrays, each once.
    footprint: usize,
}

/// Flops per value of one transform of `n`, which folds into halves: the odd half is a dense
/// product, and so is the even one once it is short.
fn transform_flops(n: usize) -> usize {
    let half = n / 2;
    let even = if half >= 32 { transform_flops(half) * half } else { 2 * half * half };
    (even + 2 * half * half) / n
}

fn works(n: usize) -> [Work; 3] {
    let flops = 6 + 4 * transform_flops(n) + 8 + 6;
    let momentum = Work { name: "momentum", bytes: 48, flops: 3 * (22 + 9) + 6, footprint: 36 };
    let projection = Work { name: "projection", bytes: 54, flops, footprint: 18 };
    let step = Work {
        name: "step",
        bytes: momentum.bytes + projection.bytes,
        flops: momentum.flops + projection.flops,
        // The velocity is in both.
        footprint: momentum.footprint + projection.footprint - 12,
    };
    [momentum, projection, step]
}

/// One flow that steps, and one that is only projected: a flow that was would be surveyed anew.
struct Flows {
    stepped: Flow,
    projected: Flow,
}

impl Flows {
    fn new(n: usize) -> Self {
        let swirl = |p: DVec3| DVec3::new((7.0 * p.y).sin(), (5.0 * p.z).cos(), p.x * p.y);
        let setup = Setup { viscosity_m2_s: 1e-3, ..Setup::new(Grid::unit_cube(n), Vessel::Box) };
        let flow = || {
            let mut flow = Flow::with_scheme(&setup, Scheme::Multistep).expect("a flow");
            flow.set_velocity(&swirl).expect("finite");
            flow
        };
        let mut flows = Self { stepped: flow(), projected: flow() };
        let report = flows.stepped.step(DT_S).expect("in range");
        assert_eq!((report.scheme, report.substeps), (Scheme::Multistep, 1));
        flows
    }

    /// Times of one step and of one projection, one after the other.
    fn times(&mut self) -> [Duration; 2] {
        [
            timed(|| {
                black_box(self.stepped.step(DT_S)).expect("in range");
            }),
            timed(|| black_box(&mut self.projected).project()),
        ]
    }
}

fn timed(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

/// The shortest of `times` runs in seconds: what others do at the same time only adds.
fn least_s(times: usize, mut work: impl FnMut()) -> f64 {
    (0..times).map(|_| timed(&mut work).as_secs_f64()).fold(f64::INFINITY, f64::min)
}

/// a = b + s c over three arrays that take `bytes` together: the rate in bytes per second.
fn triad_bytes_per_s(simd: SimdClass, bytes: usize, times: usize) -> f64 {
    let len = bytes / (3 * size_of::<f32>());
    let (mut a, b, c) = (vec![0f32; len], vec![1f32; len], vec![2f32; len]);
    let seconds = least_s(times, || {
        let (a, b, c) = (&mut black_box(&mut a)[..len], &b[..len], &c[..len]);
        simd.vectorize(
            #[inline(always)]
            || {
                for i in 0..len {
                    a[i] = b[i] + 0.5 * c[i];
                }
            },
        );
    });
    (3 * size_of::<f32>() * len) as f64 / seconds
}

/// Fused multiplications and additions: flops per second.
fn peak_flops_per_s(simd: SimdClass, times: usize) -> f64 {
    const ROUNDS: usize = 100;
    let mut values = [1f32; VALUES];
    let seconds = least_s(times, || {
        let (factor, term) = black_box((0.999, 0.001));
        simd.vectorize_as(
            #[inline(always)]
            |class| {
                for _ in 0..ROUNDS {
                    for value in &mut values {
                        for _ in 0..DEPTH {
                            *value = class.multiply_add(*value, factor, term);
                        }
                    }
                }
            },
        );
        black_box(&mut values);
    });
    (2 * DEPTH * VALUES * ROUNDS) as f64 / seconds
}

/// Prints one line for each kernel and size, from the shortest of `times` runs.
fn print_rooflines(sizes: &[usize], times: usize) {
    let simd = SimdClass::detect();
    let peak = peak_flops_per_s(simd, 10 * times);
    println!("one thread, {simd}, {:.0} Gflop/s in registers", peak * 1e-9);
    println!(
        "{:12} {:>3} {:>7} {:>7} {:>8} {:>7} {:>8} {:>11} {:>9}",
        "kernel", "n", "B/cell", "fl/cell", "ns/cell", "GB/s", "Gflop/s", "triad GB/s", "roofline"
    );
    for &n in sizes {
        let cells = n * n * n;
        let mut flows = Flows::new(n);
        let mut least = [f64::INFINITY; 2];
        for _ in 0..times {
            let spent = flows.times();
            least = [0, 1].map(|m| least[m].min(spent[m].as_secs_f64()));
        }
        let [step_s, projection_s] = least;
        let all_s = [step_s - projection_s, projection_s, step_s];
        for (work, seconds) in works(n).into_iter().zip(all_s) {
            let Work { name, bytes, flops, footprint } = work;
            let triad = triad_bytes_per_s(simd, cells * footprint, times);
            let cell_s = seconds / cells as f64;
            let bound_s = (bytes as f64 / triad).max(flops as f64 / peak);
            println!(
                "{name:12} {n:3} {bytes:7} {flops:7} {:8.2} {:7.1} {:8.1} {:11.1} {:8.0} %",
                cell_s * 1e9,
                bytes as f64 / cell_s * 1e-9,
                flops as f64 / cell_s * 1e-9,
                triad * 1e-9,
                100.0 * bound_s / cell_s
            );
        }
    }
}

fn flow(criterion: &mut Criterion) {
    // Without the flag it is a test that everything runs.
    let is_test = !env::args().any(|argument| argument == "--bench");
    let sizes = if is_test { &SIZES[..1] } else { &SIZES[..] };
    print_rooflines(sizes, if is_test { 2 } else { 300 });
    let mut group = criterion.benchmark_group("flow");
    group.measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(300));
    for &n in sizes {
        let mut flows = Flows::new(n);
        group.throughput(Throughput::Elements((n * n * n) as u64));
        for (name, place) in [("step", 0), ("projection", 1)] {
            group.bench_function(BenchmarkId::new(name, n), |bencher| {
                bencher.iter_custom(|times| (0..times).map(|_| flows.times()[place]).sum());
            });
        }
    }
    group.finish();
}

criterion_group!(benches, flow);
criterion_main!(benches);
