//! What the liquid is made of, cell by cell.
//!
//! Small differences of density act through gravity alone (Boussinesq 1903):
//! ```text
//! du/dt = ... + g (rho - rho_level) / rho_0
//! ```
//! rho_level being the least density at the same height: what depends on the height alone is the
//! gradient of a pressure, and liquid in level layers stays at rest to the last bit.

use glam::{DVec3, Vec3};

use crate::{
    solver::{
        Refused,
        flow::{
            Flow, Force, MAX_ACCELERATION_M_S2,
            density::Density,
            engine::Engine,
            faces::cells,
            field::{Field, Layout, Run, Vector, components, cut, cut_mut},
            thick::Thick,
        },
        within,
    },
    substance::{Properties, Substances},
};

/// Difference of density from the setup's, as a part of it, that acts through gravity alone.
const BOUSSINESQ: f64 = 0.1;

/// What is lighter than this part of the densest counts as that.
const LEAST_SHARE: f32 = 1e-3;

/// Viscosities that differ by less than this part of the greatest are alike ...
const ALIKE: f32 = 2e-3;

/// ... and below this they are none.
const LEAST_VISCOSITY_M2_S: f32 = 1e-30;

/// What a liquid is like at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Density.
    pub density_kg_m3: f64,
    /// Kinematic viscosity.
    pub viscosity_m2_s: f64,
}

impl Medium {
    /// # Errors
    /// [`Refused`] if a value is not finite or out of range.
    fn check(self) -> Result<Self, Refused> {
        for (what, value, least) in [
            ("density_kg_m3", self.density_kg_m3, f64::MIN_POSITIVE),
            ("viscosity_m2_s", self.viscosity_m2_s, 0.0),
        ] {
            let sound = if value < least { f64::NAN } else { value };
            within(what, sound, 1e6).map_err(|refused| Refused { value, ..refused })?;
        }
        Ok(self)
    }
}

/// Liquid that is not the same everywhere. Arrays are padded; densities are per that of the flow.
pub(super) struct Mixture {
    /// Density of each cell, and beyond the sides as next to them.
    pub(super) density: Field,
    /// Kinematic viscosity of each cell.
    pub(super) viscosity_m2_s: Field,
    /// What gravity does at open faces.
    pub(super) buoyancy_m_s2: Vector,
    /// Least density at each level along one axis.
    lightest: Vec<f32>,
    /// Largest of what gravity does.
    pub(super) largest_m_s2: f64,
    /// All that accelerates a stage.
    pub(super) total_m_s2: Vector,
    /// The friction of viscosities that differ; as it was when they last did.
    pub(super) thick: Option<Thick>,
    is_thick_somewhere: bool,
    /// What densities weigh that differ too much for gravity alone, and no pressure.
    pub(super) weight: Option<(Density, Field)>,
    is_weighty: bool,
}

/// What pulls at a mixture besides gravity.
#[derive(Clone, Copy)]
pub(super) struct Pull<'a> {
    /// Scale of the force.
    pub(super) scale: f64,
    /// The velocity whose friction is part of it, where that differs from place to place.
    pub(super) slowed: Option<[&'a [f32]; 3]>,
    /// The pressure whose gradient is part of it, where densities weigh.
    pub(super) pressure: Option<&'a Field>,
}

impl Pull<'_> {
    /// The force alone.
    pub(super) fn of(scale: f64) -> Self {
        Self { scale, slowed: None, pressure: None }
    }
}

/// What a stage takes.
pub(super) struct Accelerating<'a> {
    /// Acceleration to add.
    pub(super) force: Option<[&'a [f32]; 3]>,
    /// What stands for the pressure, if that is in the acceleration: zeros.
    pub(super) pressure: Option<&'a Field>,
}

/// Least and most over the liquid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    least: f32,
    most: f32,
}

impl Mixture {
    fn new(layout: &Layout) -> Self {
        let vector = || [layout.zeros(), layout.zeros(), layout.zeros()];
        Self {
            density: layout.zeros(),
            viscosity_m2_s: layout.zeros(),
            buoyancy_m_s2: vector(),
            lightest: vec![0.0; layout.cells.into_iter().max().unwrap_or(0)],
            largest_m_s2: 0.0,
            total_m_s2: vector(),
            thick: None,
            is_thick_somewhere: false,
            weight: None,
            is_weighty: false,
        }
    }

