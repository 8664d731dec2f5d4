//! What pulls at liquid that is not the same everywhere.
//!
//! Gravity at a face of component c is
//! ```text
//! g_c (rho_f - rho_level) / rho_0         where differences are small,
//! g_c (rho_f - rho_level) / rho_f         where densities weigh
//! ```
//! rho_level being the least rho_f at the same height: what depends on the height alone is the
//! gradient of a pressure, and liquid in level layers stays at rest to the last bit.

use glam::DVec3;

use crate::solver::flow::{
    Force,
    density::Density,
    engine::Engine,
    faces::{Faces, cells},
    field::{Field, Layout, Run, Vector, components, cut, cut_mut},
    openings,
    thick::Thick,
};

/// Liquid that is not the same everywhere. Arrays are padded; densities are per that of the flow.
pub struct Mixture {
    /// Density of each cell, and beyond the sides as next to them.
    pub density: Field,
    /// Kinematic viscosity of each cell.
    pub viscosity_m2_s: Field,
    /// What gravity does at open faces.
    pub buoyancy_m_s2: Vector,
    /// Density of what floats at each level along each axis; infinite where nothing is open.
    floating: [Vec<f32>; 3],
    /// Largest of what gravity does.
    pub largest_m_s2: f64,
    /// All that accelerates a stage.
    pub total_m_s2: Vector,
    /// The friction of viscosities that differ; as it was when they last did.
    pub thick: Option<Thick>,
    pub is_thick_somewhere: bool,
    /// True if the friction is still that of other liquid or faces: the next step sets it.
    pub is_friction_due: bool,
    /// What densities weigh that differ too much for gravity alone, and no pressure.
    pub weight: Option<(Density, Field)>,
    pub is_weighty: bool,
}

/// What pulls at a mixture besides gravity.
#[derive(Clone, Copy)]
pub struct Pull<'a> {
    /// Scale of the force.
    pub scale: f64,
    /// The velocity whose friction is part of it, where that differs from place to place.
    pub slowed: Option<[&'a [f32]; 3]>,
    /// The pressure whose gradient is part of it, where densities weigh.
    pub pressure: Option<&'a Field>,
}

impl Pull<'_> {
    /// The force alone.
    pub fn of(scale: f64) -> Self {
        Self { scale, slowed: None, pressure: None }
    }
}

/// What a stage takes.
pub struct Accelerating<'a> {
    /// Acceleration to add.
    pub force: Option<[&'a [f32]; 3]>,
    /// What stands for the pressure, if that is in the acceleration: zeros.
    pub pressure: Option<&'a Field>,
    /// What else a mixture is.
    pub unlike: Unlike<'a>,
}

/// What is not the same everywhere, where that counts for more than gravity.
#[derive(Clone, Copy, Default)]
pub struct Unlike<'a> {
    /// Density of cells, per that of the flow, if it weighs.
    pub density: Option<&'a Field>,
    /// Friction that differs from place to place.
    pub friction: Option<&'a Thick>,
}

impl Unlike<'_> {
    /// Density of the liquid at a face, per that of the flow.
    pub fn density_at(&self, layout: &Layout, c: usize, at: usize) -> f64 {
        self.density.map_or(1.0, |density| {
            0.5 * (f64::from(density[at]) + f64::from(density[at - layout.strides()[c]]))
        })
    }
}

impl Mixture {
    pub fn new(layout: &Layout) -> Self {
        let vector = || [layout.zeros(), layout.zeros(), layout.zeros()];
        Self {
            density: layout.zeros(),
            viscosity_m2_s: layout.zeros(),
            buoyancy_m_s2: vector(),
            floating: layout.cells.map(|n| vec![f32::INFINITY; n]),
            largest_m_s2: 0.0,
            total_m_s2: vector(),
            thick: None,
            is_thick_somewhere: false,
            is_friction_due: false,
            weight: None,
            is_weighty: false,
        }
    }

    /// Makes anew what it has been made for other faces.
    pub fn remake(&mut self, layout: &Layout, faces: &Faces) {
        if let Some((density, _)) = &mut self.weight {
            *density = Density::new(layout, faces);
        }
        if let Some(thick) = &mut self.thick {
            *thick = Thick::new(layout, faces);
        }
    }

