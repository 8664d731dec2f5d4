//! The surface of the liquid: what is seen rippling, and what the probe presses on.

mod spring;

pub(crate) use spring::MOST_SUBSTEPS;
pub use spring::{SpringSheet, SurfaceParams};
