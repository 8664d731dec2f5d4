//! Where a mesh is open, and fans of triangles that close it.
//!
//! Files double the points along seams of texture and of hard edges, and round them apart: points
//! are joined before edges are counted.

use std::collections::{BTreeMap, HashMap};

use glam::Vec3;

use super::{bvh::Triangle, mesh::Mesh};

/// A hole: open edges that hang together.
pub(super) struct Hole {
    /// Number of edges.
    pub edges: usize,
    /// Its box.
    pub low_m: Vec3,
    pub high_m: Vec3,
    /// The lowest point of its rim.
    pub lowest_m: Vec3,
    /// Triangles from its rim to its middle. With them, the mesh is closed.
    pub fan: Vec<Triangle>,
}

/// All holes of `mesh`, where points nearer than `join_m` are one. An edge is open that is not
/// run through as often one way as the other.
pub(super) fn holes(mesh: &Mesh, join_m: f32) -> Vec<Hole> {
    let points = mesh.points_m();
    let joined = join(points, join_m);
    // Ordered, so that the same file makes the same bits.
    let mut runs: BTreeMap<[usize; 2], i32> = BTreeMap::new();
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|corner| joined[corner as usize]);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *runs.entry([from.min(to), from.max(to)]).or_default() +=
                if from < to { 1 } else { -1 };
        }
    }
    // An edge from a point to itself has no length and no side.
    runs.retain(|[a, b], run| *run != 0 && a != b);
    let mut rims: BTreeMap<usize, Vec<([usize; 2], i32)>> = BTreeMap::new();
    let mut group: Vec<usize> = (0..points.len()).collect();
    for [a, b] in runs.keys() {
        let (a, b) = (root(&mut group, *a), root(&mut group, *b));
        group[a.max(b)] = a.min(b);
    }
    for (edge, run) in runs {
        rims.entry(root(&mut group, edge[0])).or_default().push((edge, run));
    }
    rims.into_values().map(|rim| hole(points, &rim)).collect()
}

fn hole(points: &[Vec3], rim: &[([usize; 2], i32)]) -> Hole {
    let ends = || rim.iter().flat_map(|(edge, _)| edge.map(|point| points[point]));
    let middle = ends().sum::<Vec3>() / (2 * rim.len()) as f32;
    let mut fan = Vec::new();
    for ([a, b], run) in rim {
        let (from, to) = if *run > 0 { (*b, *a) } else { (*a, *b) };
        let times = run.unsigned_abs() as usize;
        fan.extend(std::iter::repeat_n([points[from], points[to], middle], times));
    }
    let lower = |a: Vec3, b: Vec3| if b.y < a.y { b } else { a };
    Hole {
        edges: rim.len(),
        low_m: ends().fold(Vec3::INFINITY, Vec3::min),
        high_m: ends().fold(Vec3::NEG_INFINITY, Vec3::max),
        lowest_m: ends().fold(Vec3::INFINITY, lower),
        fan,
    }
}

/// For each point the first one that is nearer than `join_m`.
fn join(points: &[Vec3], join_m: f32) -> Vec<usize> {
    let bin = |at: Vec3| (at / (4.0 * join_m)).floor().to_array().map(|c| c as i64);
    let mut bins: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut joined = Vec::with_capacity(points.len());
    for (place, &at) in points.iter().enumerate() {
        let (low, high) = (bin(at - join_m), bin(at + join_m));
        let [x, y, z] = [0, 1, 2].map(|axis| low[axis]..=high[axis]);
        let beside = x.flat_map(|i| {
            y.clone().flat_map({
                let z = z.clone();
                move |j| z.clone().map(move |k| [i, j, k])
            })
        });
        let near = |other: &&usize| points[**other].distance(at) < join_m;
        let found = beside.filter_map(|bin| bins.get(&bin)?.iter().find(near)).min().copied();
        if found.is_none() {
            bins.entry(bin(at)).or_default().push(place);
        }
        joined.push(found.unwrap_or(place));
    }
    joined
}

/// The point that stands for the group of `place`.
fn root(group: &mut [usize], mut place: usize) -> usize {
    while group[place] != place {
        group[place] = group[group[place]];
        place = group[place];
    }
    place
}
