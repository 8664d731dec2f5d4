//! What obstacles do to the faces that they cover, and to those beside them.
//!
//! A solid that covers the part 1 - a of a face carries the flux (1 - a) U through it, U being
//! its own velocity there. In a liquid cell these add up to what its walls displace, `swell`:
//! ```text
//! div:  sum of a u out of a cell = -swell,        swell = sum of (1 - a) U out of it
//! m du/dt = ... + u (swell of both cells) / (2 h) + nu/h^2 W U
//! ```
//! The first of the two is that nothing passes a wall that moves: the liquid beside it takes its
//! momentum along (a wall that has not come as far as its velocity says does so in part: liquid
//! that it never reaches would gain without end); the second is friction towards the solid's
//! velocity (W as in [`super::walls`]). A face that is covered wholly has the velocity of the
//! solid.

pub mod balance;

use self::balance::Balance;
use crate::solver::flow::{
    faces::Faces,
    field::{Field, Layout, Vector},
    ghosts::Ghosts,
    momentum::Stage,
    walls::{WallFaces, Weights},
};

/// A face that a solid covers, in part or wholly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covered {
    /// Its index.
    pub at: u32,
    /// The solid.
    pub owner: u32,
    /// The part that it covers.
    pub part: f32,
    /// Velocity of the solid there.
    pub velocity_m_s: f32,
    /// True if nothing else passes.
    pub is_closed: bool,
    /// True if it is on a side of the box, which solids pass as they like, and nothing else.
    pub is_side: bool,
}

/// A face of liquid beside a moving solid; rates are by its inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Beside {
    at: u32,
    /// Velocity of the wall, and drag times that.
    wall_m_s: f32,
    pull: f32,
    /// What the walls of both cells displace.
    swell: f32,
}

/// The faces about all solids.
pub struct Solids {
    covered: [Vec<Covered>; 3],
    beside: [Vec<Vec<Beside>>; 3],
    /// What the walls of each liquid cell displace, in units of face area.
    pub swell: Field,
    /// True if one of them moves.
    pub is_moving: bool,
}

impl Solids {
    /// None yet.
    pub fn new(layout: &Layout) -> Self {
        Self {
            covered: [const { Vec::new() }; 3],
            beside: std::array::from_fn(|_| vec![Vec::new(); layout.cells[2]]),
            swell: layout.zeros(),
            is_moving: false,
        }
    }

    /// Gives faces that were covered wholly, and are no more, the velocity of the liquid beside
    /// them, which slides along walls: that of the solid, which they have, would drag it.
    pub fn uncover(&self, layout: &Layout, open: &Vector, velocity: &mut Vector) {
        for ((covered, open), u) in self.covered.iter().zip(open).zip(velocity) {
            let fresh = || {
                let closed = covered.iter().filter(|face| face.is_closed);
                closed.filter(|face| open[face.at as usize] > 0.0)
            };
            fresh().for_each(|face| u[face.at as usize] = f32::NAN);
            for face in fresh() {
                let at = face.at as usize;
                let around = layout.strides().into_iter().flat_map(|s| [at - s, at + s]);
                let liquid = around.filter(|at| open[*at] > 0.0 && !u[*at].is_nan());
                let (sum, count) = liquid.fold((0.0, 0.0), |(s, n), at| (s + u[at], n + 1.0));
                u[at] = if count > 0.0 { sum / count } else { face.velocity_m_s };
            }
        }
    }

    /// Takes the covered faces of component `c`, of which some may have come twice.
    pub fn cover(&mut self, c: usize, faces: Vec<Covered>) {
        let covered = &mut self.covered[c];
        covered.clear();
        covered.extend(faces);
        covered.sort_unstable_by_key(|face| face.at);
        covered.dedup_by_key(|face| face.at);
    }

    /// The covered faces of component `c`.
    pub fn covered(&self, c: usize) -> &[Covered] {
        &self.covered[c]
    }

    /// Sets what the walls of cells displace, from the covered faces.
    pub fn set_swell(&mut self, layout: &Layout, ghosts: &Ghosts, liquid: &[f32]) {
        self.is_moving = self.covered.iter().flatten().any(|face| face.velocity_m_s != 0.0);
        self.swell.fill(0.0);
        for (c, faces) in self.covered.iter().enumerate() {
            let (n, stride) = (layout.cells[c], layout.strides()[c]);
            for face in faces {
                let at = face.at as usize;
                let place = layout.cell_of(at)[c];
                let out = face.part * face.velocity_m_s;
                if place < n {
                    self.swell[at] -= out * liquid[at];
                }
                let below = match place {
                    0 if ghosts.is_periodic(c) => at + (n - 1) * stride,
                    0 => continue,
                    _ => at - stride,
                };
                self.swell[below] += out * liquid[below];
            }
        }
    }

