//! The field: the medium around the probe, sampled on a window of nodes that follows it.
//!
//! A field travels as a head ([`FieldHead`], a control message) and raw little-endian i16
//! samples in slabs of at most 512 B, and is committed as a whole when the last one is there.
//! Samples stand channel by channel in the order of [`Channel`], nodes x fastest, then y, then
//! z; then the surface patch, channel by channel in the order of [`PatchChannel`], x fastest.
//! A channel that the scene lacks is not sent; a scene without surface sends no patch.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::units::{Metres, Ticks};

/// Nodes that a window can have.
pub const MAX_NODES: usize = 512;
/// Nodes that a surface patch can have.
pub const MAX_PATCH_NODES: usize = 64;
/// Samples that a field can have.
pub const MAX_SAMPLES: usize = MAX_NODES * Channel::COUNT + MAX_PATCH_NODES * PatchChannel::COUNT;
/// Slabs that a field can have.
pub const MAX_SLABS: usize = (2 * MAX_SAMPLES).div_ceil(SlabHead::MAX_DATA);

/// What a node of the window can say of the medium, in device metres and felt newtons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Channel {
    /// Flow velocity along x, m/s.
    FlowX,
    /// Flow velocity along y, m/s.
    FlowY,
    /// Flow velocity along z, m/s.
    FlowZ,
    /// c1 of F = (c1 + c2 |w|) w with w = flow - velocity, N s/m.
    LinearDrag,
    /// c2 of the same, N s^2/m^2.
    QuadraticDrag,
    /// Force along x that no medium carries, N.
    BiasX,
    /// Force along y that no medium carries, N.
    BiasY,
    /// Force along z that no medium carries, N.
    BiasZ,
}

impl Channel {
    /// Channels of the window.
    pub const COUNT: usize = 8;
    /// The three of the flow, as a set.
    pub const FLOW: Channels = Channels(0b0000_0111);
    /// The two of the drag, as a set.
    pub const DRAG: Channels = Channels(0b0001_1000);
    /// The three of the bias force, as a set.
    pub const BIAS: Channels = Channels(0b1110_0000);
    /// The vertical one of them, as a set.
    pub const BIAS_Y: Channels = Channels(0b0100_0000);
}

/// What a node of the surface patch says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum PatchChannel {
    /// Height of the surface above the device's origin, m.
    Height,
    /// Its vertical velocity, m/s.
    VerticalVelocity,
    /// Its stiffness under the probe, N/m.
    Stiffness,
    /// Force at which the probe breaks through, N.
    BreakForce,
}

impl PatchChannel {
    /// Channels of the patch.
    pub const COUNT: usize = 4;
}

/// A set of [`Channel`]s, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Channels(u8);

impl Channels {
    /// The channels of both sets.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True if all channels of `other` are in the set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Number of channels in the set.
    #[must_use]
    pub const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// True for the channel with this place in [`Channel`].
    #[must_use]
    pub const fn has(self, place: usize) -> bool {
        self.0 >> place & 1 == 1
    }
}

/// The head of a field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FieldHead {
    /// Running number of the field, from 1.
    pub epoch: u32,
    /// The device ramps to this field from here ...
    pub valid_from: Ticks,
    /// ... to here, the moment that the field predicts.
    pub valid_until: Ticks,
    /// Channels that follow.
    pub channels: Channels,
    /// Nodes along x, y, z, each at least 2; at most [`MAX_NODES`] in all.
    pub nodes: [u8; 3],
    /// Node (0, 0, 0).
    pub origin: [Metres; 3],
    /// Distance between nodes.
    pub spacing: Metres,
    /// Value of one quantum of each channel, in the channel's unit.
    pub quanta: [f32; Channel::COUNT],
    /// The surface patch, if the scene has a surface.
    pub patch: Option<PatchHead>,
}

/// The head of a surface patch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct PatchHead {
    /// Nodes along x and z, each at least 2; at most [`MAX_PATCH_NODES`] in all.
    pub nodes: [u8; 2],
    /// x and z of node (0, 0).
    pub origin: [Metres; 2],
    /// Distance between nodes.
    pub spacing: Metres,
    /// Value of one quantum of each channel, in the channel's unit.
    pub quanta: [f32; PatchChannel::COUNT],
}

impl Default for FieldHead {
    fn default() -> Self {
        Self::NONE
    }
}

impl FieldHead {
    /// The head of no field: epoch 0, no nodes.
    pub const NONE: Self = Self {
        epoch: 0,
        valid_from: Ticks(0),
        valid_until: Ticks(0),
        channels: Channels(0),
        nodes: [0; 3],
        origin: [Metres(0.0); 3],
        spacing: Metres(0.0),
        quanta: [0.0; Channel::COUNT],
        patch: None,
    };

    /// Nodes of the window.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.iter().map(|n| usize::from(*n)).product()
    }

    /// Samples of window and patch.
    #[must_use]
    pub fn sample_count(&self) -> usize {
        let patch = self.patch.map_or(0, |p| p.node_count() * PatchChannel::COUNT);
        self.node_count() * self.channels.count() + patch
    }

    /// Slabs that the samples travel in.
    #[must_use]
    pub fn slab_count(&self) -> usize {
        (2 * self.sample_count()).div_ceil(SlabHead::MAX_DATA)
    }

    /// True if a device can hold the field and work with it: sizes in range, every number
    /// finite, spacings above zero, a window of time that is not backwards.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let window = self.nodes.iter().all(|n| *n >= 2) && self.node_count() <= MAX_NODES;
        let place = self.origin.iter().all(|o| o.0.is_finite()) && is_spacing(self.spacing);
        let values = self.quanta.iter().all(|q| q.is_finite());
        let time = self.valid_until.since(self.valid_from) >= 0;
        window && place && values && time && self.patch.is_none_or(|p| p.is_sound())
    }
}

