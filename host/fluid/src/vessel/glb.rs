//! glTF 2.0: the triangles of the default scene, each where its node puts it.
//!
//! The container, the schema and its validation are the `gltf` crate's. Numbers are taken from
//! the buffers here, since its own reader trusts their lengths and types.

use std::{fs, path::Path};

use ::gltf::{
    Accessor, Gltf, Node, Primitive, Semantic,
    accessor::{DataType, Dimensions},
    buffer::Source,
    mesh::Mode,
};
use glam::{Mat4, Vec3};

use super::mesh::Soup;

/// Nodes within nodes; more is a circle.
const DEEPEST: usize = 64;

/// The triangles of a file whose further buffers lie in `folder`.
///
/// # Errors
/// What is wrong with it.
pub(super) fn read(bytes: &[u8], folder: &Path) -> Result<Soup, String> {
    let Gltf { document, blob } = Gltf::from_slice(bytes).map_err(|why| why.to_string())?;
    let buffers = document.buffers().map(|buffer| match buffer.source() {
        Source::Bin => blob.clone().ok_or("it has no binary chunk".into()),
        Source::Uri(uri) if uri.starts_with("data:") => {
            Err("its buffer is text in the file: export it as .glb".into())
        }
        Source::Uri(uri) => {
            fs::read(folder.join(uri)).map_err(|why| format!("its buffer '{uri}': {why}"))
        }
    });
    let buffers = buffers.collect::<Result<Vec<Vec<u8>>, String>>()?;
    let mut soup = (Vec::new(), Vec::new());
    let scene = document.default_scene().or_else(|| document.scenes().next());
    for node in scene.iter().flat_map(|scene| scene.nodes()) {
        add_node(&node, Mat4::IDENTITY, 0, &buffers, &mut soup)?;
    }
    Ok(soup)
}

fn add_node(
    node: &Node<'_>,
    world_from_parent: Mat4,
    depth: usize,
    buffers: &[Vec<u8>],
    soup: &mut Soup,
) -> Result<(), String> {
    if depth > DEEPEST {
        return Err(format!(
            "its nodes lie more than {DEEPEST} deep in each other, or in a circle"
        ));
    }
    let world_from_node = world_from_parent * Mat4::from_cols_array_2d(&node.transform().matrix());
    for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
        add_primitive(&primitive, world_from_node, buffers, soup)?;
    }
    node.children()
        .try_for_each(|child| add_node(&child, world_from_node, depth + 1, buffers, soup))
}

fn add_primitive(
    primitive: &Primitive<'_>,
    world_from_node: Mat4,
    buffers: &[Vec<u8>],
    (points_m, triangles): &mut Soup,
) -> Result<(), String> {
    match primitive.mode() {
        Mode::Triangles => {}
        Mode::TriangleStrip | Mode::TriangleFan => {
            return Err("its triangles are a strip or fan: export them as a list".into());
        }
        _ => return Ok(()),
    }
    let positions = primitive.get(&Semantic::Positions).ok_or("its triangles have no positions")?;
    let first = points_m.len();
    for place in items(&positions, buffers, &[DataType::F32], Dimensions::Vec3)? {
        let number = |n: usize| f32::from_le_bytes([0, 1, 2, 3].map(|b| place[4 * n + b]));
        let at = Vec3::new(number(0), number(1), number(2));
        points_m.push(world_from_node.transform_point3(at));
    }
    let integers = [DataType::U8, DataType::U16, DataType::U32];
    let corners: Vec<usize> = match primitive.indices() {
        None => (first..points_m.len()).collect(),
        Some(indices) => items(&indices, buffers, &integers, Dimensions::Scalar)?
            .map(|index| first + index.iter().rev().fold(0, |n, b| n << 8 | usize::from(*b)))
            .collect(),
    };
    let is_mirrored = world_from_node.determinant() < 0.0;
    for corner in corners.chunks_exact(3) {
        let beyond = corner.iter().find(|corner| **corner >= points_m.len());
        if let Some(corner) = beyond {
            let points = points_m.len() - first;
            return Err(format!("index {} is out of range of {points} points", corner - first));
        }
        let [a, b, c] = [corner[0], corner[1], corner[2]].map(|corner| corner as u32);
        triangles.push(if is_mirrored { [a, c, b] } else { [a, b, c] });
    }
    Ok(())
}

/// The bytes of each item of an accessor, which must be of a kind and lie in its buffer.
fn items<'a>(
    accessor: &Accessor<'_>,
    buffers: &'a [Vec<u8>],
    kinds: &[DataType],
    dimensions: Dimensions,
) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, String> {
    let (kind, count, size) = (accessor.data_type(), accessor.count(), accessor.size());
    if accessor.sparse().is_some() || accessor.dimensions() != dimensions || !kinds.contains(&kind)
    {
        return Err(format!("accessor {} is sparse or of a wrong type", accessor.index()));
    }
    let lying = || {
        let view = accessor.view()?;
        let stride = view.stride().unwrap_or(size).max(size);
        let end = view.offset().checked_add(view.length())?;
        let bytes = buffers.get(view.buffer().index())?.get(view.offset()..end)?;
        let bytes = bytes.get(accessor.offset()..)?;
        let needed =
            count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size));
        (needed? <= bytes.len()).then_some((bytes, stride))
    };
    let (bytes, stride) = lying()
        .ok_or_else(|| format!("accessor {} reaches beyond its buffer", accessor.index()))?;
    Ok((0..count).map(move |n| &bytes[n * stride..n * stride + size]))
}
