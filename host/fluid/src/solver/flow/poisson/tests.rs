//! The solver against its operator, for all kinds of ends.

use super::{Modal, Poisson, Room, Stored, Unknowns};
use crate::{
    pool::Pool,
    simd::SimdClass,
    solver::flow::{
        faces::cells,
        field::{Field, Layout},
    },
    spectral::basis::{End, Ends},
};

const HALF_OPEN: Ends = Ends::Between([End::Closed, End::Open]);
const OTHER_HALF: Ends = Ends::Between([End::Open, End::Closed]);
const OPEN: Ends = Ends::Between([End::Open; 2]);
const ODD: Ends = Ends::Between([End::Odd; 2]);
const ODD_BELOW: Ends = Ends::Between([End::Odd, End::Closed]);

/// Every kind of end on every axis, and what may go wrong with them together.
const ENDS: [[Ends; 3]; 12] = [
    [Ends::CLOSED; 3],
    [Ends::Periodic; 3],
    [OPEN; 3],
    [HALF_OPEN; 3],
    [OTHER_HALF; 3],
    [Ends::Periodic, Ends::CLOSED, HALF_OPEN],
    [Ends::CLOSED, OPEN, Ends::Periodic],
    [HALF_OPEN, Ends::Periodic, Ends::CLOSED],
    [OPEN, OTHER_HALF, Ends::Periodic],
    [ODD; 3],
    [ODD_BELOW, ODD, OPEN],
    [OPEN, ODD_BELOW, ODD_BELOW],
];

const SIZES: [[usize; 3]; 9] = [
    [1, 1, 1],
    [2, 2, 2],
    [1, 8, 8],
    [8, 1, 1],
    [3, 1, 5],
    [5, 9, 1],
    [7, 13, 11],
    [32, 16, 4],
    [31, 12, 20],
];

/// A with f64, as the module of the solver states it.
fn apply(size: [usize; 3], ends: [Ends; 3], psi: &[f64]) -> Vec<f64> {
    let strides = [1, size[0], size[0] * size[1]];
    cells(size)
        .map(|(i, j, k)| {
            let cell = [i, j, k];
            let at = i + size[0] * (j + size[1] * k);
            let across = |axis: usize, up: usize| {
                let (n, stride, c) = (size[axis], strides[axis], cell[axis]);
                let is_end = c == up * (n - 1);
                match (is_end, ends[axis]) {
                    (false, _) if up == 1 => psi[at] - psi[at + stride],
                    (false, _) => psi[at] - psi[at - stride],
                    (true, Ends::Periodic) if up == 1 => psi[at] - psi[at - c * stride],
                    (true, Ends::Periodic) => psi[at] - psi[at + (n - 1) * stride],
                    (true, Ends::Between(ends)) => match ends[up] {
                        End::Closed => 0.0,
                        End::Open => psi[at],
                        End::Odd => 2.0 * psi[at],
                    },
                }
            };
            (0..3).map(|axis| across(axis, 0) + across(axis, 1)).sum()
        })
        .collect()
}

fn is_singular(ends: [Ends; 3]) -> bool {
    ends.iter().all(|ends| matches!(ends, Ends::Periodic) || *ends == Ends::CLOSED)
}

fn subtract_mean(values: &mut [f64]) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
}

/// A right-hand side that can be solved for.
fn right_hand_side(size: [usize; 3], ends: [Ends; 3]) -> Vec<f64> {
    let mut rhs: Vec<f64> = cells(size)
        .map(|(i, j, k)| ((3 * i + 5 * j + 7 * k) as f64).sin() + (i as f64 * 0.2).cos())
        .collect();
    if is_singular(ends) {
        subtract_mean(&mut rhs);
    }
    rhs
}

fn padded(layout: &Layout, values: &[f64]) -> Field {
    let mut field = layout.zeros();
    for ((i, j, k), value) in cells(layout.cells).zip(values) {
        field[layout.index(i, j, k)] = *value as f32;
    }
    field
}

