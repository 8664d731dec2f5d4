//! Shapes at nodes against the shapes themselves, and both ways against each other.

use std::f64::consts::PI;

use glam::Vec3;
use proptest::prelude::*;

use super::*;
use crate::{
    Grid, Vessel,
    surface::round::{RadialMode, modes, profile::Piece},
};

/// A lattice over the square from -1 to 1 and an upright cylinder in it.
struct Case {
    lattice: Lattice,
    profile: Profile,
}

impl Case {
    fn new(along: usize, [x_m, z_m]: [f32; 2], radius_m: f32) -> Self {
        let spacing_m = 2.0 / along as f32;
        let grid = Grid {
            cells: [along, 1, along],
            spacing_m,
            origin_in_world_m: Vec3::new(-1.0, -spacing_m, -1.0),
        };
        let centre_in_world_m = Vec3::new(x_m, 0.0, z_m);
        let vessel = Vessel::Cylinder { centre_in_world_m, axis: Vec3::Y, radius_m };
        let pieces =
            vec![Piece { down_to_m: 0.7, square: [f64::from(radius_m).powi(2), 0.0, 0.0] }];
        Self {
            lattice: Lattice::over(&grid, &vessel, 1),
            profile: Profile::new([x_m, z_m].map(f64::from), pieces).unwrap(),
        }
    }

    fn table(&self, simd: SimdClass) -> Table {
        Table::new(&self.profile, &self.lattice, simd).unwrap()
    }

    /// The shape of a wave at all nodes.
    fn shape(&self, table: &Table, wave: usize) -> Vec<f32> {
        let modal: Vec<f32> = (0..table.waves().len()).map(|w| f32::from(w == wave)).collect();
        let mut nodal = vec![f32::NAN; self.lattice.wet.len()];
        table.synthesise([&modal], [&mut nodal]);
        nodal
    }
}

/// Mirrors along both axes, through nodes and between them, along one, and along none.
fn cases() -> [Case; 4] {
    [
        Case::new(18, [0.0; 2], 0.97),
        Case::new(17, [0.0; 2], 1.0),
        Case::new(20, [0.1, 0.013], 0.8),
        Case::new(16, [0.03, -0.02], 0.9),
    ]
}

fn noise(count: usize, seed: usize) -> Vec<f32> {
    let mut random = oorandom::Rand32::new(seed as u64);
    (0..count).map(|_| 2.0 * random.rand_float() - 1.0).collect()
}

fn largest_error(a: &[f32], b: impl IntoIterator<Item = f32>) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn mirrors_are_found_where_they_are() {
    let mirrored = cases().map(|case| {
        let mirrors = Mirrors::new(&case.lattice, case.profile.axis_in_world_m);
        let counted: f32 = mirrors.images.iter().map(|images| 4.0 * share(images)).sum();
        let wet = case.lattice.wet.iter().filter(|wet| **wet).count();
        assert_eq!(counted, wet as f32);
        mirrors.mirrored
    });
    assert_eq!(mirrored, [[true, true], [true, true], [true, false], [false, false]]);
    // Half of a disc at the side of the box mirrors nothing in it.
    let case = Case::new(10, [-1.0, 0.0], 0.15);
    let mirrors = Mirrors::new(&case.lattice, case.profile.axis_in_world_m);
    assert_eq!((mirrors.mirrored, mirrors.images.len()), ([false, true], 1));
}

#[test]
fn a_sum_of_waves_is_found_again_and_lifts_nothing() {
    for case in cases() {
        let mut table = case.table(SimdClass::detect());
        let modal = noise(table.waves().len(), 1);
        let mut nodal = vec![f32::NAN; case.lattice.wet.len()];
        table.synthesise([&modal], [&mut nodal]);
        assert!(nodal.iter().zip(&case.lattice.wet).all(|(value, wet)| *wet || *value == 0.0));
        let sum: f64 = nodal.iter().map(|v| f64::from(*v)).sum();
        let all: f64 = nodal.iter().map(|v| f64::from(v.abs())).sum();
        assert!(sum.abs() < 1e-6 * all, "{sum} {all}");
        let mut found = vec![f32::NAN; modal.len()];
        table.analyse(&nodal, &mut found);
        let node_m2 = case.lattice.node_m2();
        let error = largest_error(&modal, found.iter().map(|found| node_m2 * found));
        assert!(error < 3e-6, "{:?}: {error}", case.lattice.nodes);
    }
}

#[test]
fn a_push_on_a_node_moves_each_wave_by_its_shape_there() {
    for case in cases() {
        let mut table = case.table(SimdClass::detect());
        let count = table.waves().len();
        let shapes: Vec<Vec<f32>> = (0..count).map(|w| case.shape(&table, w)).collect();
        for node in (0..case.lattice.wet.len()).step_by(7) {
            let mut nodal = vec![0.0; case.lattice.wet.len()];
            nodal[node] = 2.0;
            let [mut whole, mut few] = [vec![f32::NAN; count], vec![f32::NAN; count]];
            table.analyse(&nodal, &mut whole);
            table.analyse_few(&[(node, 0.5), (node, 1.5)], &mut few);
            for found in [whole, few] {
                let error = largest_error(&found, shapes.iter().map(|shape| 2.0 * shape[node]));
                assert!(error < 2e-6, "{:?} {node}: {error}", case.lattice.nodes);
            }
        }
    }
}

