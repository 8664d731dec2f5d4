//! Liquid that is shut in cannot give way: what walls and openings ask of it in sum is taken back.
//!
//! A piston that closes a tube, an obstacle that comes in through a wall, a pocket that is cut
//! off: there is no flow without divergence then. What goes in beyond what comes out is spread
//! over the pocket by the open area of its cells, as if its liquid gave that much, and all stays as
//! small as that. Nor is a cell asked for more than passes its open faces at the speed of the
//! solids: more is asked only of a film that is squeezed between two walls, which would leave at
//! any speed. Pockets are found by rows: the segments of each that nothing closes, joined
//! with those beside them (union-find with halved paths; Tarjan, van Leeuwen 1984).

use std::ops::Range;

use crate::solver::flow::{
    faces::Faces,
    field::{Field, Layout, Vector},
    ghosts::Ghosts,
    solids::Covered,
};

/// A pocket is taken to be in balance to this part of what passes its walls: rounding.
const BALANCED: f64 = 1e-6;

/// A cell's walls displace at most what passes its open faces at this many times the largest
/// speed of a solid along an axis: that of one wall is never more, but for rounding.
const MOST_SPEEDS: f32 = 1.8;

/// Part of a row that is liquid throughout.
struct Segment {
    cells: Range<u32>,
    /// Another of the same pocket, itself if it speaks for that.
    joined: u32,
    /// What flows out of the pocket through solids and sides, and the sum of magnitudes.
    net: [f64; 2],
    /// True if liquid can leave as it likes.
    has_outlet: bool,
}

/// Finds pockets.
pub struct Balance {
    segments: Vec<Segment>,
    /// Where each row's begin, and where the last one's end.
    first: Vec<u32>,
}

impl Balance {
    /// For a grid of this layout.
    pub fn new(layout: &Layout) -> Self {
        let [_, ny, nz] = layout.cells;
        Self { segments: Vec::with_capacity(2 * ny * nz), first: Vec::with_capacity(ny * nz + 1) }
    }

    /// Adds to `swell`, which `covered` faces have made, what it lacks for every pocket to
    /// have a flow; `velocity` tells what passes the sides.
    pub fn balance(
        &mut self,
        layout: &Layout,
        ghosts: &Ghosts,
        faces: &Faces,
        velocity: &Vector,
        covered: &[Vec<Covered>; 3],
        swell: &mut Field,
    ) {
        let Some(vessel) = &faces.vessel else { return };
        self.divide(layout, faces, &vessel.area);
        self.join(layout, &vessel.area);
        self.look_at_sides(layout, ghosts, &vessel.area, velocity);
        for (c, covered) in covered.iter().enumerate() {
            for face in covered.iter().filter(|face| face.velocity_m_s != 0.0) {
                let out = f64::from(face.part) * f64::from(face.velocity_m_s);
                let cell = layout.cell_of(face.at as usize);
                if let Some(below) = before(layout, ghosts, c, cell) {
                    self.count(layout, below, out);
                }
                self.count(layout, cell, -out);
            }
        }
        let fastest_m_s = covered.iter().flatten().map(|face| face.velocity_m_s.abs());
        let most_m_s = MOST_SPEEDS * fastest_m_s.fold(0.0, f32::max);
        for row in 0..self.first.len() - 1 {
            let at = layout.index(0, row % layout.cells[1], row / layout.cells[1]);
            for segment in self.of_row(row) {
                let Range { start, end } = self.segments[segment].cells;
                for at in at + start as usize..at + end as usize {
                    let most = most_m_s * vessel.open_area[at];
                    let excess = swell[at] - swell[at].clamp(-most, most);
                    if excess != 0.0 {
                        swell[at] -= excess;
                        let root = self.root(segment);
                        self.segments[root].net[0] -= f64::from(excess);
                        self.segments[root].net[1] += f64::from(excess.abs());
                    }
                }
            }
        }
        let is_lacking = |s: &Segment| !s.has_outlet && s.net[0].abs() > BALANCED * s.net[1];
        if self.segments.iter().any(is_lacking) {
            self.take_back(layout, &vessel.open_area, swell);
        }
    }

    /// Finds the segments of all rows.
    fn divide(&mut self, layout: &Layout, faces: &Faces, area: &Vector) {
        let [nx, ny, nz] = layout.cells;
        self.segments.clear();
        self.first.clear();
        for row in 0..ny * nz {
            self.first.push(self.segments.len() as u32);
            let at = layout.index(0, row % ny, row / ny);
            let (liquid, passed) = (&faces.liquid[at..][..nx], &area[0][at..][..nx]);
            let mut start = 0;
            while let Some(skipped) = liquid[start..].iter().position(|liquid| *liquid > 0.0) {
                start += skipped;
                let rest = liquid[start..].iter().zip(&passed[start..]).skip(1);
                let more = rest.take_while(|(liquid, passed)| **liquid > 0.0 && **passed > 0.0);
                let end = start + 1 + more.count();
                let joined = self.segments.len() as u32;
                let cells = start as u32..end as u32;
                self.segments.push(Segment { cells, joined, net: [0.0; 2], has_outlet: false });
                start = end;
                if start == nx {
                    break;
                }
            }
        }
        self.first.push(self.segments.len() as u32);
    }