impl PatchHead {
    /// Nodes of the patch.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.iter().map(|n| usize::from(*n)).product()
    }

    fn is_sound(&self) -> bool {
        let size = self.nodes.iter().all(|n| *n >= 2) && self.node_count() <= MAX_PATCH_NODES;
        let place = self.origin.iter().all(|o| o.0.is_finite()) && is_spacing(self.spacing);
        size && place && self.quanta.iter().all(|q| q.is_finite())
    }
}

fn is_spacing(spacing: Metres) -> bool {
    spacing.0 >= 1e-6 && spacing.0 <= 1e3
}

/// The head of a slab: which field, and which slice of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlabHead {
    /// Epoch of the field.
    pub epoch: u32,
    /// The slab's place: its data starts at byte `512 * index`.
    pub index: u16,
}

impl SlabHead {
    /// Bytes of the head on the wire.
    pub const BYTES: usize = 6;
    /// Bytes of samples in a slab, but for the last.
    pub const MAX_DATA: usize = 512;

    /// Splits a slab's body into head and data.
    #[must_use]
    pub fn split(body: &[u8]) -> Option<(Self, &[u8])> {
        let (head, data) = body.split_first_chunk::<{ Self::BYTES }>()?;
        let &[e0, e1, e2, e3, i0, i1] = head;
        let epoch = u32::from_le_bytes([e0, e1, e2, e3]);
        Some((Self { epoch, index: u16::from_le_bytes([i0, i1]) }, data))
    }

    /// Writes head and data into `room`; the bytes written, or `None` if they do not fit.
    pub fn join(self, data: &[u8], room: &mut [u8]) -> Option<usize> {
        let bytes = Self::BYTES + data.len();
        let (head, rest) = room.get_mut(..bytes)?.split_first_chunk_mut::<{ Self::BYTES }>()?;
        let [e0, e1, e2, e3] = self.epoch.to_le_bytes();
        let [i0, i1] = self.index.to_le_bytes();
        *head = [e0, e1, e2, e3, i0, i1];
        rest.copy_from_slice(data);
        Some(bytes)
    }
}

/// The quantum with which values up to `largest` fit into i16: a power of two, so that it
/// seldom changes from one field to the next and a field that did not change is seen as such.
#[must_use]
pub fn quantum_for(largest: f32) -> f32 {
    const SMALLEST: f32 = 1.0 / (1u32 << 30) as f32;
    let least = largest / f32::from(i16::MAX);
    if least > SMALLEST && least < f32::MAX / 4.0 {
        let mantissa = 0x007f_ffff;
        let bits = least.to_bits();
        f32::from_bits(if bits & mantissa == 0 { bits } else { (bits & !mantissa) + mantissa + 1 })
    } else {
        SMALLEST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantum_is_the_next_power_of_two() {
        assert_eq!(quantum_for(32767.0), 1.0);
        assert_eq!(quantum_for(32768.0), 2.0);
        assert_eq!(quantum_for(0.25 * 32767.0), 0.25);
        for junk in [0.0, f32::NAN, f32::INFINITY, -1.0] {
            assert!(quantum_for(junk) > 0.0 && quantum_for(junk) < 1e-8);
        }
    }

    #[test]
    fn the_default_window_is_what_the_design_counts() {
        let head = FieldHead {
            channels: Channel::FLOW.and(Channel::DRAG).and(Channel::BIAS),
            nodes: [8; 3],
            spacing: Metres(0.005),
            ..FieldHead::default()
        };
        assert!(head.is_sound());
        assert_eq!(2 * head.sample_count(), 8192);
        assert_eq!(head.slab_count(), 16);
        assert_eq!(MAX_SLABS, 17);
    }

    #[test]
    fn a_slab_comes_apart_as_it_was_joined() {
        let head = SlabHead { epoch: 0x0102_0304, index: 7 };
        let mut room = [0; 16];
        let n = head.join(&[9, 8, 7], &mut room).unwrap();
        assert_eq!(&room[..n], [4, 3, 2, 1, 7, 0, 9, 8, 7]);
        assert_eq!(SlabHead::split(&room[..n]), Some((head, &[9, 8, 7][..])));
        assert_eq!(SlabHead::split(&room[..5]), None);
    }

    #[test]
    fn heads_that_contradict_themselves_are_not_sound() {
        let sound = FieldHead { nodes: [8; 3], spacing: Metres(0.01), ..FieldHead::default() };
        assert!(sound.is_sound());
        assert!(!FieldHead { nodes: [9, 8, 8], ..sound }.is_sound());
        assert!(!FieldHead { nodes: [1, 8, 8], ..sound }.is_sound());
        assert!(!FieldHead { spacing: Metres(0.0), ..sound }.is_sound());
        assert!(!FieldHead { spacing: Metres(f32::NAN), ..sound }.is_sound());
        assert!(!FieldHead { valid_from: Ticks(5), valid_until: Ticks(4), ..sound }.is_sound());
        let patch = PatchHead {
            nodes: [8, 9],
            origin: [Metres(0.0); 2],
            spacing: Metres(0.01),
            quanta: [0.0; 4],
        };
        assert!(!FieldHead { patch: Some(patch), ..sound }.is_sound());
    }
}
