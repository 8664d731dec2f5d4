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
//! gravity_m_s2 = 9.81
//! colour = [0.8, 0.5, 0.1]
//! [surface]
//! model = "auto"
//! nodes_per_cell = 2
//! break_force_n = 0.2
//! [gas]
//! hotter_k = 30.0
//! vents = 8
//! [probe]
//! radius_m = 0.012
//! [feel]
//! felt_scale = 2.0
//! [[substance]]
//! density_kg_m3 = 1100.0
//! viscosity_m2_s = 1e-4
//! diffusivity_m2_s = 0.0
//! [story]
//! stir = true
//! pour = true
//! ```
//!
//! How the surface moves is `model`: `wave` knows the box and upright round vessels, `spring` any,
//! and `auto` is the first of them that knows the vessel.
//!
//! The vessel is a `shape` (`box`, `pot`, `bowl` or `cylinder`, the latter with an `axis`), by
//! default the base scene's, or a mesh (OBJ or glTF, in metres, y up; its path starts from the
//! scene file):
//!
//! ```toml
//! [vessel]
//! mesh = "pot.glb"
//! inside_m = [0.0, -0.05, 0.0]
//! ```
//!
//! With `inside_m`, a point in the liquid, the mesh is the solid wall, as an open pot is modelled;
//! without, it is the liquid's own shape. The liquid rests at the top of the grid's box, and the
//! mesh has to reach up to it. The hand feels a bowl as a pot, and a cylinder and a mesh as the
//! grid's box: the wire to the device has no other walls yet.
//!
//! What it takes to break through the surface, to come out again, and how far it dents follows
//! from the meniscus ([`Meniscus`](crate::force::Meniscus)) where a contact angle is given and
//! `break_force_n`, `pull_force_n` or `contact_stiffness_n_per_m` is not. Its tension is the
//! liquid's own, by default water's; `tension_n_per_m` is that of the waves. A probe with a density
//! has weight, and floats or sinks:
//!
//! ```toml
//! [surface]
//! contact_angle_deg = 100.0
//! capillary_tension_n_per_m = 0.0728
//! [probe]
//! radius_m = 0.003
//! density_kg_m3 = 500.0
//! ```
//!
//! An unknown key, a value of the wrong kind and one out of its range are refused with their
//! line and key.

use std::{fmt, fs, io, path::Path};

use toml::Spanned;

use super::{
    INDEX, Scene, Wrong,
    keys::{File, Lines, Misfit, line_of},
};

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
        let what = one_line(error.message());
        let said = match key_in(text, line).filter(|key| !what.contains(*key)) {
            Some(key) => format!("{key}: {what}"),
            None => what,
        };
        SceneError::Malformed(path.into(), line, said)
    })?;
    let mut scene = base(path, text, file.base.as_ref())?;
    if file.name.is_none() {
        scene.name =
            Path::new(path).file_stem().map_or("scene".into(), |s| s.to_string_lossy().into());
    }
    let mesh = file.vessel.as_ref().and_then(|vessel| vessel.get_ref().mesh());
    let mut lines = Lines { text, seen: Vec::new() };
    let misfit =
        |(span, wrong): Misfit| SceneError::Nonsense(path.into(), Some(line_of(text, span)), wrong);
    file.apply(&mut scene, &mut lines).map_err(misfit)?;
    let nonsense =
        |wrong: Wrong| SceneError::Nonsense(path.into(), lines.line_of_key(&wrong.key), wrong);
    scene.check().map_err(nonsense)?;
    if let Some(mesh) = mesh {
        let folder = Path::new(path).parent().unwrap_or(Path::new(""));
        scene.vessel = mesh.load(folder, &scene.grid).map_err(misfit)?;
        scene.check().map_err(nonsense)?;
    }
    Ok(scene)
}

fn base(path: &str, text: &str, name: Option<&Spanned<String>>) -> Result<Scene, SceneError> {
    let wanted = name.map_or("cauldron", |name| name.get_ref().as_str());
    let row = INDEX.iter().find(|row| row.name == wanted);
    row.map(|row| (row.make)()).ok_or_else(|| {
        let line = name.map_or(1, |name| line_of(text, name.span()));
        let what = format!("base: {}", SceneError::Unknown(wanted.into()));
        SceneError::Malformed(path.into(), line, what)
    })
}

