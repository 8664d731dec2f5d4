//! The pot: incompressible flow, substances, surface, and the local field of force baked from them.
//!
//! Pure simulation in SI units: no wire, no picture, no clock.

pub mod air;
pub mod bench;
pub mod force;
pub mod grid;
mod lanes;
pub mod mask;
pub mod plan;
pub mod pool;
pub mod pot;
pub mod scenes;
pub mod simd;
pub mod snapshot;
pub mod solver;
mod spectral;
pub mod substance;
pub mod surface;
pub mod torture;
pub mod vessel;

pub use grid::Grid;
pub use pot::Pot;
pub use snapshot::{SmokeView, Snapshot, SubstanceView, SurfaceView};
pub use vessel::Vessel;
