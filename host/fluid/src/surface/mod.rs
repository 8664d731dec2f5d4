//! The surface of the liquid: what is seen rippling, and what the probe presses on.

mod motion;
mod params;
mod round;
mod spring;

pub(crate) use params::MOST_SUBSTEPS;
pub use params::SurfaceParams;
pub use spring::SpringSheet;