    /// Joins segments of neighbouring rows.
    fn join(&mut self, layout: &Layout, area: &Vector) {
        let [_, ny, nz] = layout.cells;
        for row in 0..ny * nz {
            let (j, k) = (row % ny, row / ny);
            if j > 0 {
                self.join_rows(&area[1][layout.index(0, j, k)..], [row - 1, row]);
            }
            if k > 0 {
                self.join_rows(&area[2][layout.index(0, j, k)..], [row - ny, row]);
            }
        }
    }

    /// Joins segments of two rows where the faces between them leave an opening.
    fn join_rows(&mut self, area: &[f32], [one, other]: [usize; 2]) {
        for a in self.of_row(one) {
            for b in self.of_row(other) {
                let (cells, beside) = (&self.segments[a].cells, &self.segments[b].cells);
                let (start, end) = (cells.start.max(beside.start), cells.end.min(beside.end));
                let both = start as usize..end.max(start) as usize;
                if area[both].iter().any(|area| *area > 0.0) {
                    self.unite(a, b);
                }
            }
        }
    }

    fn of_row(&self, row: usize) -> Range<usize> {
        self.first[row] as usize..self.first[row + 1] as usize
    }

    /// Joins what periodic sides join, and notes what passes the others.
    fn look_at_sides(
        &mut self,
        layout: &Layout,
        ghosts: &Ghosts,
        area: &Vector,
        velocity: &Vector,
    ) {
        for c in 0..3 {
            let (n, across) = (layout.cells[c], [(c + 1) % 3, (c + 2) % 3]);
            for place in 0..layout.cells[across[0]] * layout.cells[across[1]] {
                for end in 0..2 {
                    let mut cell = [0; 3];
                    cell[across[0]] = place % layout.cells[across[0]];
                    cell[across[1]] = place / layout.cells[across[0]];
                    cell[c] = [0, n - 1][end];
                    let face = layout.index(cell[0], cell[1], cell[2]) + end * layout.strides()[c];
                    let part = f64::from(area[c][face]);
                    let Some(segment) = self.of_cell(layout, cell).filter(|_| part > 0.0) else {
                        continue;
                    };
                    if ghosts.is_periodic(c) {
                        let mut image = cell;
                        image[c] = [n - 1, 0][end];
                        if let Some(image) = self.of_cell(layout, image) {
                            self.unite(segment, image);
                        }
                    } else if ghosts.is_free(c, end) {
                        let root = self.root(segment);
                        self.segments[root].has_outlet = true;
                    } else {
                        let out = part * f64::from(velocity[c][face]);
                        self.count(layout, cell, [-out, out][end]);
                    }
                }
            }
        }
    }

    /// Counts what flows out of a cell, if that is liquid.
    fn count(&mut self, layout: &Layout, cell: [usize; 3], out: f64) {
        if let Some(segment) = self.of_cell(layout, cell) {
            let root = self.root(segment);
            let [net, all] = &mut self.segments[root].net;
            *net += out;
            *all += out.abs();
        }
    }

    /// Takes back what pockets cannot give.
    fn take_back(&mut self, layout: &Layout, open_area: &[f32], swell: &mut Field) {
        let [_, ny, nz] = layout.cells;
        let of = |row: usize, cells: &Range<u32>| {
            let at = layout.index(0, row % ny, row / ny);
            at + cells.start as usize..at + cells.end as usize
        };
        let mut open = vec![[0.0; 2]; self.segments.len()];
        for row in 0..ny * nz {
            for segment in self.of_row(row) {
                let cells = of(row, &self.segments[segment].cells);
                let [area, count] = &mut open[self.root(segment)];
                *area += open_area[cells.clone()].iter().copied().map(f64::from).sum::<f64>();
                *count += cells.len() as f64;
            }
        }
        for row in 0..ny * nz {
            for segment in self.of_row(row) {
                let (root, cells) = (self.root(segment), of(row, &self.segments[segment].cells));
                let Segment { has_outlet: false, net: [net, _], .. } = self.segments[root] else {
                    continue;
                };
                let [area, count] = open[root];
                for at in cells {
                    let own = f64::from(open_area[at]);
                    let share = if area > 0.0 { own / area } else { 1.0 / count };
                    swell[at] -= (net * share) as f32;
                }
            }
        }
    }

