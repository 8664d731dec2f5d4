//! What the walls of a vessel do to the momentum equation.
//!
//! The liquid of a face with neighbours g = f + d is bounded by areas A_g (the mean of those of
//! the faces that they are made of) and by the wall:
//! ```text
//! m du/dt = -1/(4 h) sum over axes of [ Q+ u(+d) - Q- u(-d) ]            Q = A times velocity
//!           + nu/h^2 ( sum over g of A_g (u_g - u) - W u ) + m (f - grad p)
//! ```
//! Advection stays skew-symmetric and free of sources in a uniform stream; viscosity is symmetric
//! and negative. The inertia m is the face's own area, but not less than the mean of the A_g
//! along any axis, nor than the friction needs: then no explicit step has less room than far from
//! the walls.
//!
//! The drag W is 0 where the liquid slides. Where it sticks, a velocity that grows linearly with
//! the depth s below the wall has no net friction: that gives W = (sum A_g (s_g - s) - V lap s) /
//! s, s being the mean over the open part of a face. So what distances between the middles of cut
//! faces do to their friction is made up for, and no more than the slope of the depth at the wall
//! is asked of a distance.

use glam::Vec3;

use crate::{
    solver::flow::{
        engine::Engine,
        faces::Section,
        field::{Layout, Run, Vector, cut, cut_mut},
        momentum::{Stage, Terms},
    },
    vessel::cut::{CellBox, each, grown},
};

/// The wall takes at least this part of what it would take at a distance of 1: less says that two
/// walls are so near to each other that the depth between them tells of neither.
const LEAST_GRIP: f32 = 0.4;

/// (2 sum A + W) / m is at most this, which is 12 far from walls: the schedule leaves Runge and
/// Kutta's three stages that much room, and more to two steps of Adams and Bashforth.
const STIFFEST: f32 = 13.6;

/// For that, the inertia of a face close to a wall is raised up to this; beyond, drag is held back.
const MOST_INERTIA: f32 = 0.75;

/// A face beside a wall.
#[derive(Clone, Copy)]
pub struct WallFace {
    pub at: u32,
    pub inertia: f32,
    pub per_inertia: f32,
    pub drag: f32,
    /// Areas towards its neighbours: before and behind along x, y and z.
    areas: [[f32; 2]; 3],
    /// The obstacle that the wall is, if it is one.
    pub owner: Option<u32>,
}

/// The faces beside walls, by component and plane, in the order of memory.
pub struct WallFaces([Vec<Vec<WallFace>>; 3]);

/// The depth below a wall at the faces beside it and at their neighbours, in spacings.
pub struct Depth {
    /// Mean over the open part of each face; not a number where nobody asked.
    below_wall: Vector,
    /// The same, but no less than the drag of an explicit step allows for.
    at_least: Vector,
}

impl Depth {
    /// Of faces that nobody has asked for.
    pub fn new(layout: &Layout) -> Self {
        let mut depth = Self { below_wall: layout.zero_vector(), at_least: layout.zero_vector() };
        depth.below_wall.iter_mut().for_each(|depth| depth.fill(f32::NAN));
        depth
    }

    fn ask(&mut self, section: Section<'_>, c: usize, padded: [usize; 3]) {
        let [_, sy, sz] = section.layout.strides();
        let at = padded[0] + padded[1] * sy + padded[2] * sz;
        if self.below_wall[c][at].is_nan() {
            self.below_wall[c][at] = section.depth(c, padded);
            self.at_least[c][at] = self.below_wall[c][at];
        }
    }
}

/// Weights of the terms of the momentum equation in what a kernel has computed.
#[derive(Clone, Copy)]
pub struct Weights {
    /// Of the sum of doubled fluxes.
    pub advection: f32,
    /// Of the viscous stencil.
    pub viscous: f32,
}

impl Weights {
    /// Those of `terms` that were taken times `dt_s`.
    pub fn of(terms: Terms, dt_s: f32) -> Self {
        Self { advection: dt_s * terms.advection_per_m, viscous: dt_s * terms.viscous_per_s }
    }
}

impl WallFaces {
    /// Memory that they take.
    pub fn bytes(&self) -> usize {
        self.0.iter().flatten().map(|faces| size_of_val(&**faces)).sum()
    }

    /// None yet.
    pub fn new(layout: &Layout) -> Self {
        Self(std::array::from_fn(|_| vec![Vec::new(); layout.cells[2]]))
    }