fn unpadded(layout: &Layout, field: &Field) -> Vec<f64> {
    cells(layout.cells).map(|(i, j, k)| f64::from(field[layout.index(i, j, k)])).collect()
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a, b| a.max(b.abs()))
}

fn solve(pool: &Pool, simd: SimdClass, size: [usize; 3], ends: [Ends; 3]) -> (Layout, Field) {
    let layout = Layout::new(size);
    let (rhs, mut psi) = (padded(&layout, &right_hand_side(size, ends)), layout.zeros());
    let mut poisson = Poisson::new(&layout, ends, pool.threads());
    poisson.solve(pool, simd, Stored(&layout, &rhs), &mut psi);
    (layout, psi)
}

#[test]
fn the_residual_is_rounding_for_any_shape_and_ends() {
    let pool = Pool::new(2, false);
    for (size, ends) in SIZES.into_iter().flat_map(|size| ENDS.map(|ends| (size, ends))) {
        let rhs = right_hand_side(size, ends);
        for simd in SimdClass::ALL {
            let (layout, psi) = solve(&pool, simd, size, ends);
            let psi = unpadded(&layout, &psi);
            let miss =
                apply(size, ends, &psi).iter().zip(&rhs).map(|(a, b)| a - b).collect::<Vec<_>>();
            // A takes what psi is rounded by up to 12 times as large.
            let scale = largest(rhs.iter().copied()) + largest(psi.iter().copied());
            let residual = largest(miss) / scale.max(1e-30);
            assert!(residual < 4e-6, "{size:?} {ends:?} {simd}: {residual}");
        }
    }
}

#[test]
fn the_solution_is_that_of_conjugate_gradients() {
    let (size, pool) = ([6, 5, 7], Pool::inline());
    for ends in ENDS {
        let rhs = right_hand_side(size, ends);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (mut exact, mut r, mut p) = (vec![0.0; rhs.len()], rhs.clone(), rhs.clone());
        for _ in 0..200 {
            let (q, square) = (apply(size, ends, &p), dot(&r, &r));
            if square < 1e-24 {
                break;
            }
            let alpha = square / dot(&p, &q);
            exact.iter_mut().zip(&p).for_each(|(x, p)| *x += alpha * p);
            r.iter_mut().zip(&q).for_each(|(r, q)| *r -= alpha * q);
            let beta = dot(&r, &r) / square;
            p.iter_mut().zip(&r).for_each(|(p, r)| *p = r + beta * *p);
        }
        let (layout, psi) = solve(&pool, SimdClass::detect(), size, ends);
        let mut psi = unpadded(&layout, &psi);
        if is_singular(ends) {
            subtract_mean(&mut psi);
            subtract_mean(&mut exact);
        }
        let miss = largest(psi.iter().zip(&exact).map(|(a, b)| a - b));
        assert!(miss < 3e-6 * largest(exact), "{ends:?}: {miss}");
    }
}

#[test]
fn threads_change_no_bits_and_neither_do_256_or_512() {
    let bits = |threads, simd, size, ends| {
        let (_, psi) = solve(&Pool::new(threads, false), simd, size, ends);
        psi.iter().map(|psi| psi.to_bits()).collect::<Vec<_>>()
    };
    for (size, ends) in [([33, 24, 17], ENDS[0]), ([64, 20, 12], ENDS[6]), ([20, 40, 9], ENDS[3])] {
        let alone = bits(1, SimdClass::Avx512, size, ends);
        assert!(alone.iter().any(|bits| *bits != 0));
        assert!(alone == bits(1, SimdClass::Avx2, size, ends), "{size:?}");
        for threads in [2, 3] {
            assert!(alone == bits(threads, SimdClass::Avx512, size, ends), "{size:?} {threads}");
        }
    }
}

