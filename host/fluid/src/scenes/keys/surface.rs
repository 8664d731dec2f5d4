//! The keys of the surface, and what a contact angle says of those that are not given.

use serde::Deserialize;
use toml::Spanned;

use super::{Lines, Misfit, Number, lacks};
use crate::{
    force::Meniscus,
    scenes::{GRAVITY_M_S2, Scene, Wrong},
    surface,
};

/// Tension of clean water at 20 C (IAPWS 1994).
const WATER_N_PER_M: f64 = 0.0728;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceKeys {
    model: Option<Spanned<String>>,
    nodes_per_cell: Option<Spanned<i64>>,
    areal_mass_kg_m2: Number,
    gravity_n_per_m3: Number,
    tension_n_per_m: Number,
    sheet_tension_n_per_m: Number,
    bend: Number,
    drag_n_s_per_m3: Number,
    tear_speed_m_s: Number,
    tear_slope: Number,
    layer_decay_m: Number,
    contact_stiffness_n_per_m: Number,
    break_force_n: Number,
    pull_force_n: Number,
    contact_angle_deg: Number,
    capillary_tension_n_per_m: Number,
}

/// Sets what is given.
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
    let sheet = &mut surface.sheet_tension_n_per_m;
    lines.set("surface.sheet_tension_n_per_m", sheet, &keys.sheet_tension_n_per_m);
    lines.set("surface.bend", &mut surface.bend, &keys.bend);
    lines.set("surface.drag_n_s_per_m3", &mut surface.drag_n_s_per_m3, &keys.drag_n_s_per_m3);
    lines.set("surface.tear_speed_m_s", &mut surface.tear_speed_m_s, &keys.tear_speed_m_s);
    lines.set("surface.tear_slope", &mut surface.tear_slope, &keys.tear_slope);
    lines.set("surface.layer_decay_m", &mut surface.layer_decay_m, &keys.layer_decay_m);
    let stiffness = &mut surface.contact_stiffness_n_per_m;
    lines.set("surface.contact_stiffness_n_per_m", stiffness, &keys.contact_stiffness_n_per_m);
    lines.set("surface.break_force_n", &mut surface.break_force_n, &keys.break_force_n);
    lines.set("surface.pull_force_n", &mut surface.pull_force_n, &keys.pull_force_n);
    let angle = keys.contact_angle_deg.iter().map(|a| ("surface.contact_angle_deg", a.span()));
    lines.seen.extend(angle);
    Ok(())
}

/// With a contact angle, what is not given of the touch follows from the meniscus; to be called
/// when liquid and probe are known. The buoyancy of a probe that has a density is sent beside the
/// surface, so the touch of that one is of the tension alone.
pub(super) fn derive(keys: &Spanned<SurfaceKeys>, scene: &mut Scene) -> Result<(), Misfit> {
    let keys = keys.get_ref();
    let (probe, liquid) = (scene.probe, scene.liquid);
    let Some(surface) = &mut scene.surface else { return Ok(()) };
    let Some(angle) = &keys.contact_angle_deg else {
        return keys.capillary_tension_n_per_m.as_ref().map_or(Ok(()), |tension| {
            let (key, value) = ("surface.capillary_tension_n_per_m".into(), tension.get_ref());
            let must = "says something only beside a contact_angle_deg".into();
            Err((tension.span(), Wrong { key, value: value.to_string(), must }))
        });
    };
    let tension = keys.capillary_tension_n_per_m.as_ref();
    let meniscus = Meniscus::new(
        probe.radius_m,
        tension.map_or(WATER_N_PER_M, |t| *t.get_ref()) as f32,
        *angle.get_ref() as f32,
        liquid.map_or(1000.0, |l| l.density_kg_m3),
        liquid.map_or(GRAVITY_M_S2, |l| l.gravity_m_s2),
    );
    let meniscus = meniscus.map_err(|wrong| {
        let of_tension = tension.filter(|_| wrong.key.ends_with("capillary_tension_n_per_m"));
        (of_tension.unwrap_or(angle).span(), wrong)
    })?;
    let touch = match probe.density_kg_m3 {
        Some(_) => meniscus.capillary_resistance(),
        None => meniscus.resistance(),
    };
    for (to, derived, given) in [
        (&mut surface.break_force_n, touch.push_in_max_n, &keys.break_force_n),
        (&mut surface.pull_force_n, touch.pull_out_max_n, &keys.pull_force_n),
        (
            &mut surface.contact_stiffness_n_per_m,
            touch.dent_stiffness_n_per_m,
            &keys.contact_stiffness_n_per_m,
        ),
    ] {
        if given.is_none() {
            *to = derived as f32;
        }
    }
    Ok(())
}

fn model_of(name: &Spanned<String>) -> Result<&'static str, Misfit> {
    surface::names().find(|known| known == name.get_ref()).ok_or_else(|| {
        let known: Vec<_> = surface::names().collect();
        let must = format!("must be one of {}", known.join(", "));
        let (key, value) = ("surface.model".into(), name.get_ref().clone());
        (name.span(), Wrong { key, value, must })
    })
}
