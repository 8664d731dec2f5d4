//! A byte pipe inside the process: what stands in for the cable where there is no hardware.

use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicBool, Ordering},
};

use crate::transport::{LinkDown, Transport};

#[derive(Debug, Default)]
struct Cable {
    lanes: [Mutex<Vec<u8>>; 2],
    pulled: AtomicBool,
}

/// One end of a pipe.
#[derive(Clone, Debug)]
pub struct PipeEnd {
    cable: Arc<Cable>,
    outgoing: usize,
}

/// Two ends: what one sends the other receives.
#[must_use]
pub fn pipe() -> (PipeEnd, PipeEnd) {
    let cable = Arc::new(Cable::default());
    (PipeEnd { cable: cable.clone(), outgoing: 0 }, PipeEnd { cable, outgoing: 1 })
}

impl PipeEnd {
    /// Pulls the cable, or plugs it in again; what was on its way is lost.
    pub fn set_plugged(&self, plugged: bool) {
        self.cable.pulled.store(!plugged, Ordering::SeqCst);
        for lane in &self.cable.lanes {
            lane.lock().unwrap_or_else(PoisonError::into_inner).clear();
        }
    }

    /// True while the cable is in.
    #[must_use]
    pub fn is_plugged(&self) -> bool {
        !self.cable.pulled.load(Ordering::SeqCst)
    }

    /// Works on a lane for as long as a copy takes; a peer that panicked left whole bytes.
    fn lane(&self, lane: usize, work: impl FnOnce(&mut Vec<u8>)) -> Result<(), LinkDown> {
        if !self.is_plugged() {
            return Err(LinkDown);
        }
        work(&mut self.cable.lanes[lane].lock().unwrap_or_else(PoisonError::into_inner));
        Ok(())
    }
}

impl Transport for PipeEnd {
    fn send(&mut self, _now_us: u64, bytes: &[u8]) -> Result<(), LinkDown> {
        self.lane(self.outgoing, |lane| lane.extend_from_slice(bytes))
    }

    fn receive(&mut self, _now_us: u64, into: &mut Vec<u8>) -> Result<(), LinkDown> {
        self.lane(1 - self.outgoing, |lane| into.append(lane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_end_sends_the_other_receives() {
        let (mut host, mut device) = pipe();
        host.send(0, &[1, 2]).unwrap();
        device.send(0, &[9]).unwrap();
        let (mut down, mut up) = (Vec::new(), Vec::new());
        device.receive(0, &mut down).unwrap();
        host.receive(0, &mut up).unwrap();
        assert_eq!((down, up), (vec![1, 2], vec![9]));
    }

    #[test]
    fn a_pulled_cable_carries_nothing_and_loses_what_it_held() {
        let (mut host, mut device) = pipe();
        host.send(0, &[1]).unwrap();
        device.set_plugged(false);
        assert_eq!(host.send(0, &[2]), Err(LinkDown));
        device.set_plugged(true);
        let mut down = Vec::new();
        device.receive(0, &mut down).unwrap();
        assert!(down.is_empty());
    }
}
