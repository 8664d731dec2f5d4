//! What carries bytes.

use std::fmt;

/// The other end is gone: unplugged, or closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkDown;

impl fmt::Display for LinkDown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the link is down: the device is unplugged or its end is closed")
    }
}

impl std::error::Error for LinkDown {}

/// A byte stream both ways. It may lose, garble and delay: the frames on it find out.
pub trait Transport {
    /// Hands `bytes` over.
    ///
    /// # Errors
    /// [`LinkDown`] if there is no other end.
    fn send(&mut self, now_us: u64, bytes: &[u8]) -> Result<(), LinkDown>;

    /// Appends what has come to `into`, without waiting.
    ///
    /// # Errors
    /// [`LinkDown`] if there is no other end.
    fn receive(&mut self, now_us: u64, into: &mut Vec<u8>) -> Result<(), LinkDown>;
}