    /// What densities weigh, if they differ too much for gravity alone.
    pub(super) fn weight(&self) -> Option<&Density> {
        self.weight.as_ref().filter(|_| self.is_weighty).map(|(density, _)| density)
    }

    /// The friction, if the viscosity differs from place to place.
    pub(super) fn thick(&mut self) -> Option<&mut Thick> {
        self.thick.as_mut().filter(|_| self.is_thick_somewhere)
    }

    /// No friction that differs from place to place is faster than this; `None` if none does.
    pub(super) fn stiffness_per_s(&self) -> Option<f64> {
        let thick = self.thick.as_ref().filter(|_| self.is_thick_somewhere);
        thick.map(|thick| thick.stress.stiffness_per_s)
    }

    /// Sets what gravity does to it.
    fn set_buoyancy(&mut self, layout: &Layout, open: &Vector, gravity_m_s2: DVec3) {
        self.largest_m_s2 = 0.0;
        for c in 0..3 {
            let (out, gravity) = (&mut self.buoyancy_m_s2[c], gravity_m_s2[c] as f32);
            if gravity == 0.0 {
                out.fill(0.0);
                continue;
            }
            let (stride, density, open) = (layout.strides()[c], &*self.density, &*open[c]);
            let mean = |at: usize| 0.5 * (density[at] + density[at - stride]);
            let lightest = &mut self.lightest[..layout.cells[c]];
            lightest.fill(f32::INFINITY);
            let faces = || {
                let all = cells(layout.cells).map(|(i, j, k)| ([i, j, k], layout.index(i, j, k)));
                all.filter(|(_, at)| open[*at] > 0.0)
            };
            for (face, at) in faces() {
                lightest[face[c]] = lightest[face[c]].min(mean(at));
            }
            for (face, at) in faces() {
                let weighs = if self.is_weighty { mean(at) } else { 1.0 };
                out[at] = gravity * (mean(at) - lightest[face[c]]) / weighs;
                self.largest_m_s2 = self.largest_m_s2.max(f64::from(out[at].abs()));
            }
        }
    }

    /// Sums up what accelerates the liquid besides its own flow, if that is more than gravity.
    pub(super) fn drive(
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
        if let (Some(pressure), Some((density, _)), true) = (pressure, &self.weight, is_weighty) {
            density.press(on, layout, pressure, 1.0, &mut self.total_m_s2);
        }
        if let (Some(velocity), Some(thick)) = (slowed, &mut self.thick) {
            thick.slow(on, velocity, &mut self.total_m_s2);
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
    pub(super) fn driven(&self, force: Option<&Force>) -> [&[f32]; 3] {
        components(if force.is_some() { &self.total_m_s2 } else { &self.buoyancy_m_s2 })
    }
}

/// What accelerates a stage: of a mixture all there is, else the force without its scale.
pub(super) fn accelerating<'a>(
    on: Engine<'_>,
    layout: &Layout,
    force: &'a Option<Force>,
    mixture: &'a mut Option<Box<Mixture>>,
    pull: Pull<'_>,
) -> Accelerating<'a> {
    match mixture {
        Some(mixture) => {
            mixture.drive(on, layout, force.as_ref(), pull);
            let is_summed = force.is_some() || mixture.is_weighty || mixture.is_thick_somewhere;
            let pressure = mixture.weight.as_ref().filter(|_| mixture.is_weighty);
            let total = if is_summed { &mixture.total_m_s2 } else { &mixture.buoyancy_m_s2 };
            Accelerating {
                force: Some(components(total)),
                pressure: pressure.map(|(_, none)| none),
            }
        }
        None => {
            let force = force.as_ref().map(|force| components(&force.acceleration_m_s2));
            Accelerating { force, pressure: None }
        }
    }
}

/// What works on the flow, for the books of its energy: by one of force, or all there is.
pub(super) fn working<'a>(
    force: Option<&'a Force>,
    mixture: Option<&'a Mixture>,
) -> Option<[&'a [f32]; 3]> {
    let alone = || force.map(|force| components(&force.acceleration_m_s2));
    mixture.map(|mixture| mixture.driven(force)).or_else(alone)
}