/// The key that a line sets.
fn key_in(text: &str, line: usize) -> Option<&str> {
    let (key, _) = text.lines().nth(line.checked_sub(1)?)?.split_once('=')?;
    Some(key.trim()).filter(|key| !key.is_empty())
}

fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Act;

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
    fn a_contact_angle_says_what_the_file_does_not() {
        let touch = |text: &str| {
            let scene = read("drop.toml", text).unwrap();
            scene.surface.map(|s| [s.break_force_n, s.pull_force_n]).unwrap()
        };
        let angle = "[surface]\ncontact_angle_deg = 120.0\n";
        let ring_n = std::f32::consts::TAU * 0.003 * 0.0728;
        let floats = touch(&format!("{angle}[probe]\nradius_m = 0.003\ndensity_kg_m3 = 500\n"));
        assert!((floats[0] / (0.75 * ring_n) - 1.0).abs() < 1e-5, "tension alone: {floats:?}");
        assert!((floats[1] / (0.25 * ring_n) - 1.0).abs() < 1e-5, "tension alone: {floats:?}");
        let weightless = touch(&format!("{angle}[probe]\nradius_m = 0.003\n"));
        assert!(weightless[0] > 1.5 * floats[0], "and buoyancy: {weightless:?} {floats:?}");
        assert_eq!(touch(&format!("{angle}break_force_n = 0.2\n"))[0], 0.2);
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
            ("[liquid]\ngravity_m_s2 = -9.8\n", 2, "liquid.gravity_m_s2 = -9.8"),
            ("[[substance]]\ndensity_kg_m3 = 0\n", 2, "substance.density_kg_m3 = 0"),
            ("[[substance]]\nviscosity_m2_s = inf\n", 2, "substance.viscosity_m2_s = inf"),
            ("[feel]\nfelt_scal = 2.0\n", 2, "felt_scal"),
            ("[liquid]\ndensity_kg_m3 = \"thick\"\n", 2, "density_kg_m3: invalid type"),
            ("\n[grid]\ncells = [32, 32]\n", 3, "cells"),
            ("name = \"x\"\nbase = \"honey\"\n", 2, "base"),
            ("[probe]\nradius_m = 0.2\n", 2, "probe.radius_m"),
            ("[vessel]\ncentre_m = [1.0, 0.0, 0.0]\n", 2, "vessel.centre_m"),
            ("[liquid\n", 1, ""),
            ("[surface]\nmodel = \"jelly\"\n", 2, "surface.model = jelly"),
            ("[surface]\nnodes_per_cell = 0\n", 2, "surface.nodes_per_cell = 0"),
            ("base = \"empty\"\n[surface]\nbend = 0.1\n", 2, "no surface"),
            ("[gas]\nvents = 3\n", 1, "no gas"),
            ("base = \"fumes\"\n[gas]\nvents = -3\n", 3, "gas.vents = -3"),
            ("base = \"fumes\"\n[gas]\nambient_k = 0\n", 3, "gas.ambient_k = 0"),
            ("base = \"fumes\"\n[gas]\nheight_m = 50.0\n", 3, "cells in all"),
            ("base = \"fumes\"\n[gas]\nhotter_k = 300\n", 3, "gas.hotter_k = 300"),
            ("[probe]\nradius_m = 1e40\n", 2, "probe.radius_m = inf"),
            ("[probe]\ndensity_kg_m3 = 0\n", 2, "probe.density_kg_m3 = 0"),
            (
                "[probe]\ndensity_kg_m3 = 500\n[feel]\nfelt_scale = 100\n[surface]\n\
                 contact_stiffness_n_per_m = 1\n",
                2,
                "too stiffly",
            ),
            ("[surface]\npull_force_n = -1\n", 2, "surface.pull_force_n = -1"),
            ("[surface]\ncontact_angle_deg = 181\n", 2, "surface.contact_angle_deg = 181"),
            (
                "[surface]\ncontact_angle_deg = 90\ncapillary_tension_n_per_m = nan\n",
                3,
                "surface.capillary_tension_n_per_m = NaN",
            ),
            ("[surface]\ncapillary_tension_n_per_m = 0.07\n", 2, "beside a contact_angle_deg"),
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
