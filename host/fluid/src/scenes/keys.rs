//! The keys of a scene file, and what each sets.

mod gas;
mod surface;
mod vessel;

use glam::Vec3;
use serde::Deserialize;
use std::ops::Range;
use toml::Spanned;

use super::{Act, Scene, Wrong};

use gas::GasKeys;
use surface::SurfaceKeys;
use vessel::VesselKeys;

/// The line, from 1, that a span of `text` begins in.
pub(super) fn line_of(text: &str, span: Range<usize>) -> usize {
    1 + text.bytes().take(span.start).filter(|b| *b == b'\n').count()
}

/// Where each key that the file set stands.
pub(super) struct Lines<'a> {
    pub(super) text: &'a str,
    pub(super) seen: Vec<(&'static str, Range<usize>)>,
}

impl Lines<'_> {
    pub(super) fn line_of_key(&self, key: &str) -> Option<usize> {
        let table = key.split('.').next()?;
        let same = |seen: &&(&str, Range<usize>)| seen.0 == key;
        let beside = |seen: &&(&str, Range<usize>)| seen.0.split('.').next() == Some(table);
        // What does not fit may be another key of the table: the one that the file set.
        let (_, span) = self.seen.iter().find(same).or(self.seen.iter().find(beside))?;
        Some(line_of(self.text, span.clone()))
    }

    fn set<T, U>(&mut self, key: &'static str, to: &mut U, from: &Option<Spanned<T>>)
    where
        T: Copy + Into<Value<U>>,
    {
        if let Some(value) = from {
            self.seen.push((key, value.span()));
            *to = (*value.get_ref()).into().0;
        }
    }
}

/// A file's number as the scene's.
struct Value<T>(T);

impl From<f64> for Value<f32> {
    fn from(value: f64) -> Self {
        Self(value as f32)
    }
}

impl From<f64> for Value<Option<f32>> {
    fn from(value: f64) -> Self {
        Self(Some(value as f32))
    }
}

impl From<[f64; 3]> for Value<Vec3> {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self(Vec3::new(x as f32, y as f32, z as f32))
    }
}

type Number = Option<Spanned<f64>>;
type Triple = Option<Spanned<[f64; 3]>>;
/// A value that does not fit, and where it stands.
pub(super) type Misfit = (Range<usize>, Wrong);

