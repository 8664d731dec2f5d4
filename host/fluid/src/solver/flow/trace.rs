//! Velocities between faces, and advection along traced paths.
//!
//! A step across many cells traces each face back along the flow (Robert 1981; midpoint rule),
//! takes the velocity found there, and corrects it by half the error of going there and back
//! (MacCormack form of Selle, Fedkiw, Kim, Liu, Rossignac 2008), unless that would leave the
//! range of the values it was interpolated from. It can lose energy but never gain amplitude.

use glam::Vec3;

use crate::solver::flow::{
    engine::Engine,
    field::{Layout, Vector, components},
    ghosts::{Fill, Ghosts},
};

/// Where a point lies between the eight values around it.
struct Place {
    index: usize,
    share: [f32; 3],
}

/// Position of face `c` of cell (i, j, k) in cells from the grid's corner.
pub fn face_in_cells(c: usize, i: usize, j: usize, k: usize) -> Vec3 {
    let mut point = Vec3::new(i as f32, j as f32, k as f32) + 0.5;
    point[c] -= 0.5;
    point
}

/// Component `c` of the velocity at a point in cells from the grid's corner. Outside the
/// grid it is that of the nearest point inside.
pub fn component_at(layout: &Layout, field: &[f32], c: usize, point: Vec3) -> f32 {
    corners(layout, field, &place(layout, c, point)).0
}

/// The velocity at a point in cells from the grid's corner.
pub fn velocity_at(layout: &Layout, velocity: [&[f32]; 3], point: Vec3) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|c| component_at(layout, velocity[c], c, point)))
}

fn place(layout: &Layout, c: usize, point: Vec3) -> Place {
    let (mut at, mut share) = ([0; 3], [0.0; 3]);
    for d in 0..3 {
        let cells = layout.cells[d];
        let (offset, last) = if d == c { (0.0, cells) } else { (0.5, cells - 1) };
        // A comparison that is false for NaN: clamp would keep it.
        let inside = if point[d] > offset { (point[d] - offset).min(last as f32) } else { 0.0 };
        at[d] = (inside as usize).min(last.saturating_sub(1));
        share[d] = inside - at[d] as f32;
    }
    Place { index: layout.index(at[0], at[1], at[2]), share }
}

/// The interpolated value, the smallest and the largest of the eight around the place.
fn corners(layout: &Layout, field: &[f32], place: &Place) -> (f32, f32, f32) {
    let [sx, sy, sz] = layout.strides();
    let (mut sum, mut low, mut high) = (0.0, f32::INFINITY, f32::NEG_INFINITY);
    for corner in 0..8 {
        let bits = [corner & 1, corner >> 1 & 1, corner >> 2];
        let value = field[place.index + bits[0] * sx + bits[1] * sy + bits[2] * sz];
        let weight = |d: usize| if bits[d] == 1 { place.share[d] } else { 1.0 - place.share[d] };
        sum += weight(0) * weight(1) * weight(2) * value;
        (low, high) = (low.min(value), high.max(value));
    }
    (sum, low, high)
}

/// Advects `velocity` along itself by `cells_per_m_s` = dt / h. `once` is work space, `out` the
/// result.
pub fn advect(
    on: Engine<'_>,
    layout: &Layout,
    ghosts: &Ghosts,
    velocity: &Vector,
    once: &mut Vector,
    out: &mut Vector,
    cells_per_m_s: f32,
) {
    let velocity = components(velocity);
    let path = |from: Vec3, reach: f32| {
        let middle = from + 0.5 * reach * velocity_at(layout, velocity, from);
        from + reach * velocity_at(layout, velocity, middle)
    };
    visit_faces(on, layout, once, |c, _, face| {
        component_at(layout, velocity[c], c, path(face, -cells_per_m_s))
    });
    ghosts.fill(once, Fill::Unprojected);
    let once = components(once);
    visit_faces(on, layout, out, |c, at, face| {
        let departure = place(layout, c, path(face, -cells_per_m_s));
        let (_, low, high) = corners(layout, velocity[c], &departure);
        let there_and_back = component_at(layout, once[c], c, path(face, cells_per_m_s));
        let corrected = once[c][at] + 0.5 * (velocity[c][at] - there_and_back);
        if (low..=high).contains(&corrected) { corrected } else { once[c][at] }
    });
    ghosts.fill(out, Fill::Unprojected);
}

/// Sets every open face to `value(component, index, position in cells)`.
fn visit_faces(
    on: Engine<'_>,
    layout: &Layout,
    out: &mut Vector,
    value: impl Fn(usize, usize, Vec3) -> f32 + Sync,
) {
    let outs = out.each_mut().map(|out| layout.planes(out));
    on.pool.planes(outs, [layout.plane; 3], |k, mut outs| {
        let [nx, ny, _] = layout.cells;
        for (c, out) in outs.iter_mut().enumerate() {
            for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
                let at = layout.index(i, j, k);
                let is_open = on.faces.open[c][at] > 0.0;
                let moved = if is_open { value(c, at, face_in_cells(c, i, j, k)) } else { 0.0 };
                out[layout.index_in_plane(i, j)] = moved;
            }
        }
    });
}
