//! What a scenario runs on.

use std::fmt;

use crate::{scenario::Scenario, trace::Trace};

/// A device and a host between which a scenario can be played.
pub trait Rig {
    /// Name for people: `sim`, ...
    fn name(&self) -> &'static str;

    /// Plays a scenario from a fresh start.
    ///
    /// # Errors
    /// [`RigError`] if it could not be played at all, which is not the same as a verdict.
    fn play(&mut self, scenario: &Scenario) -> Result<Trace, RigError>;
}

/// Why a scenario could not be played.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RigError(pub String);

impl fmt::Display for RigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for RigError {}
