//! Liquids that are not the same everywhere, against closed forms.

use std::{f64::consts::PI, sync::Arc};

use cauldron_fluid::{
    Grid, Pot, Vessel,
    pool::Pool,
    scenes,
    simd::SimdClass,
    solver::{
        Scheme, Setup, Side, Sides, Solver, Walls,
        flow::{Flow, Medium},
    },
    substance::{Properties, Substances},
};
use glam::{DVec3, Vec3};

/// A closed box or pot with gravity along -y.
fn heavy(n: usize, vessel: Vessel) -> Setup {
    let gravity_m_s2 = Vec3::new(0.0, -10.0, 0.0);
    Setup { gravity_m_s2, ..Setup::new(Grid::unit_cube(n), vessel) }
}

fn pot() -> Vessel {
    Vessel::Pot { centre_in_world_m: Vec3::new(0.5, 0.55, 0.5), radius_m: 0.47 }
}

fn inviscid(density_kg_m3: f64) -> Medium {
    Medium { density_kg_m3, viscosity_m2_s: 0.0 }
}

#[test]
fn level_layers_stay_at_rest_to_the_last_bit_and_sleep() {
    for vessel in [Vessel::Box, pot()] {
        let setup = heavy(12, vessel);
        let setup = Setup { viscosity_m2_s: 1e-3, walls: Walls::NoSlip, ..setup };
        let mut flow = Flow::new(&setup).expect("a flow");
        // Light on top and heavy on top alike: nothing disturbs them.
        for slope in [-90.0, 90.0] {
            flow.set_medium(&|p| inviscid(1000.0 + slope * p.y * p.y)).expect("in range");
            for _ in 0..20 {
                let report = flow.step(0.02).expect("in range");
                assert!(report.asleep && report.guard_actions == 0);
            }
            assert_eq!(flow.kinetic_energy_j(), 0.0);
        }
    }
}

#[test]
fn a_small_difference_of_density_accelerates_as_its_mode_does() {
    // Of b = B cos(pi x) sin(pi y) along y, half is free of divergence: the rest is pressure.
    for (n, allowed) in [(8, 0.02), (16, 0.005)] {
        let mut flow = Flow::new(&heavy(n, Vessel::Box)).expect("a flow");
        let share = |p: DVec3| 0.05 * (PI * p.x).cos() * (PI * p.y).sin();
        flow.set_medium(&|p| inviscid(1000.0 * (1.0 + share(p)))).expect("in range");
        let (dt_s, steps) = (1e-3, 5);
        let mut guard_actions = 0;
        for _ in 0..steps {
            guard_actions += flow.step(dt_s).expect("in range").guard_actions;
        }
        let mut worst = 0f64;
        flow.visit(&mut |p, c, value| {
            let (x, y) = (PI * p.x, PI * p.y);
            let mode = DVec3::new(x.sin() * y.cos(), -x.cos() * y.sin(), 0.0);
            let exact = 0.5 * 10.0 * 0.05 * dt_s * f64::from(steps) * mode[c];
            worst = worst.max((value - exact).abs());
        });
        let fastest = 0.25 * dt_s * f64::from(steps);
        assert!(worst < allowed * fastest, "{n}: {}", worst / fastest);
        assert_eq!(guard_actions, 0);
    }
}

#[test]
fn what_is_the_same_everywhere_changes_no_bits() {
    let run = |sets: bool| {
        let setup = Setup { viscosity_m2_s: 0.01, ..heavy(8, pot()) };
        let mut flow = Flow::new(&setup).expect("a flow");
        let wild = |p: DVec3| DVec3::new((9.0 * p.y).sin(), (7.0 * p.z).cos(), (8.0 * p.x).sin());
        flow.set_velocity(&wild).expect("finite");
        let mut bits = Vec::new();
        for _ in 0..4 {
            if sets {
                let viscosity_m2_s = f64::from(setup.viscosity_m2_s);
                flow.set_medium(&|_| Medium { density_kg_m3: 1000.0, viscosity_m2_s })
                    .expect("in range");
            }
            flow.step(0.01).expect("in range");
            flow.visit(&mut |_, _, value| bits.push(value.to_bits()));
        }
        bits
    };
    assert_eq!(run(false), run(true));
}

