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
//! back: it is the term that stabilises backflow (Bazilevs, Gohean, Hughes, Moser, Zhang 2009; Bertoglio,
//! Caiazzo 2014).
//!
//! Where viscosity is implicit, a face on an open side moves with the next one within instead.

use crate::solver::flow::{
    faces::Faces,
    field::{Layout, Vector},
    momentum::{Multistep, RungeKutta, Stage},
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

    /// Completes a multistep part whose viscosity is implicit: `out` is what it changes.
    pub fn relax(&self, beside: Beside<'_>, new_s: f32, [history, out]: [&mut Vector; 2]) {
        for Opening { axis, end, .. } in &self.0 {
            beside.calm(*axis, *end, true, |c, at, more| {
                out[c][at] += new_s * more;
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

impl Beside<'_> {
    fn area(&self, c: usize, at: usize) -> f32 {
        self.faces.vessel.as_ref().map_or(1.0, |vessel| vessel.area[c][at])
    }

    /// Rate of change of a face on an open side, but for the pressure.
    fn rate(&self, c: usize, end: usize, Place { at, cell, ijk }: Place) -> f32 {
        let Stage { layout, velocity, force, terms } = self.stage;
        let (u, strides) = (velocity[c], layout.strides());
        let inner = if end == 0 { at + strides[c] } else { at - strides[c] };
        let out = if end == 0 { -u[at] } else { u[at] };
        let inward = if end == 0 { u[inner] } else { -u[inner] };
        let [own, behind] = [at, inner].map(|at| self.area(c, at));
        let mut flux = (behind * inward - own * out) * u[inner] + 2.0 * own * out.max(0.0) * u[at];
        let mut inertia = own.max(0.25 * (3.0 * own + behind));
        let between = |other: usize| match self.area(c, other) > 0.0 {
            true => 0.5 * (own + self.area(c, other)),
            false => 0.0,
        };
        let mut drag = between(inner) * (u[inner] - u[at]);
        for d in (0..3).filter(|d| *d != c) {
            let mut passed = 0.0;
            for (face, next, sign, is_last) in [
                (cell, at - strides[d], -1.0, ijk[d] == 0),
                (cell + strides[d], at + strides[d], 1.0, ijk[d] + 1 == layout.cells[d]),
            ] {
                let area = self.area(d, face);
                let out = 2.0 * sign * area * velocity[d][face];
                let is_from_rest =
                    is_last && out < 0.0 && self.faces.is_free(d, usize::from(sign > 0.0));
                flux += if is_from_rest { 0.0 } else { out * u[next] };
                let is_beside = self.area(c, next) > 0.0;
                drag += if is_beside { area * (u[next] - u[at]) } else { 0.0 };
                passed += 0.5 * area;
            }
            inertia = inertia.max(passed);
        }
        let force = force.map_or(0.0, |force| terms.force * force[c][at]);
        (terms.advection_per_m * flux + terms.viscous_per_s * drag) / inertia.max(f32::MIN_POSITIVE)
            + force
    }

    /// Calls `visit(c, index, more)` with what the rates of faces within have to be more by, as
    /// liquid that comes in beside them is from rest. If faces on the side follow those within, that
    /// goes for these, too.
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

/// Gives faces on upper open sides what those before them have, where kernels end before them.
pub fn extend_above(layout: &Layout, faces: &Faces, vector: &mut Vector) {
    for (c, _) in open_sides(faces).filter(|(_, end)| *end == 1) {
        each_place(layout, c, 1, |Place { at, cell, .. }| vector[c][at] = vector[c][cell]);
    }
}

/// Gives faces on all open sides what the next ones within have.
pub fn extend(layout: &Layout, faces: &Faces, vector: &mut Vector) {
    for (c, _) in open_sides(faces).filter(|(c, end)| *end == 0 && layout.cells[*c] > 1) {
        let behind = layout.strides()[c];
        each_place(layout, c, 0, |Place { at, .. }| vector[c][at] = vector[c][at + behind]);
    }
    extend_above(layout, faces, vector);
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