    /// The segment that a cell is in; `None` if it is not liquid.
    fn of_cell(&self, layout: &Layout, [i, j, k]: [usize; 3]) -> Option<usize> {
        let [nx, ny, _] = layout.cells;
        let row = (i < nx && j < ny && k < layout.cells[2]).then_some(j + ny * k)?;
        self.of_row(row).find(|segment| self.segments[*segment].cells.contains(&(i as u32)))
    }

    fn root(&mut self, mut segment: usize) -> usize {
        while self.segments[segment].joined as usize != segment {
            let next = self.segments[segment].joined as usize;
            self.segments[segment].joined = self.segments[next].joined;
            segment = next;
        }
        segment
    }

    fn unite(&mut self, one: usize, other: usize) {
        let (one, other) = (self.root(one), self.root(other));
        let (first, second) = (one.min(other), one.max(other));
        if first == second {
            return;
        }
        let Segment { net, has_outlet, .. } = self.segments[second];
        self.segments[second].joined = first as u32;
        let into = &mut self.segments[first];
        into.has_outlet |= has_outlet;
        into.net = [into.net[0] + net[0], into.net[1] + net[1]];
    }
}

/// The cell below the lower face of a cell across `c`, which may be one beyond the last.
fn before(layout: &Layout, ghosts: &Ghosts, c: usize, mut cell: [usize; 3]) -> Option<[usize; 3]> {
    cell[c] = match cell[c] {
        0 if ghosts.is_periodic(c) => layout.cells[c] - 1,
        0 => return None,
        place => place - 1,
    };
    Some(cell)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{
        grid::Grid,
        solver::{Side, Sides, Walls},
        vessel::Vessel,
    };

    /// Two halls of 4^3 cells and a wall of two cells between them.
    fn pockets_of(sides: &Sides) -> (Layout, Ghosts, Faces) {
        let grid = Grid { cells: [10, 4, 4], ..Grid::unit_cube(4) };
        let layout = Layout::new(grid.cells);
        let wall = Vessel::from_distance(&grid, |p: Vec3| (p.x - 1.25).abs() - 0.25 - 1e-3);
        let faces = Faces::new(&layout, &grid, &wall.expect("finite"), sides, Walls::FreeSlip);
        let ghosts = Ghosts::new(&layout, sides);
        (layout, ghosts, faces)
    }

    #[test]
    fn each_pocket_gives_back_what_it_cannot_take() {
        let (layout, ghosts, faces) = pockets_of(&Sides::all(Side::FreeSlip));
        let push = |i: usize, velocity_m_s: f32| Covered {
            at: layout.index(i, 2, 2) as u32,
            owner: 1,
            part: 1.0,
            velocity_m_s,
            is_closed: false,
            is_side: false,
        };
        // Out of the first hall, which is shut, and to and fro in the second, which keeps it.
        let covered = [vec![push(4, 0.5), push(7, 0.5), push(8, 0.5)], Vec::new(), Vec::new()];
        let mut swell = layout.zeros();
        swell[layout.index(3, 2, 2)] = 0.5;
        swell[layout.index(6, 2, 2)] = 0.5;
        swell[layout.index(8, 2, 2)] = -0.5;
        let velocity = layout.zero_vector();
        let mut balance = Balance::new(&layout);
        balance.balance(&layout, &ghosts, &faces, &velocity, &covered, &mut swell);
        let sum = |x: Range<usize>| {
            let cells = x.flat_map(|i| (0..16).map(move |c| (i, c % 4, c / 4)));
            cells.map(|(i, j, k)| f64::from(swell[layout.index(i, j, k)])).sum::<f64>()
        };
        assert!(sum(0..4).abs() < 1e-6 && swell[layout.index(0, 0, 0)] < 0.0);
        assert_eq!([6, 8].map(|i| swell[layout.index(i, 2, 2)]), [0.5, -0.5]);
        assert_eq!(swell[layout.index(9, 0, 0)], 0.0);
    }

    #[test]
    fn what_can_leave_or_come_round_is_no_pocket() {
        let open = Sides::all(Side::FreeSlip).with(0, [Side::Outflow, Side::FreeSlip]);
        let round = Sides::all(Side::FreeSlip).with(0, [Side::Periodic; 2]);
        for (sides, pockets) in [(open, 2), (round, 1)] {
            let (layout, ghosts, faces) = pockets_of(&sides);
            let mut balance = Balance::new(&layout);
            let (velocity, none) = (layout.zero_vector(), [const { Vec::new() }; 3]);
            let mut swell = layout.zeros();
            balance.balance(&layout, &ghosts, &faces, &velocity, &none, &mut swell);
            let roots = (0..balance.segments.len()).filter(|s| balance.root(*s) == *s);
            assert_eq!(roots.count(), pockets);
            let first = balance.root(0);
            assert_eq!(balance.segments[first].has_outlet, pockets == 2);
        }
    }
}
