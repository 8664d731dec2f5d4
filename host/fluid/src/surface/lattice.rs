//! Where the nodes of a surface stand: one over the middle of each column of cells, or several.

use glam::Vec3;

use crate::{grid::Grid, vessel::Vessel};

/// A probe presses on the nodes around it, however small it is.
const LEAST_RADIUS_NODES: f32 = 1.5;

/// The nodes of a surface, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Nodes along x and z.
    pub nodes: [usize; 2],
    /// Way from one to the next.
    pub spacing_m: f32,
    /// The first node, at rest.
    pub origin_in_world_m: Vec3,
    /// Which of them are over the liquid; the others do not move.
    pub wet: Vec<bool>,
}

impl Lattice {
    /// The lattice on the top of the grid's box, with `per_cell` nodes along the edge of a cell.
    #[must_use]
    pub fn over(grid: &Grid, vessel: &Vessel, per_cell: usize) -> Self {
        let [nx, ny, nz] = grid.cells;
        let nodes = [nx * per_cell, nz * per_cell];
        let spacing_m = grid.spacing_m / per_cell as f32;
        let first = Vec3::new(0.5 * spacing_m, ny as f32 * grid.spacing_m, 0.5 * spacing_m);
        let origin_in_world_m = grid.origin_in_world_m + first;
        let mut lattice = Self { nodes, spacing_m, origin_in_world_m, wet: Vec::new() };
        let is_wet = |n| vessel.depth_inside_m(lattice.in_world_m(n)) > 0.0;
        lattice.wet = (0..lattice.len()).map(is_wet).collect();
        lattice
    }

    /// Number of nodes, wet and dry.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "a grid has at least one cell")]
    pub fn len(&self) -> usize {
        self.nodes[0] * self.nodes[1]
    }

    /// Number of wet nodes.
    #[must_use]
    pub fn wet_count(&self) -> usize {
        self.wet.iter().filter(|wet| **wet).count()
    }

    /// Area that a node stands for.
    #[must_use]
    pub fn node_m2(&self) -> f32 {
        self.spacing_m * self.spacing_m
    }

    /// Place of a node at rest.
    #[must_use]
    pub fn in_world_m(&self, node: usize) -> Vec3 {
        let [i, k] = [node % self.nodes[0], node / self.nodes[0]];
        self.origin_in_world_m + self.spacing_m * Vec3::new(i as f32, 0.0, k as f32)
    }

    /// The four nodes around a place and their bilinear shares; of a place beside the lattice,
    /// those at its edge.
    #[must_use]
    pub fn around(&self, at_in_world_m: Vec3) -> [(usize, f32); 4] {
        let from = (at_in_world_m - self.origin_in_world_m) / self.spacing_m;
        let along = |x: f32, n: usize| {
            let held = x.max(0.0).min((n - 1) as f32);
            let node = (held as usize).min(n.saturating_sub(2));
            (node, (node + 1).min(n - 1), held - node as f32)
        };
        let (i, next_i, x) = along(from.x, self.nodes[0]);
        let (k, next_k, z) = along(from.z, self.nodes[1]);
        let row = self.nodes[0];
        [
            (i + row * k, (1.0 - x) * (1.0 - z)),
            (next_i + row * k, x * (1.0 - z)),
            (i + row * next_k, (1.0 - x) * z),
            (next_i + row * next_k, x * z),
        ]
    }

    /// Wet nodes under a round body, and shares that sum to 1 and fall from its middle to 0.
    pub fn find_under(&self, at_in_world_m: Vec3, radius_m: f32, under: &mut Vec<(usize, f32)>) {
        let at = (at_in_world_m - self.origin_in_world_m) / self.spacing_m;
        let radius = (radius_m / self.spacing_m).max(LEAST_RADIUS_NODES);
        under.clear();
        for k in near(at.z, radius, self.nodes[1]) {
            for i in near(at.x, radius, self.nodes[0]) {
                let (x, z) = ((i as f32 - at.x) / radius, (k as f32 - at.z) / radius);
                let weight = 1.0 - (x * x + z * z);
                let node = i + self.nodes[0] * k;
                if weight > 0.0 && self.wet[node] {
                    under.push((node, weight));
                }
            }
        }
        let total: f32 = under.iter().map(|(_, weight)| weight).sum();
        under.iter_mut().for_each(|(_, weight)| *weight /= total);
    }
}

/// Nodes along an axis within `radius` of a place, all in node spacings.
fn near(at: f32, radius: f32, nodes: usize) -> std::ops::Range<usize> {
    // A float to integer cast saturates.
    let first = (at - radius).ceil().max(0.0) as usize;
    let end = ((at + radius).floor() + 1.0).max(0.0) as usize;
    first.min(nodes)..end.min(nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(cells: [usize; 3], per_cell: usize) -> Lattice {
        let grid = Grid { cells, spacing_m: 0.02, origin_in_world_m: Vec3::new(0.1, 0.2, 0.3) };
        Lattice::over(&grid, &Vessel::Box, per_cell)
    }

    #[test]
    fn nodes_stand_over_the_middle_of_columns() {
        let plain = lattice([4, 2, 3], 1);
        assert_eq!(plain.nodes, [4, 3]);
        assert!(plain.in_world_m(5).distance(Vec3::new(0.13, 0.24, 0.33)) < 1e-6);
        let fine = lattice([4, 2, 3], 2);
        assert_eq!(fine.nodes, [8, 6]);
        assert!(fine.in_world_m(0).distance(Vec3::new(0.105, 0.24, 0.305)) < 1e-6);
    }

    #[test]
    fn shares_sum_to_one_and_find_their_place_again() {
        for (cells, per_cell) in [([4, 2, 3], 1), ([1, 1, 1], 1), ([1, 1, 5], 3)] {
            let lattice = lattice(cells, per_cell);
            for at in [Vec3::new(0.133, 0.0, 0.341), Vec3::splat(-7.0), Vec3::splat(1e30)] {
                let around = lattice.around(at);
                assert!((around.iter().map(|(_, share)| share).sum::<f32>() - 1.0).abs() < 1e-6);
                assert!(around.iter().all(|(node, _)| *node < lattice.len()));
            }
        }
        let lattice = lattice([4, 2, 3], 1);
        let at = Vec3::new(0.133, 0.24, 0.341);
        let again = lattice.around(at).map(|(n, share)| share * lattice.in_world_m(n));
        assert!(again.iter().sum::<Vec3>().distance(at) < 1e-6);
    }

    #[test]
    fn a_body_has_nodes_under_it_however_small_it_is() {
        let lattice = lattice([8, 2, 8], 1);
        let mut under = Vec::new();
        for radius in [0.0, 1e-9, 0.05, 1e30] {
            lattice.find_under(Vec3::new(0.18, 0.0, 0.37), radius, &mut under);
            assert!((under.iter().map(|(_, share)| share).sum::<f32>() - 1.0).abs() < 1e-5);
        }
        lattice.find_under(Vec3::splat(9.0), 0.01, &mut under);
        assert!(under.is_empty());
    }
}
