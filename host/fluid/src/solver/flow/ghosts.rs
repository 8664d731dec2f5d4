//! The values beyond the sides of the grid that make a kernel's stencil mean what the side is.
//!
//! ```text
//! side        velocity through it      velocity along it     pressure
//! slides      0                        u_ghost = u           none: the face is set
//! sticks      that of the side, U      of a parabola         none: the face is set
//! free        its own                  u_ghost = u           0
//! periodic    all are those of the opposite side
//! ```
//! (Harlow, Welch 1965; Ferziger, Peric 2002.) The parabola is that through the side and the
//! first two values: with a straight line, u_ghost = 2 U - u, a boundary layer of a few cells
//! comes out too weak. What passes a free side moves like any face within (see
//! [`super::openings`]) or, where a scheme knows nothing of it, is set from inside before a
//! projection, which then corrects it.

mod line;

use self::line::{Line, copy, extrapolate, mirror, put, set};
use crate::{
    solver::{
        Side, Sides,
        flow::{
            field::{Field, Layout, Vector},
            poisson::Unknowns,
        },
    },
    spectral::basis::{End, Ends},
};

/// How one side makes its ghosts.
enum Rule {
    Slides,
    /// The velocity of the side at each of its points, by component; `None` if it rests.
    Sticks(Option<[Vec<f32>; 3]>),
    Free,
    Periodic,
}

/// The ghosts of one grid.
pub struct Ghosts {
    layout: Layout,
    rules: [[Rule; 2]; 3],
}

/// What is filled.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Fill {
    /// A velocity that a projection follows on.
    Unprojected,
    /// The same, but what passes free sides is not known: it is as before them.
    Inside,
    /// A velocity as it is to be.
    Projected,
    /// A velocity to be interpolated: ghosts are on a straight line through the side, so that
    /// nothing between them and the flow exceeds both the flow and the side.
    Carried,
    /// A difference of two velocities: sides count as resting.
    Difference,
}

/// Fills both ends of one axis: of lines of values that are `stride` apart, the first at `first`.
type FillAxis = fn(&Ghosts, usize, &mut [f32], usize, (usize, usize), Line);

impl Ghosts {
    /// The ghosts of a grid with these sides.
    pub fn new(layout: &Layout, sides: &Sides) -> Self {
        let rule = |axis: usize, side: Side| match side {
            Side::FreeSlip => Rule::Slides,
            Side::Outflow => Rule::Free,
            Side::Periodic => Rule::Periodic,
            Side::NoSlip | Side::Moving(_) | Side::Inflow(_) => {
                let velocity = side.velocity_m_s(axis).unwrap_or_default().to_array();
                let is_still = velocity == [0.0; 3];
                Rule::Sticks(
                    (!is_still).then(|| velocity.map(|u| vec![u; layout.points_of_side(axis)])),
                )
            }
        };
        let rules = std::array::from_fn(|axis| sides.0[axis].map(|side| rule(axis, side)));
        Self { layout: *layout, rules }
    }

    /// Gives a side that the flow sticks to its velocity at each of its points, by component, in
    /// exchange for what it had.
    pub fn stick_to(&mut self, axis: usize, end: usize, velocity: &mut [Vec<f32>; 3]) {
        let given = Rule::Sticks(Some(std::mem::take(velocity)));
        if let Rule::Sticks(Some(had)) = std::mem::replace(&mut self.rules[axis][end], given) {
            *velocity = had;
        }
    }

    /// What the pressure meets at the ends of each axis.
    pub fn pressure_ends(&self) -> [Ends; 3] {
        self.rules.each_ref().map(|rules| match rules {
            [Rule::Periodic, _] => Ends::Periodic,
            rules => Ends::Between(rules.each_ref().map(|rule| match rule {
                Rule::Free => End::Open,
                _ => End::Closed,
            })),
        })
    }