    /// Brings the faces of `cells` up to date with what is `open` in `area`; `depth` is that
    /// below a wall that the liquid sticks to.
    pub fn refresh(
        &mut self,
        section: Section<'_>,
        [open, area]: [&Vector; 2],
        mut depth: Option<&mut Depth>,
        cells: &CellBox,
    ) {
        let layout = section.layout;
        // The drag of one more depends on what is known of these.
        let about = grown(cells, 1, layout.cells);
        let [x, y, z] = about.clone();
        if let Some(depth) = &mut depth {
            section.each_padded(cells, |_, at| {
                depth.below_wall.iter_mut().for_each(|depth| depth[at] = f32::NAN);
            });
        }
        for c in 0..3 {
            let mut fresh = Vec::new();
            each(&about, |[i, j, k]| {
                let at = layout.index(i, j, k);
                if open[c][at] > 0.0 {
                    fresh.extend(WallFace::new(layout, c, at, area));
                }
            });
            if let Some(depth) = &mut depth {
                set_drag(section, depth, &area[c], c, &mut fresh);
            }
            for k in z.clone() {
                let faces = &mut self.0[c][k];
                faces.retain(|face| {
                    let [i, j, _] = layout.cell_of(face.at as usize);
                    !(x.contains(&i) && y.contains(&j))
                });
                let end = layout.index(0, 0, k + 1) as u32;
                let count = fresh.iter().take_while(|face| face.at < end).count();
                faces.extend(fresh.drain(..count));
                faces.sort_unstable_by_key(|face| face.at);
            }
        }
    }

    /// Says which obstacle the walls of `cells` are: `owner(component, index)`.
    pub fn own(
        &mut self,
        layout: &Layout,
        [x, y, z]: &CellBox,
        owner: impl Fn(usize, usize) -> Option<u32>,
    ) {
        for c in 0..3 {
            for face in self.0[c][z.clone()].iter_mut().flatten() {
                let [i, j, _] = layout.cell_of(face.at as usize);
                if x.contains(&i) && y.contains(&j) {
                    face.owner = owner(c, face.at as usize);
                }
            }
        }
    }

    /// The faces of component `c`, in the order of memory.
    pub fn of_component(&self, c: usize) -> impl Iterator<Item = &WallFace> {
        self.0[c].iter().flatten()
    }

    /// The faces of component `c` in plane `k`.
    pub fn in_plane(&self, c: usize, k: usize) -> &[WallFace] {
        &self.0[c][k]
    }

    /// Corrects plane `k` of what was computed as if there were liquid everywhere.
    pub fn correct(
        &self,
        stage: Stage<'_>,
        area: &Vector,
        k: usize,
        weights: Weights,
        out: [&mut [f32]; 3],
    ) {
        for (c, out) in out.into_iter().enumerate() {
            for face in self.in_plane(c, k) {
                let at = face.at as usize;
                let (free, held) = face.terms(&stage, area, c);
                let change = |n: usize| face.per_inertia * held[n] - free[n];
                out[at - (k + 1) * stage.layout.plane] +=
                    weights.advection * change(0) + weights.viscous * change(1);
            }
        }
    }

    /// Sets plane `k` of `out` to own m u + share D u, where D u is the friction as in the module's
    /// formula; returns what that adds to the sum of u `out`.
    pub fn apply(
        &self,
        layout: &Layout,
        u: [&[f32]; 3],
        k: usize,
        [own, share]: [f32; 2],
        out: [&mut [f32]; 3],
    ) -> f64 {
        let mut sum = 0.0;
        for (c, out) in out.into_iter().enumerate() {
            for face in self.in_plane(c, k) {
                let (here, out) = (u[c][face.at as usize], &mut out[face.in_own(layout, k)]);
                let before = *out;
                *out = own * face.inertia * here - share * face.friction(layout, u[c]);
                sum += f64::from(here) * (f64::from(*out) - f64::from(before));
            }
        }
        sum
    }

    /// Calls `visit(index, drag)` for the faces of component `c`.
    pub fn visit_drag(&self, c: usize, mut visit: impl FnMut(usize, f32)) {
        self.of_component(c).for_each(|face| visit(face.at as usize, face.drag));
    }