#[test]
fn a_medium_that_is_none_is_refused_by_name_and_changes_nothing() {
    let mut flow = Flow::new(&heavy(4, Vessel::Box)).expect("a flow");
    let medium = |density_kg_m3, viscosity_m2_s| Medium { density_kg_m3, viscosity_m2_s };
    for (bad, what) in [
        (medium(f64::NAN, 0.0), "density_kg_m3"),
        (medium(0.0, 0.0), "density_kg_m3"),
        (medium(1e7, 0.0), "density_kg_m3"),
        (medium(1.0, -1.0), "viscosity_m2_s"),
        (medium(1.0, f64::INFINITY), "viscosity_m2_s"),
    ] {
        let here = |p: DVec3| if p.x > 0.7 { bad } else { medium(900.0, 1.0) };
        assert_eq!(flow.set_medium(&here).expect_err("bad").what, what);
    }
    assert!(flow.step(0.1).expect("in range").asleep);
    let nowhere = Setup { gravity_m_s2: Vec3::NAN, ..heavy(4, Vessel::Box) };
    let refused = Flow::new(&nowhere).err().expect("no gravity").to_string();
    assert!(refused.contains("gravity_m_s2"), "{refused}");
}

/// A channel between plates at y = 0 and 1, the upper one moving.
fn channel(n: usize, lid_m_s: f32) -> Setup {
    let sides = Sides::all(Side::Periodic)
        .with(1, [Side::NoSlip, Side::Moving(Vec3::new(lid_m_s, 0.0, 0.0))]);
    let grid = Grid { cells: [4, n, 3], ..Grid::unit_cube(n) };
    Setup { sides, viscosity_m2_s: 1.0, ..Setup::new(grid, Vessel::Box) }
}

fn thick(viscosity_m2_s: f64) -> Medium {
    Medium { density_kg_m3: 1000.0, viscosity_m2_s }
}

/// Largest error of the velocity along x.
fn worst_error(flow: &Flow, exact: impl Fn(f64) -> f64) -> f64 {
    let mut worst = 0f64;
    flow.visit(&mut |p, c, value| {
        let exact = if c == 0 { exact(p.y) } else { 0.0 };
        worst = worst.max((value - exact).abs());
    });
    worst
}

#[test]
fn two_layers_between_moving_plates_share_the_shear_as_their_viscosities_say() {
    for contrast in [3.0, 1e3, 1e6] {
        let mut flow = Flow::new(&channel(8, 1.0)).expect("a flow");
        let nu = |y: f64| if y < 0.5 { 0.1 } else { 0.1 * contrast };
        flow.set_medium(&|p| thick(nu(p.y))).expect("in range");
        let mut guard_actions = 0;
        for _ in 0..40 {
            guard_actions += flow.step(50.0).expect("in range").guard_actions;
        }
        // The stress is the same in both.
        let stress = 2.0 / (1.0 / 0.1 + 1.0 / (0.1 * contrast));
        let exact = |y: f64| match y < 0.5 {
            true => stress * y / 0.1,
            false => 1.0 - stress * (1.0 - y) / (0.1 * contrast),
        };
        let worst = worst_error(&flow, exact);
        // What is left at a millionfold is the rounding of f32, times that viscosity.
        let allowed = if contrast < 1e6 { 2e-3 } else { 0.05 };
        assert!(worst < allowed && guard_actions == 0, "{contrast}: {worst} {guard_actions}");
    }
}

#[test]
fn two_layers_that_are_pushed_converge_with_the_square_of_the_spacing() {
    let nu = |y: f64| if y < 0.5 { 1.0 } else { 20.0 };
    // nu u'' = -1 in each, with one stress nu u' = s - y.
    let s = {
        let (a, b) = (1.0, 20.0);
        (0.125 / a + 0.375 / b) / (0.5 / a + 0.5 / b)
    };
    let exact = |y: f64| match y < 0.5 {
        true => s * y - 0.5 * y * y,
        false => (s * (y - 1.0) - 0.5 * (y * y - 1.0)) / 20.0,
    };
    let error = |n| {
        let mut flow = Flow::new(&channel(n, 0.0)).expect("a flow");
        flow.set_medium(&|p| thick(nu(p.y))).expect("in range");
        flow.set_force(&|_| DVec3::X).expect("finite");
        (0..40).for_each(|_| assert!(flow.step(0.1).expect("in range").guard_actions == 0));
        worst_error(&flow, exact)
    };
    let (coarse, fine) = (error(8), error(16));
    let order = (coarse / fine).log2();
    assert!(fine < 2e-3 && order > 1.6, "{coarse} {fine} {order}");
}

