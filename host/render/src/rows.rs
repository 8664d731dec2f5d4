//! Filling a picture on several threads.

use std::{sync::Mutex, thread};

/// Sets each pixel to `pixel(x, y)`. A thread that is done with a row takes the next one, so all
/// are busy to the end; what is drawn does not depend on how many threads there are.
pub(crate) fn fill<P: Send>(
    pixels: &mut [P],
    width: usize,
    threads: usize,
    pixel: impl Fn(usize, usize) -> P + Sync,
) {
    let rows = Mutex::new(pixels.chunks_mut(width.max(1)).enumerate());
    let next_row = || rows.lock().ok()?.next();
    let draw = || {
        while let Some((y, row)) = next_row() {
            for (x, out) in row.iter_mut().enumerate() {
                *out = pixel(x, y);
            }
        }
    };
    thread::scope(|scope| {
        for number in 1..threads {
            let helper = thread::Builder::new().name(format!("render-{number}"));
            // A helper that cannot be had is not missed: this thread goes on to the last row.
            if helper.spawn_scoped(scope, draw).is_err() {
                break;
            }
        }
        draw();
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_is_set_on_any_number_of_threads() {
        for threads in [0, 1, 2, 7] {
            let mut pixels = vec![(0, 0); 5 * 4];
            fill(&mut pixels, 5, threads, |x, y| (x, y));
            assert!(pixels.iter().enumerate().all(|(i, pixel)| *pixel == (i % 5, i / 5)));
        }
        fill(&mut Vec::<u8>::new(), 0, 2, |_, _| 1);
    }
}
