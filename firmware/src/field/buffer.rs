//! One field: its head and its samples, and whether all of them have come.

use cauldron_protocol::{
    field::{FieldHead, MAX_SAMPLES, MAX_SLABS, SlabHead},
    units::Ticks,
};

/// Room for a field of any size that the protocol allows.
#[derive(Clone, Debug)]
pub struct Buffer {
    pub(super) head: FieldHead,
    /// The field is stale after this; its head's `valid_until`, or later where it was kept.
    pub(super) expires: Ticks,
    samples: [i16; MAX_SAMPLES],
    missing: u32,
}

const _: () = assert!(MAX_SLABS <= u32::BITS as usize, "a bit for each slab");

impl Buffer {
    /// No field.
    pub const EMPTY: Self =
        Self { head: FieldHead::NONE, expires: Ticks(0), samples: [0; MAX_SAMPLES], missing: 0 };

    /// Begins the field that `head` announces; false, and no field, if it cannot be held.
    pub fn begin(&mut self, head: FieldHead) -> bool {
        let sound = head.epoch != 0 && head.is_sound() && head.slab_count() <= MAX_SLABS;
        self.head = if sound { head } else { FieldHead::NONE };
        self.expires = self.head.valid_until;
        self.missing = if sound { (1u32 << head.slab_count()) - 1 } else { 0 };
        sound
    }

    /// True if a field was begun here and has not become whole.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.missing != 0
    }

    /// Stores a slab; true if it was the last one missing. One of another field, or of another
    /// length than its place asks for, is left alone.
    pub fn store(&mut self, slab: SlabHead, data: &[u8]) -> bool {
        let place = usize::from(slab.index);
        let bytes = 2 * self.head.sample_count();
        let start = place * SlabHead::MAX_DATA;
        let wanted = bytes.saturating_sub(start);
        let wanted = if wanted < SlabHead::MAX_DATA { wanted } else { SlabHead::MAX_DATA };
        if slab.epoch != self.head.epoch || !self.is_open() || wanted == 0 || data.len() != wanted {
            return false;
        }
        let Some(room) = self.samples.get_mut(start / 2..) else { return false };
        for (sample, bytes) in room.iter_mut().zip(data.as_chunks::<2>().0) {
            *sample = i16::from_le_bytes(*bytes);
        }
        self.missing &= !(1 << place);
        !self.is_open()
    }

    /// The sample at `index` and the one after it, 0 past the end: read together, since a check
    /// of bounds costs as much as a sample.
    pub(super) fn pair(&self, index: usize) -> [f32; 2] {
        let pair = self.samples.get(index..).and_then(|from| from.first_chunk::<2>());
        pair.copied().unwrap_or_default().map(f32::from)
    }
}