#[test]
fn a_viscosity_that_hardly_differs_does_as_the_same_everywhere() {
    let wild = |p: DVec3| {
        0.1 * DVec3::new(
            (7.0 * p.y).sin(),
            (5.0 * p.z).cos(),
            (6.0 * p.x).sin() * (3.0 * p.y).cos(),
        )
    };
    for (vessel, allowed) in [(Vessel::Box, 5e-3), (pot(), 0.05)] {
        for (dt_s, scheme) in [(1e-4, Scheme::Multistep), (5e-3, Scheme::MultistepImplicit)] {
            let run = |more: f64| {
                let sides = Sides::of_vessel(Walls::NoSlip);
                let setup = Setup { sides, walls: Walls::NoSlip, ..heavy(12, vessel.clone()) };
                let mut flow = Flow::new(&Setup { viscosity_m2_s: 0.5, ..setup }).expect("a flow");
                let nu = |p: DVec3| if p.x > 0.5 { 0.5 * (1.0 + more) } else { 0.5 };
                flow.set_medium(&|p| thick(nu(p))).expect("in range");
                flow.set_velocity(&wild).expect("finite");
                flow.project();
                let mut before = flow.kinetic_energy_j();
                for _ in 0..3 {
                    let report = flow.step(dt_s).expect("in range");
                    assert_eq!((report.scheme, report.guard_actions), (scheme, 0));
                    assert!(report.kinetic_energy_j < before);
                    before = report.kinetic_energy_j;
                }
                let mut values = Vec::new();
                flow.visit(&mut |_, _, value| values.push(value));
                values
            };
            let (same, other) = (run(0.0), run(3e-3));
            let size = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
            let apart: Vec<f64> = same.iter().zip(&other).map(|(a, b)| a - b).collect();
            let error = size(&apart) / size(&same);
            assert!(error < allowed, "{vessel:?} {dt_s}: {error}");
        }
    }
}

#[test]
fn any_contrast_comes_to_rest_and_gains_nothing() {
    for vessel in [Vessel::Box, pot()] {
        for dt_s in [1e-3, 0.05, 5.0] {
            let setup = Setup { walls: Walls::NoSlip, ..heavy(10, vessel.clone()) };
            let mut flow = Flow::new(&setup).expect("a flow");
            // A millionfold within a cell.
            let nu = |p: DVec3| if (p.x - 0.5).abs() < 0.2 && p.y < 0.6 { 1e4 } else { 1e-2 };
            flow.set_medium(&|p| thick(nu(p))).expect("in range");
            let wild =
                |p: DVec3| DVec3::new((9.0 * p.y).sin(), (7.0 * p.z).cos(), (8.0 * p.x).sin());
            flow.set_velocity(&wild).expect("finite");
            flow.project();
            let mut before = flow.kinetic_energy_j();
            for _ in 0..30 {
                let after = flow.step(dt_s).expect("in range").kinetic_energy_j;
                assert!(after <= 1.001 * before, "{dt_s}: {before} {after}");
                before = after;
            }
            for _ in 0..60 {
                flow.step(5.0).expect("in range");
            }
            assert!(flow.step(5.0).expect("in range").asleep, "{}", flow.kinetic_energy_j());
        }
    }
}

/// A liquid and one substance of so many times its density, both inviscid, with gravity.
fn with_substance(grid: Grid, ratio: f32) -> (Flow, Substances) {
    let gravity_m_s2 = Vec3::new(0.0, -10.0, 0.0);
    let setup = Setup { gravity_m_s2, ..Setup::new(grid, Vessel::Box) };
    let density_kg_m3 = ratio * setup.density_kg_m3;
    let other = Properties { density_kg_m3, ..Properties::of_liquid(&setup) };
    (Flow::new(&setup).expect("a flow"), Substances::new(&setup, &[other]))
}

