//! Modes of round vessels against closed forms.

use glam::Vec3;
use proptest::prelude::*;

use super::{profile::Piece, *};
use crate::{Grid, Vessel, solver::SetupError};

/// Zeros of J_m', m first: Abramowitz & Stegun 1964, table 9.5.
const BESSEL: [(u32, f64); 12] = [
    (1, 1.84118),
    (2, 3.05424),
    (0, 3.83171),
    (3, 4.20119),
    (4, 5.31755),
    (1, 5.33144),
    (5, 6.41562),
    (2, 6.70613),
    (0, 7.01559),
    (6, 7.50127),
    (3, 8.01524),
    (1, 8.53632),
];

fn vessel(pieces: &[(f64, [f64; 3])]) -> Profile {
    let pieces =
        pieces.iter().map(|(down_to_m, square)| Piece { down_to_m: *down_to_m, square: *square });
    Profile::new([0.0; 2], pieces.collect()).unwrap()
}

fn cylinder(depth_m: f64) -> Profile {
    vessel(&[(depth_m, [1.0, 0.0, 0.0])])
}

/// A sphere of radius 1 whose centre is so deep.
fn sphere(centre_m: f64, down_to_m: f64) -> Profile {
    vessel(&[(down_to_m, [1.0 - centre_m * centre_m, 2.0 * centre_m, -1.0])])
}

fn paraboloid(depth_m: f64) -> Profile {
    vessel(&[(depth_m, [1.0, -1.0 / depth_m, 0.0])])
}

fn all_kinds() -> Vec<Profile> {
    let pot = vessel(&[(0.2, [1.0, 0.0, 0.0]), (1.2, [0.96, 0.4, -1.0])]);
    let spheres = [(0.0, 1.0), (0.0, 0.7), (-0.6, 0.4), (0.8, 1.8)].map(|(c, d)| sphere(c, d));
    [vec![pot, cylinder(0.3), paraboloid(0.05), paraboloid(1.0)], spheres.to_vec()].concat()
}

#[test]
fn an_upright_cylinder_has_the_waves_of_bessel() {
    for depth_m in [1e-3, 0.02, 0.3, 1.0, 30.0] {
        let modes = modes(&cylinder(depth_m), 40, 0.1).unwrap();
        for (mode, (m, k)) in modes.iter().zip(BESSEL) {
            let exact = k * (k * depth_m).tanh();
            assert_eq!(mode.waves_around, m, "{depth_m}");
            assert!((mode.wavenumber_per_m / k - 1.0).abs() < 3e-6, "{depth_m} {m} {k}");
            assert!((mode.lambda_per_m / exact - 1.0).abs() < 6e-6, "{depth_m} {m} {k}");
        }
        // The zeros of the table have six digits: the relation itself holds better.
        for RadialMode { lambda_per_m, wavenumber_per_m: k, .. } in modes {
            assert!(
                (lambda_per_m / (k * (k * depth_m).tanh()) - 1.0).abs() < 1e-8,
                "{depth_m} {k}"
            );
        }
    }
}

#[test]
fn an_upright_cylinder_has_the_shapes_of_bessel() {
    // J_1 and J_0 at k r with k R = 1.84118 and 3.83171, by their series.
    let bessel = |order: i32, x: f64| {
        let mut term = (0.5 * x).powi(order);
        (1..30).fold(term, |sum, i| {
            term *= -0.25 * x * x / f64::from(i * (i + order));
            sum + term
        })
    };
    let modes = modes(&cylinder(1.0), 6, 0.1).unwrap();
    for (mode, order) in [(&modes[0], 1), (&modes[2], 0)] {
        let k = mode.wavenumber_per_m;
        for r_m in [0.0, 1e-3, 0.2, 0.5, 0.9, 1.0] {
            let exact = bessel(order, k * r_m) / bessel(order, k) * mode.shape_per_m(1.0);
            assert!((mode.shape_per_m(r_m) - exact).abs() < 1e-8, "{order} {r_m}");
        }
    }
}

