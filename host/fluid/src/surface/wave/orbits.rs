//! How the liquid below moves along with the waves.
//!
//! ```text
//! phi_j = w_j / lambda_j   cosh k(h - d) / cosh kh,      v_j = w_j   sinh k(h - d) / sinh kh
//! ```
//! at depth d, exact where walls are upright. Depths are layers of cells, whose shares are computed
//! when they are first asked for.

use super::Mode;

/// What has fallen by e as often is nothing, in f32, beside what it was at the surface; and
/// products of what is less and less would be very slow.
const DEAD: f64 = 17.0;

/// Shares of a mode's vertical speed that are potential and vertical speed of one layer.
type Layer = [Vec<f32>; 2];

/// Shares by layer.
pub struct Orbits {
    depth_m: f64,
    layer_m: f64,
    layers: Vec<Option<Layer>>,
}

impl Orbits {
    /// For liquid of a depth, in layers of this height, the first of them at the surface.
    pub fn new(depth_m: f64, layer_m: f64) -> Self {
        Self { depth_m, layer_m, layers: Vec::new() }
    }

    pub fn bytes(&self) -> usize {
        let values = self.layers.iter().flatten().map(|[phi, v]| phi.len() + v.len());
        values.sum::<usize>() * size_of::<f32>()
    }

    /// The shares in a layer.
    pub(super) fn layer(&mut self, layer: usize, modes: &[Mode]) -> &Layer {
        if self.layers.len() <= layer {
            self.layers.resize(layer + 1, None);
        }
        let Self { depth_m, layer_m, layers } = self;
        layers[layer].get_or_insert_with(|| {
            let at_m = (layer as f64 * *layer_m).min(*depth_m);
            let [mut potential, mut rising] = [(); 2].map(|()| Vec::with_capacity(modes.len()));
            for mode in modes {
                let [phi, v] = shares(mode, at_m, *depth_m);
                potential.push(phi as f32);
                rising.push(v as f32);
            }
            [potential, rising]
        })
    }

    /// What is shorter does not reach down to a layer.
    pub fn reach_per_m(&self, layer: usize) -> f64 {
        DEAD / (layer as f64 * self.layer_m).min(self.depth_m)
    }
}

fn shares(mode: &Mode, at_m: f64, depth_m: f64) -> [f64; 2] {
    let k = mode.wavenumber_below_per_m;
    if mode.lambda_per_m <= 0.0 || k * at_m > DEAD {
        return [0.0; 2];
    }
    let left = |down: f64| if down > DEAD { 0.0 } else { (-down).exp() };
    let [down, up] = [left(k * at_m), left(k * (2.0 * depth_m - at_m))];
    let whole = left(2.0 * k * depth_m);
    [(down + up) / (1.0 + whole) / mode.lambda_per_m, (down - up) / (1.0 - whole)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orbits_are_a_potential_flow_over_a_floor() {
        let (k, h) = (7.0_f64, 0.3);
        let lambda_per_m = k * (k * h).tanh();
        let mode = Mode { lambda_per_m, wavenumber_per_m: k, wavenumber_below_per_m: k };
        let [phi, v] = shares(&mode, 0.0, h);
        assert!((phi - 1.0 / mode.lambda_per_m).abs() < 1e-12 && (v - 1.0).abs() < 1e-12);
        assert!(shares(&mode, h, h)[1].abs() < 1e-12, "nothing passes the floor");
        let step = 1e-4;
        for at in [0.05, 0.17, 0.29] {
            let slope = |i: usize| {
                let [up, down] = [at - step, at + step].map(|at| shares(&mode, at, h)[i]);
                (up - down) / (2.0 * step)
            };
            let [phi, v] = shares(&mode, at, h);
            assert!((slope(0) - v).abs() < 1e-5, "v is the slope of phi");
            assert!((slope(1) - k * k * phi).abs() < 1e-4, "and nothing is compressed");
        }
    }
}