#[test]
fn heavy_over_light_starts_to_overturn_at_the_rate_of_linear_theory() {
    // Layers of half a metre between rigid ends (Taylor 1950): from rest, the interface
    // a cos(k x) is accelerated by sigma^2 a cos(k x).
    for ratio in [1.1, 3.0, 30.0] {
        let n = 32;
        let grid = Grid { cells: [n, n, 1], ..Grid::unit_cube(n) };
        let (mut flow, mut substances) = with_substance(grid, ratio);
        let (amplitude_m, h) = (0.4 / n as f32, 1.0 / n as f32);
        let interface = |x: f32| 0.5 + amplitude_m * (std::f32::consts::PI * x).cos();
        let above = |p: Vec3| ((p.y + 0.5 * h - interface(p.x)) / h).clamp(0.0, 1.0);
        substances.set_fraction(0, above).expect("a fraction");
        let dt_s = 1e-3;
        for _ in 0..4 {
            flow.set_mixture(&substances);
            flow.step(dt_s).expect("in range");
            substances.step(&flow, dt_s).expect("in range");
        }
        let (heavy, light) = (f64::from(ratio), 1.0);
        let rate_per_s2 = 10.0 * PI * (heavy - light) / (heavy + light) * (0.5 * PI).tanh();
        let (mut measured, mut norm) = (0.0, 0.0);
        flow.visit(&mut |p, c, value| {
            if c == 1 && (p.y - 0.5).abs() < 1e-6 {
                measured += value * (PI * p.x).cos();
                norm += (PI * p.x).cos().powi(2);
            }
        });
        let expected = rate_per_s2 * f64::from(amplitude_m) * 4.0 * dt_s;
        let error = measured / norm / expected - 1.0;
        // The velocity has a kink at the interface, of which a cell sees the mean.
        assert!((-0.07..0.01).contains(&error), "{ratio}: {error}");
    }
}

#[test]
fn a_heavy_blob_falls_and_never_gains_more_than_it_falls_by() {
    for ratio in [1.08, 2.0, 10.0, 1000.0] {
        let n = 12;
        let grid = Grid { cells: [n, 2 * n, n], ..Grid::unit_cube(n) };
        let (mut flow, mut substances) = with_substance(grid, ratio);
        let blob = |p: Vec3| (0.25 - (p - Vec3::new(0.5, 1.4, 0.5)).length()) * n as f32 + 0.5;
        substances.set_fraction(0, |p| blob(p).clamp(0.0, 1.0)).expect("a fraction");
        // Work of gravity: the difference of weight times what its middle has come down by.
        let potential_j = |substances: &Substances| {
            let mut fraction = vec![0.0; grid.len()];
            substances.copy_fraction(0, &mut fraction);
            let height = |at: usize| f64::from(grid.centre_in_world_m(0, at / n % (2 * n), 0).y);
            let moment: f64 =
                fraction.iter().enumerate().map(|(at, f)| f64::from(*f) * height(at)).sum();
            moment * f64::from(grid.cell_volume_m3()) * 1e4 * f64::from(ratio - 1.0)
        };
        let start_j = potential_j(&substances);
        let (mut guard_actions, mut worst, mut lowest) = (0, 0f64, f64::MAX);
        let dt_s = 4e-3;
        for _ in 0..130 {
            flow.set_mixture(&substances);
            guard_actions += flow.step(dt_s).expect("in range").guard_actions;
            substances.step(&flow, dt_s).expect("in range");
            let fallen_j = start_j - potential_j(&substances);
            worst = worst.max(flow.kinetic_energy_j() / fallen_j.max(1e-3 * start_j));
            lowest = lowest.min(potential_j(&substances) / start_j);
        }
        assert!(flow.kinetic_energy_j().is_finite() && lowest < 0.99);
        assert!(worst < 1.1, "{ratio}: {worst}");
        assert!(ratio > 100.0 || guard_actions == 0, "{ratio}: {guard_actions}");
    }
}

#[test]
fn bits_depend_on_neither_threads_nor_the_width_of_a_wide_class() {
    let run = |threads, simd, vessel: &Vessel, dt_s| {
        let pool = Arc::new(Pool::new(threads, false));
        let setup = Setup { pool, simd, walls: Walls::NoSlip, ..heavy(17, vessel.clone()) };
        let mut flow = Flow::new(&setup).expect("a flow");
        let share =
            |p: DVec3| 0.5 + 0.5 * (5.0 * p.x).sin() * (4.0 * p.y).cos() * (3.0 * p.z).cos();
        let medium = |p: DVec3| Medium {
            density_kg_m3: 1000.0 * (1.0 + 4.0 * share(p)),
            viscosity_m2_s: 10f64.powf(4.0 * share(p) - 4.0),
        };
        flow.set_medium(&medium).expect("in range");
        flow.set_force(&|p| DVec3::new(p.y, -p.x, 0.3)).expect("finite");
        (0..5).for_each(|_| assert_eq!(flow.step(dt_s).expect("in range").guard_actions, 0));
        let mut bits = Vec::new();
        flow.visit(&mut |_, _, value| bits.push(value.to_bits()));
        bits
    };
    let widest = SimdClass::detect();
    for vessel in [Vessel::Box, pot()] {
        for dt_s in [1e-3, 0.05] {
            let one = run(1, widest, &vessel, dt_s);
            assert!(one.iter().any(|bits| *bits != 0));
            assert!(one == run(3, widest, &vessel, dt_s));
            assert!(one == run(1, widest.min(SimdClass::Avx2), &vessel, dt_s));
            let portable = SimdClass::Portable;
            assert!(run(1, portable, &vessel, dt_s) == run(2, portable, &vessel, dt_s));
        }
    }
}

