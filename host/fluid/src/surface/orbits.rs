//! What moves below along with the surface, near the probe: what it feels beside the flow.

use glam::Vec3;

use super::{Lattice, Model};
use crate::grid::Grid;

/// Layers of cells that are kept, but for those above the surface and below the floor: as many as a
/// field around the probe has, and two on each side.
const LAYERS: usize = 12;

/// A few layers of the potential flow below the surface.
pub struct Orbits {
    /// The first layer that is kept, counted from the surface; `None` while nothing moves.
    first: Option<usize>,
    layer_m: f32,
    /// The layer at the bottom.
    deepest: usize,
    /// Layers that are kept.
    count: usize,
    /// By layer: potential and vertical speed at the nodes of the lattice. Room is used again.
    layers: Vec<[Vec<f32>; 2]>,
}

impl Orbits {
    /// Nothing moves, over layers of the cells of a grid.
    pub fn new(grid: &Grid) -> Self {
        let [_, deepest, _] = grid.cells;
        Self { first: None, layer_m: grid.spacing_m, deepest, count: 0, layers: Vec::new() }
    }

    /// Forgets what is kept: nothing moves.
    pub fn rest(&mut self) {
        self.first = None;
    }

    /// Keeps the layers around a depth; none if the model has none.
    pub fn find(&mut self, model: &mut dyn Model, nodes: usize, depth_m: f32) {
        let middle = ((depth_m / self.layer_m).max(0.0) as usize).min(self.deepest);
        let first = middle.saturating_sub(LAYERS / 2);
        self.count = (middle + LAYERS / 2).min(self.deepest) + 1 - first;
        if self.layers.len() < self.count {
            self.layers.resize_with(self.count, || [(); 2].map(|()| vec![0.0; nodes]));
        }
        let mut layers = self.layers[..self.count].iter_mut().enumerate();
        let found = layers.all(|(n, [phi, rising])| model.orbit(first + n, phi, rising));
        self.first = found.then_some(first);
    }

    /// Velocity at a place; what is beside the layers is taken for the nearest of them.
    pub fn at(&self, lattice: &Lattice, at_in_world_m: Vec3) -> Vec3 {
        let Some(first) = self.first else { return Vec3::ZERO };
        let depth_m = lattice.origin_in_world_m.y - at_in_world_m.y;
        let last = self.count - 1;
        let place = (depth_m / self.layer_m - first as f32).max(0.0).min(last as f32);
        let below = (place as usize).min(last - 1);
        let share = place - below as f32;
        let [upper, lower] = [below, below + 1].map(|n| self.in_layer(n, lattice, at_in_world_m));
        upper.lerp(lower, share)
    }

    fn in_layer(&self, layer: usize, lattice: &Lattice, at: Vec3) -> Vec3 {
        let [phi, rising_m_s] = &self.layers[layer];
        // Half a node to both sides: at a wall there is nothing beyond, and no flow through it.
        let half = 0.5 * lattice.spacing_m;
        let slope = |axis: Vec3| {
            (lattice.between(phi, at + half * axis) - lattice.between(phi, at - half * axis))
                / lattice.spacing_m
        };
        Vec3::new(slope(Vec3::X), lattice.between(rising_m_s, at), slope(Vec3::Z))
    }
}
