//! Sides that let out what comes, and beyond which all is at rest.
//!
//! A face on such a side moves by the momentum equation like any face within: half of its liquid
//! is beyond the side. So a projection, which knows of whole faces, takes energy
//! ```text
//! E = h^3 sum over all faces, those on open sides too, of u^2 / 2
//! ```
//! and never gives any. Advection changes u by -1/(4 h) sum over neighbours g of Q_g u_g, Q_g being
//! the doubled outward flux. As two faces see the same flux with opposite signs, the sum of u du/dt
//! leaves nothing of all pairs of faces, and of a face with what is beyond an open side
//! ```text
//! dE/dt = -h^2/4 sum over the faces next to what is beyond of Q_g u u_g
//! ```
//! What leaves has u_g = u there and takes Q u^2. What comes in is from rest, u_g = 0: then it
//! brings none, and a stream that is drawn in meets the pressure of rest less u^2 / 2, as Bernoulli
//! has it. Since kernels know of u_g = u alone, what this makes of liquid that comes in is taken
//! back: it is the term that stabilises backflow (Bazilevs, Gohean, Hughes, Moser, Zhang 2009;
//! Bertoglio, Caiazzo 2014).
//!
//! Where viscosity differs from place to place and is implicit, a face on an open side moves with
//! the next one within instead.

use crate::solver::flow::{
    faces::Faces,
    field::{Layout, Vector},
    momentum::{Multistep, RungeKutta, Semi, Stage},
};

/// One side that lets out what comes.
struct Opening {
    axis: usize,
    end: usize,
    /// The last rates of change of its faces, for the next multistep part.
    rates: Vec<f32>,
}

/// All of them.
pub struct Openings(Vec<Opening>);

/// What a stage is computed of.
#[derive(Clone, Copy)]
pub struct Beside<'a> {
    /// The stage.
    pub stage: Stage<'a>,
    /// What lies between cells.
    pub faces: &'a Faces,
}

/// One face on an open side.
#[derive(Clone, Copy)]
struct Place {
    /// Index of the face, and of the cell that it is a face of.
    at: usize,
    cell: usize,
    /// The cell.
    ijk: [usize; 3],
}

/// Axis and end of the sides that let out what comes.
fn open_sides(faces: &Faces) -> impl Iterator<Item = (usize, usize)> {
    let all = (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]);
    all.filter(|(axis, end)| faces.is_free(*axis, *end))
}

/// Calls `visit` for the faces of a side.
fn each_place(layout: &Layout, axis: usize, end: usize, mut visit: impl FnMut(Place)) {
    let mut last = layout.cells;
    last[axis] = 1;
    let strides = layout.strides();
    let shift = end * (layout.cells[axis] - 1);
    for k in 0..last[2] {
        for j in 0..last[1] {
            for i in 0..last[0] {
                let mut ijk = [i, j, k];
                ijk[axis] = shift;
                let cell = layout.index(ijk[0], ijk[1], ijk[2]);
                visit(Place { at: cell + end * strides[axis], cell, ijk });
            }
        }
    }
}

impl Openings {
    /// Of these sides.
    pub fn new(layout: &Layout, faces: &Faces) -> Self {
        let rates =
            |axis: usize| vec![0.0; layout.cells.iter().product::<usize>() / layout.cells[axis]];
        let opening = |(axis, end)| Opening { axis, end, rates: rates(axis) };
        Self(open_sides(faces).map(opening).collect())
    }

    /// Completes an explicit multistep part of which `history` and `out` are there.
    pub fn extrapolate(
        &mut self,
        beside: Beside<'_>,
        advance: Multistep,
        [history, out]: [&mut Vector; 2],
    ) {
        for Opening { axis, end, rates } in &mut self.0 {
            let (c, mut index, u) = (*axis, 0, beside.stage.velocity[*axis]);
            each_place(&beside.stage.layout, c, *end, |place| {
                let rate = beside.rate(c, *end, place);
                let next = u[place.at] + advance.new_s * rate + advance.old_s * rates[index];
                out[c][place.at] = beside.faces.open[c][place.at] * next;
                rates[index] = rate;
                index += 1;
            });
            beside.calm(c, *end, false, |c, at, more| {
                out[c][at] += advance.new_s * more;
                history[c][at] += more;
            });
        }
    }

