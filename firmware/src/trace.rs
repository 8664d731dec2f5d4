//! A hash over what the device did: two runs with the same hash moved and pushed alike, bit by
//! bit.

use cauldron_protocol::State;

/// FNV-1a, 64 bit (Fowler, Noll, Vo 1991), over tick, position and force bits of every state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceHash(u64);

impl Default for TraceHash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl TraceHash {
    /// Takes the next state.
    pub fn add(&mut self, state: &State) {
        self.add_word(state.tick.0);
        state.position.iter().for_each(|p| self.add_word(p.0.to_bits()));
        state.force.iter().for_each(|f| self.add_word(f.0.to_bits()));
    }

    /// The hash so far.
    #[must_use]
    pub fn value(self) -> u64 {
        self.0
    }

    fn add_word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cauldron_protocol::units::{Newtons, Ticks};

    #[test]
    fn follows_the_published_vectors() {
        let mut hash = TraceHash::default();
        assert_eq!(hash.value(), 0xcbf2_9ce4_8422_2325, "of nothing");
        hash.add_word(u32::from_le_bytes(*b"chon"));
        for byte in b"go was here!\n" {
            hash.0 = (hash.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        assert_eq!(hash.value(), 0x4681_0940_eff5_f915, "of \"chongo was here!\\n\"");
    }

    #[test]
    fn a_bit_of_a_force_changes_it() {
        let hash = |force| {
            let mut hash = TraceHash::default();
            hash.add(&State { tick: Ticks(1), force: [Newtons(force); 3], ..State::default() });
            hash.value()
        };
        assert_ne!(hash(1.0), hash(1.0 + f32::EPSILON));
        assert_ne!(hash(0.0), hash(-0.0));
    }
}
