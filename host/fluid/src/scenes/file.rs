//! Scenes as TOML files. A file starts from a scene of the index (`base`, by default `cauldron`)
//! and changes what it names:
//!
//! ```toml
//! base = "cauldron"
//! name = "honey"
//! step_s = 0.01
//! [grid]
//! cells = [32, 32, 32]
//! spacing_m = 0.008
//! [vessel]
//! radius_m = 0.12
//! [liquid]
//! density_kg_m3 = 1420.0
//! viscosity_m2_s = 7e-3
//! colour = [0.8, 0.5, 0.1]
//! [surface]
//! break_force_n = 0.2
//! [probe]
//! radius_m = 0.012
//! [feel]
//! felt_scale = 2.0
//! [[substance]]
//! diffusivity_m2_s = 0.0
//! [story]
//! stir = true
//! pour = true
//! ```
//!
//! An unknown key, a value of the wrong kind and one out of its range are refused with their
//! line and key.

use glam::Vec3;
use serde::Deserialize;
use std::{fmt, fs, io, ops::Range, path::Path};
use toml::Spanned;

use super::{Act, INDEX, Scene, Wrong};
use crate::vessel::Vessel;

/// Why there is no scene.
#[derive(Debug)]
pub enum SceneError {
    /// No row of the index has this name, and it is not a file's.
    Unknown(String),
    /// The file could not be read.
    Unreadable(String, io::Error),
    /// The file is not what a scene file is; line from 1, and what is wrong.
    Malformed(String, usize, String),
    /// A value that a scene may not have; line from 1, if it stands in the file.
    Nonsense(String, Option<usize>, Wrong),
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => {
                let known: Vec<&str> = INDEX.iter().map(|row| row.name).collect();
                write!(
                    f,
                    "no scene is called '{name}'; there are {}, or name a .toml file",
                    known.join(", ")
                )
            }
            Self::Unreadable(path, why) => write!(f, "cannot read the scene {path}: {why}"),
            Self::Malformed(path, line, what) => write!(f, "{path}, line {line}: {what}"),
            Self::Nonsense(path, Some(line), wrong) => write!(f, "{path}, line {line}: {wrong}"),
            Self::Nonsense(path, None, wrong) => write!(f, "{path}: {wrong}"),
        }
    }
}

impl std::error::Error for SceneError {}

/// The scene that `name` names: a row of the index, or a path that ends in `.toml`.
///
/// # Errors
/// [`SceneError`]: it says what is wrong and where.
pub fn find(name: &str) -> Result<Scene, SceneError> {
    if Path::new(name).extension().is_some_and(|e| e == "toml") {
        let text =
            fs::read_to_string(name).map_err(|why| SceneError::Unreadable(name.into(), why))?;
        return read(name, &text);
    }
    let row = INDEX.iter().find(|row| row.name == name);
    row.map(|row| (row.make)()).ok_or_else(|| SceneError::Unknown(name.into()))
}

/// The scene in `text`, the content of the file `path`.
///
/// # Errors
/// [`SceneError`]: it says what is wrong and where.
pub fn read(path: &str, text: &str) -> Result<Scene, SceneError> {
    let file: File = toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(1, |span| line_of(text, span));
        SceneError::Malformed(path.into(), line, one_line(error.message()))
    })?;
    let mut scene = find_base(file.base.as_deref())?;
    if file.name.is_none() {
        scene.name =
            Path::new(path).file_stem().map_or("scene".into(), |s| s.to_string_lossy().into());
    }
    let mut lines = Lines { text, seen: Vec::new() };
    file.apply(&mut scene, &mut lines).map_err(|(span, wrong)| {
        SceneError::Nonsense(path.into(), Some(line_of(text, span)), wrong)
    })?;
    scene
        .check()
        .map_err(|wrong| SceneError::Nonsense(path.into(), lines.line_of_key(&wrong.key), wrong))?;
    Ok(scene)
}

fn find_base(name: Option<&str>) -> Result<Scene, SceneError> {
    let name = name.unwrap_or("cauldron");
    let row = INDEX.iter().find(|row| row.name == name);
    row.map(|row| (row.make)()).ok_or_else(|| SceneError::Unknown(name.into()))
}

fn line_of(text: &str, span: Range<usize>) -> usize {
    1 + text.bytes().take(span.start).filter(|b| *b == b'\n').count()
}

fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Where each key that the file set stands.
struct Lines<'a> {
    text: &'a str,
    seen: Vec<(&'static str, Range<usize>)>,
}

impl Lines<'_> {
    fn line_of_key(&self, key: &str) -> Option<usize> {
        let (_, span) = self.seen.iter().find(|(seen, _)| *seen == key)?;
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

impl From<[f64; 3]> for Value<Vec3> {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self(Vec3::new(x as f32, y as f32, z as f32))
    }
}