#[test]
fn what_passes_by_is_the_solution_for_any_number_of_threads() {
    let (size, simd) = ([33, 24, 17], SimdClass::detect());
    for threads in 1..=3 {
        let pool = Pool::new(threads, false);
        let (layout, psi) = solve(&pool, simd, size, ENDS[0]);
        let rhs = padded(&layout, &right_hand_side(size, ENDS[0]));
        let mut poisson = Poisson::new(&layout, ENDS[0], threads);
        poisson.room().scratch.fill(f32::NAN);
        poisson.find_modes(&pool, simd, Stored(&layout, &rhs));
        let (mut seen, mut seen_below) = (layout.zeros(), layout.zeros());
        let outs = [layout.planes(&mut seen), layout.planes(&mut seen_below)];
        let keep = |_, [below, here]: [&[f32]; 2], [to, to_below]: [&mut [f32]; 2]| {
            to.copy_from_slice(here);
            to_below.copy_from_slice(below);
            [1.0, 0.0, 0.0, 0.0]
        };
        let sum = |a: [f64; 4], b: [f64; 4]| [a[0] + b[0], 0.0, 0.0, 0.0];
        assert_eq!(poisson.pass_by(&pool, simd, outs, keep, sum)[0], 17.0);
        assert!(psi[..] == seen[..], "{threads}");
        let shifted = layout.plane..layout.plane * (size[2] + 1);
        assert!(psi[..layout.plane * size[2]] == seen_below[shifted], "{threads}");
    }
}

#[test]
fn solving_in_place_is_solving_and_leaves_the_padding_alone() {
    let (layout, pool, simd) = (Layout::new([9, 6, 5]), Pool::inline(), SimdClass::detect());
    let rhs = padded(&layout, &right_hand_side(layout.cells, ENDS[0]));
    let mut poisson = Poisson::new(&layout, ENDS[0], 1);
    let (mut psi, mut in_place) = (layout.zeros(), padded(&layout, &unpadded(&layout, &rhs)));
    poisson.solve(&pool, simd, Stored(&layout, &rhs), &mut psi);
    poisson.modal.solve_in_place(&pool, simd, &mut poisson.room, &mut in_place);
    assert_eq!(psi[..], in_place[..]);
    let inside: f32 = unpadded(&layout, &psi).iter().map(|v| v.abs() as f32).sum();
    let all: f32 = psi.iter().map(|v| v.abs()).sum();
    assert!(inside > 0.0 && (all - inside).abs() < 1e-4 * all);
}

#[test]
fn a_shift_is_added_to_the_operator_and_only_the_unknowns_are_touched() {
    let (layout, pool, simd) = (Layout::new([12, 9, 7]), Pool::inline(), SimdClass::detect());
    let unknowns = Unknowns { first: [1, 0, 1], count: [11, 9, 6] };
    let ends = [OPEN, ODD, OPEN];
    let mut modal = Modal::new(&layout, unknowns, ends);
    let mut room = Room::new(1);
    room.make_for(&modal);
    let rhs = right_hand_side(unknowns.count, ends);
    let place = |(i, j, k): (usize, usize, usize)| layout.index(i + 1, j, k + 1);
    for shift in [1e-12, 0.3, 1e6] {
        modal.set_shift(shift);
        let mut psi = layout.zeros();
        psi.fill(7.0);
        cells(unknowns.count).zip(&rhs).for_each(|(cell, rhs)| psi[place(cell)] = *rhs as f32);
        modal.solve_in_place(&pool, simd, &mut room, &mut psi);
        let found: Vec<f64> = cells(unknowns.count).map(|c| f64::from(psi[place(c)])).collect();
        let back = apply(unknowns.count, ends, &found);
        let scale = largest(rhs.iter().copied()) + (12.0 + shift) * largest(found.iter().copied());
        let miss = (0..rhs.len()).map(|at| back[at] + shift * found[at] - rhs[at]);
        assert!(largest(miss) < 1e-6 * scale, "{shift}");
        let sum: f64 = psi.iter().map(|psi| f64::from(*psi)).sum();
        let others = 7.0 * (psi.len() - found.len()) as f64;
        assert!((sum - found.iter().sum::<f64>() - others).abs() < 1e-3, "{shift}");
    }
}
