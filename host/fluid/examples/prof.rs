//! Profile.
use cauldron_fluid::{
    Grid, Vessel,
    bench::case::CASES,
    solver::{Setup, Solver, flow::Flow},
};
use std::time::Instant;
fn main() {
    let n: usize = std::env::args().nth(1).map_or(32, |a| a.parse().unwrap());
    let cfl: f64 = std::env::args().nth(2).map_or(0.25, |a| a.parse().unwrap());
    let case = &CASES[1];
    let mut flow =
        Flow::new(&Setup { viscosity_m2_s: 0.01, ..Setup::new(Grid::unit_cube(n), Vessel::Box) })
            .unwrap();
    flow.set_velocity(&case.velocity_m_s).unwrap();
    flow.set_force(&case.force_m_s2.unwrap()).unwrap();
    let steps = (case.steps(n) as f64 / cfl) as usize;
    let dt = 1.0 / steps as f64;
    let mut t: Vec<f64> = vec![];
    let mut sch = None;
    for s in 0..steps {
        flow.scale_force(case.force_scale(s as f64 * dt), case.force_scale((s + 1) as f64 * dt))
            .unwrap();
        let a = Instant::now();
        let r = flow.step(dt).unwrap();
        t.push(a.elapsed().as_secs_f64() * 1e3);
        sch = Some(r.scheme);
    }
    let (mut e, mut nn) = (0.0, 0.0);
    flow.visit(&mut |p, c, v| {
        let x = case.exact(p, 1.0)[c];
        e += (v - x).powi(2);
        nn += x * x;
    });
    t.sort_by(f64::total_cmp);
    println!(
        "n={n} cfl={cfl} steps={steps} {sch:?} err {:.4e} min {:.4} median {:.4} ms",
        (e / nn).sqrt(),
        t[0],
        t[t.len() / 2]
    );
}