type Number = Option<Spanned<f64>>;
type Triple = Option<Spanned<[f64; 3]>>;
type Misfit = (Range<usize>, Wrong);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    base: Option<String>,
    name: Option<String>,
    about: Option<String>,
    step_s: Number,
    #[serde(default)]
    grid: GridKeys,
    vessel: Option<Spanned<VesselKeys>>,
    liquid: Option<Spanned<LiquidKeys>>,
    surface: Option<Spanned<SurfaceKeys>>,
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
struct VesselKeys {
    centre_m: Triple,
    radius_m: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LiquidKeys {
    density_kg_m3: Number,
    viscosity_m2_s: Number,
    colour: Triple,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SurfaceKeys {
    areal_mass_kg_m2: Number,
    gravity_n_per_m3: Number,
    tension_n_per_m: Number,
    bend: Number,
    drag_n_s_per_m3: Number,
    layer_decay_m: Number,
    contact_stiffness_n_per_m: Number,
    break_force_n: Number,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct ProbeKeys {
    radius_m: Number,
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
    fn apply(self, scene: &mut Scene, lines: &mut Lines<'_>) -> Result<(), Misfit> {
        scene.name = self.name.unwrap_or(std::mem::take(&mut scene.name));
        scene.about = self.about.unwrap_or(std::mem::take(&mut scene.about));
        lines.set("step_s", &mut scene.step_s, &self.step_s);
        self.grid.apply(scene, lines)?;
        self.vessel.map_or(Ok(()), |v| apply_vessel(&v, scene, lines))?;
        self.liquid.map_or(Ok(()), |l| apply_liquid(&l, scene, lines))?;
        self.surface.map_or(Ok(()), |s| apply_surface(&s, scene, lines))?;
        lines.set("probe.radius_m", &mut scene.probe.radius_m, &self.probe.radius_m);
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

fn apply_vessel(
    keys: &Spanned<VesselKeys>,
    scene: &mut Scene,
    lines: &mut Lines<'_>,
) -> Result<(), Misfit> {
    let Vessel::Pot { centre_in_world_m, radius_m } = &mut scene.vessel else {
        return Err(lacks(keys, "vessel", "pot"));
    };
    lines.set("vessel.centre_m", centre_in_world_m, &keys.get_ref().centre_m);
    lines.set("vessel.radius_m", radius_m, &keys.get_ref().radius_m);
    Ok(())
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
    lines.set("liquid.colour", &mut liquid.colour, &keys.colour);
    Ok(())
}

fn apply_surface(
    keys: &Spanned<SurfaceKeys>,
    scene: &mut Scene,
    lines: &mut Lines<'_>,
) -> Result<(), Misfit> {
    let Some(surface) = &mut scene.surface else { return Err(lacks(keys, "surface", "surface")) };
    let keys = keys.get_ref();
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

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        read("pot.toml", text).map(|_| ()).unwrap_err().to_string()
    }

    #[test]
    fn a_file_changes_what_it_names_and_nothing_else() {
        let text = "[liquid]\nviscosity_m2_s = 7e-3\n[grid]\ncells = [40, 32, 40]\n";
        let scene = read("honey.toml", text).unwrap();
        let mut base = find("cauldron").unwrap();
        assert_eq!(scene.name, "honey");
        base.name = "honey".into();
        base.grid.cells = [40, 32, 40];
        if let Some(liquid) = &mut base.liquid {
            liquid.viscosity_m2_s = 7e-3;
        }
        assert_eq!(scene, base);
    }

    #[test]
    fn a_story_can_be_told_without_stirring() {
        let scene = read("still.toml", "[story]\nstir = false\n").unwrap();
        assert!(!scene.story.acts.iter().any(|a| matches!(a, Act::Stir { .. })));
        let seconds = |s: &Scene| s.story.acts.iter().map(Act::seconds).sum::<f32>();
        assert_eq!(seconds(&scene), seconds(&find("cauldron").unwrap()));
    }

    #[test]
    fn nonsense_is_refused_with_line_and_key() {
        for (text, line, words) in [
            ("\n[grid]\ncells = [32, -4, 32]\n", 3, "grid.cells = -4"),
            ("[grid]\ncells = [32, 0, 32]\n", 2, "grid.cells = 0"),
            ("[liquid]\n\nviscosity_m2_s = nan\n", 3, "liquid.viscosity_m2_s = NaN"),
            ("[liquid]\nviscosity_m2_s = -1.0\n", 2, "liquid.viscosity_m2_s = -1"),
            ("step_s = inf\n", 1, "step_s = inf"),
            ("[feel]\nfelt_scal = 2.0\n", 2, "felt_scal"),
            ("[liquid]\ndensity_kg_m3 = \"thick\"\n", 2, "invalid type"),
            ("[liquid\n", 1, ""),
            ("[surface]\ntension_n_per_m = 1e7\n", 2, "sub-steps"),
            ("base = \"empty\"\n[surface]\nbend = 0.1\n", 2, "no surface"),
            ("[probe]\nradius_m = 1e40\n", 2, "probe.radius_m = inf"),
        ] {
            let said = error(text);
            assert!(said.contains(&format!("line {line}:")), "{text:?}: {said}");
            assert!(said.contains(words), "{text:?}: {said}");
            assert!(!said.contains('\n'), "one line: {said}");
        }
    }

    #[test]
    fn a_wrong_name_lists_the_right_ones() {
        let said = find("cauldorn").unwrap_err().to_string();
        assert!(said.contains("'cauldorn'") && said.contains("taylor-green"), "{said}");
        assert!(find("no-such-file.toml").unwrap_err().to_string().contains("no-such-file.toml"));
    }
}
