//! The weights of the friction, from what fills the cells.

use super::{Stress, from_axis};
use crate::solver::flow::{
    engine::Engine,
    faces::{VesselFaces, cells},
    field::{Field, Layout, components, cut, cut_mut},
    ghosts::Ghosts,
};

/// Below this part of the greatest, a viscosity is as good as none.
const LEAST_SHARE: f32 = 1e-12;

impl Stress {
    /// Takes the viscosity of all cells and, where that counts, their density, both with what
    /// lies beyond the sides; `per_area` is 1/h^2.
    pub fn set(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        viscosity_m2_s: &Field,
        density: Option<&Field>,
        per_area: f32,
    ) {
        self.set_cells(on, ghosts, viscosity_m2_s, density, per_area);
        self.set_edges(on, ghosts);
        self.set_inertia(on, ghosts, density);
        if let Some(vessel) = &on.faces.vessel {
            self.set_cut(on, vessel);
        }
        self.stiffness_per_s = self.stiffest(on);
    }

    fn set_cells(
        &mut self,
        on: Engine<'_>,
        ghosts: &Ghosts,
        viscosity_m2_s: &Field,
        density: Option<&Field>,
        per_area: f32,
    ) {
        let (layout, liquid) = (&self.layout, &*on.faces.liquid);
        on.pool.planes([layout.planes(&mut self.cell)], [layout.plane], |k, [out]| {
            let (at, len) = ((k + 1) * layout.plane, layout.plane);
            let (nu, liquid) = (cut(viscosity_m2_s, at, len), cut(liquid, at, len));
            let out = cut_mut(out, 0, len);
            on.simd.vectorize(
                #[inline(always)]
                || {
                    for i in 0..len {
                        out[i] = 2.0 * per_area * nu[i] * liquid[i];
                    }
                    if let Some(density) = density {
                        let density = cut(density, at, len);
                        (0..len).for_each(|i| out[i] *= density[i]);
                    }
                },
            );
        });
        let cell = &*self.cell;
        let most = on.pool.max(layout.cells[2], |k| {
            let plane = cut(cell, (k + 1) * layout.plane, layout.plane);
            f64::from(plane.iter().fold(0, |most, w| w.to_bits().max(most)))
        });
        let least = LEAST_SHARE * f32::from_bits(most as u32);
        on.pool.planes([layout.planes(&mut self.resistance)], [layout.plane], |k, [out]| {
            let (at, len) = ((k + 1) * layout.plane, layout.plane);
            let (cell, liquid) = (cut(cell, at, len), cut(liquid, at, len));
            let out = cut_mut(out, 0, len);
            on.simd.vectorize(
                #[inline(always)]
                || {
                    for i in 0..len {
                        let weight = if cell[i] > least { cell[i] } else { least };
                        out[i] = if liquid[i] > 0.0 { 2.0 / weight } else { 0.0 };
                    }
                },
            );
        });
        ghosts.wrap_cells(&mut self.cell);
        ghosts.wrap_cells(&mut self.resistance);
    }

    fn set_edges(&mut self, on: Engine<'_>, ghosts: &Ghosts) {
        let (layout, resistance, strides) =
            (&self.layout, &*self.resistance, self.layout.strides());
        for (axis, out) in self.edge.iter_mut().enumerate() {
            let [_, c, d] = from_axis(axis);
            // The upper edges of the last cells are in the plane beyond them.
            let outs = [&mut out[layout.plane..]];
            on.pool.planes(outs, [layout.plane], |k, [out]| {
                let (to, at) = (layout.row + 1, (k + 1) * layout.plane + layout.row + 1);
                let len = layout.plane - to;
                let out = cut_mut(out, to, len);
                let around = [at, at - strides[c], at - strides[d], at - strides[c] - strides[d]]
                    .map(|at| cut(resistance, at, len));
                on.simd.vectorize(
                    #[inline(always)]
                    || {
                        for i in 0..len {
                            let (mut count, mut sum) = (0.0, 0.0);
                            for resistance in around {
                                count += if resistance[i] > 0.0 { 1.0 } else { 0.0 };
                                sum += resistance[i];
                            }
                            out[i] = if count > 0.0 { count / sum } else { 0.0 };
                        }
                    },
                );
            });
        }
        // Nothing rubs against sides that the liquid slides along, or that it leaves through.
        for (side, end) in SIDES {
            if !ghosts.is_periodic(side) && !ghosts.holds(side, end) {
                let (layout, [_, c, d]) = (self.layout, from_axis(side));
                visit_side(&layout, side, end, |at| {
                    (self.edge[c][at], self.edge[d][at]) = (0.0, 0.0);
                });
            }
        }
    }

