//! Pictures of the pot: a reference ray marcher on the CPU, PNG files, contact sheets, plots.
//!
//! [`render`] draws a [`cauldron_fluid::Snapshot`] as a [`View`] sees it, in linear light and
//! with a label per pixel that says what it shows; [`Image::resolve`] turns it into an 8-bit
//! [`Canvas`]. A canvas is what everything else here speaks of: [`png`] reads and writes it,
//! [`classify`] says how much of it is red, green or blended, [`sheet`] puts many on one page,
//! and [`plot`] draws curves on one, or as a document for [`svg`].
//!
//! Lengths are metres in world space, y up. Colours are linear RGB until they are resolved.

pub mod camera;
pub mod canvas;
pub mod classify;
pub mod handle;
pub mod image;
pub mod march;
pub mod plot;
pub mod png;
pub mod sheet;
pub mod srgb;
pub mod svg;

mod drops;
mod file;
mod film;
mod frame;
mod light;
mod pot;
mod rows;
mod smooth;
mod solid;
mod surface;
mod text;
mod vessel;
mod volume;

pub use camera::Camera;
pub use canvas::Canvas;
pub use classify::Shares;
pub use file::FileError;
pub use handle::Handle;
pub use image::{Image, Layer};
pub use march::{View, render};
pub use plot::Plot;

/// `value` brought into 0 to 1. NaN becomes 0, where `clamp` would keep it.
fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Threads that a picture is drawn on where the caller has no wish of its own.
pub const DEFAULT_THREADS: usize = 2;
