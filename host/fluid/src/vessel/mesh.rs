//! Triangles in space, from a file or from code.

use std::{
    fmt, fs,
    path::{Path, PathBuf},
};

use glam::Vec3;

use super::{glb, obj};

/// Triangles in world metres, counted anticlockwise as seen from outside of the body they bound.
#[derive(Clone, PartialEq)]
pub struct Mesh {
    /// Where it comes from, for messages; empty if from code.
    path: PathBuf,
    points_m: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// A mesh has more numbers than a message has room for.
impl fmt::Debug for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (points, triangles) = (self.points_m.len(), self.triangles.len());
        write!(f, "Mesh({}: {points} points, {triangles} triangles)", name(&self.path))
    }
}

/// What makes a mesh: points in metres and triangles of them.
pub(super) type Soup = (Vec<Vec3>, Vec<[u32; 3]>);

/// No body in a laboratory is larger, and its square is still a number.
const FARTHEST_M: f32 = 1e4;

impl Mesh {
    /// The mesh of `triangles`, which name their corners by their place in `points_m`.
    ///
    /// # Errors
    /// [`MeshError`] if there is no triangle, a corner is not among the points, or a point is not
    /// finite or farther than 10 km from the origin.
    pub fn new(points_m: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        Self::checked(PathBuf::new(), (points_m, triangles))
    }

    /// The mesh in a file: Wavefront OBJ (`.obj`; `v` and `f` lines are read, polygons as fans)
    /// or glTF 2.0 (`.glb`, and `.gltf` with its buffers in files; all triangles of the default
    /// scene, moved by its nodes). Units are metres.
    ///
    /// # Errors
    /// [`MeshError`]: the file cannot be read or understood, or as [`Mesh::new`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let error = |fault| MeshError { path: path.into(), fault };
        let bytes = fs::read(path).map_err(|why| error(MeshFault::Unreadable(why.to_string())))?;
        let kind = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let soup = match kind.as_deref() {
            Some("obj") => obj::read(&bytes),
            Some("glb" | "gltf") => {
                glb::read(&bytes, path.parent().unwrap_or(Path::new(""))).map_err(|what| (0, what))
            }
            _ => return Err(error(MeshFault::UnknownKind)),
        };
        let soup = soup.map_err(|(line, what)| error(MeshFault::Malformed { line, what }))?;
        Self::checked(path.into(), soup)
    }

    fn checked(path: PathBuf, (points_m, triangles): Soup) -> Result<Self, MeshError> {
        let points = points_m.len();
        let strange = |at: &Vec3| !(at.abs().max_element() <= FARTHEST_M && at.is_finite());
        let missing = |(_, corner): &(usize, u32)| *corner as usize >= points;
        let numbered = triangles.iter().enumerate();
        let mut corners = numbered.flat_map(|(n, t)| t.map(|corner| (n, corner)));
        let fault = if triangles.is_empty() {
            Some(MeshFault::NoTriangles)
        } else if let Some((triangle, corner)) = corners.find(missing) {
            Some(MeshFault::NoSuchPoint { triangle, corner, points })
        } else {
            let point = points_m.iter().position(strange);
            point.map(|point| MeshFault::StrangePoint { point, at_m: points_m[point] })
        };
        match fault {
            Some(fault) => Err(MeshError { path, fault }),
            None => Ok(Self { path, points_m, triangles }),
        }
    }

    /// Its points.
    pub(super) fn points_m(&self) -> &[Vec3] {
        &self.points_m
    }

    /// Its triangles.
    pub(super) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    pub(super) fn error(&self, fault: MeshFault) -> MeshError {
        MeshError { path: self.path.clone(), fault }
    }
}

/// A mesh that no vessel can be made of.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshError {
    /// The file; empty for a mesh from code.
    pub path: PathBuf,
    /// What is wrong with it.
    pub fault: MeshFault,
}

/// What is wrong with a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshFault {
    /// The file cannot be read: why.
    Unreadable(String),
    /// The name of the file does not end in .obj, .glb or .gltf.
    UnknownKind,
    /// The file is not what its name says.
    Malformed {
        /// Line from 1, or 0 where there are no lines.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// It has no triangle, or none with an area.
    NoTriangles,
    /// A triangle names a point that is not there.
    NoSuchPoint {
        /// The triangle, from 0.
        triangle: usize,
        /// The point that it names, from 0.
        corner: u32,
        /// Points that there are.
        points: usize,
    },
    /// A point that is not finite, or too far away.
    StrangePoint {
        /// The point, from 0.
        point: usize,
        /// Where it is.
        at_m: Vec3,
    },
    /// It has a hole below the rest surface, wider than a cell.
    Open {
        /// Edges around the hole that belong to one triangle, or to two that face opposite ways.
        edges: usize,
        /// The lowest point of its rim.
        at_m: Vec3,
    },
    /// There is no liquid up to the rest surface.
    Dry {
        /// Height of the rest surface.
        top_m: f32,
    },
    /// The point that shall be liquid is not in the box.
    OutOfBox(Vec3),
    /// The point that shall be liquid is in the wall.
    InWall(Vec3),
    /// The liquid runs out to the side of the box.
    Leaks(Vec3),
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", name(&self.path), self.fault)
    }
}

impl fmt::Display for MeshFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(why) => write!(f, "cannot be read: {why}"),
            Self::UnknownKind => write!(f, "not a mesh that can be read: .obj, .glb or .gltf"),
            Self::Malformed { line: 0, what } => write!(f, "{what}"),
            Self::Malformed { line, what } => write!(f, "line {line}: {what}"),
            Self::NoTriangles => write!(f, "no triangle with an area: export faces, not edges"),
            Self::NoSuchPoint { triangle, corner, points } => write!(
                f,
                "triangle {triangle} has corner {corner}, but there are {points} points: \
                 export it again"
            ),
            Self::StrangePoint { point, at_m } => write!(
                f,
                "point {point} is {at_m}: must be finite and within {FARTHEST_M} m; \
                 units are metres"
            ),
            Self::Open { edges, at_m } => write!(
                f,
                "not closed: {edges} open edges around a hole down to {at_m}, below the top of \
                 the grid's box; close it, or turn all faces outwards"
            ),
            Self::Dry { top_m } => write!(
                f,
                "no liquid up to the rest surface, the top of the grid's box at y = {top_m} m: \
                 move the mesh or the grid's origin_m"
            ),
            Self::OutOfBox(at_m) => write!(f, "the liquid's point {at_m} is not in the grid's box"),
            Self::InWall(at_m) => write!(
                f,
                "the liquid's point {at_m} is in the wall: move it into the hollow, or leave it \
                 out if the mesh is the liquid's own shape"
            ),
            Self::Leaks(at_m) => write!(
                f,
                "the liquid runs out to the side of the grid's box at {at_m}: the wall has a \
                 hole, a rim below the top of the box, or is thinner than two cells"
            ),
        }
    }
}

impl std::error::Error for MeshError {}

fn name(path: &Path) -> String {
    if path.as_os_str().is_empty() { "the mesh".into() } else { path.display().to_string() }
}