#[test]
fn what_gravity_and_substances_make_of_a_liquid_is_undone_with_them() {
    let grid = Grid::unit_cube(8);
    let (mut flow, mut substances) = with_substance(grid, 5.0);
    substances.set_fraction(0, |_| 1.0).expect("a fraction");
    flow.set_mixture(&substances);
    assert!((flow.cell_mass_kg() - 5000.0 / 512.0).abs() < 1e-6, "full of it");
    substances.clear();
    // Nothing of it is there yet.
    flow.set_mixture(&substances);
    assert!(flow.step(0.01).expect("in range").asleep);
    substances.set_fraction(0, |p| if p.x < 0.5 { 0.5 } else { 0.0 }).expect("a fraction");
    flow.set_mixture(&substances);
    assert!(flow.step(0.01).expect("in range").kinetic_energy_j > 0.0);
    flow.set_gravity_m_s2(Vec3::ZERO).expect("finite");
    flow.set_velocity(&|_| DVec3::ZERO).expect("finite");
    assert!(flow.step(0.01).expect("in range").asleep);
    substances.clear();
    flow.set_gravity_m_s2(Vec3::NEG_Y).expect("finite");
    flow.set_mixture(&substances);
    assert!(flow.step(0.01).expect("in range").asleep);
    assert!((flow.cell_mass_kg() - 1000.0 / 512.0).abs() < 1e-6);
}

#[test]
fn a_push_into_what_is_heavy_gives_the_momentum_that_it_reports() {
    let mut flow = Flow::new(&heavy(12, pot())).expect("a flow");
    flow.set_medium(&|p| inviscid(if p.x < 0.5 { 1000.0 } else { 1e5 })).expect("in range");
    for at in [Vec3::new(0.3, 0.5, 0.5), Vec3::new(0.5, 0.4, 0.5), Vec3::new(0.7, 0.5, 0.5)] {
        let impulse = DVec3::new(3.0, -2.0, 5.0);
        let before = flow.momentum_n_s();
        let reported = flow.push(at, 0.2, impulse).expect("finite");
        let measured = flow.momentum_n_s() - before;
        assert!((reported - measured).length() < 1e-9, "{reported} {measured}");
        assert!((reported - impulse).length() < 1e-5 * impulse.length(), "{reported}");
    }
    let light_kg = flow.effective_mass_kg(Vec3::new(0.25, 0.5, 0.5), 0.15);
    let heavy_kg = flow.effective_mass_kg(Vec3::new(0.75, 0.5, 0.5), 0.15);
    assert!((heavy_kg / light_kg / 100.0 - 1.0).abs() < 0.01, "{heavy_kg} {light_kg}");
}

#[test]
fn what_is_poured_into_a_pot_sinks_if_it_is_heavier_and_floats_if_it_is_lighter() {
    let height_m = |text: &str| {
        let mut scene = scenes::read("pot.toml", text).expect("a scene");
        scene.regrid(16);
        let mut pot =
            Pot::new(&scene, Arc::new(Pool::inline()), SimdClass::detect()).expect("a pot");
        for step in 0..40 {
            pot.pour(u8::from(step < 10), 0.01);
            pot.step(0.01);
        }
        assert_eq!(pot.totals().guard_actions, 0, "{text}");
        let mut fraction = vec![0.0; pot.grid().len()];
        pot.substances().expect("some").copy_fraction(0, &mut fraction);
        let centre = |at: usize| pot.grid().centre_in_world_m(0, at / 16 % 16, 0).y;
        let moment: f32 = fraction.iter().enumerate().map(|(at, f)| f * centre(at)).sum();
        moment / fraction.iter().sum::<f32>()
    };
    let of = |key: &str| height_m(&format!("[[substance]]\n{key}\n"));
    let (alike, thick) = (of("density_kg_m3 = 1000"), of("viscosity_m2_s = 2e-2"));
    assert_eq!(alike, thick, "nothing moves them");
    for (heavy, light) in [(1090.0, 910.0), (2500.0, 400.0)] {
        let of = |density: f64| of(&format!("density_kg_m3 = {density}"));
        assert!(of(heavy) < alike - 0.005 && of(light) > alike + 0.005, "{heavy} {light} {alike}");
    }
}