    /// Where component `c` can change between walls, and what its changes meet at the ends of each
    /// axis: see [`Fill::Difference`]. `None` where there is no face within.
    pub fn unknown_changes(&self, c: usize) -> Option<(Unknowns, [Ends; 3])> {
        let mut unknowns = Unknowns { first: [0; 3], count: self.layout.cells };
        let ends = std::array::from_fn(|axis| match &self.rules[axis] {
            [Rule::Periodic, _] => Ends::Periodic,
            _ if axis == c => {
                unknowns.first[c] = 1;
                unknowns.count[c] -= 1;
                Ends::Between([End::Open; 2])
            }
            rules => Ends::Between(rules.each_ref().map(|rule| match rule {
                Rule::Sticks(_) => End::Odd,
                _ => End::Closed,
            })),
        });
        (unknowns.count[c] > 0).then_some((unknowns, ends))
    }

    /// Fills what lies beyond x and y in plane `k` of component `c`.
    pub fn fill_plane(&self, c: usize, k: usize, plane: &mut [f32], fill: Fill) {
        let (layout, [nx, ny, _]) = (&self.layout, self.layout.cells);
        let (row, first) = (layout.row, layout.index_in_plane(0, 0) - 1);
        let along_x = Line { start: 0, step: 1, len: nx + 2 };
        let values = (k + 1) * (nx + 2);
        self.fill_axis(1, c, plane, ny, (first, row), along_x, values, fill);
        self.fill_rows(c, k, plane, fill);
        // A run is rounded up to whole blocks: what it made of the rest must not feed on itself.
        plane[row * (ny + 2)..].fill(0.0);
    }

    /// Fills both ends of all rows in plane `k` of component `c`.
    fn fill_rows(&self, c: usize, k: usize, plane: &mut [f32], fill: Fill) {
        let (layout, [nx, ny, _]) = (&self.layout, self.layout.cells);
        if nx > 1 && matches!(self.rules[0], [Rule::Slides, Rule::Slides]) {
            // Both in one pass, as rows are far apart.
            for row in plane.chunks_exact_mut(layout.row).take(ny + 2) {
                let [below, first, .., last, above] = row else { return };
                if c == 0 {
                    (*below, *first, *above) = (0.0, 0.0, 0.0);
                } else {
                    (*below, *above) = (*first, *last);
                }
            }
            return;
        }
        let along_y = Line { start: 0, step: layout.row, len: ny + 2 };
        let values = (k + 1) * (ny + 2);
        self.fill_axis(0, c, plane, nx, (1, 1), along_y, values, fill);
    }

    /// Fills the planes beyond z of component `c`; all others are to be filled before.
    pub fn fill_ends(&self, c: usize, field: &mut Field, fill: Fill) {
        let (plane, nz) = (self.layout.plane, self.layout.cells[2]);
        let along = Line { start: 0, step: 1, len: plane };
        self.fill_axis(2, c, field, nz, (plane, plane), along, 0, fill);
        if c == 2 && self.is_free(2, 1) {
            // The faces on the side have ghosts of their own.
            self.fill_plane(c, nz, &mut field[(nz + 1) * plane..][..plane], fill);
        }
    }

    /// Fills the ghosts of plane `k` of all components once it is projected, and sets what passes
    /// the lower z side.
    pub fn close_plane(&self, k: usize, mut planes: [&mut [f32]; 3]) {
        for (c, plane) in planes.iter_mut().enumerate() {
            self.fill_plane(c, k, plane, Fill::Projected);
        }
        if k == 0 {
            self.set_floor(planes[2]);
        }
    }

    /// True if all sides are walls.
    pub fn are_walls(&self) -> bool {
        let is_wall = |rule: &Rule| matches!(rule, Rule::Slides | Rule::Sticks(_));
        self.rules.iter().flatten().all(is_wall)
    }

    /// Sets what passes the lower z side in its plane of w, where the side says it.
    fn set_floor(&self, plane: &mut [f32]) {
        match &self.rules[2][0] {
            Rule::Slides | Rule::Sticks(None) => plane.fill(0.0),
            Rule::Sticks(Some([_, _, w])) => plane.copy_from_slice(w),
            Rule::Free | Rule::Periodic => {}
        }
    }

