//! Trilinear interpolation in a window of nodes, bilinear in a patch of the surface.

use cauldron_protocol::{
    field::{Channel, Channels, PatchChannel, PatchHead},
    message::RestMedium,
};

use super::{Buffer, Medium, Surface};
use crate::{
    math::{clamp, lerp},
    vector::Vec3,
};

/// The cell between two nodes along one axis, and where in it the point stands.
#[derive(Clone, Copy)]
struct Along {
    node: usize,
    part: f32,
    /// Distance outside of the window, in spacings.
    outside: f32,
}

impl Along {
    fn new(at_m: f32, origin_m: f32, spacing_m: f32, nodes: u8) -> Self {
        let exact = (at_m - origin_m) / spacing_m;
        let held = clamp(exact, 0.0, f32::from(nodes - 1));
        let last_cell = usize::from(nodes - 2);
        let node = held as usize;
        let node = if node < last_cell { node } else { last_cell };
        Self { node, part: held - node as f32, outside: crate::math::abs(exact - held) }
    }
}

impl Buffer {
    /// The medium at a point, `wanted` channels only. Outside of the window its edge is held and
    /// faded to `rest` over one spacing.
    pub(super) fn medium(&self, at_m: Vec3, wanted: Channels, rest: &RestMedium) -> Medium {
        let head = &self.head;
        let [ox, oy, oz] = head.origin.map(|o| o.0);
        let [nx, ny, nz] = head.nodes;
        let spacing = head.spacing.0;
        let axes = [
            Along::new(at_m.x, ox, spacing, nx),
            Along::new(at_m.y, oy, spacing, ny),
            Along::new(at_m.z, oz, spacing, nz),
        ];
        let values = self.channels(&axes, wanted);
        let inside = Medium::from_channels(values, self.surface(at_m));
        let outside =
            axes.iter().fold(0.0, |most, a| if a.outside > most { a.outside } else { most });
        let fade = clamp(outside, 0.0, 1.0);
        if fade > 0.0 { inside.faded_to(rest, 1.0 - fade) } else { inside }
    }

    fn channels(&self, axes: &[Along; 3], wanted: Channels) -> [f32; Channel::COUNT] {
        let [x, y, z] = axes;
        let [nx, ny, _] = self.head.nodes.map(usize::from);
        let corner = x.node + nx * (y.node + ny * z.node);
        let nodes = self.head.node_count();
        let mut values = [0.0; Channel::COUNT];
        let mut first = 0;
        for (place, (value, quantum)) in values.iter_mut().zip(self.head.quanta).enumerate() {
            if !self.head.channels.has(place) {
                continue;
            }
            if wanted.has(place) {
                let at = first + corner;
                let near = self.square(at, nx, x.part, y.part);
                let far = self.square(at + nx * ny, nx, x.part, y.part);
                *value = lerp(near, far, z.part) * quantum;
            }
            first += nodes;
        }
        values
    }

    fn surface(&self, at_m: Vec3) -> Option<Surface> {
        let patch = self.head.patch?;
        let [ox, oz] = patch.origin.map(|o| o.0);
        let [nx, nz] = patch.nodes;
        let x = Along::new(at_m.x, ox, patch.spacing.0, nx);
        let z = Along::new(at_m.z, oz, patch.spacing.0, nz);
        let value = |channel: PatchChannel| self.patch_value(&patch, channel, x, z);
        Some(Surface {
            height_m: value(PatchChannel::Height),
            velocity_m_s: value(PatchChannel::VerticalVelocity),
            stiffness_n_per_m: value(PatchChannel::Stiffness),
            break_force_n: value(PatchChannel::BreakForce),
        })
    }

    fn patch_value(&self, patch: &PatchHead, channel: PatchChannel, x: Along, z: Along) -> f32 {
        let window = self.head.node_count() * self.head.channels.count();
        let first = window + patch.node_count() * channel as usize;
        let nx = usize::from(patch.nodes.first().copied().unwrap_or(0));
        let at = first + x.node + nx * z.node;
        let quantum = patch.quanta.get(channel as usize).copied().unwrap_or(0.0);
        self.square(at, nx, x.part, z.part) * quantum
    }

    /// Bilinear in the square whose lowest corner is sample `at`.
    fn square(&self, at: usize, row: usize, across: f32, along: f32) -> f32 {
        let [a, b] = self.pair(at);
        let [c, d] = self.pair(at + row);
        lerp(lerp(a, b, across), lerp(c, d, across), along)
    }
}
