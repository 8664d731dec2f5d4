//! `cauldron bench`.

use crate::{Failure, cli::BenchArgs};

/// Measures the flow solvers.
///
/// # Errors
/// [`Failure::Check`] if a row of ours misses its target.
pub fn fluid(_args: &BenchArgs) -> Result<(), Failure> {
    Ok(())
}
