//! Four fields and the part that each plays. Parts change hands, samples never move: a field is
//! 9 kB, and a tick has no time to copy it.

use super::Buffer;

/// Buffers, and who is who.
#[derive(Clone, Debug)]
pub struct Shelf {
    buffers: [Buffer; 4],
    from: u8,
    to: u8,
    waiting: u8,
    receiving: u8,
}

impl Default for Shelf {
    fn default() -> Self {
        Self { buffers: [const { Buffer::EMPTY }; 4], from: 0, to: 1, waiting: 2, receiving: 3 }
    }
}

impl Shelf {
    /// The field that is ramped from.
    pub fn from(&self) -> &Buffer {
        self.get(self.from)
    }

    /// The field that acts, or is ramped to.
    pub fn to(&self) -> &Buffer {
        self.get(self.to)
    }

    /// The field that acts, to prolong it.
    pub fn to_mut(&mut self) -> &mut Buffer {
        self.get_mut(self.to)
    }

    /// The field whose time has not come.
    pub fn waiting(&self) -> &Buffer {
        self.get(self.waiting)
    }

    /// The same, to prolong it.
    pub fn waiting_mut(&mut self) -> &mut Buffer {
        self.get_mut(self.waiting)
    }

    /// The field that is being received.
    pub fn receiving(&mut self) -> &mut Buffer {
        self.get_mut(self.receiving)
    }

    /// What was received waits; what waited is overwritten next.
    pub fn commit(&mut self) {
        core::mem::swap(&mut self.waiting, &mut self.receiving);
    }

    /// What waited acts; what acted is ramped from.
    pub fn promote(&mut self) {
        core::mem::swap(&mut self.from, &mut self.to);
        core::mem::swap(&mut self.to, &mut self.waiting);
    }

    // By pattern: an index could be out of bounds, in the compiler's eyes.
    fn get(&self, part: u8) -> &Buffer {
        let [a, b, c, d] = &self.buffers;
        match part {
            0 => a,
            1 => b,
            2 => c,
            _ => d,
        }
    }

    fn get_mut(&mut self, part: u8) -> &mut Buffer {
        let [a, b, c, d] = &mut self.buffers;
        match part {
            0 => a,
            1 => b,
            2 => c,
            _ => d,
        }
    }
}