#[test]
fn shapes_at_nodes_are_those_of_the_vessel() {
    let mut compared = 0;
    for axis_in_world_m in [[0.0; 2], [0.05, 0.021]] {
        let case = Case::new(40, axis_in_world_m, 0.92);
        let table = case.table(SimdClass::detect());
        // The same modes by another set of polynomials.
        let modes = modes(&case.profile, 9, 0.1).unwrap();
        for (w, wave) in table.waves().iter().enumerate() {
            let is_same = |mode: &&RadialMode| {
                let ratio = mode.lambda_per_m / wave.lambda_per_m;
                mode.waves_around == wave.waves_around && (ratio - 1.0).abs() < 1e-6
            };
            let Some(mode) = modes.iter().find(is_same) else { continue };
            compared += 1;
            let shape = case.shape(&table, w);
            for (node, value) in
                shape.iter().enumerate().filter(|(node, _)| case.lattice.wet[*node])
            {
                let [x_m, z_m] = table.mirrors.offset_m(&case.lattice, node);
                let angle = f64::from(wave.waves_around) * z_m.atan2(x_m);
                let around = if wave.is_sine { angle.sin() } else { angle.cos() };
                let exact = mode.shape_per_m(x_m.hypot(z_m)) * around;
                let error = (f64::from(*value) - exact).abs();
                assert!(error < 0.05 * mode.shape_per_m(0.92), "{wave:?} {node}: {value} {exact}");
            }
        }
    }
    assert_eq!(compared, 2 * 9);
}

#[test]
fn waves_are_as_many_as_nodes_tell_apart() {
    for (along, least, most) in [(12, 25, 45), (24, 120, 170), (60, 399, 400)] {
        let table = Case::new(along, [0.0; 2], 0.95).table(SimdClass::detect());
        let count = table.waves().len();
        assert!((least..=most).contains(&count), "{along}: {count}");
        let most_per_m = 2.0 * PI / (3.0 * 2.0 / along as f64);
        assert!(table.waves().iter().all(|wave| wave.wavenumber_per_m <= most_per_m));
    }
}

#[test]
fn a_surface_without_room_has_no_waves() {
    for radius_m in [0.01, 0.1] {
        let case = Case::new(8, [0.0; 2], radius_m);
        let mut table = case.table(SimdClass::detect());
        assert_eq!(table.waves().len(), 0);
        let mut nodal = vec![1.0; 64];
        table.synthesise([&[]], [&mut nodal]);
        assert_eq!(nodal, [0.0; 64]);
        table.analyse(&nodal, &mut []);
        table.analyse_few(&[(3, 1.0)], &mut []);
    }
    let case = Case::new(8, [0.0; 2], 0.9);
    let refused = Table::new(
        &case.profile,
        &Lattice { spacing_m: f32::NAN, ..case.lattice },
        SimdClass::Portable,
    );
    assert!(refused.is_err_and(|refused| refused.what.contains("shortest")));
}

#[test]
fn two_at_once_and_wider_vectors_have_the_same_bits() {
    for case in cases() {
        let both_ways = |simd| {
            let mut table = case.table(simd);
            let count = table.waves().len();
            let [a, b] = [1, 2].map(|seed| noise(count, seed));
            let [mut from_a, mut from_b, mut alone] =
                [(); 3].map(|()| vec![0.0; case.lattice.wet.len()]);
            table.synthesise([&a, &b], [&mut from_a, &mut from_b]);
            table.synthesise([&b], [&mut alone]);
            assert_eq!(from_b, alone);
            let mut found = vec![0.0; count];
            table.analyse(&from_a, &mut found);
            (from_a, found)
        };
        let [portable, avx2, avx512] = SimdClass::ALL.map(both_ways);
        assert_eq!(avx2, avx512);
        assert!(largest_error(&portable.0, avx2.0) < 1e-5);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn any_round_surface_is_found_again(
        along in 4usize..26,
        x_m in -0.3..0.3f32,
        z_m in -0.3..0.3f32,
        radius_m in 0.05..1.4f32,
        mirrored in 0..4,
    ) {
        // Beyond the box too, where the lattice sees a part of the disc only.
        let axes = [[0.0, 0.0], [1e-5, -1e-5], [0.0, z_m], [x_m, z_m]];
        let axis_in_world_m = axes[mirrored as usize];
        let case = Case::new(along, axis_in_world_m, radius_m);
        let mut table = case.table(SimdClass::detect());
        let modal = noise(table.waves().len(), along);
        let mut nodal = vec![0.0; case.lattice.wet.len()];
        table.synthesise([&modal], [&mut nodal]);
        let mut found = vec![0.0; modal.len()];
        table.analyse(&nodal, &mut found);
        let node_m2 = case.lattice.node_m2();
        let error = largest_error(&modal, found.iter().map(|found| node_m2 * found));
        prop_assert!(error < 1e-5, "{error}");
    }
}
