use cauldron_fluid::{Grid, Vessel, bench::case::CASES, solver::*};
use glam::DVec3;
use std::{f64::consts::PI, time::Instant};
fn vortex(p: DVec3) -> DVec3 {
    let (s, c) = ((PI * p).map(f64::sin), (PI * p).map(f64::cos));
    DVec3::new(s.x * c.y, -c.x * s.y, 0.0)
}
fn main() {
    let n = 32;
    for row in INDEX.iter().filter(|r| !r.name.starts_with("found")) {
        for case in CASES {
            let mut s = (row.make)(&Setup {
                viscosity_m2_s: case.viscosity_m2_s as f32,
                ..Setup::new(Grid::unit_cube(n), Vessel::Box)
            })
            .unwrap();
            s.set_velocity(&case.velocity_m_s).unwrap();
            if let Some(f) = case.force_m_s2 {
                s.set_force(&f).unwrap();
            }
            let steps = case.steps(n);
            let dt = case.end_s / steps as f64;
            let mut best = f64::MAX;
            for step in 0..steps {
                s.scale_force(
                    case.force_scale(step as f64 * dt),
                    case.force_scale((step + 1) as f64 * dt),
                )
                .unwrap();
                let t = Instant::now();
                s.step(dt).unwrap();
                best = best.min(t.elapsed().as_secs_f64());
            }
            let (mut e, mut q) = (0.0, 0.0);
            s.visit(&mut |p, c, v| {
                let x = case.exact(p, case.end_s)[c];
                e += (v - x).powi(2);
                q += x * x;
            });
            println!(
                "{:22} {:14} {:.4e}  {:.3} ms",
                row.name,
                case.name,
                (e / q).sqrt(),
                best * 1e3
            );
        }
        for (cfl, steps) in [(4.0, 16), (16.0, 4), (20.0, 4), (32.0, 2), (100.0, 4)] {
            let mut s = (row.make)(&Setup::new(Grid::unit_cube(n), Vessel::Box)).unwrap();
            s.set_velocity(&vortex).unwrap();
            let k = s.kinetic_energy_j();
            let mut r = StepReport::at_rest();
            let mut g = 0;
            let t = Instant::now();
            let mut most = 0f64;
            for _ in 0..steps {
                r = s.step(cfl / n as f64).unwrap();
                g += r.guard_actions;
                most = most.max(r.kinetic_energy_j / k);
            }
            println!(
                "   cfl {cfl} x {steps}: {:?} parts {} kept {:.4} most {most:.4} guard {g}  {:.2} ms/step",
                r.scheme,
                r.substeps,
                r.kinetic_energy_j / k,
                t.elapsed().as_secs_f64() * 1e3 / steps as f64
            );
        }
    }
}
