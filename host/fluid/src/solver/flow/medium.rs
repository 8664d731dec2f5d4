//! What the liquid is made of, cell by cell.
//!
//! Small differences of density act through gravity alone (Boussinesq 1903):
//! ```text
//! du/dt = ... + g (rho - rho_level) / rho_0
//! ```
//! Larger ones weigh in the pressure, too (see [`super::density`]). Where viscosities differ, or
//! large differences of density make them, friction is that of stresses (see [`super::stress`]).

use glam::{DVec3, Vec3};

use crate::{
    solver::{
        Refused,
        flow::{
            Flow, MAX_ACCELERATION_M_S2,
            density::Density,
            engine::Engine,
            faces::cells,
            field::{Field, Vector},
            mixture::{Mixture, Pull},
            pressure::masses,
            thick::Thick,
        },
        not_negative, within,
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

/// Least and most over the liquid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    least: f32,
    most: f32,
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

    /// Says what the liquid is made of, from the next step on: `medium` is sampled at the centres
    /// of the cells. Where densities differ by at most a tenth from [`crate::solver::Setup`]'s they
    /// act through its gravity alone (Boussinesq 1903); beyond, they weigh in the pressure, too,
    /// and what is lighter than a thousandth of the densest counts as that. Viscosities that differ
    /// are solved for as stresses. Obstacles feel what is around them: what they cover is kept, and
    /// is liquid again where they leave it. A medium that is the same everywhere costs nothing.
    ///
    /// Beyond open sides there is the liquid of the setup, at rest: what is lighter rises in it.
    /// Where densities weigh in the pressure, the lightest at each level is taken to be there
    /// instead.
    ///
    /// ```
    /// use cauldron_fluid::{Grid, Vessel, solver::{Setup, Solver, flow::{Flow, Medium}}};
    /// use glam::Vec3;
    ///
    /// let gravity_m_s2 = Vec3::new(0.0, -9.81, 0.0);
    /// let setup = Setup { gravity_m_s2, ..Setup::new(Grid::unit_cube(8), Vessel::Box) };
    /// let mut flow = Flow::new(&setup)?;
    /// flow.set_medium(&|p| match p.x < 0.5 {
    ///     true => Medium { density_kg_m3: 1400.0, viscosity_m2_s: 7e-3 },
    ///     false => Medium { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
    /// })?;
    /// flow.step(0.01)?;
    /// assert!(flow.velocity_at(Vec3::new(0.1, 0.5, 0.5)).y < 0.0, "honey sinks");
    /// assert!(flow.velocity_at(Vec3::new(0.9, 0.5, 0.5)).y > 0.0, "water gives way");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
        let mut mixture = self.take_mixture();
        (mixture.density, mixture.viscosity_m2_s) = (density, viscosity_m2_s);
        self.settle_medium(mixture);
        Ok(())
    }

    /// Mass of the liquid in one cell; where densities differ, of liquid that the flow counts by:
    /// that of the setup, or the nearest to it that there is.
    #[must_use]
    pub fn cell_mass_kg(&self) -> f64 {
        self.density_kg_m3 * f64::from(self.grid.cell_volume_m3())
    }

    /// Changes the kinematic viscosity from the next step on, to the same everywhere.
    ///
    /// # Errors
    /// [`Refused`] if it is negative, not finite or above 10^6 m^2/s; it is unchanged then.
    pub fn set_viscosity_m2_s(&mut self, viscosity_m2_s: f32) -> Result<(), Refused> {
        self.viscosity_m2_s = not_negative("viscosity_m2_s", viscosity_m2_s)?;
        self.pure.viscosity_m2_s = self.viscosity_m2_s;
        self.mixed = None;
        if let Some(mixture) = &mut self.mixture {
            mixture.is_thick_somewhere = false;
        }
        if self.viscosity_m2_s > 0.0 {
            self.make_viscous();
        }
        Ok(())
    }

    /// Changes gravity from the next step on.
    ///
    /// # Errors
    /// [`Refused`] if it is not finite or above 10^6 m/s^2; it is unchanged then.
    pub fn set_gravity_m_s2(&mut self, gravity_m_s2: Vec3) -> Result<(), Refused> {
        self.gravity_m_s2 = sound_gravity(gravity_m_s2)?;
        if let Some(mut mixture) = self.mixture.take() {
            self.set_buoyancy(&mut mixture);
            self.mixture = Some(mixture);
        }
        self.survey = None;
        Ok(())
    }

    /// Says that the liquid is made of what is dissolved in it: call it before each step that
    /// follows one of the substances. Densities mix by volume, dynamic viscosities as
    /// [`crate::substance::mixture`] says. As long as all substances are like the liquid, or on
    /// another grid, and as long as nothing has moved them, nothing is changed or computed.
    ///
    /// Where a difference of densities is carried along, so is the energy of what moves: what an
    /// exchange of heavy for light liquid adds to it counts as made from nothing, until the next
    /// step has taken as much.
    pub fn set_mixture(&mut self, substances: &Substances) {
        let is_pure = self.mixture.is_none() && self.mixed.is_none();
        let is_one = is_pure && !substances.differ_from(&self.liquid());
        let is_known = self.mixed == Some(substances.stamp());
        if is_one || is_known || !substances.are_on(&self.layout) {
            return;
        }
        let cell_mass_kg = self.cell_mass_kg();
        let before_j = self.surveyed().energy_m2_s2 * cell_mass_kg;
        let mut mixture = self.take_mixture();
        substances.mixture_density_kg_m3(&self.liquid(), &mut mixture.density);
        substances.mixture_viscosity_m2_s(&self.liquid(), &mut mixture.viscosity_m2_s);
        self.settle_medium(mixture);
        self.mixed = Some(substances.stamp());
        self.set_drive();
        let after = self.surveyed();
        self.survey = Some(after);
        let gained_j = after.energy_m2_s2 * self.cell_mass_kg() - before_j;
        self.excess_m2_s2 = (self.excess_m2_s2 * cell_mass_kg + gained_j) / self.cell_mass_kg();
    }

    /// The mass of faces, per density and cell volume; `None` where all are whole and alike.
    pub(super) fn masses(&self) -> Option<&Vector> {
        masses(&self.faces, self.mixture.as_ref().and_then(|mixture| mixture.weight()))
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
        if substances.viscosities().any(|viscosity| viscosity != liquid.viscosity_m2_s) {
            mixture.thick = Some(Thick::new(&self.layout, &self.faces));
        }
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
        let reference = pure.max(density.least).min(density.most);
        self.density_kg_m3 = f64::from(reference);
        self.mixed = None;
        let has_viscosity = viscosity.most > LEAST_VISCOSITY_M2_S;
        self.viscosity_m2_s = if has_viscosity { f64::from(viscosity.most) } else { 0.0 };
        self.survey = None;
        mixture.is_weighty = self.is_weighty(density.most) || self.is_weighty(density.least);
        let is_thick_somewhere = viscosity.most - viscosity.least > ALIKE * viscosity.most
            && viscosity.most > LEAST_VISCOSITY_M2_S;
        if density.least >= density.most && !is_thick_somewhere {
            self.spare_mixture = Some(mixture);
            return;
        }
        let lightest = density.most * LEAST_SHARE;
        mixture.density.iter_mut().for_each(|density| *density = density.max(lightest) / reference);
        self.ghosts.extend_cells(&mut mixture.density);
        let is_weighty_and_thick = mixture.is_weighty && viscosity.most > LEAST_VISCOSITY_M2_S;
        mixture.is_thick_somewhere = is_thick_somewhere || is_weighty_and_thick;
        self.fit(&mut mixture);
        self.mixture = Some(mixture);
    }

    /// Sets what the faces make of what is in the cells.
    fn fit(&mut self, mixture: &mut Mixture) {
        let Self { layout, faces, ghosts, pool, simd, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        if mixture.is_weighty {
            self.projection.make_room();
            let room = || (Density::new(layout, faces), layout.zeros());
            let (weight, _) = mixture.weight.get_or_insert_with(room);
            weight.set(on, layout, ghosts, &mixture.density);
        }
        if mixture.is_thick_somewhere {
            mixture.thick.get_or_insert_with(|| Thick::new(layout, faces));
            mixture.is_friction_due = true;
        }
        self.set_buoyancy(mixture);
    }

    /// Brings the friction up to date with what has been set since the last step.
    pub(super) fn set_friction(&mut self) {
        let Self { faces, ghosts, pool, simd, mixture, .. } = self;
        let Some(mixture) = mixture.as_mut().filter(|mixture| mixture.is_friction_due) else {
            return;
        };
        mixture.is_friction_due = false;
        let density = mixture.is_weighty.then_some(&mixture.density);
        let per_area = self.grid.spacing_m.powi(2).recip();
        if let Some(thick) = &mut mixture.thick {
            let on = Engine { pool, simd: *simd, faces };
            thick.stress.set(on, ghosts, &mixture.viscosity_m2_s, density, per_area);
        }
    }

    /// Brings a mixture up to date with faces that have changed.
    pub(super) fn refit_mixture(&mut self) {
        if let Some(mut mixture) = self.mixture.take() {
            self.fit(&mut mixture);
            self.mixture = Some(mixture);
        }
    }

    /// Makes anew what has been made for a mixture, once the faces are of another kind.
    pub(super) fn remake_mixture(&mut self) {
        for mixture in [&mut self.mixture, &mut self.spare_mixture].into_iter().flatten() {
            mixture.remake(&self.layout, &self.faces);
            if mixture.weight.is_some() {
                self.projection.make_room();
            }
        }
        self.refit_mixture();
    }

    /// Lets gravity act on what a mixture is made of. Beyond sides that are open there is pure
    /// liquid: what is lighter rises in it. Where densities weigh in the pressure, the lightest
    /// floats.
    fn set_buoyancy(&self, mixture: &mut Mixture) {
        let beyond = (self.ghosts.is_any_free() && !mixture.is_weighty)
            .then_some((self.pure.density_kg_m3 / self.density_kg_m3) as f32);
        mixture.set_buoyancy(&self.layout, &self.faces, self.gravity_m_s2, beyond);
    }

    /// What obstacles cover counts, too: it may be liquid in the next step.
    fn range(&self, field: &Field) -> Range {
        let liquid = &self.bare().liquid;
        // Bits of positive floats are in their order, and extremes of integers are vector code.
        let (mut least, mut most) = (f32::INFINITY.to_bits(), 0);
        self.simd.vectorize(
            #[inline(always)]
            || {
                for (value, liquid) in field.iter().zip(liquid.iter()) {
                    let bits = value.to_bits();
                    least = least.min(if *liquid > 0.0 { bits } else { u32::MAX });
                    most = most.max(if *liquid > 0.0 { bits } else { 0 });
                }
            },
        );
        Range { least: f32::from_bits(least), most: f32::from_bits(most) }
    }
}