    /// How fast walls displace liquid, in units of face area, by its density where that weighs.
    pub fn displaced_m_s(&self, density: Option<&Field>) -> f64 {
        if !self.is_moving {
            return 0.0;
        }
        let all = self.swell.iter().map(|swell| f64::from(swell.abs()));
        match density {
            Some(density) => all.zip(density.iter()).map(|(s, rho)| s * f64::from(*rho)).sum(),
            None => all.sum(),
        }
    }

    /// Sum over all cells of what their walls displace, times `weight`.
    pub fn displaced_by(&self, weight: &[f32]) -> f64 {
        if !self.is_moving {
            return 0.0;
        }
        let pairs = self.swell.iter().zip(weight);
        pairs.map(|(swell, weight)| f64::from(*swell) * f64::from(*weight)).sum()
    }

    /// Lets no pocket of liquid be asked for more than it has.
    pub fn balance(
        &mut self,
        balance: &mut Balance,
        layout: &Layout,
        ghosts: &Ghosts,
        faces: &Faces,
        velocity: &Vector,
    ) {
        balance.balance(layout, ghosts, faces, velocity, &self.covered, &mut self.swell);
    }

    /// Sets what moving solids do to the faces of liquid beside them; `wall(component, index,
    /// owner)` is the velocity of the solid at a face, and the share of its way that it has really
    /// come.
    pub fn set_beside(
        &mut self,
        layout: &Layout,
        walls: &WallFaces,
        wall: impl Fn(usize, usize, u32) -> (f32, f32),
    ) {
        for (c, planes) in self.beside.iter_mut().enumerate() {
            for (k, beside) in planes.iter_mut().enumerate() {
                beside.clear();
                if !self.is_moving {
                    continue;
                }
                let owned =
                    walls.in_plane(c, k).iter().filter_map(|face| Some((face, face.owner?)));
                beside.extend(owned.map(|(face, owner)| {
                    let at = face.at as usize;
                    let (wall_m_s, share) = wall(c, at, owner);
                    let swell = self.swell[at] + self.swell[at - layout.strides()[c]];
                    let per_inertia = face.per_inertia;
                    let pull = per_inertia * face.drag * wall_m_s;
                    Beside { at: face.at, wall_m_s, pull, swell: per_inertia * share * swell }
                }));
            }
        }
    }

    /// Gives the faces that are covered wholly the velocity of the solid.
    pub fn hold(&self, velocity: &mut Vector) {
        for (covered, u) in self.covered.iter().zip(velocity) {
            for face in covered.iter().filter(|face| face.is_closed) {
                u[face.at as usize] = face.velocity_m_s;
            }
        }
    }

    /// Adds what moving walls do to plane `k` of what was computed as if they rested.
    pub fn correct(&self, stage: Stage<'_>, k: usize, weights: Weights, out: [&mut [f32]; 3]) {
        for (c, out) in out.into_iter().enumerate() {
            for face in &self.beside[c][k] {
                let at = face.at as usize;
                out[at - (k + 1) * stage.layout.plane] += weights.viscous * face.pull
                    + weights.advection * face.swell * stage.velocity[c][at];
            }
        }
    }

    /// Adds the friction towards moving walls to a change of velocity, `number` = nu dt / h^2.
    pub fn pull(&self, change: &mut Vector, number: f32) {
        for (planes, change) in self.beside.iter().zip(change) {
            for face in planes.iter().flatten() {
                change[face.at as usize] += number * face.pull;
            }
        }
    }

    /// Calls `visit(component, index, wall's velocity)` for the faces of liquid beside moving
    /// walls.
    pub fn visit_beside(&self, mut visit: impl FnMut(usize, usize, f32)) {
        for (c, planes) in self.beside.iter().enumerate() {
            planes.iter().flatten().for_each(|face| visit(c, face.at as usize, face.wall_m_s));
        }
    }

    /// Adds what passes faces with the solids.
    pub fn add_fluxes(&self, layout: &Layout, ghosts: &Ghosts, fluxes: &mut Vector) {
        for (c, flux) in fluxes.iter_mut().enumerate() {
            for face in self.covered[c].iter().filter(|face| !face.is_side) {
                let at = face.at as usize;
                flux[at] += face.part * face.velocity_m_s;
                if ghosts.is_periodic(c) && layout.cell_of(at)[c] == 0 {
                    flux[at + layout.cells[c] * layout.strides()[c]] = flux[at];
                }
            }
        }
    }
}