/// A scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) base: Option<Spanned<String>>,
    pub(super) name: Option<String>,
    about: Option<String>,
    step_s: Number,
    #[serde(default)]
    grid: GridKeys,
    pub(super) vessel: Option<Spanned<VesselKeys>>,
    liquid: Option<Spanned<LiquidKeys>>,
    surface: Option<Spanned<SurfaceKeys>>,
    gas: Option<Spanned<GasKeys>>,
    #[serde(default)]
    probe: ProbeKeys,
    #[serde(default)]
    feel: FeelKeys,
    #[serde(default)]
    substance: Vec<Spanned<SubstanceKeys>>,
    #[serde(default)]
    story: StoryKeys,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct GridKeys {
    cells: Option<Spanned<[i64; 3]>>,
    spacing_m: Number,
    origin_m: Triple,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LiquidKeys {
    density_kg_m3: Number,
    viscosity_m2_s: Number,
    gravity_m_s2: Number,
    colour: Triple,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct ProbeKeys {
    radius_m: Number,
    density_kg_m3: Number,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct FeelKeys {
    felt_scale: Number,
    scale: Number,
    wall_stiffness_n_per_m: Number,
    wall_damping_n_s_per_m: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SubstanceKeys {
    name: Option<String>,
    colour: Triple,
    density_kg_m3: Number,
    viscosity_m2_s: Number,
    diffusivity_m2_s: Number,
    pour_at_m: Triple,
    pour_radius_m: Number,
    pour_per_s: Number,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct StoryKeys {
    stir: Option<bool>,
    pour: Option<bool>,
}

impl File {
    /// Changes what the file names.
    pub(super) fn apply(self, scene: &mut Scene, lines: &mut Lines<'_>) -> Result<(), Misfit> {
        scene.name = self.name.unwrap_or(std::mem::take(&mut scene.name));
        scene.about = self.about.unwrap_or(std::mem::take(&mut scene.about));
        lines.set("step_s", &mut scene.step_s, &self.step_s);
        self.grid.apply(scene, lines)?;
        self.vessel.map_or(Ok(()), |v| vessel::apply(&v, scene, lines))?;
        self.liquid.map_or(Ok(()), |l| apply_liquid(&l, scene, lines))?;
        self.surface.as_ref().map_or(Ok(()), |s| surface::apply(s, scene, lines))?;
        self.gas.map_or(Ok(()), |g| gas::apply(&g, scene, lines))?;
        lines.set("probe.radius_m", &mut scene.probe.radius_m, &self.probe.radius_m);
        let density = &self.probe.density_kg_m3;
        lines.set("probe.density_kg_m3", &mut scene.probe.density_kg_m3, density);
        self.surface.as_ref().map_or(Ok(()), |s| surface::derive(s, scene))?;
        self.feel.apply(scene, lines);
        for (place, keys) in self.substance.iter().enumerate() {
            apply_substance(place, keys, scene, lines)?;
        }
        self.story.apply(scene);
        Ok(())
    }
}

impl GridKeys {
    fn apply(&self, scene: &mut Scene, lines: &mut Lines<'_>) -> Result<(), Misfit> {
        lines.set("grid.spacing_m", &mut scene.grid.spacing_m, &self.spacing_m);
        lines.set("grid.origin_m", &mut scene.grid.origin_in_world_m, &self.origin_m);
        let Some(cells) = &self.cells else { return Ok(()) };
        lines.seen.push(("grid.cells", cells.span()));
        for (to, from) in scene.grid.cells.iter_mut().zip(*cells.get_ref()) {
            *to = usize::try_from(from).map_err(|_| {
                let must = "a size is at least 1".into();
                let value = from.to_string();
                (cells.span(), Wrong { key: "grid.cells".into(), value, must })
            })?;
        }
        Ok(())
    }
}

impl FeelKeys {
    fn apply(&self, scene: &mut Scene, lines: &mut Lines<'_>) {
        let feel = &mut scene.feel;
        lines.set("feel.felt_scale", &mut feel.felt_scale, &self.felt_scale);
        lines.set("feel.scale", &mut feel.world_from_device.scale, &self.scale);
        let (stiffness, damping) = (&self.wall_stiffness_n_per_m, &self.wall_damping_n_s_per_m);
        lines.set("feel.wall_stiffness_n_per_m", &mut feel.wall_stiffness_n_per_m, stiffness);
        lines.set("feel.wall_damping_n_s_per_m", &mut feel.wall_damping_n_s_per_m, damping);
    }
}

impl StoryKeys {
    /// A story without stirring keeps its times: the hand rests where it would have begun to stir.
    fn apply(&self, scene: &mut Scene) {
        if self.stir == Some(false) {
            for act in &mut scene.story.acts {
                if let Act::Stir { seconds, .. } = *act {
                    *act = Act::Rest { seconds };
                }
            }
        }
        if self.pour == Some(false) {
            scene.story.pours.clear();
        }
    }
}

fn apply_liquid(
    keys: &Spanned<LiquidKeys>,
    scene: &mut Scene,
    lines: &mut Lines<'_>,
) -> Result<(), Misfit> {
    let Some(liquid) = &mut scene.liquid else { return Err(lacks(keys, "liquid", "liquid")) };
    let keys = keys.get_ref();
    lines.set("liquid.density_kg_m3", &mut liquid.density_kg_m3, &keys.density_kg_m3);
    lines.set("liquid.viscosity_m2_s", &mut liquid.viscosity_m2_s, &keys.viscosity_m2_s);
    lines.set("liquid.gravity_m_s2", &mut liquid.gravity_m_s2, &keys.gravity_m_s2);
    lines.set("liquid.colour", &mut liquid.colour, &keys.colour);
    Ok(())
}

fn apply_substance(
    place: usize,
    keys: &Spanned<SubstanceKeys>,
    scene: &mut Scene,
    lines: &mut Lines<'_>,
) -> Result<(), Misfit> {
    let Some(substance) = scene.substances.get_mut(place) else {
        return Err(lacks(keys, "substance", "so many substances"));
    };
    let keys = keys.get_ref();
    substance.name = keys.name.clone().unwrap_or(std::mem::take(&mut substance.name));
    lines.set("substance.colour", &mut substance.colour, &keys.colour);
    lines.set("substance.density_kg_m3", &mut substance.density_kg_m3, &keys.density_kg_m3);
    lines.set("substance.viscosity_m2_s", &mut substance.viscosity_m2_s, &keys.viscosity_m2_s);
    let diffusivity = &mut substance.diffusivity_m2_s;
    lines.set("substance.diffusivity_m2_s", diffusivity, &keys.diffusivity_m2_s);
    lines.set("substance.pour_at_m", &mut substance.pour_at_m, &keys.pour_at_m);
    lines.set("substance.pour_radius_m", &mut substance.pour_radius_m, &keys.pour_radius_m);
    lines.set("substance.pour_per_s", &mut substance.pour_per_s, &keys.pour_per_s);
    Ok(())
}

fn lacks<T>(keys: &Spanned<T>, key: &str, what: &str) -> Misfit {
    let must = format!("the base scene has no {what}: choose another base");
    (keys.span(), Wrong { key: key.into(), value: "set".into(), must })
}
