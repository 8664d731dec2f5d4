//! What a flow computes, and what it takes.

use crate::{
    plan::Item,
    solver::flow::{
        Flow,
        faces::{Faces, VesselFaces},
        field::{Field, vector_bytes},
        mixture::Mixture,
        stress::{CutWeights, Stress},
        thick::Thick,
    },
};

impl Flow {
    /// What is computed in each step, and what has been made for it. What is off is neither.
    #[must_use]
    pub fn plan(&self) -> Vec<Item> {
        let vessel = self.faces.vessel.as_ref();
        let force = self.force.as_ref().map(|force| vector_bytes(&force.acceleration_m_s2));
        let momentum =
            vector_bytes(&self.velocity) + self.stage.iter().map(vector_bytes).sum::<usize>();
        let prediction = self.pressure.next.bytes() + self.pressure.trend.bytes();
        let looks = self.looks.as_ref().map(|looking| looking.bytes());
        let coupling = self.coupling.as_ref().map(|coupling| coupling.bytes());
        let is_direct = self.projection.is_direct();
        let drag = coupling.map(|bytes| Item::on("drag", "solved for with the liquid", bytes));
        let mixture = self.mixture.as_deref().or(self.spare_mixture.as_deref());
        let [gravity, friction, weight] = mixture.map_or([None; 3], Mixture::bytes);
        let always = [
            Item::on("momentum", "central fluxes; scheme and parts by step", momentum),
            Item::on(
                "pressure",
                if is_direct { "direct" } else { "conjugate gradients, direct as preconditioner" },
                self.projection.bytes() + prediction,
            ),
            Item::on("cells and faces", "open or closed", self.faces.bytes()),
            Item::if_any("walls", vessel.map(|v| ("cut cells", v.bytes()))),
            Item::if_any("body force", force.map(|bytes| ("given by the caller", bytes))),
            Item::if_any("looks", looks.map(|bytes| ("confinement, sub-grid viscosity", bytes))),
            Item::if_any(
                "viscosity",
                self.viscous.as_ref().map(|viscous| {
                    let how = if viscous.is_direct() { "direct" } else { "conjugate gradients" };
                    (format!("explicit while it is weak, implicit beyond: {how}"), viscous.bytes())
                }),
            ),
            Item::if_any("buoyancy", gravity.map(|bytes| ("of what is dissolved", bytes))),
            Item::if_any("unlike viscosities", friction.map(|b| ("conjugate gradients", b))),
            Item::if_any("unlike weights", weight.map(|bytes| ("in the pressure, too", bytes))),
        ];
        always.into_iter().chain(drag).collect()
    }
}

impl Faces {
    fn bytes(&self) -> usize {
        vector_bytes(&self.open) + self.liquid.bytes() + size_of_val(&*self.live_rows)
    }
}

impl VesselFaces {
    fn bytes(&self) -> usize {
        vector_bytes(&self.area) + self.open_area.bytes() + self.lift.bytes() + self.walls.bytes()
    }
}

impl Mixture {
    /// Memory for gravity, for friction that differs and for densities that weigh.
    fn bytes(&self) -> [Option<usize>; 3] {
        let cells = [&self.density, &self.viscosity_m2_s];
        let faces = self.buoyancy_m_s2.iter().chain(&self.total_m_s2);
        let weight = self.weight.as_ref().map(|(density, none)| density.bytes() + none.bytes());
        [Some(bytes(cells.into_iter().chain(faces))), self.thick.as_ref().map(Thick::bytes), weight]
    }
}

impl Stress {
    /// Memory that it takes.
    pub(super) fn bytes(&self) -> usize {
        let of_cut = |cut: &'_ CutWeights| {
            bytes(cut.cell.iter().chain(cut.along.iter().flatten()).chain(&cut.drag))
        };
        let always = self.edge.iter().chain(&self.inertia).chain([&self.cell, &self.resistance]);
        bytes(always) + self.cut.as_ref().map_or(0, of_cut)
    }
}

/// Memory of fields.
pub(super) fn bytes<'a>(fields: impl IntoIterator<Item = &'a Field>) -> usize {
    fields.into_iter().map(Field::bytes).sum()
}