#[test]
fn a_hemisphere_sloshes_as_mciver_1989_found() {
    // Digits beyond his 1.5602 for m = 1 by a series of solid harmonics, which gives the same for
    // the others.
    let modes = modes(&sphere(0.0, 1.0), 40, 0.1).unwrap();
    let known = [(1, 1.560157), (2, 2.819694), (0, 3.745169)];
    for (mode, (m, lambda)) in modes.iter().zip(known) {
        assert_eq!(mode.waves_around, m);
        assert!((mode.lambda_per_m - lambda).abs() < 1e-6, "{m} {}", mode.lambda_per_m);
    }
}

#[test]
fn what_moves_below_fades_as_between_upright_walls() {
    let depth_m = 0.3;
    for mode in modes(&cylinder(depth_m), 20, 0.1).unwrap() {
        let ratio = mode.wavenumber_below_per_m(depth_m) / mode.wavenumber_per_m;
        assert!((ratio - 1.0).abs() < 1e-8, "{ratio}");
    }
    // The slowest wave of a hemisphere near its axis, by a series of solid harmonics.
    let k = modes(&sphere(0.0, 1.0), 2, 0.1).unwrap()[0].wavenumber_below_per_m(1.0);
    for (depth_m, part) in [(0.1, 0.8564), (0.2, 0.7366), (0.5, 0.4836)] {
        let about = (k * (1.0 - depth_m)).cosh() / k.cosh();
        assert!((about - part).abs() < 0.02, "{depth_m}: {about} {part}");
    }
}