    /// What it is like where it is not as the flow says.
    pub fn unlike(&self) -> Unlike<'_> {
        Unlike {
            density: self.is_weighty.then_some(&self.density),
            friction: self.thick.as_ref().filter(|_| self.is_thick_somewhere),
        }
    }

    /// Density of what floats at the level of a face, per that of the flow; `None` where nothing
    /// does.
    pub fn floating(&self, c: usize, level: usize) -> Option<f32> {
        self.floating[c].get(level).copied().filter(|density| density.is_finite())
    }

    /// What densities weigh, if they differ too much for gravity alone.
    pub fn weight(&self) -> Option<&Density> {
        self.weight.as_ref().filter(|_| self.is_weighty).map(|(density, _)| density)
    }

    /// The friction, if the viscosity differs from place to place.
    pub fn thick_somewhere(&mut self) -> Option<&mut Thick> {
        self.thick.as_mut().filter(|_| self.is_thick_somewhere)
    }

    /// No friction that differs from place to place is faster than this; `None` if none does.
    pub fn stiffness_per_s(&self) -> Option<f64> {
        let thick = self.thick.as_ref().filter(|_| self.is_thick_somewhere);
        thick.map(|thick| thick.stress.stiffness_per_s)
    }

    /// Sets what gravity does to it.
    ///
    /// Where it weighs, by what is denser of the liquid and what floats in it, so that nothing
    /// falls or rises faster than freely.
    /// What is as dense as `beyond` floats, or, where that is not said, the lightest of each level
    /// does: in a closed box the pressure makes up for either, and this one leaves layers at rest.
    pub fn set_buoyancy(
        &mut self,
        layout: &Layout,
        faces: &Faces,
        gravity_m_s2: DVec3,
        beyond: Option<f32>,
    ) {
        self.largest_m_s2 = 0.0;
        for c in 0..3 {
            let (out, gravity) = (&mut self.buoyancy_m_s2[c], gravity_m_s2[c] as f32);
            let floating = &mut self.floating[c];
            out.fill(0.0);
            floating.fill(f32::INFINITY);
            if gravity == 0.0 {
                continue;
            }
            let (stride, density, open) = (layout.strides()[c], &*self.density, &*faces.open[c]);
            let mean = |at: usize| 0.5 * (density[at] + density[at - stride]);
            let open_faces = || {
                let all = cells(layout.cells).map(|(i, j, k)| ([i, j, k], layout.index(i, j, k)));
                all.filter(|(_, at)| open[*at] > 0.0)
            };
            if let Some(density) = beyond {
                floating.fill(density);
            } else {
                for (face, at) in open_faces() {
                    floating[face[c]] = floating[face[c]].min(mean(at));
                }
            }
            for (face, at) in open_faces() {
                let weight = if self.is_weighty { mean(at).max(floating[face[c]]) } else { 1.0 };
                out[at] = gravity * (mean(at) - floating[face[c]]) / weight;
                self.largest_m_s2 = self.largest_m_s2.max(f64::from(out[at].abs()));
            }
        }
        openings::extend_above(layout, faces, &mut self.buoyancy_m_s2);
    }

    /// Sums up what accelerates the liquid besides its own flow, if that is more than gravity.
    pub fn drive(
        &mut self,
        on: Engine<'_>,
        layout: &Layout,
        force: Option<&Force>,
        Pull { scale, slowed, pressure }: Pull<'_>,
    ) {
        let (slowed, is_weighty) = (slowed.filter(|_| self.is_thick_somewhere), self.is_weighty);
        if force.is_none() && !is_weighty && !self.is_thick_somewhere {
            return;
        }
        self.sum_up(on, layout, force, scale);
        if let (Some(velocity), Some(thick)) = (slowed, &mut self.thick) {
            thick.slow(on, velocity, &mut self.total_m_s2);
            // Friction knows of no face on a side.
            openings::extend(layout, on.faces, &mut self.total_m_s2);
        } else {
            openings::extend_above(layout, on.faces, &mut self.total_m_s2);
        }
        if let (Some(pressure), Some((density, _)), true) = (pressure, &self.weight, is_weighty) {
            density.press(on, layout, pressure, 1.0, &mut self.total_m_s2);
        }
    }

    fn sum_up(&mut self, on: Engine<'_>, layout: &Layout, force: Option<&Force>, scale: f64) {
        let Some(force) = force else {
            for (total, buoyancy) in self.total_m_s2.iter_mut().zip(&self.buoyancy_m_s2) {
                total.copy_from_slice(buoyancy);
            }
            return;
        };
        let outs = self.total_m_s2.each_mut().map(|out| layout.planes(out));
        let (scale, buoyancy) = (scale as f32, &self.buoyancy_m_s2);
        on.pool.planes(outs, [layout.plane; 3], |k, outs| {
            on.run(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    for (c, out) in outs.into_iter().enumerate() {
                        let out = cut_mut(out, to, len);
                        let force = cut(&force.acceleration_m_s2[c], at, len);
                        let buoyancy = cut(&buoyancy[c], at, len);
                        for i in 0..len {
                            out[i] = scale * force[i] + buoyancy[i];
                        }
                    }
                },
            );
        });
    }

    /// What [`Mixture::drive`] has found last.
    pub fn driven(&self, force: Option<&Force>) -> [&[f32]; 3] {
        components(if force.is_some() { &self.total_m_s2 } else { &self.buoyancy_m_s2 })
    }
}

/// What accelerates a stage: of a mixture all there is, else the force without its scale.
pub fn accelerating<'a>(
    on: Engine<'_>,
    layout: &Layout,
    force: &'a Option<Force>,
    mixture: &'a mut Option<Box<Mixture>>,
    pull: Pull<'_>,
) -> Accelerating<'a> {
    match mixture {
        Some(mixture) => {
            mixture.drive(on, layout, force.as_ref(), pull);
            let mixture = &**mixture;
            let is_summed = force.is_some() || mixture.is_weighty || mixture.is_thick_somewhere;
            let pressure = mixture.weight.as_ref().filter(|_| mixture.is_weighty);
            let total = if is_summed { &mixture.total_m_s2 } else { &mixture.buoyancy_m_s2 };
            Accelerating {
                force: Some(components(total)),
                pressure: pressure.map(|(_, none)| none),
                unlike: mixture.unlike(),
            }
        }
        None => {
            let force = force.as_ref().map(|force| components(&force.acceleration_m_s2));
            Accelerating { force, pressure: None, unlike: Unlike::default() }
        }
    }
}

/// What works on the flow, for the books of its energy: by one of force, or all there is.
pub fn working<'a>(
    force: Option<&'a Force>,
    mixture: Option<&'a Mixture>,
) -> Option<[&'a [f32]; 3]> {
    let alone = || force.map(|force| components(&force.acceleration_m_s2));
    mixture.map(|mixture| mixture.driven(force)).or_else(alone)
}

/// What is not the same everywhere in a liquid, if anything is.
pub fn unlike_in(mixture: Option<&Mixture>) -> Unlike<'_> {
    mixture.map(Mixture::unlike).unwrap_or_default()
}
