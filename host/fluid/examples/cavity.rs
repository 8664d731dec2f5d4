use cauldron_fluid::{
    Grid, Vessel,
    solver::{Setup, Side, Sides, Solver, flow::Flow},
};
use glam::Vec3;
const Y: [f64; 17] = [
    1., 0.9766, 0.9688, 0.9609, 0.9531, 0.8516, 0.7344, 0.6172, 0.5, 0.4531, 0.2813, 0.1719,
    0.1016, 0.0703, 0.0625, 0.0547, 0.,
];
const X: [f64; 17] = [
    1., 0.9688, 0.9609, 0.9531, 0.9453, 0.9063, 0.8594, 0.8047, 0.5, 0.2344, 0.2266, 0.1563,
    0.0938, 0.0781, 0.0703, 0.0625, 0.,
];
const U: [[f64; 17]; 3] = [
    [
        1., 0.84123, 0.78871, 0.73722, 0.68717, 0.23151, 0.00332, -0.13641, -0.20581, -0.21090,
        -0.15662, -0.10150, -0.06434, -0.04775, -0.04192, -0.03717, 0.,
    ],
    [
        1., 0.75837, 0.68439, 0.61756, 0.55892, 0.29093, 0.16256, 0.02135, -0.11477, -0.17119,
        -0.32726, -0.24299, -0.14612, -0.10338, -0.09266, -0.08186, 0.,
    ],
    [
        1., 0.65928, 0.57492, 0.51117, 0.46604, 0.33304, 0.18719, 0.05702, -0.06080, -0.10648,
        -0.27805, -0.38289, -0.29730, -0.22220, -0.20196, -0.18109, 0.,
    ],
];
const V: [[f64; 17]; 3] = [
    [
        0., -0.05906, -0.07391, -0.08864, -0.10313, -0.16914, -0.22445, -0.24533, 0.05454, 0.17527,
        0.17507, 0.16077, 0.12317, 0.10890, 0.10091, 0.09233, 0.,
    ],
    [
        0.,
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
        0.,
    ],
    [
        0., -0.21388, -0.27669, -0.33714, -0.39188, -0.51550, -0.42665, -0.31966, 0.02526, 0.32235,
        0.33075, 0.37095, 0.32627, 0.30353, 0.29012, 0.27485, 0.,
    ],
];
fn lag(xs: &[(f64, f64)], x: f64, m: usize) -> f64 {
    let mut i = xs.iter().position(|p| p.0 >= x).unwrap_or(xs.len() - 1);
    i = i.saturating_sub(m / 2).min(xs.len() - m);
    let p = &xs[i..i + m];
    let mut s = 0.0;
    for a in 0..m {
        let mut w = p[a].1;
        for b in 0..m {
            if a != b {
                w *= (x - p[b].0) / (p[a].0 - p[b].0);
            }
        }
        s += w;
    }
    s
}
fn main() {
    let n: usize = std::env::args().nth(1).map_or(32, |a| a.parse().unwrap());
    for (r, (re, t)) in [(100., 10.), (400., 40.), (1000., 80.)].into_iter().enumerate() {
        let h = 1.0 / n as f32;
        let grid = Grid { cells: [n, n, 1], spacing_m: h, origin_in_world_m: Vec3::ZERO };
        let sides = Sides::all(Side::NoSlip)
            .with(1, [Side::NoSlip, Side::Moving(Vec3::X)])
            .with(2, [Side::FreeSlip; 2]);
        let mut flow = Flow::new(&Setup {
            viscosity_m2_s: (1.0 / re) as f32,
            sides,
            ..Setup::new(grid, Vessel::Box)
        })
        .unwrap();
        let dt = std::env::args().nth(2).map_or(1.0, |a| a.parse::<f64>().unwrap()) / n as f64;
        let steps = (t / dt) as usize;
        let mut sch = None;
        let mut guards = 0;
        let mut last = 0.0;
        let mut change = 0.0;
        let a = std::time::Instant::now();
        for _ in 0..steps {
            let rep = flow.step(dt).unwrap();
            sch = Some((rep.scheme, rep.substeps));
            guards += rep.guard_actions;
            change = rep.kinetic_energy_j - last;
            last = rep.kinetic_energy_j;
        }
        let ms = a.elapsed().as_secs_f64() * 1e3 / steps as f64;
        let z = 0.5 * h;
        let mut s = 0.0;
        let mut c = 0.0;
        for i in 0..17 {
            let u = flow.velocity_at(Vec3::new(0.5, Y[i] as f32, z)).x as f64;
            let d = u - U[r][i];
            if i != 0 && i != 16 {
                s += d * d;
                c += 1.0;
            }
            let v = flow.velocity_at(Vec3::new(X[i] as f32, 0.5, z)).y as f64;
            let d = v - V[r][i];
            if !d.is_nan() && i != 0 && i != 16 {
                s += d * d;
                c += 1.0;
            }
            if std::env::args().nth(3).is_some() {
                println!(
                    "{:.4} {:.4} {:.4} | {:.4} {:.4} {:.4}",
                    Y[i], u, U[r][i], X[i], v, V[r][i]
                );
            }
        }
        let mut us = vec![(0.0, 0.0)];
        let mut vs = vec![(0.0, 0.0)];
        flow.visit(&mut |p, c, val| {
            if c == 0 && (p.x - 0.5).abs() < 1e-6 {
                us.push((p.y, val));
            }
            if c == 1 && (p.y - 0.5).abs() < 1e-6 {
                vs.push((p.x, val));
            }
        });
        us.push((1.0, 1.0));
        vs.push((1.0, 0.0));
        for m in [2usize, 4] {
            let (mut s, mut c) = (0.0, 0.0);
            for i in 1..16 {
                let d = lag(&us, Y[i], m) - U[r][i];
                s += d * d;
                c += 1.0;
                let d = lag(&vs, X[i], m) - V[r][i];
                if !d.is_nan() {
                    s += d * d;
                    c += 1.0;
                }
            }
            println!("   m={m} rms {:.5}", (s / c as f64).sqrt());
        }
        println!(
            "Re {re} rms {:.5} scheme {sch:?} guards {guards} steps {steps} dE {:.2e} ms {:.4}",
            (s / c as f64).sqrt(),
            change / last,
            ms
        );
    }
}
