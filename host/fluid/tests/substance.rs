//! Substances: carried without loss, without new extremes, and only where liquid is.

use cauldron_fluid::{
    Grid, Vessel,
    solver::{Setup, Solver, Walls, flow::Flow},
    substance::{Carrying, Substances},
};
use glam::{DVec3, Vec3};

fn pot() -> Setup {
    let grid = Grid { cells: [24; 3], spacing_m: 0.256 / 24.0, origin_in_world_m: Vec3::ZERO };
    let centre_in_world_m = Vec3::new(0.128, 0.14, 0.128);
    let vessel = Vessel::Pot { centre_in_world_m, radius_m: 0.12 };
    Setup { walls: Walls::NoSlip, viscosity_m2_s: 1e-5, ..Setup::new(grid, vessel) }
}

fn fractions(substances: &Substances, index: usize, cells: usize) -> Vec<f32> {
    let mut fractions = vec![0.0; cells];
    substances.copy_fraction(index, &mut fractions);
    fractions
}

#[test]
fn stirring_keeps_the_volume_of_each_substance_and_makes_no_new_extremes() {
    let setup = pot();
    let (mut flow, mut substances) =
        (Flow::new(&setup).expect("a flow"), Substances::new(&setup, &[0.0, 1e-6]));
    let centre = Vec3::new(0.12, 0.15, 0.13);
    substances.set_fraction(0, |p| if p.distance(centre) < 0.04 { 1.0 } else { 0.0 }).unwrap();
    substances.set_fraction(1, |p| (p.y / 0.256).clamp(0.0, 0.5)).unwrap();
    let before = [0, 1].map(|index| substances.volume_m3(index));
    for step in 0..100 {
        let angle = step as f32 * 0.1;
        let at = Vec3::new(0.128 + 0.05 * angle.cos(), 0.15, 0.128 + 0.05 * angle.sin());
        let impulse = Vec3::new(-angle.sin(), 0.3, angle.cos()).as_dvec3() * 1e-3;
        flow.push(at, 0.012, impulse).unwrap();
        flow.step(0.01).unwrap();
        assert_eq!(substances.step(&flow, 0.01).unwrap().carrying, Carrying::Limited);
    }
    for (index, highest) in [(0, 1.0), (1, 0.5)] {
        let change = substances.volume_m3(index) / before[index] - 1.0;
        assert!(change.abs() < 1e-5, "{index}: {change}");
        let fractions = fractions(&substances, index, setup.grid.len());
        let (low, high) =
            fractions.iter().fold((1f32, 0f32), |(low, high), f| (low.min(*f), high.max(*f)));
        assert!(low >= -1e-5 && high <= highest + 1e-5, "{index}: {low} {high}");
    }
}

#[test]
fn a_blob_in_solid_rotation_comes_round_to_where_it_was() {
    let n = 32;
    let setup = Setup::new(Grid { cells: [n, n, 2], ..Grid::unit_cube(n) }, Vessel::Box);
    let mut flow = Flow::new(&setup).expect("a flow");
    // Rotation inside, smoothly none at the walls: psi = (sin pi x sin pi y)^2.
    let pi = std::f64::consts::PI;
    flow.set_velocity(&|p| {
        let (x, y) = (pi * p.x, pi * p.y);
        let u = x.sin().powi(2) * (2.0 * y).sin();
        let v = -(2.0 * x).sin() * y.sin().powi(2);
        DVec3::new(u, v, 0.0)
    })
    .unwrap();
    flow.project();
    let mut substances = Substances::new(&setup, &[0.0]);
    let blob = |p: Vec3| (-60.0 * ((p.x - 0.5).powi(2) + (p.y - 0.6).powi(2))).exp();
    substances.set_fraction(0, blob).unwrap();
    // Near the middle one turn takes 1 s / pi; the blob is smeared along its orbit but its
    // distance from the centre of rotation is kept.
    let mean_radius = |substances: &Substances| {
        let fractions = fractions(substances, 0, setup.grid.len());
        let (mut sum, mut weight) = (0f64, 0f64);
        for k in 0..2 {
            for j in 0..n {
                for i in 0..n {
                    let p = setup.grid.centre_in_world_m(i, j, k) - Vec3::new(0.5, 0.5, 0.0);
                    let fraction = f64::from(fractions[setup.grid.cell(i, j, k)]);
                    sum += fraction * f64::from(p.x.hypot(p.y));
                    weight += fraction;
                }
            }
        }
        sum / weight
    };
    let (before, volume) = (mean_radius(&substances), substances.volume_m3(0));
    for _ in 0..32 {
        substances.step(&flow, 0.01).unwrap();
    }
    assert!((mean_radius(&substances) / before - 1.0).abs() < 0.05);
    assert!((substances.volume_m3(0) / volume - 1.0).abs() < 1e-5);
    assert!(fractions(&substances, 0, setup.grid.len()).iter().all(|f| (-1e-5..1.0).contains(f)));
}

