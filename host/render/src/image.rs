//! A rendered picture in linear light, with what each pixel shows.

use glam::Vec3;

use crate::{canvas::Canvas, srgb};

/// What a pixel shows first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layer {
    /// Nothing of the scene.
    #[default]
    Background,
    /// A wall, seen through no liquid.
    Vessel,
    /// Liquid, seen through the cut side of the vessel.
    Liquid,
    /// Liquid, seen through its free surface.
    Surface,
    /// The handle, in the air or through little enough liquid to be the main thing seen.
    Handle,
}

/// One rendered pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    pub(crate) colour: Vec3,
    pub(crate) layer: Layer,
}

/// A picture in linear RGB, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Linear RGB of each pixel, 0 to 1 save in highlights.
    pub linear: Vec<Vec3>,
    /// What each pixel shows.
    pub layer: Vec<Layer>,
}

impl Image {
    /// The picture as 8-bit sRGB.
    #[must_use]
    pub fn resolve(&self) -> Canvas {
        let rgb = self.linear.iter().flat_map(|colour| srgb::to_bytes(*colour)).collect();
        Canvas::from_rgb(self.width, self.height, rgb)
    }

    /// Number of pixels that show `layer`.
    #[must_use]
    pub fn count(&self, layer: Layer) -> usize {
        self.layer.iter().filter(|shown| **shown == layer).count()
    }
}
