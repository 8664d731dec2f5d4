//! Where the nodes of a surface stand: one over the middle of each column of cells, or several.

use std::ops::{Add, Mul};

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

    /// The node nearest to a place; of one beside the lattice, that at its edge.
    #[must_use]
    pub fn nearest(&self, at_in_world_m: Vec3) -> usize {
        let from = (at_in_world_m - self.origin_in_world_m) / self.spacing_m;
        // A float to integer cast saturates.
        let along = |x: f32, n: usize| ((x + 0.5).max(0.0) as usize).min(n - 1);
        along(from.x, self.nodes[0]) + self.nodes[0] * along(from.z, self.nodes[1])
    }

    /// True for a place over or under a node that is wet.
    #[must_use]
    pub fn is_over(&self, at_in_world_m: Vec3) -> bool {
        let from = (at_in_world_m - self.origin_in_world_m) / self.spacing_m;
        let within = |x: f32, n: usize| x >= -0.5 && x <= n as f32 - 0.5;
        let is_within = within(from.x, self.nodes[0]) && within(from.z, self.nodes[1]);
        is_within && self.wet[self.nearest(at_in_world_m)]
    }

    /// The nodes before and after one along x and along z; itself for one that is not there or dry.
    #[must_use]
    pub fn beside(&self, node: usize) -> [[usize; 2]; 2] {
        let [nx, nz] = self.nodes;
        let wet = |to: usize, is_there: bool| if is_there && self.wet[to] { to } else { node };
        let (i, k) = (node % nx, node / nx);
        [
            [wet(node.saturating_sub(1), i > 0), wet((node + 1).min(self.len() - 1), i + 1 < nx)],
            [wet(node.saturating_sub(nx), k > 0), wet((node + nx).min(self.len() - 1), k + 1 < nz)],
        ]
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

    /// A field of the nodes at a place: bilinear between those that are wet, which goes on as it
    /// is up to the wall; nothing where there are none.
    #[must_use]
    pub fn between<T>(&self, field: &[T], at_in_world_m: Vec3) -> T
    where
        T: Copy + Default + Add<Output = T> + Mul<f32, Output = T>,
    {
        let around = self.around(at_in_world_m);
        let shares = around.map(|(node, share)| if self.wet[node] { share } else { 0.0 });
        let whole: f32 = shares.iter().sum();
        let each_node = around.into_iter().zip(shares);
        // All four are wet but at the wall: the sum of their shares is 1 but for rounding.
        let per_share = if whole > 0.0 { 1.0 / whole } else { 0.0 };
        each_node
            .fold(T::default(), |sum, ((node, _), share)| sum + field[node] * (share * per_share))
    }

    /// A field of the nodes that goes on into the wall: each dry node within `rings` of a wet one
    /// has the mean of what is known around it.
    #[must_use]
    pub fn spread(&self, field: &[f32], rings: usize) -> Vec<f32> {
        let mut spread = field.to_vec();
        let mut known = self.wet.clone();
        if known.iter().all(|is_known| *is_known) {
            return spread;
        }
        for _ in 0..rings {
            let before = known.clone();
            for node in (0..self.len()).filter(|node| !before[*node]) {
                let around = self.square_around(node).filter(|beside| before[*beside]);
                let (sum, count) = around
                    .fold((0.0, 0.0), |(sum, count), beside| (sum + spread[beside], count + 1.0));
                if count > 0.0 {
                    (spread[node], known[node]) = (sum / count, true);
                }
            }
        }
        spread
    }

    /// The node and its up to eight neighbours.
    fn square_around(&self, node: usize) -> impl Iterator<Item = usize> {
        let [nx, nz] = self.nodes;
        let (i, k) = (node % nx, node / nx);
        let along_x = i.saturating_sub(1)..(i + 2).min(nx);
        (k.saturating_sub(1)..(k + 2).min(nz))
            .flat_map(move |k| along_x.clone().map(move |i| i + nx * k))
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
    fn a_field_goes_on_into_the_wall() {
        let grid = Grid { cells: [16, 1, 16], spacing_m: 1.0, origin_in_world_m: Vec3::ZERO };
        let centre_in_world_m = Vec3::new(8.0, 0.0, 8.0);
        let tub = Vessel::Cylinder { centre_in_world_m, axis: Vec3::Y, radius_m: 5.3 };
        let lattice = Lattice::over(&grid, &tub, 1);
        let tilted = |node: usize| 3.0 + 0.1 * lattice.in_world_m(node).x;
        let wet = |node: usize| if lattice.wet[node] { tilted(node) } else { 0.0 };
        let field: Vec<f32> = (0..lattice.len()).map(wet).collect();
        let spread = lattice.spread(&field, 2);
        for turn in 0..40 {
            let away = Vec3::new((turn as f32).cos(), 0.0, (turn as f32).sin());
            let at = centre_in_world_m + 5.3 * away;
            let exact = 3.0 + 0.1 * at.x;
            assert!((lattice.between(&field, at) - exact).abs() < 0.1, "{at}");
            let around = lattice.around(at).into_iter();
            let drawn: f32 = around.map(|(node, share)| share * spread[node]).sum();
            assert!((drawn - exact).abs() < 0.1, "{at}: {drawn}");
        }
        assert_eq!(lattice.between(&field, Vec3::ZERO), 0.0);
        let at = Vec3::new(8.2, 1.0, 7.7);
        assert!((lattice.between(&field, at) - 3.82).abs() < 1e-5, "and is itself inside");
        assert!((0..lattice.len()).all(|n| !lattice.wet[n] || spread[n] == field[n]));
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
