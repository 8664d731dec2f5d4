//! May the servo act? A table of states and events, watchdogs that make events, and the log of
//! faults.
//!
//! | | Arm | Disarm | field acts | cable or host gone | other fault |
//! |---|---|---|---|---|---|
//! | **Idle** | Armed | Idle | Idle | Idle | Fault |
//! | **Armed** | refused | Idle | Running | Fault | Fault |
//! | **Running** | refused | Idle | Running | Fault | Fault |
//! | **Fault** | refused | Idle | Fault | Fault | Fault |
//!
//! Arm asks for a vessel, params and the deadman; Disarm leaves Fault only when its cause is
//! gone; a second fault does not displace the first.

use cauldron_protocol::{
    Fault, Refusal, Supervisor,
    message::{FAULT_LOG, FaultEntry},
    units::Ticks,
};
use heapless::Deque;

/// The link must be dead for so long before it counts as gone.
const CABLE_TICKS: u32 = 5;
/// The host must be silent for so long before that is a fault.
const SILENCE_TICKS: i32 = 250;
/// The force ramps up over so many ticks after arming.
const ARMING_TICKS: f32 = 250.0;

/// What can happen to the supervisor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The host asks to arm, and all that is needed is there.
    Arm,
    /// The host asks to disarm, or the deadman was let go.
    Disarm,
    /// A field acts.
    FieldActs,
    /// Something is wrong.
    Fault(Fault),
}

/// The table.
///
/// # Errors
/// [`Refusal::WrongState`] for Arm in any state but Idle.
pub fn next(state: Supervisor, event: Event) -> Result<Supervisor, Refusal> {
    use Supervisor::{Armed, Fault as Faulted, Idle, Running};
    Ok(match (state, event) {
        (Idle, Event::Arm) => Armed,
        (_, Event::Arm) => return Err(Refusal::WrongState),
        (_, Event::Disarm) => Idle,
        (Armed, Event::FieldActs) => Running,
        (_, Event::FieldActs) => state,
        (Faulted(first), Event::Fault(_)) => Faulted(first),
        (Idle, Event::Fault(Fault::CableGone | Fault::HostSilent)) => Idle,
        (_, Event::Fault(fault)) => Faulted(fault),
    })
}

/// What the limiter may let through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// Part of the wanted force, 0 to 1; below 1 while the arming ramp lasts.
    pub gain: f32,
    /// The force goes to zero, and by the fast way: F_max within 2 ms.
    pub safe: bool,
}

/// What the watchdogs look at in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Signs {
    /// The link is alive.
    pub link_up: bool,
    /// The last tick overran.
    pub overrun: bool,
    /// The deadman is held.
    pub deadman: bool,
    /// A field acts.
    pub field_acts: bool,
    /// The encoders' fault, if they have one.
    pub sensing: Option<Fault>,
}

/// State, watchdogs and log.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    state: Supervisor,
    link_down_ticks: u32,
    heard: Ticks,
    cause_stands: bool,
    gain: f32,
    log: Deque<FaultEntry, FAULT_LOG>,
}

impl Watch {
    /// Where the supervisor stands.
    #[must_use]
    pub fn state(&self) -> Supervisor {
        self.state
    }

