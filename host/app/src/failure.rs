//! Why the program ends without having done what it was asked.

use std::fmt;

/// One line for people, and a number for scripts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A check failed.
    Check(String),
    /// The input or the call was wrong; nothing was changed.
    Input(String),
    /// The device failed.
    Device(String),
}

impl Failure {
    /// 1, 2 or 3.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Check(_) => 1,
            Self::Input(_) => 2,
            Self::Device(_) => 3,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Check(what) | Self::Input(what) | Self::Device(what) => f.write_str(what),
        }
    }
}

impl std::error::Error for Failure {}