/// Accepts a gravity.
pub(super) fn sound_gravity(gravity_m_s2: Vec3) -> Result<DVec3, Refused> {
    for value in gravity_m_s2.to_array() {
        within("gravity_m_s2", f64::from(value), MAX_ACCELERATION_M_S2)?;
    }
    Ok(gravity_m_s2.as_dvec3())
}

impl Flow {
    /// Prepares what works on a mixture in the whole step, for the books of its energy.
    pub(super) fn set_drive(&mut self) {
        let scale = 0.5 * (self.force_scale[0] + self.force_scale[1]);
        let Self { layout, faces, pool, simd, force, mixture, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        if let (Some(mixture), Some(force)) = (mixture, force) {
            mixture.drive(on, layout, Some(force), Pull::of(scale));
        }
    }

    /// Says what the liquid is made of, from the next step on: `medium` is sampled at the centres of
    /// the cells. Where densities differ by at most a tenth from [`crate::solver::Setup`]'s they
    /// act through its gravity alone (Boussinesq 1903); beyond, they weigh in the pressure, too, and
    /// what is lighter than a thousandth of the densest counts as that. Viscosities that differ
    /// are solved for as stresses. A medium that is the same everywhere costs nothing.
    ///
    /// # Errors
    /// [`Refused`] if a density is not above 0, a viscosity negative, or either not finite or above
    /// 10^6; nothing is changed then.
    pub fn set_medium(&mut self, medium: &dyn Fn(DVec3) -> Medium) -> Result<(), Refused> {
        let (mut density, mut viscosity_m2_s) = (self.layout.zeros(), self.layout.zeros());
        for (i, j, k) in cells(self.layout.cells) {
            let centre = self.grid.centre_in_world_m(i, j, k).as_dvec3();
            let found = medium(centre).check()?;
            let at = self.layout.index(i, j, k);
            density[at] = found.density_kg_m3 as f32;
            viscosity_m2_s[at] = found.viscosity_m2_s as f32;
        }
        let mixture = self.take_mixture();
        self.settle_medium(Box::new(Mixture { density, viscosity_m2_s, ..*mixture }));
        Ok(())
    }

    /// Changes gravity from the next step on.
    ///
    /// # Errors
    /// [`Refused`] if it is not finite or above 10^6 m/s^2; it is unchanged then.
    pub fn set_gravity_m_s2(&mut self, gravity_m_s2: Vec3) -> Result<(), Refused> {
        self.gravity_m_s2 = sound_gravity(gravity_m_s2)?;
        if let Some(mixture) = &mut self.mixture {
            mixture.set_buoyancy(&self.layout, &self.faces.open, self.gravity_m_s2);
        }
        self.survey = None;
        Ok(())
    }

    /// Says that the liquid is made of what is dissolved in it: call it before each step that
    /// follows one of the substances. Densities mix by volume, dynamic viscosities as
    /// [`crate::substance::mixture`] says. As long as all substances are like the liquid, or on another
    /// grid, nothing is changed or computed.
    ///
    /// Where a difference of densities is carried along, so is the energy of what moves: what an
    /// exchange of heavy for light liquid adds to it counts as made from nothing, until the next
    /// step has taken as much.
    pub fn set_mixture(&mut self, substances: &Substances) {
        let is_one = self.mixture.is_none() && !substances.differ_from(&self.liquid());
        if is_one || !substances.are_on(&self.layout) {
            return;
        }
        let cell_mass_kg = self.cell_mass_kg();
        let before_j = self.surveyed().energy_m2_s2 * cell_mass_kg;
        let mut mixture = self.take_mixture();
        substances.mixture_density_kg_m3(&self.liquid(), &mut mixture.density);
        substances.mixture_viscosity_m2_s(&self.liquid(), &mut mixture.viscosity_m2_s);
        self.settle_medium(mixture);
        self.set_drive();
        let after = self.surveyed();
        self.survey = Some(after);
        let gained_j = after.energy_m2_s2 * self.cell_mass_kg() - before_j;
        self.excess_m2_s2 = (self.excess_m2_s2 * cell_mass_kg + gained_j) / self.cell_mass_kg();
    }

    fn liquid(&self) -> Properties {
        Properties {
            density_kg_m3: self.pure.density_kg_m3 as f32,
            viscosity_m2_s: self.pure.viscosity_m2_s as f32,
            diffusivity_m2_s: 0.0,
        }
    }

    /// Makes room for all that these substances can make of the liquid, so that no step has to.
    pub(crate) fn make_room_for(&mut self, substances: &Substances) {
        let liquid = self.liquid();
        if !substances.may_differ_from(&liquid) || self.mixture.is_some() {
            return;
        }
        let mut mixture = self.take_mixture();
        if substances.densities().any(|density| self.is_weighty(density)) {
            self.projection.make_room();
            mixture.weight = Some((Density::new(&self.layout, &self.faces), self.layout.zeros()));
        }
        mixture.thick = Some(Thick::new(&self.layout, &self.faces));
        self.spare_mixture = Some(mixture);
    }

    fn is_weighty(&self, density_kg_m3: f32) -> bool {
        // Rounded to f32, a tenth may be a little more.
        (f64::from(density_kg_m3) / self.pure.density_kg_m3 - 1.0).abs() > BOUSSINESQ + 1e-6
    }

    fn take_mixture(&mut self) -> Box<Mixture> {
        let old = self.mixture.take().or_else(|| self.spare_mixture.take());
        old.unwrap_or_else(|| Box::new(Mixture::new(&self.layout)))
    }

    /// Takes a mixture whose densities are in kg/m^3, and keeps what differs in it.
    fn settle_medium(&mut self, mut mixture: Box<Mixture>) {
        let density = self.range(&mixture.density);
        let viscosity = self.range(&mixture.viscosity_m2_s);
        let pure = self.pure.density_kg_m3 as f32;
        let reference = pure.clamp(density.least, density.most);
        self.density_kg_m3 = f64::from(reference);
        let has_viscosity = viscosity.most > LEAST_VISCOSITY_M2_S;
        self.viscosity_m2_s = if has_viscosity { f64::from(viscosity.most) } else { 0.0 };
        self.survey = None;
        mixture.is_weighty = self.is_weighty(density.most) || self.is_weighty(density.least);
        let is_thick_somewhere = viscosity.most - viscosity.least > ALIKE * viscosity.most
            && viscosity.most > LEAST_VISCOSITY_M2_S;
        if density.least == density.most && !is_thick_somewhere {
            self.spare_mixture = Some(mixture);
            return;
        }
        let Self { layout, faces, ghosts, gravity_m_s2, pool, simd, .. } = self;
        let lightest = density.most * LEAST_SHARE;
        mixture.density.iter_mut().for_each(|density| *density = density.max(lightest) / reference);
        ghosts.extend_cells(&mut mixture.density);
        mixture.set_buoyancy(layout, &faces.open, *gravity_m_s2);
        let on = Engine { pool, simd: *simd, faces };
        if mixture.is_weighty {
            self.projection.make_room();
            let room = || (Density::new(layout, faces), layout.zeros());
            let (weight, _) = mixture.weight.get_or_insert_with(room);
            weight.set(on, layout, ghosts, &mixture.density);
        }
        let is_weighty_and_thick = mixture.is_weighty && viscosity.most > LEAST_VISCOSITY_M2_S;
        mixture.is_thick_somewhere = is_thick_somewhere || is_weighty_and_thick;
        if mixture.is_thick_somewhere {
            let thick = mixture.thick.get_or_insert_with(|| Thick::new(layout, faces));
            let per_area = self.grid.spacing_m.powi(2).recip();
            let density = mixture.is_weighty.then_some(&mixture.density);
            thick.stress.set(on, ghosts, &mixture.viscosity_m2_s, density, per_area);
        }
        self.mixture = Some(mixture);
    }

    /// The viscosity is the same everywhere from now on.
    pub(super) fn forget_thickness(&mut self) {
        if let Some(mixture) = &mut self.mixture {
            mixture.is_thick_somewhere = false;
        }
    }

    fn range(&self, field: &Field) -> Range {
        let mut range = Range { least: f32::INFINITY, most: 0.0 };
        for (i, j, k) in cells(self.layout.cells) {
            let at = self.layout.index(i, j, k);
            if self.faces.liquid[at] > 0.0 {
                range.least = range.least.min(field[at]);
                range.most = range.most.max(field[at]);
            }
        }
        range
    }
}
