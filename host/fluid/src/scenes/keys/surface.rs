//! The keys of `[surface]`.

use serde::Deserialize;
use toml::Spanned;

use super::{Lines, Misfit, Number, lacks};
use crate::{
    scenes::{Scene, Wrong},
    surface,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceKeys {
    model: Option<Spanned<String>>,
    nodes_per_cell: Option<Spanned<i64>>,
    areal_mass_kg_m2: Number,
    gravity_n_per_m3: Number,
    tension_n_per_m: Number,
    bend: Number,
    drag_n_s_per_m3: Number,
    layer_decay_m: Number,
    contact_stiffness_n_per_m: Number,
    break_force_n: Number,
}

pub(super) fn apply(
    keys: &Spanned<SurfaceKeys>,
    scene: &mut Scene,
    lines: &mut Lines<'_>,
) -> Result<(), Misfit> {
    let Some(surface) = &mut scene.surface else { return Err(lacks(keys, "surface", "surface")) };
    let keys = keys.get_ref();
    if let Some(model) = &keys.model {
        surface.model = model_of(model)?;
        lines.seen.push(("surface.model", model.span()));
    }
    if let Some(nodes) = &keys.nodes_per_cell {
        // Too many and too few are named by the check of the scene.
        surface.nodes_per_cell = usize::try_from(*nodes.get_ref()).unwrap_or(0);
        lines.seen.push(("surface.nodes_per_cell", nodes.span()));
    }
    lines.set("surface.areal_mass_kg_m2", &mut surface.areal_mass_kg_m2, &keys.areal_mass_kg_m2);
    lines.set("surface.gravity_n_per_m3", &mut surface.gravity_n_per_m3, &keys.gravity_n_per_m3);
    lines.set("surface.tension_n_per_m", &mut surface.tension_n_per_m, &keys.tension_n_per_m);
    lines.set("surface.bend", &mut surface.bend, &keys.bend);
    lines.set("surface.drag_n_s_per_m3", &mut surface.drag_n_s_per_m3, &keys.drag_n_s_per_m3);
    lines.set("surface.layer_decay_m", &mut surface.layer_decay_m, &keys.layer_decay_m);
    let stiffness = &mut surface.contact_stiffness_n_per_m;
    lines.set("surface.contact_stiffness_n_per_m", stiffness, &keys.contact_stiffness_n_per_m);
    lines.set("surface.break_force_n", &mut surface.break_force_n, &keys.break_force_n);
    Ok(())
}

fn model_of(name: &Spanned<String>) -> Result<&'static str, Misfit> {
    let row = surface::find(name.get_ref()).ok_or_else(|| {
        let known: Vec<_> = surface::INDEX.iter().map(|row| row.name).collect();
        let must = format!("must be one of {}", known.join(", "));
        let (key, value) = ("surface.model".into(), name.get_ref().clone());
        (name.span(), Wrong { key, value, must })
    })?;
    Ok(row.name)
}
