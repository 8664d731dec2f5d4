//! The trace of a run: what the host heard of every tick.

use cauldron_firmware::trace::TraceHash;
use cauldron_protocol::{State, state::Flags};
use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
};

use crate::Failure;

/// States in the order in which they were heard.
#[derive(Clone, Debug, Default)]
pub struct Record {
    states: Vec<State>,
    hash: TraceHash,
}

/// First line of `run.csv`.
pub const HEADER: &str = "tick,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,fx_n,fy_n,fz_n,wet";

impl Record {
    /// Takes states, up to `most` in all.
    pub fn take(&mut self, states: &[State], most: usize) {
        let room = most.saturating_sub(self.states.len());
        for state in states.iter().take(room) {
            self.hash.add(state);
            self.states.push(*state);
        }
    }

    /// Ticks heard of.
    #[must_use]
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// True before the first.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// The states.
    #[must_use]
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// Hash over tick, position and force bits.
    #[must_use]
    pub fn hash(&self) -> u64 {
        self.hash.value()
    }

    /// Writes the trace; numbers in the shortest form that reads back as the same bits.
    ///
    /// # Errors
    /// [`Failure::Input`] if the file cannot be written.
    pub fn write_csv(&self, path: &Path) -> Result<(), Failure> {
        let write = || -> io::Result<()> {
            let mut file = BufWriter::new(File::create(path)?);
            writeln!(file, "{HEADER}")?;
            for s in &self.states {
                let [x, y, z] = s.position.map(|v| v.0);
                let [vx, vy, vz] = s.velocity.map(|v| v.0);
                let [fx, fy, fz] = s.force.map(|v| v.0);
                let wet = u8::from(s.flags.contains(Flags::WET));
                let tick = s.tick.0;
                writeln!(file, "{tick},{x},{y},{z},{vx},{vy},{vz},{fx},{fy},{fz},{wet}")?;
            }
            file.flush()
        };
        write().map_err(|why| Failure::Input(format!("cannot write {}: {why}", path.display())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cauldron_protocol::units::{Metres, Ticks};

    #[test]
    fn the_csv_reads_back_as_the_same_bits() {
        let odd = f32::from_bits(0x3dcc_cccd);
        let state = State { tick: Ticks(7), position: [Metres(odd); 3], ..State::default() };
        let mut record = Record::default();
        record.take(&[state; 3], 2);
        let path = std::env::temp_dir().join(format!("cauldron-csv-{}", std::process::id()));
        record.write_csv(&path).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!((lines[0], lines.len()), (HEADER, 3));
        let x: f32 = lines[1].split(',').nth(1).unwrap().parse().unwrap();
        assert_eq!(x.to_bits(), odd.to_bits());
    }
}
