//! Liquid whose density differs by more than gravity alone can stand for.
//!
//! ```text
//! rho_f du/dt = -grad p + ...,   div (1/rho_f) grad p = div u* / dt
//! ```
//! rho_f being the mean of the cells on both sides of a face. Pressures are per density of the
//! flow.

use crate::solver::flow::{
    engine::Engine,
    faces::Faces,
    field::{FaceRuns, Field, Layout, Run, Vector, components, cut, cut_mut},
    ghosts::Ghosts,
    inventory::bytes,
    openings::visit_unreached,
};

/// What density makes of faces and cells, all per density of the flow.
pub struct Density {
    /// Mass of the liquid that has the velocity of a face: its open part times density.
    pub mass: Vector,
    /// Inverse density of open faces, 0 elsewhere: what a gradient does to their velocity.
    pub lightness: Vector,
    /// The same by their open parts; `None` in a box, where it is the same.
    through: Option<Vector>,
    /// Sum of that over the faces of each liquid cell.
    pub through_cell: Field,
    /// Square root of the density of each liquid cell.
    pub root: Field,
}

impl Density {
    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        let fields = self.mass.iter().chain(&self.lightness).chain(self.through.iter().flatten());
        bytes(fields.chain([&self.through_cell, &self.root]))
    }

    /// For the liquid in these faces.
    pub fn new(layout: &Layout, faces: &Faces) -> Self {
        let vector = || [layout.zeros(), layout.zeros(), layout.zeros()];
        Self {
            mass: vector(),
            lightness: vector(),
            through: faces.vessel.as_ref().map(|_| vector()),
            through_cell: layout.zeros(),
            root: layout.zeros(),
        }
    }

    /// Takes the density of all cells, with what lies beyond the sides.
    pub fn set(&mut self, on: Engine<'_>, layout: &Layout, ghosts: &Ghosts, density: &Field) {
        for c in 0..3 {
            let area = on.faces.vessel.as_ref().map(|vessel| &*vessel.area[c]);
            let (open, stride) = (&*on.faces.open[c], layout.strides()[c]);
            // Beyond the last plane, too: a side may be open there.
            let outs = [&mut self.mass[c][layout.plane..], &mut self.lightness[c][layout.plane..]];
            on.pool.planes(outs, [layout.plane; 2], |k, [mass, lightness]| {
                let (at, len) = ((k + 1) * layout.plane, layout.plane);
                let (mass, lightness) = (cut_mut(mass, 0, len), cut_mut(lightness, 0, len));
                let (here, below) = (cut(density, at, len), cut(density, at - stride, len));
                let (open, area) = (cut(open, at, len), cut(area.unwrap_or(open), at, len));
                on.simd.vectorize(
                    #[inline(always)]
                    || {
                        for i in 0..len {
                            let mean = 0.5 * (here[i] + below[i]);
                            mass[i] = area[i] * mean;
                            lightness[i] = if open[i] > 0.0 { 1.0 / mean } else { 0.0 };
                        }
                    },
                );
            });
            ghosts.wrap_cells(&mut self.lightness[c]);
            if let (Some(through), Some(area)) = (&mut self.through, area) {
                let pairs = self.lightness[c].iter().zip(area);
                through[c]
                    .iter_mut()
                    .zip(pairs)
                    .for_each(|(out, (light, area))| *out = light * area);
            }
        }
        let Self { lightness, through, through_cell, root, .. } = self;
        let through = through.as_ref().unwrap_or(lightness);
        let outs = [layout.planes(through_cell), layout.planes(root)];
        on.pool.planes(outs, [layout.plane; 2], |k, [sum, root]| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    let (sum, root) = (cut_mut(sum, to, len), cut_mut(root, to, len));
                    let liquid = cut(&on.faces.liquid, at, len);
                    let FaceRuns { x, y, z } = FaceRuns::new(layout, components(through), at, len);
                    let density = cut(density, at, len);
                    for i in 0..len {
                        let all = (x.0[i] + x.1[i]) + (y.0[i] + y.1[i]) + (z.0[i] + z.1[i]);
                        sum[i] = liquid[i] * all;
                        root[i] = liquid[i] * density[i].sqrt();
                    }
                },
            );
        });
    }

    /// out -= share grad p / rho at open faces.
    pub fn press(
        &self,
        on: Engine<'_>,
        layout: &Layout,
        pressure: &Field,
        share: f32,
        out: &mut Vector,
    ) {
        let outs = out.each_mut().map(|out| layout.planes(out));
        on.pool.planes(outs, [layout.plane; 3], |k, outs| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    for (c, out) in outs.into_iter().enumerate() {
                        let out = cut_mut(out, to, len);
                        let lightness = cut(&self.lightness[c], at, len);
                        let above = cut(pressure, at, len);
                        let below = cut(pressure, at - layout.strides()[c], len);
                        for i in 0..len {
                            out[i] -= share * lightness[i] * (above[i] - below[i]);
                        }
                    }
                },
            );
        });
        visit_unreached(layout, on.faces, |c, at| {
            out[c][at] += share * self.lightness[c][at] * pressure[at - layout.strides()[c]];
        });
    }

    /// What passes a face for a difference of pressure.
    pub fn through(&self) -> &Vector {
        self.through.as_ref().unwrap_or(&self.lightness)
    }
}