    /// Faces on the sides are set by them, and move with nothing of their own.
    fn set_inertia(&mut self, on: Engine<'_>, ghosts: &Ghosts, density: Option<&Field>) {
        let layout = &self.layout;
        for (c, out) in self.inertia.iter_mut().enumerate() {
            let open = &on.faces.open[c];
            on.pool.planes([layout.planes(out)], [layout.plane], |k, [out]| {
                let (at, len) = ((k + 1) * layout.plane, layout.plane);
                let (out, open) = (cut_mut(out, 0, len), cut(open, at, len));
                let density = density.map(|density| {
                    (cut(density, at - layout.strides()[c], len), cut(density, at, len))
                });
                on.simd.vectorize(
                    #[inline(always)]
                    || {
                        out.copy_from_slice(open);
                        if let Some((below, above)) = density {
                            (0..len).for_each(|i| out[i] *= 0.5 * (above[i] + below[i]));
                        }
                    },
                );
            });
            for end in 0..2 {
                if !ghosts.is_periodic(c) {
                    visit_side(layout, c, end, |at| out[at] = 0.0);
                }
            }
        }
        if let Some(vessel) = &on.faces.vessel {
            vessel.walls.weigh(&mut self.inertia, false);
        }
    }

    fn set_cut(&mut self, on: Engine<'_>, vessel: &VesselFaces) {
        let (layout, Some(weights)) = (&self.layout, &mut self.cut) else { return };
        let (strides, area) = (layout.strides(), components(&vessel.area));
        let both = |a: f32, b: f32| if a > 0.0 && b > 0.0 { 0.5 * (a + b) } else { 0.0 };
        let [nx, ny, nz] = layout.cells;
        for (c, out) in weights.cell.iter_mut().enumerate() {
            for (i, j, k) in cells(layout.cells.map(|n| n + 1)) {
                let at = layout.index(i, j, k) - strides[c];
                out[at] = self.cell[at] * both(area[c][at], area[c][at + strides[c]]);
            }
        }
        for axis in 0..3 {
            let [_, c, d] = from_axis(axis);
            for (i, j, k) in cells([nx + 1, ny + 1, nz + 1]) {
                let at = layout.index(i, j, k);
                let edge = &mut self.edge[axis][at];
                // Between the two faces of one component is the mean of the other's two.
                let between = |own: usize, other: usize| {
                    let is_open = area[own][at] > 0.0 && area[own][at - strides[other]] > 0.0;
                    let mean = 0.5 * (area[other][at] + area[other][at - strides[own]]);
                    if is_open { mean } else { 0.0 }
                };
                let shares = [between(c, d), between(d, c)];
                for (along, share) in weights.along[axis].iter_mut().zip(shares) {
                    along[at] = *edge * share;
                }
                *edge *= shares[0].min(shares[1]);
            }
        }
        for (c, out) in weights.drag.iter_mut().enumerate() {
            out.fill(0.0);
            vessel.walls.visit_drag(c, |at, drag| {
                let (a, b) = (self.cell[at], self.cell[at - strides[c]]);
                let is_between = on.faces.liquid[at] * on.faces.liquid[at - strides[c]] > 0.0;
                let harmonic = a * b / (a + b).max(f32::MIN_POSITIVE);
                out[at] = drag * if is_between { harmonic } else { 0.5 * a.max(b) };
            });
        }
    }
}

/// The axis and the end of all sides.
const SIDES: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)];

/// Calls `visit(index)` for what lies on a side, and at its upper ends.
fn visit_side(layout: &Layout, side: usize, end: usize, mut visit: impl FnMut(usize)) {
    let [_, c, d] = from_axis(side);
    let (n, strides) = (layout.cells, layout.strides());
    let first = layout.index(0, 0, 0) + end * n[side] * strides[side];
    for j in 0..=n[d] {
        for i in 0..=n[c] {
            visit(first + i * strides[c] + j * strides[d]);
        }
    }
}
