//! Counts the instructions of every stage.
//!
//! Under `-icount shift=7` an instruction takes 128 ns whatever it does, and SysTick, at 25 MHz,
//! counts 3.2 in it: enough for the difference of two readings to name one number of
//! instructions. What a mark itself costs is measured at the start and taken off.

use core::{arch::asm, fmt};

use cauldron_firmware::stopwatch::{Stage, Stopwatch};
use cortex_m::peripheral::{SYST, syst::SystClkSource};

/// SysTick counts down, in 24 bit.
const COUNTER: u32 = 0x00ff_ffff;
/// Instructions of known number, to see that they are what is counted.
const KNOWN: u32 = 1000;
/// What reading the clock may add to them.
const SLACK: u32 = 8;

const STAGES: usize = Stage::ALL.len();

/// What every stage cost so far.
pub struct Watch {
    /// SysTick when the last mark let go.
    last: u32,
    /// Instructions of a mark that fall to the stage it ends.
    own: u32,
    ticks: u32,
    /// Of the tick that runs.
    spent: [u32; STAGES],
    stages: [Cost; STAGES],
    servo: Cost,
    tick: Cost,
}

/// Instructions of something that happens once a tick.
#[derive(Clone, Copy, Default)]
struct Cost {
    sum: u64,
    worst: u32,
}

impl Watch {
    /// Starts SysTick, and sees to it that it counts instructions.
    pub fn start() -> Result<Self, &'static str> {
        let mut systick = cortex_m::Peripherals::take().ok_or("SysTick is taken")?.SYST;
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(COUNTER);
        systick.clear_current();
        systick.enable_counter();
        if !(KNOWN..KNOWN + SLACK).contains(&count_known()) {
            return Err("SysTick does not count instructions: run under `-icount shift=7`");
        }
        let mut trial = Self::with_own_cost(0);
        trial.ended(Stage::Link);
        trial.ended(Stage::Encoder);
        Ok(Self::with_own_cost(trial.spent[Stage::Encoder as usize]))
    }

    fn with_own_cost(own: u32) -> Self {
        Self {
            last: SYST::get_current(),
            own,
            ticks: 0,
            spent: [0; STAGES],
            stages: [Cost::default(); STAGES],
            servo: Cost::default(),
            tick: Cost::default(),
        }
    }

    fn book(&mut self, stage: Stage, spent: u32) {
        // Before the first mark the device was made: that is no part of a tick.
        let is_first = self.ticks == 0 && stage == Stage::Link;
        self.spent[stage as usize] = if is_first { 0 } else { spent };
        if stage == Stage::Report {
            self.close_tick();
        }
    }

    fn close_tick(&mut self) {
        for (cost, spent) in self.stages.iter_mut().zip(self.spent) {
            cost.add(spent);
        }
        let servo = Stage::Encoder as usize..=Stage::Limit as usize;
        self.servo.add(self.spent[servo].iter().sum());
        self.tick.add(self.spent.iter().sum());
        self.ticks += 1;
    }
}

impl Stopwatch for Watch {
    #[inline(never)] // so that every mark costs the same
    fn ended(&mut self, stage: Stage) {
        let now = SYST::get_current();
        self.book(stage, instructions(self.last, now).saturating_sub(self.own));
        self.last = SYST::get_current();
    }
}

impl Cost {
    fn add(&mut self, spent: u32) {
        self.sum += u64::from(spent);
        self.worst = self.worst.max(spent);
    }
}

impl fmt::Display for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ticks = u64::from(self.ticks.max(1));
        writeln!(f, "{:<24}{:>8}{:>8}", "instructions", "mean", "worst")?;
        let mut row = |name: &str, cost: &Cost| {
            writeln!(f, "{name:<24}{:>8}{:>8}", cost.sum / ticks, cost.worst)
        };
        for (stage, cost) in Stage::ALL.iter().zip(&self.stages) {
            row(stage.name(), cost)?;
        }
        row("servo: encoder to torque", &self.servo)?;
        row("whole tick", &self.tick)
    }
}

/// Instructions between two readings of SysTick.
fn instructions(before: u32, after: u32) -> u32 {
    let counts = before.wrapping_sub(after) & COUNTER;
    (counts * 5 + 8) / 16
}

/// How many instructions [`KNOWN`] ones seem to be.
fn count_known() -> u32 {
    let before = SYST::get_current();
    // SAFETY: instructions that do nothing.
    unsafe { asm!(".rept {n}", "nop", ".endr", n = const KNOWN, options(nostack)) };
    instructions(before, SYST::get_current())
}