    /// Sets what passes the sides, which is all that a divergence needs to know of them.
    pub fn fill_normals(&self, [u, v, w]: &mut Vector) {
        let layout = &self.layout;
        let [u, v] = [u, v].map(|u| layout.planes(u).chunks_exact_mut(layout.plane));
        u.zip(v).enumerate().for_each(|(k, (u, v))| self.fill_normals_in_plane(k, u, v));
        self.fill_ends(2, w, Fill::Unprojected);
    }

    /// The same of the sides across x and y, in plane `k` of u and v.
    pub fn fill_normals_in_plane(&self, k: usize, u: &mut [f32], v: &mut [f32]) {
        let (layout, [nx, ny, _]) = (&self.layout, self.layout.cells);
        let (row, first) = (layout.row, layout.index_in_plane(0, 0) - 1);
        self.fill_rows(0, k, u, Fill::Unprojected);
        let along_x = Line { start: 0, step: 1, len: nx + 2 };
        let values = (k + 1) * (nx + 2);
        self.fill_axis(1, 1, v, ny, (first, row), along_x, values, Fill::Unprojected);
    }

    /// Fills all ghosts of a velocity.
    pub fn fill(&self, velocity: &mut Vector, fill: Fill) {
        for (c, field) in velocity.iter_mut().enumerate() {
            let planes = self.layout.planes(field).chunks_exact_mut(self.layout.plane);
            planes.enumerate().for_each(|(k, plane)| self.fill_plane(c, k, plane, fill));
            self.fill_ends(c, field, fill);
        }
    }

    /// True if some side lets out what comes.
    pub fn is_any_free(&self) -> bool {
        (0..3).any(|axis| self.is_free(axis, 0) || self.is_free(axis, 1))
    }

    /// True if the side lets out what comes.
    pub fn is_free(&self, axis: usize, end: usize) -> bool {
        matches!(self.rules[axis][end], Rule::Free)
    }

    /// True if the flow sticks to the side.
    pub fn holds(&self, axis: usize, end: usize) -> bool {
        matches!(self.rules[axis][end], Rule::Sticks(_))
    }

    /// Fills the ghosts of a pressure that a correction needs: none at a wall.
    pub fn fill_pressure(&self, psi: &mut Field) {
        if (0..3).any(|axis| self.is_periodic(axis)) {
            self.wrap_cells(psi);
        }
        let (layout, [nx, ny, nz]) = (&self.layout, self.layout.cells);
        let along_x = Line { start: 0, step: 1, len: nx + 2 };
        let along_y = Line { start: 0, step: layout.row, len: ny + 2 };
        for end in 0..2 {
            let planes = layout.planes(psi).chunks_exact_mut(layout.plane);
            if self.is_free(0, end) {
                let ghost = along_y.from([0, nx + 1][end]);
                planes.for_each(|plane| set(plane, ghost, 0.0));
            }
            let planes = layout.planes(psi).chunks_exact_mut(layout.plane);
            if self.is_free(1, end) {
                let ghost = along_x.from([0, (ny + 1) * layout.row][end]);
                planes.for_each(|plane| set(plane, ghost, 0.0));
            }
            if self.is_free(2, end) {
                psi[[0, (nz + 1) * layout.plane][end]..][..layout.plane].fill(0.0);
            }
        }
    }

    /// True if the axis is periodic.
    pub fn is_periodic(&self, axis: usize) -> bool {
        matches!(self.rules[axis][0], Rule::Periodic)
    }

    /// Fills what lies beyond periodic sides of a cell field in all planes.
    pub fn wrap_cells(&self, field: &mut Field) {
        let planes = self.layout.planes(field).chunks_exact_mut(self.layout.plane);
        planes.for_each(|plane| self.wrap_plane(plane));
        self.wrap_ends(field);
    }

    /// Fills what lies beyond the sides of a cell field: as next to them, or, where an axis is
    /// periodic, as at the opposite side.
    pub fn extend_cells(&self, field: &mut Field) {
        let planes = self.layout.planes(field).chunks_exact_mut(self.layout.plane);
        planes.for_each(|plane| self.along_plane(plane, Self::extend_axis));
        self.along_ends(field, Self::extend_axis);
    }

