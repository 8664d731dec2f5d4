//! The host's end of the wire: transports, faults made on purpose, and the session that greets a
//! device, sets it up, arms it, feeds it fields and finds it again after it was lost.
//!
//! Time is an argument (microseconds of the host's clock), so that everything runs on virtual
//! time too.

pub mod clock;
pub mod faulty;
pub mod pipe;
pub mod session;
pub mod transport;

pub use clock::DeviceClock;
pub use faulty::{Faults, Faulty};
pub use pipe::{PipeEnd, pipe};
pub use session::{Session, SessionError, Setup};
pub use transport::{LinkDown, Transport};