    /// Inertia of a face; `None` if no wall is beside it.
    pub fn inertia(&self, layout: &Layout, c: usize, at: usize) -> Option<f32> {
        let faces = self.0[c].get(layout.cell_of(at)[2])?;
        let index = faces.binary_search_by_key(&at, |face| face.at as usize).ok()?;
        Some(faces[index].inertia)
    }

    /// Multiplies by the inertia, or divides by it.
    pub fn weigh(&self, vector: &mut Vector, divides: bool) {
        for (faces, field) in self.0.iter().zip(vector) {
            for face in faces.iter().flatten() {
                let weight = if divides { face.per_inertia } else { face.inertia };
                field[face.at as usize] *= weight;
            }
        }
    }
}

impl WallFace {
    /// The face at index `at`; `None` if neither it nor its neighbours are cut.
    fn new(layout: &Layout, c: usize, at: usize, area: &Vector) -> Option<Self> {
        let strides = layout.strides();
        let (own, behind) = (area[c][at], strides[c]);
        let (mut inertia, mut areas) = (own, [[0.0; 2]; 3]);
        let mut is_cut = own < 1.0;
        for d in 0..3 {
            let ends = if d == c {
                [at - behind, at + behind].map(|other| 0.5 * (own + area[c][other]))
            } else {
                [at, at + strides[d]].map(|upper| 0.5 * (area[d][upper] + area[d][upper - behind]))
            };
            inertia = inertia.max(0.5 * (ends[0] + ends[1]));
            for (end, other) in [at - strides[d], at + strides[d]].into_iter().enumerate() {
                is_cut |= ends[end] < 1.0 || area[c][other] < 1.0;
                areas[d][end] = if area[c][other] > 0.0 { ends[end] } else { 0.0 };
            }
        }
        let (at, per_inertia) = (at as u32, 1.0 / inertia);
        is_cut.then_some(Self { at, inertia, per_inertia, drag: 0.0, areas, owner: None })
    }

    fn in_own(&self, layout: &Layout, k: usize) -> usize {
        self.at as usize - (k + 1) * layout.plane
    }

    /// Sum of A_g.
    pub fn area(&self) -> f32 {
        self.areas.iter().flatten().sum()
    }

    /// Largest drag that an explicit step bears.
    fn most_drag(&self) -> f32 {
        (STIFFEST * self.inertia.max(MOST_INERTIA) - 2.0 * self.area()).max(0.0)
    }

    /// Sum of A_g value_g.
    pub fn around(&self, layout: &Layout, values: &[f32]) -> f32 {
        let (at, strides) = (self.at as usize, layout.strides());
        let both = |d: usize| {
            self.areas[d][0] * values[at - strides[d]] + self.areas[d][1] * values[at + strides[d]]
        };
        both(0) + both(1) + both(2)
    }

    /// Area of the walls beside the face, from what they take of its neighbours.
    fn wall(&self) -> f32 {
        let along = |[before, behind]: [f32; 2]| match before + behind {
            0.0 => 2.0,
            _ => behind - before,
        };
        self.areas.iter().map(|ends| along(*ends).powi(2)).sum::<f32>().sqrt()
    }

    #[inline(always)]
    fn friction(&self, layout: &Layout, u: &[f32]) -> f32 {
        self.around(layout, u) - (self.area() + self.drag) * u[self.at as usize]
    }

    /// Sums of doubled fluxes and of the viscous stencil, without and with walls.
    #[inline(always)]
    fn terms(&self, stage: &Stage<'_>, area: &Vector, c: usize) -> ([f32; 2], [f32; 2]) {
        let (at, strides) = (self.at as usize, stage.layout.strides());
        let (own, behind) = (stage.velocity[c], strides[c]);
        let (mut free, mut held) = ([0.0, -6.0 * own[at]], [0.0, 0.0]);
        for d in 0..3 {
            let (u, a) = (stage.velocity[d], &area[d]);
            let (low, high) = (at, at + strides[d]);
            let (below, above) = (own[at - strides[d]], own[at + strides[d]]);
            free[0] += (u[high] + u[high - behind]) * above - (u[low] + u[low - behind]) * below;
            let flux = |upper: usize| a[upper] * u[upper] + a[upper - behind] * u[upper - behind];
            held[0] += flux(high) * above - flux(low) * below;
            free[1] += below + above;
        }
        held[1] = self.friction(&stage.layout, own);
        (free, held)
    }
}