    fn wrap_plane(&self, plane: &mut [f32]) {
        self.along_plane(plane, Self::wrap_axis);
    }

    /// Fills the planes beyond z of a cell field if that is periodic.
    fn wrap_ends(&self, field: &mut Field) {
        self.along_ends(field, Self::wrap_axis);
    }

    fn along_plane(&self, plane: &mut [f32], fill: FillAxis) {
        let (layout, [nx, ny, _]) = (&self.layout, self.layout.cells);
        let (row, first) = (layout.row, layout.index_in_plane(0, 0) - 1);
        let along_x = Line { start: 0, step: 1, len: nx + 2 };
        fill(self, 1, plane, ny, (first, row), along_x);
        let along_y = Line { start: 0, step: row, len: ny + 2 };
        fill(self, 0, plane, nx, (1, 1), along_y);
    }

    fn along_ends(&self, field: &mut Field, fill: FillAxis) {
        let (plane, nz) = (self.layout.plane, self.layout.cells[2]);
        let along = Line { start: 0, step: 1, len: plane };
        fill(self, 2, field, nz, (plane, plane), along);
    }

    fn wrap_axis(
        &self,
        axis: usize,
        array: &mut [f32],
        n: usize,
        place: (usize, usize),
        along: Line,
    ) {
        if self.is_periodic(axis) {
            self.extend_axis(axis, array, n, place, along);
        }
    }

    fn extend_axis(
        &self,
        axis: usize,
        array: &mut [f32],
        n: usize,
        (first, stride): (usize, usize),
        along: Line,
    ) {
        let line = |index: usize| along.from(first + index * stride);
        let [lower, upper] = if self.is_periodic(axis) { [n - 1, 0] } else { [0, n - 1] };
        copy(array, line(lower), along.from(first - stride), 1.0);
        copy(array, line(upper), line(n), 1.0);
    }

    /// One axis of component `c`: lines of values are `stride` apart, the first at `first`.
    #[allow(clippy::too_many_arguments, reason = "a place in an array has many coordinates")]
    fn fill_axis(
        &self,
        axis: usize,
        c: usize,
        array: &mut [f32],
        n: usize,
        (first, stride): (usize, usize),
        along: Line,
        values: usize,
        fill: Fill,
    ) {
        let line = |index: usize| along.from(first + index * stride);
        let below = along.from(first - stride);
        if c == axis && !self.is_periodic(axis) {
            // No kernel needs the face beyond the lower side, but all compute it.
            set(array, below, 0.0);
        }
        for (end, rule) in self.rules[axis].iter().enumerate() {
            // The side itself, the values before it, and what lies beyond; written out, as lines
            // that are chosen from an array would go through memory.
            let (side, inner, ghost, opposite) = if end == 0 {
                (line(0), line(0), below, line(n - 1))
            } else {
                (line(n), line(n - 1), line(n), line(0))
            };
            match rule {
                Rule::Periodic => copy(array, opposite, ghost, 1.0),
                Rule::Slides if c == axis => set(array, side, 0.0),
                Rule::Slides => copy(array, inner, ghost, 1.0),
                Rule::Free if c == axis => {
                    if fill == Fill::Inside {
                        let before = line(if end == 0 { 1 } else { n - 1 });
                        copy(array, before, side, 1.0);
                    }
                }
                Rule::Free => copy(array, inner, ghost, 1.0),
                Rule::Sticks(_) if fill == Fill::Difference => match c == axis {
                    true => set(array, side, 0.0),
                    false => copy(array, inner, ghost, -1.0),
                },
                Rule::Sticks(velocity) => {
                    let velocity = velocity.as_ref().map(|u| &u[c][values..]);
                    let second = line(if end == 0 { 1.min(n - 1) } else { n.saturating_sub(2) });
                    match velocity {
                        None if c == axis => set(array, side, 0.0),
                        Some(u) if c == axis => put(array, side, u),
                        _ if fill == Fill::Carried => mirror(array, inner, velocity, ghost),
                        _ => extrapolate(array, [inner, second], velocity, ghost),
                    }
                }
            }
        }
    }
}