    /// Completes a multistep part whose viscosity is implicit: `out` is what it changes, and faces
    /// on open sides follow those within if nothing solves for them.
    pub fn relax(
        &mut self,
        beside: Beside<'_>,
        advance: Semi<'_>,
        follows: bool,
        [history, out]: [&mut Vector; 2],
    ) {
        let Stage { layout, velocity, .. } = beside.stage;
        for Opening { axis, end, rates } in &mut self.0 {
            let (c, mut index) = (*axis, 0);
            each_place(&layout, c, *end, |place| {
                let rate = beside.rate(c, *end, place);
                let out_of_cell = if *end == 0 { -1.0 } else { 1.0 };
                let side = OnSide { layout: &layout, faces: beside.faces, c, end: *end, place };
                let friction = advance.viscous * side.friction(velocity[c]) / side.inertia();
                let push = advance.dt_s * out_of_cell * advance.pressure[place.cell];
                let Multistep { new_s, old_s } = advance.rates;
                let change = new_s * rate + old_s * rates[index] + friction + push;
                out[c][place.at] = beside.faces.open[c][place.at] * change;
                rates[index] = rate;
                index += 1;
            });
            beside.calm(c, *end, follows, |c, at, more| {
                out[c][at] += advance.rates.new_s * more;
                history[c][at] += more;
            });
        }
    }

    /// Completes a stage of Runge and Kutta.
    pub fn advance(&self, beside: Beside<'_>, advance: RungeKutta<'_>, out: &mut Vector) {
        for Opening { axis, end, .. } in &self.0 {
            let (c, u) = (*axis, beside.stage.velocity[*axis]);
            each_place(&beside.stage.layout, c, *end, |place| {
                let out_of_cell = if *end == 0 { -1.0 } else { 1.0 };
                let rate = beside.rate(c, *end, place) + out_of_cell * advance.pressure[place.cell];
                let next = advance.own_share * (u[place.at] + advance.dt_s * rate);
                let kept = advance.start_share * advance.start[c][place.at];
                out[c][place.at] = beside.faces.open[c][place.at] * (next + kept);
            });
            let share_s = advance.own_share * advance.dt_s;
            beside.calm(c, *end, false, |c, at, more| out[c][at] += share_s * more);
        }
    }
}

/// A face on an open side, and what is beside it.
struct OnSide<'a> {
    layout: &'a Layout,
    faces: &'a Faces,
    c: usize,
    end: usize,
    place: Place,
}

impl OnSide<'_> {
    /// Index of the next face within.
    fn inner(&self) -> usize {
        let (at, stride) = (self.place.at, self.layout.strides()[self.c]);
        if self.end == 0 { at + stride } else { at - stride }
    }

    /// As of any face beside walls.
    fn inertia(&self) -> f32 {
        let (Some(vessel), Place { at, cell, .. }) = (&self.faces.vessel, self.place) else {
            return 1.0;
        };
        if self.end == 0 {
            return vessel.walls.inertia(self.layout, self.c, at).unwrap_or(1.0);
        }
        let [own, behind] = [at, self.inner()].map(|at| vessel.area[self.c][at]);
        let across = (0..3).filter(|d| *d != self.c).map(|d| {
            let area = &vessel.area[d];
            0.5 * (area[cell] + area[cell + self.layout.strides()[d]])
        });
        across.fold(own.max(0.25 * (3.0 * own + behind)), f32::max).max(f32::MIN_POSITIVE)
    }

    /// Sum over the neighbours of A_g (u_g - u): none with what is beyond, nor with walls.
    fn friction(&self, u: &[f32]) -> f32 {
        let (Place { at, cell, .. }, strides, inner) =
            (self.place, self.layout.strides(), self.inner());
        let Some(vessel) = &self.faces.vessel else {
            let across =
                (0..3).filter(|d| *d != self.c).map(|d| u[at - strides[d]] + u[at + strides[d]]);
            return u[inner] - 5.0 * u[at] + across.sum::<f32>();
        };
        let area = &vessel.area[self.c];
        let towards = |next: usize, between: f32| match area[next] > 0.0 {
            true => between * (u[next] - u[at]),
            false => 0.0,
        };
        let across = (0..3).filter(|d| *d != self.c).map(|d| {
            let between = [cell, cell + strides[d]].map(|face| vessel.area[d][face]);
            towards(at - strides[d], between[0]) + towards(at + strides[d], between[1])
        });
        towards(inner, 0.5 * (area[at] + area[inner])) + across.sum::<f32>()
    }
}