impl WallFace {
    /// Sum of doubled fluxes of what the neighbours have more than the face, and the part of it
    /// that keeps momentum: an exchange with those that are open. Through closed ones it leaves
    /// with what passes them faster than the wall, of velocity `wall_m_s`.
    pub fn advection(
        &self,
        stage: &Stage<'_>,
        area: &Vector,
        c: usize,
        wall_m_s: Vec3,
    ) -> [f32; 2] {
        let (at, strides) = (self.at as usize, stage.layout.strides());
        let (own, behind) = (stage.velocity[c], strides[c]);
        let (mut all, mut open) = (0.0, 0.0);
        for d in 0..3 {
            let (u, a) = (stage.velocity[d], &area[d]);
            let flux = |upper: usize| a[upper] * u[upper] + a[upper - behind] * u[upper - behind];
            let with_wall = |upper: usize| wall_m_s[d] * (a[upper] + a[upper - behind]);
            let (low, high) = (at - strides[d], at + strides[d]);
            for (neighbour, face, sign) in [(low, at, -1.0), (high, high, 1.0)] {
                let (more, out) = (own[neighbour] - own[at], sign * flux(face));
                all += out * more;
                let is_open = area[c][neighbour] > 0.0;
                open += more * if is_open { out } else { 2.0 * (out - sign * with_wall(face)) };
            }
        }
        [all, open]
    }
}

/// Sets the drag of faces of component `c`.
fn set_drag(
    section: Section<'_>,
    depth: &mut Depth,
    area: &[f32],
    c: usize,
    faces: &mut [WallFace],
) {
    let layout = section.layout;
    let padded = |face: &WallFace| layout.cell_of(face.at as usize).map(|cell| cell + 1);
    for face in &*faces {
        let own = padded(face);
        depth.ask(section, c, own);
        for axis in 0..3 {
            let [mut before, mut behind] = [own; 2];
            before[axis] -= 1;
            behind[axis] += 1;
            depth.ask(section, c, before);
            depth.ask(section, c, behind);
        }
    }
    // A face so near to the wall that its drag would be more than a step bears is taken to be
    // as far from it as that drag says; what its neighbours see of it is adjusted with it.
    let (below_wall, at_least) = (&depth.below_wall[c], &mut depth.at_least[c]);
    for face in &*faces {
        let at = face.at as usize;
        let least = face.around(layout, below_wall) / (face.area() + face.most_drag()).max(1e-3);
        at_least[at] = below_wall[at].max(least);
    }
    for face in faces {
        let at = face.at as usize;
        let (here, wall) = (at_least[at], face.wall());
        let curvature = area[at] * section.bend(c, padded(face));
        let rise = face.around(layout, at_least) - face.area() * here - curvature;
        let grip = if rise < LEAST_GRIP * wall { wall } else { rise };
        if here > 0.0 {
            face.drag = (grip / here).clamp(0.0, face.most_drag());
            face.inertia = face.inertia.max((2.0 * face.area() + face.drag) / STIFFEST);
            face.per_inertia = 1.0 / face.inertia;
        }
    }
}

/// Corrects a stage that was computed as if there were liquid everywhere: see [`WallFaces`], and
/// nothing passes a closed face.
pub fn hold(
    on: Engine<'_>,
    stage: Stage<'_>,
    k: usize,
    run: Run,
    weights: Weights,
    mut out: [&mut [f32]; 3],
) {
    correct(on, stage, k, weights, out.each_mut().map(|out| &mut **out));
    for (open, out) in on.faces.open.iter().zip(out) {
        let (open, out) = (cut(open, run.at, run.len), cut_mut(out, run.to, run.len));
        on.simd.vectorize(
            #[inline(always)]
            || out.iter_mut().zip(open).for_each(|(out, open)| *out *= open),
        );
    }
}

/// The same for rates of change that are kept; closed faces are left as they are.
pub fn correct(
    on: Engine<'_>,
    stage: Stage<'_>,
    k: usize,
    weights: Weights,
    mut out: [&mut [f32]; 3],
) {
    if let Some(vessel) = &on.faces.vessel {
        vessel.walls.correct(stage, &vessel.area, k, weights, out.each_mut().map(|out| &mut **out));
        if let Some(solids) = &vessel.solids {
            solids.correct(stage, k, weights, out);
        }
    }
}
