//! An 8-bit sRGB picture: what is written to files, classified, put on sheets and plotted on.

use std::convert::Infallible;

use embedded_graphics::{
    Pixel,
    draw_target::DrawTarget,
    geometry::{OriginDimensions, Size},
    pixelcolor::{Rgb888, RgbColor},
};
use glam::Vec3;

use crate::srgb;

/// Pixels in rows from the top, each row from the left, three bytes (red, green, blue) a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Canvas {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Canvas {
    /// A canvas of one colour.
    #[must_use]
    pub fn new(width: usize, height: usize, colour: [u8; 3]) -> Self {
        Self { width, height, rgb: colour.repeat(width * height) }
    }

    /// A canvas around `rgb`, which is cut or filled with black to `width * height * 3` bytes.
    #[must_use]
    pub fn from_rgb(width: usize, height: usize, mut rgb: Vec<u8>) -> Self {
        rgb.resize(width * height * 3, 0);
        Self { width, height, rgb }
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All bytes, `width * height * 3` of them.
    #[must_use]
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// All pixels in order.
    pub fn pixels(&self) -> impl Iterator<Item = [u8; 3]> + '_ {
        self.rgb.as_chunks().0.iter().copied()
    }

    /// The pixel at column `x` of row `y`; `None` outside.
    #[must_use]
    pub fn get(&self, x: usize, y: usize) -> Option<[u8; 3]> {
        let at = self.index(x, y)?;
        self.rgb.get(at..at + 3)?.try_into().ok()
    }

    /// Lays `colour` over a pixel with the given cover (0 to 1); outside nothing happens.
    pub fn blend(&mut self, x: usize, y: usize, colour: [u8; 3], cover: f32) {
        let Some(at) = self.index(x, y) else { return };
        for (below, above) in self.rgb[at..at + 3].iter_mut().zip(colour) {
            let mixed = f32::from(*below) + cover * (f32::from(above) - f32::from(*below));
            *below = (mixed + 0.5) as u8;
        }
    }

    /// Copies `picture` with its upper left corner at (`left`, `top`); what sticks out is cut off.
    pub fn paste(&mut self, picture: &Canvas, left: usize, top: usize) {
        let columns = picture.width.min(self.width.saturating_sub(left));
        let rows = picture.height.min(self.height.saturating_sub(top));
        for row in 0..rows {
            let from = 3 * picture.width * row;
            let to = 3 * (left + self.width * (top + row));
            self.rgb[to..to + 3 * columns].copy_from_slice(&picture.rgb[from..from + 3 * columns]);
        }
    }

    /// The picture at another size. Each new pixel is the mean, in linear light, of the pixels
    /// it covers: for making pictures smaller.
    #[must_use]
    pub fn resized(&self, width: usize, height: usize) -> Self {
        let linear: [Vec3; 256] = std::array::from_fn(|byte| srgb::from_bytes([byte as u8; 3]));
        let light = |x: usize, y: usize| {
            let [r, g, b] = self.get(x, y).unwrap_or_default();
            Vec3::new(linear[r as usize].x, linear[g as usize].x, linear[b as usize].x)
        };
        let mut rgb = Vec::with_capacity(width * height * 3);
        for y in 0..height {
            let rows = covered(y, height, self.height);
            for x in 0..width {
                let columns = covered(x, width, self.width);
                let count = (rows.len() * columns.len()) as f32;
                let sum: Vec3 =
                    rows.clone().flat_map(|y| columns.clone().map(move |x| light(x, y))).sum();
                rgb.extend(srgb::to_bytes(sum / count));
            }
        }
        Self::from_rgb(width, height, rgb)
    }

    fn index(&self, x: usize, y: usize) -> Option<usize> {
        (x < self.width && y < self.height).then(|| 3 * (x + self.width * y))
    }
}

/// Pixels of a row of `old` that pixel `at` of a row of `new` covers: at least one.
fn covered(at: usize, new: usize, old: usize) -> std::ops::Range<usize> {
    let first = at * old / new;
    first..((at + 1) * old / new).max(first + 1)
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = Pixel<Rgb888>>,
    {
        for Pixel(at, colour) in pixels {
            if let (Ok(x), Ok(y)) = (usize::try_from(at.x), usize::try_from(at.y)) {
                self.blend(x, y, [colour.r(), colour.g(), colour.b()], 1.0);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shrinking_averages_light_and_not_bytes() {
        let chequered = Canvas::from_rgb(2, 1, vec![0, 0, 0, 255, 255, 255]);
        assert_eq!(chequered.resized(1, 1).get(0, 0), Some([188; 3]));
    }

    #[test]
    fn a_picture_is_cut_at_the_edge_it_sticks_out_of() {
        let mut canvas = Canvas::new(3, 3, [0; 3]);
        canvas.paste(&Canvas::new(2, 2, [9; 3]), 2, 2);
        canvas.paste(&Canvas::new(2, 2, [9; 3]), 7, 7);
        assert_eq!(canvas.get(2, 2), Some([9; 3]));
        assert_eq!(canvas.pixels().filter(|pixel| *pixel == [9; 3]).count(), 1);
        assert_eq!(canvas.get(3, 3), None);
    }
}