/// Calls `visit` for all faces on open sides that no wall shuts.
fn each_on_sides<'a>(layout: &'a Layout, faces: &'a Faces, mut visit: impl FnMut(OnSide<'a>)) {
    for (c, end) in open_sides(faces) {
        each_place(layout, c, end, |place| {
            if faces.open[c][place.at] > 0.0 {
                visit(OnSide { layout, faces, c, end, place });
            }
        });
    }
}

/// Sets `out` on open sides to own m u + share D u (see [`super::viscous`]). Returns what that adds
/// to the sum of u `out` over all faces, of which the kernel has counted some there.
pub fn apply_on_sides(
    layout: &Layout,
    faces: &Faces,
    u: [&[f32]; 3],
    out: &mut Vector,
    [own, share]: [f32; 2],
) -> f64 {
    let mut sum = 0.0;
    each_on_sides(layout, faces, |side| {
        let (at, c) = (side.place.at, side.c);
        let value = own * side.inertia() * u[c][at] - share * side.friction(u[c]);
        let counted = if is_reached(layout, faces, at) { out[c][at] } else { 0.0 };
        sum += f64::from(u[c][at]) * (f64::from(value) - f64::from(counted));
        out[c][at] = value;
    });
    sum
}

/// Multiplies by the inertia of faces on upper open sides, or divides by it: no list of walls has
/// them.
pub fn weigh_above(layout: &Layout, faces: &Faces, vector: &mut Vector, divides: bool) {
    each_on_sides(layout, faces, |side| {
        if side.end == 1 {
            let inertia = side.inertia();
            vector[side.c][side.place.at] *= if divides { 1.0 / inertia } else { inertia };
        }
    });
}

impl Beside<'_> {
    fn area(&self, c: usize, at: usize) -> f32 {
        self.faces.vessel.as_ref().map_or(1.0, |vessel| vessel.area[c][at])
    }

    /// Rate of change of a face on an open side, but for the pressure.
    fn rate(&self, c: usize, end: usize, place: Place) -> f32 {
        let Stage { layout, velocity, force, terms } = self.stage;
        let side = OnSide { layout: &layout, faces: self.faces, c, end, place };
        let (u, strides, Place { at, cell, ijk }) = (velocity[c], layout.strides(), place);
        let inner = side.inner();
        let out = if end == 0 { -u[at] } else { u[at] };
        let inward = if end == 0 { u[inner] } else { -u[inner] };
        let [own, behind] = [at, inner].map(|at| self.area(c, at));
        let mut flux = (behind * inward - own * out) * u[inner] + 2.0 * own * out.max(0.0) * u[at];
        for d in (0..3).filter(|d| *d != c) {
            let ends = [(cell, at - strides[d]), (cell + strides[d], at + strides[d])];
            for (upper, (face, next)) in ends.into_iter().enumerate() {
                let sign = if upper == 0 { -2.0 } else { 2.0 };
                let out = sign * self.area(d, face) * velocity[d][face];
                let is_last = ijk[d] == [0, layout.cells[d] - 1][upper];
                let is_from_rest = is_last && out < 0.0 && self.faces.is_free(d, upper);
                flux += if is_from_rest { 0.0 } else { out * u[next] };
            }
        }
        let mut rate = terms.advection_per_m * flux;
        if terms.viscous_per_s > 0.0 {
            rate += terms.viscous_per_s * side.friction(u);
        }
        rate / side.inertia() + force.map_or(0.0, |force| terms.force * force[c][at])
    }

    /// Calls `visit(c, index, more)` with what the rates of faces within have to be more by, as
    /// liquid that comes in beside them is from rest. If faces on the side follow those within,
    /// that goes for these, too.
    fn calm(
        &self,
        axis: usize,
        end: usize,
        follows: bool,
        mut visit: impl FnMut(usize, usize, f32),
    ) {
        let Stage { layout, velocity, terms, .. } = self.stage;
        let (strides, out_of_cell) = (layout.strides(), if end == 0 { -1.0 } else { 1.0 });
        each_place(&layout, axis, end, |Place { at, cell, ijk }| {
            let passing = |at: usize| out_of_cell * self.area(axis, at) * velocity[axis][at];
            for c in 0..3 {
                let (face, out, beyond) = if c == axis {
                    let inner = if end == 0 { at + strides[c] } else { at - strides[c] };
                    if !follows || layout.cells[c] == 1 {
                        continue;
                    }
                    (inner, passing(at) + passing(inner), velocity[c][at])
                } else if ijk[c] == 0 && !self.faces.sides.is_periodic(c) {
                    continue;
                } else {
                    (cell, passing(at) + passing(at - strides[c]), velocity[c][cell])
                };
                if out < 0.0 && self.faces.open[c][face] > 0.0 {
                    let vessel = self.faces.vessel.as_ref();
                    let inertia = vessel.and_then(|vessel| vessel.walls.inertia(&layout, c, face));
                    visit(c, face, -terms.advection_per_m * out * beyond / inertia.unwrap_or(1.0));
                }
            }
        });
    }
}

