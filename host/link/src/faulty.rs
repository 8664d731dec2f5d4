//! A transport that delays, loses and garbles on purpose, seeded: what every other transport may
//! do by accident.

use oorandom::Rand64;
use std::collections::VecDeque;

use crate::transport::{LinkDown, Transport};

/// What goes wrong, each way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Part of the hand-overs that are lost as a whole.
    pub loss: f64,
    /// Part of the bytes of which one bit is flipped.
    pub bit_flips: f64,
    /// Time on the way.
    pub delay_us: u64,
    /// Most that is added to it by chance; the order stays.
    pub jitter_us: u64,
}

impl Faults {
    /// The default way to a device: half a millisecond to one, and nothing lost. A device takes
    /// a kilobyte a tick, so a field of 6 kB has come whole some 6 ms after it was sent.
    pub const TRANSFER: Self = Self { loss: 0.0, bit_flips: 0.0, delay_us: 500, jitter_us: 500 };
}

/// A transport with faults. Those of what is sent and received are drawn from one seed.
#[derive(Debug)]
pub struct Faulty<T> {
    inner: T,
    /// Faults on what is sent; may be changed while it runs.
    pub down: Faults,
    /// Faults on what is received.
    pub up: Faults,
    random: Rand64,
    sent: Lane,
    received: Lane,
    fresh: Vec<u8>,
}

/// Bytes on their way, and when they arrive.
#[derive(Debug, Default)]
struct Lane {
    parcels: VecDeque<(u64, Vec<u8>)>,
    latest_us: u64,
}

impl Lane {
    fn put(&mut self, now_us: u64, bytes: &[u8], faults: &Faults, random: &mut Rand64) {
        if bytes.is_empty() || random.rand_float() < faults.loss {
            return;
        }
        let mut parcel = bytes.to_vec();
        if faults.bit_flips > 0.0 {
            for byte in &mut parcel {
                if random.rand_float() < faults.bit_flips {
                    *byte ^= 1 << random.rand_range(0..8);
                }
            }
        }
        let jitter_us = (random.rand_float() * faults.jitter_us as f64) as u64;
        self.latest_us = self.latest_us.max(now_us + faults.delay_us + jitter_us);
        self.parcels.push_back((self.latest_us, parcel));
    }

    fn arrived(&mut self, now_us: u64) -> Option<Vec<u8>> {
        self.parcels.pop_front_if(|p| p.0 <= now_us).map(|p| p.1)
    }
}

impl<T: Transport> Faulty<T> {
    /// Puts faults around `inner`.
    #[must_use]
    pub fn new(inner: T, down: Faults, up: Faults, seed: u64) -> Self {
        Self {
            inner,
            down,
            up,
            random: Rand64::new(u128::from(seed)),
            sent: Lane::default(),
            received: Lane::default(),
            fresh: Vec::new(),
        }
    }

    /// Lets what is due go on its way; both calls of the transport do so too.
    ///
    /// # Errors
    /// [`LinkDown`] if the transport inside is down: then all that was on its way is lost.
    pub fn flush(&mut self, now_us: u64) -> Result<(), LinkDown> {
        while let Some(parcel) = self.sent.arrived(now_us) {
            self.inner.send(now_us, &parcel).inspect_err(|_| self.sent.parcels.clear())?;
        }
        Ok(())
    }
}

impl<T: Transport> Transport for Faulty<T> {
    fn send(&mut self, now_us: u64, bytes: &[u8]) -> Result<(), LinkDown> {
        self.sent.put(now_us, bytes, &self.down, &mut self.random);
        self.flush(now_us)
    }

    fn receive(&mut self, now_us: u64, into: &mut Vec<u8>) -> Result<(), LinkDown> {
        self.flush(now_us)?;
        self.fresh.clear();
        self.inner
            .receive(now_us, &mut self.fresh)
            .inspect_err(|_| self.received.parcels.clear())?;
        self.received.put(now_us, &self.fresh, &self.up, &mut self.random);
        while let Some(parcel) = self.received.arrived(now_us) {
            into.extend_from_slice(&parcel);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipe::pipe;

    fn carried(faults: Faults, seed: u64) -> Vec<(u64, Vec<u8>)> {
        let (host, mut device) = pipe();
        let mut host = Faulty::new(host, faults, Faults::default(), seed);
        let mut seen = Vec::new();
        for ms in 0..400 {
            let now_us = ms * 1000;
            if ms < 300 {
                host.send(now_us, &[ms as u8; 40]).unwrap();
            }
            host.flush(now_us).unwrap();
            let mut got = Vec::new();
            device.receive(now_us, &mut got).unwrap();
            if !got.is_empty() {
                seen.push((ms, got));
            }
        }
        seen
    }

    #[test]
    fn without_faults_everything_arrives_at_once() {
        let seen = carried(Faults::default(), 1);
        assert_eq!(seen.len(), 300);
        assert!(seen.iter().all(|(ms, bytes)| bytes[..] == [*ms as u8; 40]));
    }

    #[test]
    fn a_delay_keeps_the_order() {
        let seen = carried(Faults { delay_us: 20_000, jitter_us: 9_000, ..Faults::default() }, 1);
        let bytes: Vec<u8> = seen.iter().flat_map(|s| s.1.iter().step_by(40).copied()).collect();
        assert_eq!(bytes, (0..300).map(|i| i as u8).collect::<Vec<_>>());
        assert!(seen[0].0 >= 20 && seen[0].0 <= 30);
    }

    #[test]
    fn loss_and_flips_come_as_often_as_asked_and_as_seeded() {
        let faults = Faults { loss: 0.3, bit_flips: 0.01, ..Faults::default() };
        let seen = carried(faults, 7);
        assert!((180..240).contains(&seen.len()), "{}", seen.len());
        let flips: u32 = seen
            .iter()
            .flat_map(|(ms, bytes)| bytes.iter().map(|b| (b ^ *ms as u8).count_ones()))
            .sum();
        assert!((40..140).contains(&flips), "{flips}");
        assert_eq!(seen, carried(faults, 7));
        assert_ne!(seen, carried(faults, 8));
    }
}