#[test]
fn a_step_across_many_cells_still_keeps_the_volume() {
    let setup = Setup::new(Grid::unit_cube(8), Vessel::Box);
    let mut flow = Flow::new(&setup).expect("a flow");
    let pi = std::f64::consts::PI;
    let roll = |p: DVec3| {
        let (x, y) = (pi * p.x, pi * p.y);
        DVec3::new(x.sin() * y.cos(), -x.cos() * y.sin(), 0.0)
    };
    flow.set_velocity(&roll).unwrap();
    flow.project();
    for (dt_s, carrying) in [(5.0, Carrying::Upwind), (500.0, Carrying::Lagging)] {
        let mut substances = Substances::new(&setup, &[0.0]);
        substances.set_fraction(0, |p| if p.x < 0.5 { 1.0 } else { 0.0 }).unwrap();
        let before = substances.volume_m3(0);
        assert_eq!(substances.step(&flow, dt_s).unwrap().carrying, carrying);
        assert!((substances.volume_m3(0) / before - 1.0).abs() < 1e-5);
        let fractions = fractions(&substances, 0, setup.grid.len());
        assert!(fractions.iter().all(|f| (-1e-5..1.0 + 1e-5).contains(f)));
    }
}

#[test]
fn diffusion_alone_follows_the_cosine_solution() {
    let grid = Grid { cells: [32, 1, 1], ..Grid::unit_cube(32) };
    let setup = Setup::new(grid, Vessel::Box);
    let mut substances = Substances::new(&setup, &[0.01]);
    let pi = std::f32::consts::PI;
    substances.set_fraction(0, |p| 0.5 + 0.4 * (pi * p.x).cos()).unwrap();
    let flow = Flow::new(&setup).expect("a flow");
    for _ in 0..100 {
        substances.step(&flow, 0.05).unwrap();
    }
    let decay = (-0.01 * pi * pi * 5.0).exp();
    for (i, fraction) in fractions(&substances, 0, 32).into_iter().enumerate() {
        let exact = 0.5 + 0.4 * decay * (pi * (i as f32 + 0.5) / 32.0).cos();
        assert!((fraction - exact).abs() < 2e-3, "{i}: {fraction} {exact}");
    }
}

#[test]
fn what_is_poured_fills_the_room_that_is_left_and_no_more() {
    let setup = pot();
    let mut substances = Substances::new(&setup, &[0.0, 0.0]);
    let at = Vec3::new(0.128, 0.2, 0.128);
    for _ in 0..200 {
        substances.pour(0, at, 0.03, 5.0, 0.01).unwrap();
    }
    assert!(substances.fraction_at(0, at) > 0.9);
    let alone = substances.volume_m3(0);
    for _ in 0..2000 {
        substances.pour(1, at, 0.03, 50.0, 0.01).unwrap();
    }
    assert_eq!(substances.volume_m3(0), alone);
    let sum: Vec<f32> = fractions(&substances, 0, setup.grid.len())
        .iter()
        .zip(fractions(&substances, 1, setup.grid.len()))
        .map(|(a, b)| a + b)
        .collect();
    assert!(sum.iter().all(|sum| (0.0..=1.0 + 1e-6).contains(sum)));
    assert!(substances.pour(0, at, f32::NAN, 1.0, 0.01).is_err());
    substances.pour(7, at, 0.03, 1.0, 0.01).unwrap();
    substances.pour(0, Vec3::splat(9.0), 0.03, 1.0, 0.01).unwrap();
    assert_eq!(substances.volume_m3(0), alone, "nothing is poured beside the pot");
}

#[test]
fn without_substances_or_motion_nothing_is_carried() {
    let setup = pot();
    let flow = Flow::new(&setup).expect("a flow");
    let mut none = Substances::new(&setup, &[]);
    assert!(none.is_empty());
    assert_eq!(none.step(&flow, 0.01).unwrap().carrying, Carrying::Nothing);
    let mut still = Substances::new(&setup, &[0.0]);
    still.pour(0, Vec3::new(0.128, 0.2, 0.128), 0.03, 5.0, 0.1).unwrap();
    let before = fractions(&still, 0, setup.grid.len());
    assert_eq!(still.step(&flow, 0.01).unwrap().carrying, Carrying::Nothing);
    assert_eq!(before, fractions(&still, 0, setup.grid.len()));
    still.clear();
    assert_eq!(still.volume_m3(0), 0.0);
    assert!(still.step(&flow, f64::INFINITY).is_err());
}
