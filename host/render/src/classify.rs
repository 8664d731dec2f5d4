//! How much of a picture is red, green, blended, clear: by colour alone, from any PNG.
//!
//! The rules hold for pictures of this crate's making: iron and background are grey, the handle
//! is paler and brighter than what is poured, and the clear liquid is bluish. They are written
//! for a scene that pours a red and a green substance, whose blend is a yellowish orange.

use crate::canvas::Canvas;

/// What the colour of a pixel says that it shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The red substance.
    Red,
    /// The green substance.
    Green,
    /// Both of them in one place, or one seen through the other.
    Blend,
    /// Liquid with next to nothing in it.
    Clear,
    /// The handle.
    Handle,
    /// The vessel, or nothing.
    Background,
}

/// Parts of a picture's pixels, each 0 to 1; together 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shares {
    /// The red substance.
    pub red: f32,
    /// The green substance.
    pub green: f32,
    /// Both of them in one place.
    pub blend: f32,
    /// Liquid with next to nothing in it.
    pub clear: f32,
    /// The handle.
    pub handle: f32,
    /// Vessel and background.
    pub background: f32,
}

impl Shares {
    /// Shares of all pixels of `canvas`; all 0 if it has none.
    #[must_use]
    pub fn of(canvas: &Canvas) -> Self {
        let mut counts = [0_u32; 6];
        for pixel in canvas.pixels() {
            counts[kind(pixel) as usize] += 1;
        }
        let all = counts.iter().sum::<u32>().max(1) as f32;
        let [red, green, blend, clear, handle, background] = counts.map(|count| count as f32 / all);
        Self { red, green, blend, clear, handle, background }
    }

    /// The part of the picture that shows liquid, clear or not.
    #[must_use]
    pub fn liquid(&self) -> f32 {
        self.red + self.green + self.blend + self.clear
    }

    /// The same shares of the liquid's pixels alone; all 0 if there are none.
    #[must_use]
    pub fn of_liquid(&self) -> Self {
        let scale = if self.liquid() > 0.0 { 1.0 / self.liquid() } else { 0.0 };
        Self {
            red: scale * self.red,
            green: scale * self.green,
            blend: scale * self.blend,
            clear: scale * self.clear,
            handle: 0.0,
            background: 0.0,
        }
    }
}

/// What an sRGB pixel shows, by its hue, saturation and brightness.
#[must_use]
pub fn kind(pixel: [u8; 3]) -> Kind {
    let Hsv { hue_deg, saturation, value } = Hsv::of(pixel);
    let is_handle = is_handle(hue_deg, saturation, value);
    match hue_deg {
        _ if is_handle => Kind::Handle,
        _ if saturation < 0.18 || value < 0.14 => Kind::Background,
        0.0..20.0 | 347.0..=360.0 if saturation > 0.35 => Kind::Red,
        20.0..82.0 => Kind::Blend,
        82.0..148.0 if saturation > 0.28 => Kind::Green,
        170.0..262.0 => Kind::Clear,
        _ => Kind::Background,
    }
}

/// Nothing poured is both so bright and so pale as the handle. Seen through liquid it is less
/// bright, but paler still.
fn is_handle(hue_deg: f32, saturation: f32, value: f32) -> bool {
    let (pale, least_value) = match hue_deg {
        172.0..338.0 => return false,
        _ if value > 0.94 => (0.25..0.70, 0.94),
        0.0..25.0 | 338.0..=360.0 => (0.28..0.54, 0.66),
        58.0..105.0 => (0.18..0.50, 0.74),
        _ => return false,
    };
    pale.contains(&saturation) && value > least_value
}

struct Hsv {
    hue_deg: f32,
    saturation: f32,
    value: f32,
}

impl Hsv {
    fn of(pixel: [u8; 3]) -> Self {
        let [r, g, b] = pixel.map(|byte| f32::from(byte) / 255.0);
        let value = r.max(g).max(b);
        let chroma = value - r.min(g).min(b);
        if chroma <= 0.0 {
            return Self { hue_deg: 0.0, saturation: 0.0, value };
        }
        let sixth = if value == r {
            ((g - b) / chroma).rem_euclid(6.0)
        } else if value == g {
            (b - r) / chroma + 2.0
        } else {
            (r - g) / chroma + 4.0
        };
        Self { hue_deg: 60.0 * sixth, saturation: chroma / value, value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_colours_are_what_they_look_like() {
        assert_eq!(kind([210, 40, 30]), Kind::Red);
        assert_eq!(kind([40, 170, 50]), Kind::Green);
        assert_eq!(kind([180, 150, 50]), Kind::Blend);
        assert_eq!(kind([60, 100, 130]), Kind::Clear);
        assert_eq!(kind([60, 60, 62]), Kind::Background);
        assert_eq!(kind([0, 0, 0]), Kind::Background);
    }

    #[test]
    fn shares_add_up() {
        let canvas =
            Canvas::from_rgb(2, 2, [[210, 40, 30], [60, 100, 130], [0; 3], [0; 3]].concat());
        let shares = Shares::of(&canvas);
        assert_eq!((shares.red, shares.clear, shares.background), (0.25, 0.25, 0.5));
        assert_eq!((shares.of_liquid().red, shares.of_liquid().background), (0.5, 0.0));
        assert_eq!(Shares::of(&Canvas::new(0, 0, [0; 3])), Shares::default());
    }
}
