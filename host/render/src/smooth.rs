//! Smooth edges: more rays, but only for the pixels where neighbours differ.

use glam::Vec3;

use crate::{image::Sample, rows};

/// Places of the further rays in a pixel: no two share a row or a column.
const PLACES: [[f32; 2]; 4] = [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]];
/// Difference of lightness from which on an edge is seen.
const VISIBLE: f32 = 0.07;

/// `samples` with the colour of each pixel at an edge replaced by the mean of several rays
/// through it. Layers stay those of the pixels' middles.
pub(crate) fn edges(
    samples: &[Sample],
    width: usize,
    threads: usize,
    colour_at: impl Fn(f32, f32) -> Vec3 + Sync,
) -> Vec<Sample> {
    let mut smoothed = samples.to_vec();
    rows::fill(&mut smoothed, width, threads, |x, y| {
        let own = samples[x + width * y];
        if !is_edge(samples, width, x, y) {
            return own;
        }
        let sum: Vec3 = PLACES.iter().map(|[dx, dy]| colour_at(x as f32 + dx, y as f32 + dy)).sum();
        Sample { colour: sum / PLACES.len() as f32, ..own }
    });
    smoothed
}

fn is_edge(samples: &[Sample], width: usize, x: usize, y: usize) -> bool {
    let at = x + width * y;
    let own = samples[at];
    let beside = [(x > 0).then(|| at - 1), (x + 1 < width).then(|| at + 1)];
    let over = [(y > 0).then(|| at - width), Some(at + width)];
    beside.into_iter().chain(over).flatten().filter_map(|near| samples.get(near)).any(|near| {
        near.layer != own.layer || lightness(near.colour).distance(lightness(own.colour)) > VISIBLE
    })
}

/// Roughly even steps to the eye, at the price of three square roots.
fn lightness(colour: Vec3) -> Vec3 {
    colour.max(Vec3::ZERO).map(f32::sqrt)
}
