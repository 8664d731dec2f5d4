//! The local field of force: what the medium around the probe will be when the field arrives,
//! and the books of what the probe gave to the medium.

mod bake;
mod drag;
mod exchange;
mod float;
mod meniscus;

pub use bake::{Baked, Baker, Life, Update};
pub use drag::{Drag, sphere_drag_n};
pub use exchange::Exchange;
pub use float::Floating;
pub use meniscus::{Meniscus, Resistance, cap_volume_m3};
