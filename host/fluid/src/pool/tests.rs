//! The pool against plain loops.

use super::*;

fn wavy(k: usize) -> f64 {
    (k as f64 * 0.7).sin() * 10f64.powi((k % 7) as i32)
}

#[test]
fn sums_have_the_same_bits_for_any_number_of_threads() {
    let alone = Pool::inline().sum(1000, wavy);
    assert_eq!(alone, (0..1000).map(wavy).fold(0.0, |a, b| a + b));
    for threads in [2, 3, 5] {
        assert_eq!(Pool::new(threads, false).sum(1000, wavy).to_bits(), alone.to_bits());
    }
}

#[test]
fn every_plane_is_written_once_and_the_rest_not_at_all() {
    let pool = Pool::new(3, false);
    let (mut a, mut b) = (vec![0f32; 64 * 128 + 5], vec![0f32; 64 * 2]);
    let sum = pool.planes_sum([&mut a, &mut b], [128, 2], |k, [a, b]| {
        a.iter_mut().for_each(|v| *v += k as f32 + 1.0);
        b[1] = k as f32;
        1.0
    });
    assert_eq!(sum, 64.0);
    assert!((0..64).all(|k| a[k * 128..][..128].iter().all(|v| *v == k as f32 + 1.0)));
    assert!((0..64).all(|k| b[2 * k] == 0.0 && b[2 * k + 1] == k as f32));
    assert_eq!(a[64 * 128..], [0.0; 5]);
}

#[test]
fn the_second_of_two_threads_does_its_half() {
    let pool = Pool::new(2, true);
    let mut cells = vec![0f32; 64 * 64 * 64];
    for _ in 0..10 {
        pool.planes([&mut cells], [64 * 64], |_, [plane]| {
            plane.iter_mut().for_each(|v| *v = 0.5 * *v + 1.0);
        });
    }
    let done = pool.cells_done();
    assert_eq!(done.iter().sum::<u64>(), 10 * 64 * 64 * 64);
    assert!(done[1] * 10 >= 4 * done.iter().sum::<u64>(), "{done:?}");
}

#[test]
fn a_panic_arrives_at_the_caller_and_the_pool_lives_on() {
    let pool = Pool::new(2, false);
    for bad in [0, 99] {
        let result = catch_unwind(AssertUnwindSafe(|| {
            pool.sum(100, |k| if k == bad { panic!("plane {k}") } else { 1.0 })
        }));
        assert!(result.is_err());
        assert_eq!(pool.sum(100, |_| 1.0), 100.0);
    }
}

#[test]
fn nested_and_concurrent_calls_finish() {
    let pool = Pool::new(2, false);
    let nested = pool.sum(8, |_| pool.sum(8, |_| 1.0));
    assert_eq!(nested, 64.0);
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| (0..200).for_each(|_| assert_eq!(pool.sum(50, |_| 1.0), 50.0)));
        }
    });
}

#[test]
fn max_is_of_all_planes() {
    assert_eq!(Pool::new(2, false).max(100, |k| (50.0 - k as f64).abs()), 50.0);
    assert_eq!(Pool::inline().max(0, |_| 1.0), 0.0);
}

#[test]
fn columns_are_cut_across_all_planes_and_a_remainder_is_left_alone() {
    let pool = Pool::new(3, false);
    let (planes, plane_len, width) = (5, 70 * 16 + 3, 16);
    let mut array = vec![-1f32; planes * plane_len + 7];
    pool.columns(&mut array, plane_len, width, |c, mut column| {
        assert_eq!(column.planes(), planes);
        for k in 0..planes {
            column.plane(k).iter_mut().for_each(|v| *v += (1 + 100 * k + c) as f32);
        }
    });
    for (at, value) in array.iter().enumerate() {
        let (k, c) = (at / plane_len, at % plane_len / width);
        let expected = if k < planes && c < 70 { (100 * k + c) as f32 } else { -1.0 };
        assert_eq!(*value, expected, "{at}");
    }
}

#[test]
fn each_thread_has_scratch_of_its_own() {
    let pool = Pool::new(3, false);
    let (mut out, mut scratch) = (vec![0f32; 60 * 128], vec![0f32; 3 * 50 + 2]);
    pool.planes_with(&mut scratch, [&mut out], [128], |k, [out], scratch| {
        assert_eq!(scratch.len(), 50);
        scratch.fill(k as f32);
        thread::yield_now();
        out[0] = scratch.iter().sum();
    });
    assert!((0..60).all(|k| out[k * 128] == 50.0 * k as f32));
}