#[test]
fn a_shallow_paraboloid_has_the_waves_of_lamb() {
    // omega^2 = (N (N + 2) - m^2) g d/R^2 for polynomials of degree N (Lamb 1932, art. 193), and
    // the correction for the depth goes with its square.
    let error = |depth_m: f64| {
        let modes = modes(&paraboloid(depth_m), 30, 0.1).unwrap();
        let slowest = |m: u32| modes.iter().filter(move |mode| mode.waves_around == m);
        (0..4)
            .flat_map(|m| slowest(m).take(2).enumerate().map(move |(j, mode)| (m, j, mode)))
            .map(|(m, j, mode)| {
                let n = f64::from(m) + 2.0 * (j + usize::from(m == 0)) as f64;
                let exact = (n * (n + 2.0) - f64::from(m * m)) * depth_m;
                (mode.lambda_per_m / exact - 1.0).abs()
            })
            .fold(0.0, f64::max)
    };
    let errors = [0.04, 0.02, 0.01].map(error);
    assert!(errors[2] < 2e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((3.5..4.5).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

#[test]
fn a_sphere_almost_closed_sloshes_as_a_hole_in_the_ice() {
    // lambda R = 2.754755 for m = 1 in a round hole in a plane over deep water (Henrici, Troesch,
    // Wuytack 1970). A wall bent away from the surface holds the liquid less.
    let lambda = |radius_m: f64| {
        let centre_m = (1.0 - radius_m * radius_m).sqrt();
        let modes = modes(&sphere(centre_m, centre_m + 1.0), 20, radius_m / 10.0).unwrap();
        assert_eq!(modes[0].waves_around, 1);
        modes[0].lambda_per_m * radius_m
    };
    let errors = [0.2, 0.1, 0.05].map(|radius_m| 1.0 - lambda(radius_m) / 2.754755);
    assert!(errors[0] > errors[1] && errors[1] > errors[2], "{errors:?}");
    assert!((0.0..0.02).contains(&errors[2]), "{errors:?}");
}

#[test]
fn finer_polynomials_and_slices_find_the_same() {
    for (vessel, profile) in all_kinds().into_iter().enumerate() {
        let coarse = modes(&profile, 60, 1e-3).unwrap();
        let waves = 30.0;
        let fine = modes_to_degree(&profile, 60, waves, 46);
        for (n, mode) in coarse.iter().enumerate() {
            let same = |other: &&RadialMode| other.waves_around == mode.waves_around;
            let nth = coarse[..n].iter().filter(same).count();
            let other = fine.iter().filter(same).nth(nth).unwrap();
            let error = (mode.lambda_per_m / other.lambda_per_m - 1.0).abs();
            // A corner of the liquid wider than a right angle leaves a kink of the potential.
            let bound = if profile.radius_m() < 0.7 && vessel == 7 { 2e-5 } else { 1e-6 };
            assert!(error < bound, "vessel {vessel}, mode {n}: {error:e}");
        }
    }
}

#[test]
fn shapes_are_orthonormal_on_the_disc() {
    for (vessel, profile) in all_kinds().into_iter().enumerate() {
        let modes = modes(&profile, 60, 1e-3).unwrap();
        let radius_m = profile.radius_m();
        let points = jacobi::gauss(40);
        for (i, j) in (0..modes.len()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let m = modes[i].waves_around;
            if m != modes[j].waves_around {
                continue;
            }
            let around = if m == 0 { 2.0 * PI } else { PI };
            let product: f64 = points
                .iter()
                .map(|[u, w]| {
                    let r_m = 0.5 * radius_m * (1.0 + u);
                    let area_m2 = around * 0.5 * radius_m * w * r_m;
                    area_m2 * modes[i].shape_per_m(r_m) * modes[j].shape_per_m(r_m)
                })
                .sum();
            let exact = f64::from(u8::from(i == j));
            assert!((product - exact).abs() < 1e-10, "vessel {vessel}, {i} {j}: {product}");
        }
    }
}

#[test]
fn no_mode_lifts_the_whole_surface_and_none_is_missed() {
    for (vessel, profile) in all_kinds().into_iter().enumerate() {
        let few = modes(&profile, 45, 1e-3).unwrap();
        let many = modes(&profile, 160, 1e-3).unwrap();
        for (n, (a, b)) in few.iter().zip(&many).enumerate() {
            assert_eq!(a.waves_around, b.waves_around, "vessel {vessel}, mode {n}");
            assert!(a.lambda_per_m > 0.0 && a.lambda_per_m.is_finite());
        }
        for modes in [&few, &many] {
            assert!(modes.is_sorted_by(|a, b| a.lambda_per_m <= b.lambda_per_m));
        }
        let shapes = |modes: &[RadialMode]| modes.iter().map(RadialMode::shapes).sum::<usize>();
        assert!((44..=45).contains(&shapes(&few)) && (159..=160).contains(&shapes(&many)));
        for mode in few.iter().filter(|mode| mode.waves_around == 0) {
            let mean: f64 = jacobi::gauss(40)
                .iter()
                .map(|[u, w]| {
                    w * (1.0 + u) * mode.shape_per_m(0.5 * profile.radius_m() * (1.0 + u))
                })
                .sum();
            assert!(mean.abs() < 1e-10 * mode.shape_per_m(0.0).abs(), "vessel {vessel}: {mean}");
        }
    }
}

fn grid() -> Grid {
    Grid { cells: [20, 10, 20], spacing_m: 0.1, origin_in_world_m: Vec3::new(-1.0, -1.0, -1.0) }
}

#[test]
fn profiles_follow_their_vessels() {
    let axis = Vec3::new(0.0, -2.0, 0.0);
    for centre_y_m in [-0.7f32, -0.4, 0.0, 0.2] {
        let centre_in_world_m = Vec3::new(0.1, centre_y_m, -0.1);
        let vessels = [
            Vessel::Pot { centre_in_world_m, radius_m: 0.8 },
            Vessel::Bowl { centre_in_world_m, radius_m: 0.8 },
            Vessel::Cylinder { centre_in_world_m, axis, radius_m: 0.8 },
        ];
        for vessel in vessels {
            let profile = Profile::of_vessel(&vessel, &grid()).unwrap();
            assert_eq!(profile.axis_in_world_m, [0.1f32, -0.1].map(f64::from));
            let mut above_m = 0.0;
            for piece in &profile.pieces {
                for part in [1e-6, 0.3, 0.6, 0.999] {
                    let depth_m = above_m + part * (piece.down_to_m - above_m);
                    let radius_m = piece.square_and_slope(depth_m)[0].sqrt();
                    let wall = Vec3::new(0.1 + radius_m as f32, -depth_m as f32, -0.1);
                    assert!(vessel.depth_inside_m(wall).abs() < 1e-3, "{vessel:?} {depth_m}");
                }
                above_m = piece.down_to_m;
            }
            let bottom = Vec3::new(0.1, -above_m as f32, -0.1);
            let is_bottom =
                vessel.depth_inside_m(bottom).abs() < 1e-3 || (above_m - 1.0).abs() < 1e-6;
            assert!(is_bottom, "{vessel:?} {above_m}");
        }
    }
}

#[test]
fn what_is_not_round_is_refused() {
    let centre_in_world_m = Vec3::ZERO;
    let of = |vessel: Vessel| Profile::of_vessel(&vessel, &grid()).map(|_| ()).unwrap_err();
    let tube = |axis| Vessel::Cylinder { centre_in_world_m, axis, radius_m: 0.5 };
    for vessel in [
        Vessel::Box,
        tube(Vec3::X),
        tube(Vec3::new(0.1, 1.0, 0.0)),
        tube(Vec3::ZERO),
        Vessel::Bowl { centre_in_world_m: Vec3::new(0.0, -0.5, 0.0), radius_m: 1.05 },
    ] {
        assert!(matches!(of(vessel.clone()), SetupError::Unsupported(_)), "{vessel:?}");
    }
    for radius_m in [f32::NAN, 0.0, -0.5, f32::INFINITY] {
        let SetupError::Refused(refused) = of(Vessel::Pot { centre_in_world_m, radius_m }) else {
            panic!("{radius_m}")
        };
        assert!(refused.what.contains("round vessel"), "{refused}");
    }
    let deep = Vessel::Bowl { centre_in_world_m: Vec3::new(0.0, -0.9, 0.0), radius_m: 0.5 };
    assert!(matches!(of(deep), SetupError::Refused(_)));
}

#[test]
fn numbers_out_of_range_are_refused_by_name() {
    let new = |down_to_m, square| Profile::new([0.0; 2], vec![Piece { down_to_m, square }]);
    for depth_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = new(depth_m, [1.0, 0.0, 0.0]).unwrap_err();
        assert!(refused.what.contains("depth"), "{refused}");
    }
    for square in [[-1.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0], [1.0, -2.0, 0.0], [1.0, -4.1, 4.1]] {
        let refused = new(1.0, square).unwrap_err();
        assert!(refused.what.contains("radius"), "{refused}");
    }
    assert!(Profile::new([0.0; 2], vec![]).unwrap_err().what.contains("depth"));
    for shortest_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = modes(&cylinder(1.0), 10, shortest_m).unwrap_err();
        assert!(refused.what.contains("shortest"), "{refused}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_vessel_has_modes_that_are_finite(
        radius_m in -3.0..2.0f64,
        depth in -3.0..1.5f64,
        c1 in -1.0..3.0f64,
        c2 in -1.0..1.0f64,
        most in 0usize..50,
        shortest in -2.0..1.0f64,
    ) {
        let [radius_m, depth, shortest] = [radius_m, depth, shortest].map(|v| 10f64.powf(v));
        let (depth_m, square_m2) = (depth * radius_m, radius_m * radius_m);
        let slope_m = c1 * square_m2 / depth_m;
        let bend = (c2 - (c1 + c2).min(0.0)).max(-1.0 - c1) * square_m2 / (depth_m * depth_m);
        let piece = Piece { down_to_m: depth_m, square: [square_m2, slope_m, bend] };
        if let Ok(profile) = Profile::new([0.0; 2], vec![piece]) {
            for mode in modes(&profile, most, shortest * radius_m).unwrap() {
                prop_assert!(mode.lambda_per_m.is_finite() && mode.lambda_per_m > 0.0, "{mode:?}");
                prop_assert!(mode.wavenumber_per_m > 0.0, "{mode:?}");
                for part in [0.0, 0.3, 0.7, 1.0] {
                    prop_assert!(mode.shape_per_m(part * radius_m).is_finite(), "{mode:?}");
                }
            }
        }
    }
}
