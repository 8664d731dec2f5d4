//! Liquid that is shut in cannot give way: what walls and openings ask of it in sum is taken back.
//!
//! A piston that closes a tube, an obstacle that comes in through a wall, a pocket that is cut
//! off: there is no flow without divergence then. What goes in beyond what comes out is spread over the pocket by
//! the open area of its cells, as if its liquid gave that much, and all stays as small as that.

use crate::solver::flow::{
    faces::{Faces, cells},
    field::{Field, Layout, Vector},
    ghosts::Ghosts,
};

/// Finds pockets.
pub struct Balance {
    is_seen: Vec<bool>,
    pocket: Vec<u32>,
}

impl Balance {
    /// For a grid of this layout.
    pub fn new(layout: &Layout) -> Self {
        Self { is_seen: vec![false; layout.zeros().len()], pocket: Vec::new() }
    }

    /// Adds to `swell` what it lacks for every pocket to have a flow; `velocity` tells what
    /// passes the sides.
    pub fn balance(
        &mut self,
        layout: &Layout,
        ghosts: &Ghosts,
        faces: &Faces,
        velocity: &Vector,
        swell: &mut Field,
    ) {
        let Some(vessel) = &faces.vessel else { return };
        self.is_seen.fill(false);
        for (i, j, k) in cells(layout.cells) {
            let first = layout.index(i, j, k);
            if self.is_seen[first] || faces.liquid[first] == 0.0 {
                continue;
            }
            let pocket = self.flood(layout, ghosts, [&vessel.area, velocity], first);
            let (mut net, mut open) = (pocket.through_sides, 0.0);
            for at in self.pocket.iter().map(|at| *at as usize) {
                net += f64::from(swell[at]);
                open += f64::from(vessel.open_area[at]);
            }
            if pocket.has_outlet || net == 0.0 {
                continue;
            }
            for at in self.pocket.iter().map(|at| *at as usize) {
                let share = if open > 0.0 { f64::from(vessel.open_area[at]) / open } else { 1.0 };
                swell[at] -= (net * share) as f32;
            }
        }
    }

    /// Fills the pocket that a cell belongs to.
    fn flood(
        &mut self,
        layout: &Layout,
        ghosts: &Ghosts,
        [area, velocity]: [&Vector; 2],
        first: usize,
    ) -> Pocket {
        let mut found = Pocket { through_sides: 0.0, has_outlet: false };
        self.pocket.clear();
        self.pocket.push(first as u32);
        self.is_seen[first] = true;
        let mut next = 0;
        while let Some(at) = self.pocket.get(next).map(|at| *at as usize) {
            next += 1;
            let cell = layout.cell_of(at);
            for c in 0..3 {
                let (n, stride) = (layout.cells[c], layout.strides()[c]);
                for end in 0..2 {
                    let face = at + end * stride;
                    if area[c][face] == 0.0 {
                        continue;
                    }
                    let is_side = cell[c] == [0, n - 1][end];
                    let beyond = match (is_side, end) {
                        (false, 0) => at - stride,
                        (false, _) => at + stride,
                        (true, _) if ghosts.is_free(c, end) => {
                            found.has_outlet = true;
                            continue;
                        }
                        (true, 0) if ghosts.is_periodic(c) => at + (n - 1) * stride,
                        (true, _) if ghosts.is_periodic(c) => at - (n - 1) * stride,
                        (true, _) => {
                            let out = f64::from(area[c][face]) * f64::from(velocity[c][face]);
                            found.through_sides += [-out, out][end];
                            continue;
                        }
                    };
                    if !self.is_seen[beyond] {
                        self.is_seen[beyond] = true;
                        self.pocket.push(beyond as u32);
                    }
                }
            }
        }
        found
    }
}

/// What is known of a pocket.
struct Pocket {
    /// What flows out through sides that say how much.
    through_sides: f64,
    /// True if liquid can leave as it likes.
    has_outlet: bool,
}
