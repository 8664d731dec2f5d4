//! Carrying across very many cells at once.
//!
//! Axis by axis, the volume that passes a face within the part tells where upstream the liquid
//! that ends at that face came from. What lay between those places, for the two faces of a cell, is
//! what the cell holds afterwards (flux-form semi-Lagrangian, after Lin, Rood 1996, at first
//! order). The places are kept in order and between the walls of their line, so that every
//! bit of liquid is taken exactly once: nothing is lost and nothing is negative, however fast and
//! rough the flow. Volumes are carried along as in the sweeps.

use crate::solver::flow::{engine::Engine, field::Layout};

/// One remap of a fraction.
#[derive(Clone, Copy)]
pub struct Remap<'a> {
    /// How the arrays lie.
    pub layout: &'a Layout,
    /// On the faces.
    pub velocity: [&'a [f32]; 3],
    /// dt / h of the part.
    pub dt_per_spacing_s_m: f64,
}

impl Remap<'_> {
    /// Carries `fraction`; `volume` and `work` are overwritten, all are padded arrays. Fractions
    /// may exceed 1 afterwards, where more came together than there is room for.
    pub fn carry(&self, on: Engine<'_>, arrays: [&mut [f32]; 3], reverse: bool) {
        let [fraction, volume, work] = arrays;
        volume.fill(1.0);
        for axis in if reverse { [2, 1, 0] } else { [0, 1, 2] } {
            let layout = self.layout;
            if axis == 2 {
                // Lines across planes cannot be dealt out: this rare case has one thread.
                self.axis(
                    2,
                    layout.index(0, 0, 0),
                    layout.index(0, 0, 0),
                    [&mut *fraction, &mut *volume, &mut *work],
                );
                continue;
            }
            let outs = [&mut *fraction, &mut *volume, &mut *work].map(|field| layout.planes(field));
            on.pool.planes(outs, [layout.plane; 3], |k, planes| {
                self.axis(axis, layout.index_in_plane(0, 0), layout.index(0, 0, k), planes);
            });
        }
    }

    /// All lines along `axis` of a plane, or of the whole for the third. The first cell is at
    /// `to`, its velocity at `at`.
    fn axis(&self, axis: usize, to: usize, at: usize, [fraction, volume, work]: [&mut [f32]; 3]) {
        let ([nx, ny, _], [sx, sy, _]) = (self.layout.cells, self.layout.strides());
        let sides = [[(1, sx), (ny, sy)], [(nx, sx), (1, sy)], [(nx, sx), (ny, sy)]][axis];
        let line = Line {
            n: self.layout.cells[axis],
            stride: self.layout.strides()[axis],
            scale: self.dt_per_spacing_s_m,
        };
        for j in 0..sides[1].0 {
            for i in 0..sides[0].0 {
                let shift = i * sides[0].1 + j * sides[1].1;
                let velocity = &self.velocity[axis][at + shift..];
                line.remap(
                    [&mut fraction[to + shift..], &mut volume[to + shift..]],
                    velocity,
                    work,
                );
            }
        }
    }
}

/// A line of cells, each `stride` from the next.
struct Line {
    n: usize,
    stride: usize,
    scale: f64,
}

impl Line {
    fn remap(&self, [content, volume]: [&mut [f32]; 2], velocity: &[f32], work: &mut [f32]) {
        let (old_content, old_volume) = work.split_at_mut(self.n);
        for p in 0..self.n {
            old_content[p] = content[p * self.stride];
            old_volume[p] = volume[p * self.stride];
        }
        let passes = |face: usize| f64::from(velocity[face * self.stride]) * self.scale;
        let is_wall = |face: usize| face == 0 || face == self.n || passes(face) == 0.0;
        let mut start = 0;
        for end in (1..=self.n).filter(|face| is_wall(*face)) {
            let total: f64 = old_volume[start..end].iter().map(|v| f64::from(*v)).sum();
            let mut donor = Donor { place: 0.0, next: start, left: 0.0, fraction: 0.0 };
            let mut reached = 0.0;
            for p in start..end {
                reached += f64::from(old_volume[p]);
                let is_last = p + 1 == end;
                let upto = if is_last { total } else { reached - passes(p + 1) };
                let before = donor.place;
                let taken = donor.take_upto(
                    upto.clamp(before, total.max(before)),
                    if is_last { Some(end) } else { None },
                    [&old_content[..end], &old_volume[..end]],
                );
                content[p * self.stride] = taken as f32;
                volume[p * self.stride] = (donor.place - before) as f32;
            }
            start = end;
        }
    }
}

/// Where in a line is taken from.
struct Donor {
    /// Volume from the wall.
    place: f64,
    /// The cell after the one that is being taken from, and what is left of that.
    next: usize,
    left: f64,
    fraction: f64,
}

impl Donor {
    /// Takes the content up to `place`; everything to the cell `all`, if it is given.
    fn take_upto(&mut self, place: f64, all: Option<usize>, [content, volume]: [&[f32]; 2]) -> f64 {
        let mut taken = 0.0;
        let wanted = place - self.place;
        let mut rest = wanted;
        while rest >= self.left || all.is_some() {
            taken += self.left * self.fraction;
            rest -= self.left;
            self.left = 0.0;
            if self.next == content.len() {
                break;
            }
            let (held, size) = (f64::from(content[self.next]), f64::from(volume[self.next]));
            (self.left, self.fraction) = (size, if size > 0.0 { held / size } else { 0.0 });
            self.next += 1;
        }
        if self.left > 0.0 {
            taken += rest * self.fraction;
            self.left -= rest;
        }
        self.place = place;
        taken
    }
}
