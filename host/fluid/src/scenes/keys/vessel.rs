//! The keys of the vessel: a round shape by its numbers, or a mesh by its file.

use std::path::Path;

use glam::Vec3;
use serde::Deserialize;
use toml::Spanned;

use super::{Lines, Misfit, Number, Triple, Value, lacks};
use crate::{
    Grid,
    scenes::{Scene, Wrong},
    vessel::{Mesh, MeshFault, MeshOf, Vessel},
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scenes) struct VesselKeys {
    shape: Option<Spanned<String>>,
    centre_m: Triple,
    radius_m: Number,
    axis: Triple,
    mesh: Option<Spanned<String>>,
    inside_m: Triple,
}

/// A mesh is sampled at the corners of the scene's cells or of parts of them: about so many along
/// the longest edge of the box, so that a coarse grid has a fine wall.
const FINE_CELLS: usize = 64;

/// A mesh that the scene's vessel shall have, once its grid has been checked.
pub(in crate::scenes) struct MeshKeys {
    mesh: Spanned<String>,
    inside_m: Triple,
}

impl VesselKeys {
    /// The mesh, if there is one.
    pub(in crate::scenes) fn mesh(&self) -> Option<MeshKeys> {
        let mesh = self.mesh.clone()?;
        Some(MeshKeys { mesh, inside_m: self.inside_m.clone() })
    }
}

impl MeshKeys {
    /// The vessel of the mesh, whose path starts from `folder`.
    pub(in crate::scenes) fn load(&self, folder: &Path, grid: &Grid) -> Result<Vessel, Misfit> {
        let inside = self.inside_m.as_ref();
        let of = inside.map_or(MeshOf::Liquid, |inside| {
            let Value(inside_in_world_m) = (*inside.get_ref()).into();
            MeshOf::Wall { inside_in_world_m }
        });
        let longest = grid.cells.into_iter().max().unwrap_or(1);
        let parts = ((FINE_CELLS + longest / 2) / longest).max(1);
        let fine = Grid {
            cells: grid.cells.map(|cells| cells * parts),
            spacing_m: grid.spacing_m / parts as f32,
            ..*grid
        };
        let vessel = Mesh::read(folder.join(self.mesh.get_ref()))
            .and_then(|mesh| Vessel::from_mesh(&mesh, &fine, of));
        vessel.map_err(|error| match (&error.fault, inside) {
            (MeshFault::InWall(at_m) | MeshFault::OutOfBox(at_m), Some(inside)) => {
                let value = at_m.to_string();
                misfit(inside, "vessel.inside_m", value, &error.fault.to_string())
            }
            (fault, _) => {
                let value = format!("\"{}\"", error.path.display());
                misfit(&self.mesh, "vessel.mesh", value, &fault.to_string())
            }
        })
    }
}

/// Sets the vessel, all but a mesh: until that is there, it is the box.
pub(super) fn apply(
    keys: &Spanned<VesselKeys>,
    scene: &mut Scene,
    lines: &mut Lines<'_>,
) -> Result<(), Misfit> {
    let VesselKeys { shape, centre_m, radius_m, axis: direction, mesh, inside_m } = keys.get_ref();
    let shape_named = shape.as_ref().map(|shape| shape.get_ref().as_str());
    if let Some(mesh) = mesh {
        lines.seen.push(("vessel.mesh", mesh.span()));
        scene.vessel = Vessel::Box;
        let alone = shape.is_none() && direction.is_none();
        return if alone && centre_m.is_none() && radius_m.is_none() {
            Ok(())
        } else {
            let must = "a mesh goes without shape, centre_m, radius_m and axis";
            Err(misfit(mesh, "vessel.mesh", format!("\"{}\"", mesh.get_ref()), must))
        };
    }
    if let Some(inside) = inside_m {
        let value = format!("{:?}", inside.get_ref());
        return Err(misfit(inside, "vessel.inside_m", value, "goes with the mesh of a wall"));
    }
    let middle = scene.grid.origin_in_world_m + 0.5 * scene.grid.extent_m();
    let inscribed_m = 0.5 * scene.grid.extent_m().min_element();
    let (name_now, mut centre, mut axis, mut radius) = match scene.vessel {
        Vessel::Pot { centre_in_world_m: c, radius_m: r } => ("pot", c, Vec3::Y, r),
        Vessel::Bowl { centre_in_world_m: c, radius_m: r } => ("bowl", c, Vec3::Y, r),
        Vessel::Cylinder { centre_in_world_m: c, axis, radius_m: r } => ("cylinder", c, axis, r),
        Vessel::Box | Vessel::Distance(_) if shape.is_none() => {
            return Err(lacks(keys, "vessel", "round vessel without a shape"));
        }
        Vessel::Box | Vessel::Distance(_) => ("box", middle, Vec3::Y, inscribed_m),
    };
    lines.seen.extend(shape.as_ref().map(|shape| ("vessel.shape", shape.span())));
    lines.set("vessel.centre_m", &mut centre, centre_m);
    lines.set("vessel.radius_m", &mut radius, radius_m);
    lines.set("vessel.axis", &mut axis, direction);
    let name = shape_named.unwrap_or(name_now);
    if let Some(direction) = direction.as_ref().filter(|_| name != "cylinder") {
        let value = format!("{:?}", direction.get_ref());
        return Err(misfit(direction, "vessel.axis", value, "goes with shape = \"cylinder\""));
    }
    scene.vessel = match name {
        "box" => Vessel::Box,
        "pot" => Vessel::Pot { centre_in_world_m: centre, radius_m: radius },
        "bowl" => Vessel::Bowl { centre_in_world_m: centre, radius_m: radius },
        "cylinder" => Vessel::Cylinder { centre_in_world_m: centre, axis, radius_m: radius },
        other => {
            let span = shape.as_ref().map_or(keys.span(), Spanned::span);
            let must = "must be box, pot, bowl or cylinder; for others, name a mesh".into();
            let value = format!("\"{other}\"");
            return Err((span, Wrong { key: "vessel.shape".into(), value, must }));
        }
    };
    Ok(())
}

fn misfit<T>(at: &Spanned<T>, key: &str, value: String, must: &str) -> Misfit {
    (at.span(), Wrong { key: key.into(), value, must: must.into() })
}