    /// The last faults, oldest first.
    pub fn log(&self) -> impl Iterator<Item = FaultEntry> + '_ {
        self.log.iter().copied()
    }

    /// The host said something.
    pub fn hear(&mut self, now: Ticks) {
        self.heard = now;
    }

    /// Arms; the caller has seen to vessel, params and deadman.
    ///
    /// # Errors
    /// [`Refusal::WrongState`] if not Idle.
    pub fn arm(&mut self) -> Result<(), Refusal> {
        self.state = next(self.state, Event::Arm)?;
        self.gain = 0.0;
        Ok(())
    }

    /// Disarms, and clears a fault.
    ///
    /// # Errors
    /// [`Refusal::FaultStands`] if its cause is not gone.
    pub fn disarm(&mut self) -> Result<(), Refusal> {
        if matches!(self.state, Supervisor::Fault(_)) && self.cause_stands {
            return Err(Refusal::FaultStands);
        }
        self.state = next(self.state, Event::Disarm)?;
        Ok(())
    }

    /// Something is wrong now.
    pub fn trip(&mut self, now: Ticks, fault: Fault) {
        let before = self.state;
        self.state = next(self.state, Event::Fault(fault)).unwrap_or(before);
        if self.state != before {
            if self.log.is_full() {
                self.log.pop_front();
            }
            // Room was made just above.
            let _ = self.log.push_back(FaultEntry { tick: now, fault });
        }
    }

    /// Looks at the signs of a tick and decides what may act.
    pub fn advance(&mut self, now: Ticks, signs: &Signs) -> Gate {
        let fault = self.find_fault(now, signs);
        self.cause_stands = fault.is_some();
        if let Some(fault) = fault {
            self.trip(now, fault);
        }
        let armed = matches!(self.state, Supervisor::Armed | Supervisor::Running);
        let event = match (armed, signs.deadman, signs.field_acts) {
            (true, false, _) => Some(Event::Disarm),
            (true, true, true) => Some(Event::FieldActs),
            _ => None,
        };
        if let Some(event) = event {
            self.state = next(self.state, event).unwrap_or(self.state);
        }
        self.gate()
    }

    fn find_fault(&mut self, now: Ticks, signs: &Signs) -> Option<Fault> {
        self.link_down_ticks =
            if signs.link_up { 0 } else { self.link_down_ticks.saturating_add(1) };
        let silent = now.since(self.heard) > SILENCE_TICKS;
        let armed = matches!(self.state, Supervisor::Armed | Supervisor::Running);
        if signs.sensing.is_some() {
            signs.sensing
        } else if signs.overrun {
            Some(Fault::Overrun)
        } else if self.link_down_ticks >= CABLE_TICKS {
            Some(Fault::CableGone)
        } else if silent && armed {
            Some(Fault::HostSilent)
        } else {
            None
        }
    }

    fn gate(&mut self) -> Gate {
        let running = self.state == Supervisor::Running;
        self.gain = if running { self.gain + 1.0 / ARMING_TICKS } else { 0.0 };
        if self.gain > 1.0 {
            self.gain = 1.0;
        }
        Gate { gain: self.gain, safe: !running }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Supervisor::{Armed, Fault as Faulted, Idle, Running};

    const WELL: Signs =
        Signs { link_up: true, overrun: false, deadman: true, field_acts: true, sensing: None };

    /// The table at the top of the file, cell by cell.
    #[test]
    fn the_table() {
        let cable = Event::Fault(Fault::CableGone);
        let other = Event::Fault(Fault::Overrun);
        let refused = Err(Refusal::WrongState);
        let stopped = Faulted(Fault::EncoderJump);
        let events = [Event::Arm, Event::Disarm, Event::FieldActs, cable, other];
        let table = [
            (Idle, [Ok(Armed), Ok(Idle), Ok(Idle), Ok(Idle), Ok(Faulted(Fault::Overrun))]),
            (
                Armed,
                [
                    refused,
                    Ok(Idle),
                    Ok(Running),
                    Ok(Faulted(Fault::CableGone)),
                    Ok(Faulted(Fault::Overrun)),
                ],
            ),
            (
                Running,
                [
                    refused,
                    Ok(Idle),
                    Ok(Running),
                    Ok(Faulted(Fault::CableGone)),
                    Ok(Faulted(Fault::Overrun)),
                ],
            ),
            (stopped, [refused, Ok(Idle), Ok(stopped), Ok(stopped), Ok(stopped)]),
        ];
        for (state, row) in table {
            for (event, want) in events.into_iter().zip(row) {
                assert_eq!(next(state, event), want, "{state:?} {event:?}");
            }
        }
    }

    fn running() -> Watch {
        let mut watch = Watch::default();
        watch.arm().unwrap();
        watch.advance(Ticks(0), &WELL);
        assert_eq!(watch.state(), Running);
        watch
    }

    #[test]
    fn a_dead_link_is_a_fault_in_the_fifth_tick_and_clears_when_it_is_back() {
        let mut watch = running();
        let dead = Signs { link_up: false, ..WELL };
        for tick in 1..5 {
            watch.advance(Ticks(tick), &dead);
            assert_eq!(watch.state(), Running);
        }
        assert!(watch.advance(Ticks(5), &dead).safe);
        assert_eq!(watch.state(), Faulted(Fault::CableGone));
        assert_eq!(watch.disarm(), Err(Refusal::FaultStands));
        watch.advance(Ticks(6), &WELL);
        assert_eq!(watch.disarm(), Ok(()));
        assert_eq!(watch.state(), Idle);
        assert_eq!(watch.log().next().map(|e| e.fault), Some(Fault::CableGone));
    }

    #[test]
    fn a_silent_host_is_a_fault_only_after_a_quarter_second() {
        let mut watch = running();
        watch.advance(Ticks(250), &WELL);
        assert_eq!(watch.state(), Running);
        watch.advance(Ticks(251), &WELL);
        assert_eq!(watch.state(), Faulted(Fault::HostSilent));
    }

    #[test]
    fn letting_the_deadman_go_disarms() {
        let mut watch = running();
        let gate = watch.advance(Ticks(1), &Signs { deadman: false, ..WELL });
        assert_eq!(watch.state(), Idle);
        assert_eq!(gate, Gate { gain: 0.0, safe: true });
    }

    #[test]
    fn the_force_ramps_up_over_a_quarter_second() {
        let mut watch = running();
        let mut gain = watch.gain;
        for tick in 1..=250 {
            watch.hear(Ticks(tick));
            let gate = watch.advance(Ticks(tick), &WELL);
            assert!(gate.gain - gain < 0.005 && !gate.safe);
            gain = gate.gain;
        }
        assert_eq!(gain, 1.0);
    }
}
