//! The friction as a matrix.

use glam::Vec3;
use proptest::prelude::*;

use super::*;
use crate::{
    grid::Grid,
    pool::Pool,
    simd::SimdClass,
    solver::{
        Side, Sides, Walls,
        flow::{
            faces::Faces,
            field::components,
            ghosts::{Fill, Ghosts},
        },
    },
    vessel::Vessel,
};

fn any_sides() -> impl Strategy<Value = Sides> {
    let side = || prop_oneof![Just(Side::FreeSlip), Just(Side::NoSlip), Just(Side::Outflow)];
    let both =
        || prop_oneof![Just([Side::Periodic; 2]), (side(), side()).prop_map(|(a, b)| [a, b])];
    [both(), both(), both()].prop_map(Sides)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn friction_is_symmetric_and_takes_energy(
        cells in [2usize..8, 2usize..8, 2usize..8],
        sides in any_sides(),
        is_pot in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let layout = Layout::new(cells);
        let grid = Grid { cells, spacing_m: 0.1, origin_in_world_m: Vec3::ZERO };
        let radius_m = 0.45 * grid.extent_m().min_element();
        let centre_in_world_m = (0.5 * grid.extent_m()).with_y(1.05 * radius_m);
        let pot = Vessel::Pot { centre_in_world_m, radius_m };
        let vessel = if is_pot { pot } else { Vessel::Box };
        let sides = if is_pot { Sides::of_vessel(Walls::NoSlip) } else { sides };
        let faces = Faces::new(&layout, &grid, &vessel, &sides, Walls::NoSlip);
        let (ghosts, pool) = (Ghosts::new(&layout, &sides), Pool::inline());
        let on = Engine { pool: &pool, simd: SimdClass::Portable, faces: &faces };
        let mut draws = oorandom::Rand64::new(u128::from(seed));
        let mut draw = || draws.rand_float() as f32;
        let (mut nu, mut density) = (layout.zeros(), layout.zeros());
        nu.iter_mut().for_each(|nu| *nu = 10f32.powf(6.0 * draw() - 3.0));
        density.iter_mut().for_each(|density| *density = 0.1 + draw());
        ghosts.extend_cells(&mut density);
        let mut stress = Stress::new(&layout, faces.vessel.as_ref());
        stress.set(on, &ghosts, &nu, Some(&density), 100.0);
        let mut any = || {
            let mut u = [layout.zeros(), layout.zeros(), layout.zeros()];
            for (u, inertia) in u.iter_mut().zip(&stress.inertia) {
                for (u, inertia) in u.iter_mut().zip(inertia.iter()) {
                    *u = if *inertia > 0.0 { draw() - 0.5 } else { 0.0 };
                }
            }
            ghosts.fill(&mut u, Fill::Difference);
            u
        };
        let (a, b) = (any(), any());
        let times = |u: &Vector| {
            let mut out = [layout.zeros(), layout.zeros(), layout.zeros()];
            stress.apply(on, components(u), &mut out, [0.0, 1.0]);
            out
        };
        let dot = |u: &Vector, v: &Vector| -> f64 {
            u.iter().zip(v).flat_map(|(u, v)| u.iter().zip(v.iter()))
                .map(|(u, v)| f64::from(*u) * f64::from(*v)).sum()
        };
        let (va, vb) = (times(&a), times(&b));
        let size = dot(&a, &va).abs() + dot(&b, &vb).abs();
        prop_assert!((dot(&a, &vb) - dot(&b, &va)).abs() <= 1e-4 * size, "{} {}", dot(&a, &vb), dot(&b, &va));
        prop_assert!(dot(&a, &va) >= 0.0);
        // No mode is faster than the bound.
        let inertial: f64 = (0..3).map(|c| {
            a[c].iter().zip(stress.inertia[c].iter()).map(|(a, m)| f64::from(a * a * m)).sum::<f64>()
        }).sum();
        prop_assert!(dot(&a, &va) <= 1.0001 * stress.stiffness_per_s * inertial);
    }
}
