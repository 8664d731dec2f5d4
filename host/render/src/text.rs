//! Words on a canvas, in fixed-width letters.

use embedded_graphics::{
    Drawable,
    geometry::Point,
    mono_font::{
        MonoFont, MonoTextStyle,
        iso_8859_1::{FONT_8X13, FONT_10X20},
    },
    pixelcolor::Rgb888,
    text::{Alignment, Baseline, Text, TextStyleBuilder},
};

use crate::canvas::Canvas;

/// Labels and numbers.
pub(crate) const SMALL: &MonoFont<'_> = &FONT_8X13;
/// Titles.
pub(crate) const LARGE: &MonoFont<'_> = &FONT_10X20;

/// Writes one line whose left end, middle or right end, as `alignment` says, is at `x`, and
/// whose letters' upper edge is at `y`. What does not fit on the canvas is cut off.
pub(crate) fn write(
    canvas: &mut Canvas,
    words: &str,
    [x, y]: [i32; 2],
    (font, colour, alignment): (&MonoFont<'_>, [u8; 3], Alignment),
) {
    let [r, g, b] = colour;
    let letters = MonoTextStyle::new(font, Rgb888::new(r, g, b));
    let place = TextStyleBuilder::new().alignment(alignment).baseline(Baseline::Top).build();
    let Ok(_) = Text::with_text_style(words, Point::new(x, y), letters, place).draw(canvas);
}

/// Width of one line in pixels.
pub(crate) fn width_px(words: &str, font: &MonoFont<'_>) -> i32 {
    words.chars().count() as i32 * font.character_size.width as i32
}
