//! The keys of the gas above the liquid.

use serde::Deserialize;
use toml::Spanned;

use super::{Lines, Misfit, Number, Triple, lacks};
use crate::scenes::{Scene, Wrong};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GasKeys {
    height_m: Number,
    density_kg_m3: Number,
    viscosity_m2_s: Number,
    diffusivity_m2_s: Number,
    ambient_k: Number,
    hotter_k: Number,
    vents: Option<Spanned<i64>>,
    vent_radius_m: Number,
    smoke_per_s: Number,
    colour: Triple,
}

pub(super) fn apply(
    keys: &Spanned<GasKeys>,
    scene: &mut Scene,
    lines: &mut Lines<'_>,
) -> Result<(), Misfit> {
    let Some(gas) = &mut scene.gas else { return Err(lacks(keys, "gas", "gas")) };
    let keys = keys.get_ref();
    lines.set("gas.height_m", &mut gas.height_m, &keys.height_m);
    lines.set("gas.density_kg_m3", &mut gas.density_kg_m3, &keys.density_kg_m3);
    lines.set("gas.viscosity_m2_s", &mut gas.viscosity_m2_s, &keys.viscosity_m2_s);
    lines.set("gas.diffusivity_m2_s", &mut gas.diffusivity_m2_s, &keys.diffusivity_m2_s);
    lines.set("gas.ambient_k", &mut gas.ambient_k, &keys.ambient_k);
    lines.set("gas.hotter_k", &mut gas.hotter_k, &keys.hotter_k);
    lines.set("gas.vent_radius_m", &mut gas.vent_radius_m, &keys.vent_radius_m);
    lines.set("gas.smoke_per_s", &mut gas.smoke_per_s, &keys.smoke_per_s);
    lines.set("gas.colour", &mut gas.colour, &keys.colour);
    let Some(vents) = &keys.vents else { return Ok(()) };
    lines.seen.push(("gas.vents", vents.span()));
    gas.vents = usize::try_from(*vents.get_ref()).map_err(|_| {
        let (key, value) = ("gas.vents".into(), vents.get_ref().to_string());
        (vents.span(), Wrong { key, value, must: "a number of vents is at least 0".into() })
    })?;
    Ok(())
}