/// Gives faces on upper open sides what those before them have, where kernels end before them;
/// those that walls shut have nothing.
pub fn extend_above(layout: &Layout, faces: &Faces, vector: &mut Vector) {
    for (c, _) in open_sides(faces).filter(|(_, end)| *end == 1) {
        each_place(layout, c, 1, |Place { at, cell, .. }| {
            vector[c][at] = faces.open[c][at] * vector[c][cell];
        });
    }
}

/// Gives faces on all open sides what the next ones within have.
pub fn extend(layout: &Layout, faces: &Faces, vector: &mut Vector) {
    for (c, _) in open_sides(faces).filter(|(c, end)| *end == 0 && layout.cells[*c] > 1) {
        let behind = layout.strides()[c];
        each_place(layout, c, 0, |Place { at, .. }| {
            vector[c][at] = faces.open[c][at] * vector[c][at + behind];
        });
    }
    extend_above(layout, faces, vector);
}

/// True if a kernel that runs over the live rows of all planes gets to a face on an open side: runs
/// are rounded up, so it may be some of those above the last row.
fn is_reached(layout: &Layout, faces: &Faces, at: usize) -> bool {
    let k = at / layout.plane - 1;
    k < layout.cells[2] && {
        let run = layout.run(faces.live_rows[k].clone(), k);
        at < run.at + run.len
    }
}

/// As [`visit_above`], but for those that kernels get to.
pub fn visit_unreached(layout: &Layout, faces: &Faces, mut visit: impl FnMut(usize, usize)) {
    visit_above(layout, faces, |c, at, _| {
        if !is_reached(layout, faces, at) {
            visit(c, at);
        }
    });
}

/// Calls `visit(axis, index, cell beyond)` for the faces on upper open sides.
pub fn visit_above(
    layout: &Layout,
    faces: &Faces,
    mut visit: impl FnMut(usize, usize, [usize; 3]),
) {
    for (c, _) in open_sides(faces).filter(|(_, end)| *end == 1) {
        each_place(layout, c, 1, |Place { at, mut ijk, .. }| {
            ijk[c] += 1;
            visit(c, at, ijk);
        });
    }
}

/// Slows what a tracing would bring in from beyond open sides, which is at rest: it has no velocity
/// along the side, and half of that through it, as in crossing it has met half the pressure that
/// brings liquid from rest to its velocity.
pub fn slow_incoming(layout: &Layout, faces: &Faces, velocity: &mut Vector) {
    for (axis, end) in open_sides(faces) {
        let strides = layout.strides();
        each_place(layout, axis, end, |Place { at, .. }| {
            let beyond = if end == 0 { at - strides[axis] } else { at };
            let is_incoming = (velocity[axis][at] < 0.0) == (end == 1);
            if is_incoming {
                velocity[axis][at] *= 0.5;
                for c in (0..3).filter(|c| *c != axis) {
                    velocity[c][beyond] = 0.0;
                }
            }
        });
    }
}

/// What a survey of cells misses: squares, speed and power of the faces on upper open sides.
pub fn survey_sides(
    layout: &Layout,
    faces: &Faces,
    velocity: [&[f32]; 3],
    force: Option<[&[f32]; 3]>,
    mass: Option<&Vector>,
) -> [f64; 4] {
    let [mut squares, mut speed, mut power] = [0f64; 3];
    for (c, _) in open_sides(faces).filter(|(_, end)| *end == 1) {
        each_place(layout, c, 1, |Place { at, cell, .. }| {
            let u = f64::from(velocity[c][at]);
            let mass = mass.map_or(1.0, |mass| f64::from(mass[c][at]));
            squares += mass * u * u;
            power += force.map_or(0.0, |force| mass * u * f64::from(force[c][at]));
            let along =
                |d: usize| if d == c { u.abs() } else { f64::from(velocity[d][cell].abs()) };
            speed = speed.max(along(0) + along(1) + along(2));
        });
    }
    [squares, speed, power, 0.0]
}
