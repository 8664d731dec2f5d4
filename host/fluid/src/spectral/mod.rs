//! The modes of a box, and the way to them and back: for the direct solver of the pressure as for
//! the waves on the surface.

pub mod basis;
mod product;
mod transform;

pub use product::{Rows, multiply};
pub use transform::{Part, Transform};
