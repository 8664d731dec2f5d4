//! The implicit midpoint rule, for steps that RK4 would take too many sub-steps for.
//!
//! With v the mean speed over a step, A v = b where
//!
//! ```text
//! A = M + dt/2 C + dt^2/4 K,    b = M v0 + dt/2 (f - K x0),    x1 = x0 + dt v,  v1 = 2 v - v0
//! ```
//! for masses M, drag C, springs K and force f. For any v whatever,
//! E1 - E0 = dt v.(f - C v) + 2 v.(A v - b): conjugate gradients from 0 keep v.(A v - b) = 0 in
//! exact arithmetic however soon they stop, and a last factor keeps it so in f32. So the sheet
//! never has more energy than it had and the force gave, and iterations buy accuracy alone.

use super::springs::{Motion, Springs};
use crate::simd::SimdClass;

/// Iterations at most: stiffer than they can tell the sheet only has to be stable.
const ITERATIONS: usize = 40;

/// The residual falls to this part of the right side.
const TOLERANCE: f64 = 1e-5;

/// Work space: padded arrays.
pub struct Implicit {
    speed_m_s: Vec<f32>,
    residual: Vec<f32>,
    search: Vec<f32>,
    product: Vec<f32>,
}

impl Implicit {
    pub fn new(len: usize) -> Self {
        let zeros = || vec![0.0; len];
        Self { speed_m_s: zeros(), residual: zeros(), search: zeros(), product: zeros() }
    }

    pub fn bytes(&self) -> usize {
        4 * size_of_val(self.residual.as_slice())
    }

    /// One step, all over the mass of a node.
    pub fn step(
        &mut self,
        springs: &Springs,
        simd: SimdClass,
        motion: &mut Motion,
        load_m_s2: &[f32],
        dt_s: f32,
    ) {
        let Self { speed_m_s: v, residual, search, product } = self;
        springs.pull_m_s2(simd, &motion.height_m, product);
        for (n, b) in residual.iter_mut().enumerate() {
            *b = motion.speed_m_s[n] + 0.5 * dt_s * (load_m_s2[n] + product[n]);
        }
        v.fill(0.0);
        search.copy_from_slice(residual);
        let first = dot(residual, residual);
        let (mut squares, mut iterations) = (first, 0);
        while squares > TOLERANCE * TOLERANCE * first && iterations < ITERATIONS {
            springs.resist(simd, dt_s, search, product);
            let along = squares / dot(search, product);
            if !along.is_finite() {
                break;
            }
            add(v, along, search);
            add(residual, -along, product);
            let next = dot(residual, residual);
            let share = (next / squares) as f32;
            search.iter_mut().zip(&*residual).for_each(|(p, r)| *p = share * *p + r);
            (squares, iterations) = (next, iterations + 1);
        }
        // b is what is left and what was taken; A v anew, without the rounding of the recurrence.
        springs.resist(simd, dt_s, v, product);
        springs.pull_m_s2(simd, &motion.height_m, search);
        let mut given = 0.0;
        for (n, v) in v.iter().enumerate() {
            let b = motion.speed_m_s[n] + 0.5 * dt_s * (load_m_s2[n] + search[n]);
            given += f64::from(*v) * f64::from(b);
        }
        let factor = given / dot(v, product);
        let factor = if factor.is_finite() { factor as f32 } else { 0.0 };
        for (n, v) in v.iter().enumerate() {
            motion.height_m[n] += dt_s * factor * v;
            motion.speed_m_s[n] = 2.0 * factor * v - motion.speed_m_s[n];
        }
    }
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}

fn add(to: &mut [f32], factor: f64, from: &[f32]) {
    let factor = factor as f32;
    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
}
