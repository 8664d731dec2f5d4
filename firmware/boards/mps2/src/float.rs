//! The floating-point unit must round as IEEE 754 asks, or the trace is not the host's.

use cortex_m::register::fpscr::{self, RMode};

/// Whether it does, since reset.
pub fn check() -> Result<(), &'static str> {
    let fpscr = fpscr::read();
    if fpscr.fz() {
        return Err("FPSCR: flush-to-zero is on");
    }
    if fpscr.dn() {
        return Err("FPSCR: default-NaN is on");
    }
    if fpscr.rmode() != RMode::Nearest {
        return Err("FPSCR: rounding is not to nearest");
    }
    Ok(())
}
