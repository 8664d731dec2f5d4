//! A tree of boxes over triangles: what is nearest, and how often they wind around a point.

use glam::Vec3;

/// A triangle by its corners in metres.
pub(super) type Triangle = [Vec3; 3];

/// Triangles in a leaf.
const LEAF: usize = 4;
/// Beyond so many radii, a box of triangles winds as a single dipole does, to a hundredth.
const FAR_RADII: f32 = 2.0;

/// A box whose squared distance is above so much of the best one's is not looked into: from the
/// middle of a round vessel all of its wall is as near as any.
const NEAR_ENOUGH: f32 = 0.998;

/// A bounding volume hierarchy, split at medians.
pub(super) struct Bvh {
    triangles: Vec<Triangle>,
    /// Parents before children, left child next to its parent.
    nodes: Vec<Node>,
}

struct Node {
    low: Vec3,
    high: Vec3,
    /// Triangles of a leaf; none in other nodes.
    leaf: std::ops::Range<usize>,
    right: usize,
    /// Sum of the triangles' area times normal, the middle they act from, and its distance to
    /// the farthest of them.
    area_normal: Vec3,
    middle: Vec3,
    radius: f32,
}

impl Bvh {
    /// Over the triangles that have an area.
    pub fn new(mut triangles: Vec<Triangle>) -> Self {
        // An area whose square is no normal number cannot be divided by.
        triangles.retain(|triangle| area_normal(triangle).length_squared().is_normal());
        let mut tree = Self { nodes: Vec::new(), triangles };
        if !tree.is_empty() {
            tree.split(0, tree.triangles.len());
        }
        tree
    }

    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Appends the node of some triangles, and those below it.
    fn split(&mut self, first: usize, end: usize) {
        let own = &mut self.triangles[first..end];
        let corners = || own.iter().flatten();
        let low = corners().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = corners().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let areas: f32 = own.iter().map(|t| area_normal(t).length()).sum();
        let weighted = |t: &Triangle| area_normal(t).length() * (t[0] + t[1] + t[2]);
        let middle = own.iter().map(weighted).sum::<Vec3>() / (3.0 * areas);
        let radius = corners().map(|c| c.distance(middle)).fold(0.0, f32::max);
        let area_normal = own.iter().map(area_normal).sum();
        let place = self.nodes.len();
        let half = own.len() / 2;
        let is_leaf = own.len() <= LEAF;
        if !is_leaf {
            let axis = (high - low).max_position();
            let key = |t: &Triangle| t[0][axis] + t[1][axis] + t[2][axis];
            own.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)));
        }
        let leaf = if is_leaf { first..end } else { 0..0 };
        self.nodes.push(Node { low, high, leaf, right: 0, area_normal, middle, radius });
        if !is_leaf {
            self.split(first, first + half);
            self.nodes[place].right = self.nodes.len();
            self.split(first + half, end);
        }
    }

    /// The nearest point on any triangle, to a thousandth of its distance, if it is nearer than
    /// the point `known`; else that.
    pub fn nearest(&self, to: Vec3, known: Vec3) -> Vec3 {
        let mut best = (known.distance_squared(to), known);
        if !self.is_empty() {
            self.nearest_below(0, to, &mut best);
        }
        best.1
    }

    fn nearest_below(&self, place: usize, to: Vec3, best: &mut (f32, Vec3)) {
        let node = &self.nodes[place];
        for triangle in &self.triangles[node.leaf.clone()] {
            let point = nearest_on(triangle, to);
            let distance = point.distance_squared(to);
            if distance < best.0 {
                *best = (distance, point);
            }
        }
        if !node.leaf.is_empty() {
            return;
        }
        let mut children = [place + 1, node.right].map(|child| {
            let Node { low, high, .. } = self.nodes[child];
            (to.clamp(low, high).distance_squared(to), child)
        });
        if children[1].0 < children[0].0 {
            children.swap(0, 1);
        }
        for (distance, child) in children {
            if distance < NEAR_ENOUGH * best.0 {
                self.nearest_below(child, to, best);
            }
        }
    }

    /// How often the triangles wind around a point: 1 inside of a closed mesh, 0 outside, between
    /// where it is open (generalized winding number: Jacobson, Kavan, Sorkine-Hornung 2013; far
    /// triangles as dipoles: Barill, Dickson, Schmidt, Levin, Jacobson 2018).
    pub fn winding(&self, around: Vec3) -> f32 {
        if self.is_empty() { 0.0 } else { self.winding_below(0, around) }
    }

    fn winding_below(&self, place: usize, around: Vec3) -> f32 {
        const TURN: f32 = 4.0 * std::f32::consts::PI;
        let node = &self.nodes[place];
        let away = node.middle - around;
        let distance = away.length();
        if distance > FAR_RADII * node.radius {
            return node.area_normal.dot(away) / (TURN * distance.powi(3));
        }
        if node.leaf.is_empty() {
            return self.winding_below(place + 1, around) + self.winding_below(node.right, around);
        }
        let own = &self.triangles[node.leaf.clone()];
        own.iter().map(|triangle| solid_angle(triangle, around)).sum::<f32>() / TURN
    }
}

fn area_normal([a, b, c]: &Triangle) -> Vec3 {
    0.5 * (b - a).cross(c - a)
}

/// Solid angle of a triangle, positive from behind (Van Oosterom & Strackee 1983).
fn solid_angle(triangle: &Triangle, from: Vec3) -> f32 {
    let [a, b, c] = triangle.map(|corner| corner - from);
    let [ra, rb, rc] = [a, b, c].map(Vec3::length);
    let over = ra * rb * rc + a.dot(b) * rc + b.dot(c) * ra + c.dot(a) * rb;
    2.0 * a.dot(b.cross(c)).atan2(over)
}

/// The point of a triangle nearest to `to`: its foot on the plane if that lies inside, else the
/// nearest on an edge.
fn nearest_on(triangle: &Triangle, to: Vec3) -> Vec3 {
    let [a, b, c] = *triangle;
    let normal = (b - a).cross(c - a);
    let is_within = |p: Vec3, q: Vec3| (q - p).cross(to - p).dot(normal) >= 0.0;
    if is_within(a, b) && is_within(b, c) && is_within(c, a) {
        return to - (to - a).dot(normal) / normal.length_squared() * normal;
    }
    let on_edge = |p: Vec3, q: Vec3| {
        let edge = q - p;
        // An edge of no length has one point.
        let part = (to - p).dot(edge) / edge.length_squared().max(f32::MIN_POSITIVE);
        p + part.clamp(0.0, 1.0) * edge
    };
    let edges = [on_edge(a, b), on_edge(b, c), on_edge(c, a)];
    let nearer = |p: Vec3, q: Vec3| {
        if q.distance_squared(to) < p.distance_squared(to) { q } else { p }
    };
    edges.into_iter().fold(edges[0], nearer)
}
