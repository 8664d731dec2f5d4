//! What a page is laid out into: a handful of shapes, which every back end can draw.

use embedded_graphics::text::Alignment;

use crate::text;

/// A part of the page, in pixels: the right and lower borders lie outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Area {
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) right: i32,
    pub(super) bottom: i32,
}

impl Area {
    pub(super) fn width(self) -> i32 {
        self.right - self.left
    }

    pub(super) fn height(self) -> i32 {
        self.bottom - self.top
    }

    pub(super) fn contains(self, [x, y]: [f64; 2]) -> bool {
        let along_x = x >= f64::from(self.left) && x <= f64::from(self.right);
        along_x && y >= f64::from(self.top) && y <= f64::from(self.bottom)
    }

    /// Whether some pixel is in both.
    pub(super) fn meets(self, other: Self) -> bool {
        let along_x = self.left < other.right && other.left < self.right;
        along_x && self.top < other.bottom && other.top < self.bottom
    }

    /// Whether all of `other` is in it.
    pub(super) fn holds(self, other: Self) -> bool {
        let along_x = self.left <= other.left && other.right <= self.right;
        along_x && self.top <= other.top && other.bottom <= self.bottom
    }
}

/// What lines are drawn with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    pub(super) colour: [u8; 3],
    pub(super) width_px: f64,
    pub(super) is_dashed: bool,
}

pub(super) const DASH_PX: f64 = 9.0;
pub(super) const GAP_PX: f64 = 6.0;

/// How large words are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Size {
    Small,
    Large,
}

/// One line of words.
#[derive(Clone, Debug)]
pub(super) struct Words {
    pub(super) words: String,
    /// Their left end, middle or right end, as `alignment` says, and their letters' upper edge.
    pub(super) at_px: [i32; 2],
    pub(super) alignment: Alignment,
    pub(super) size: Size,
    pub(super) colour: [u8; 3],
}

/// Everything is made of these.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    Fill { area: Area, colour: [u8; 3] },
    Line { points_px: Vec<[f64; 2]>, pen: Pen },
    Polygon { corners_px: Vec<[f64; 2]>, colour: [u8; 3] },
    Words(Words),
}

impl Shape {
    /// Small words.
    pub(super) fn words(
        words: &str,
        at_px: [i32; 2],
        alignment: Alignment,
        colour: [u8; 3],
    ) -> Self {
        Self::Words(Words { words: words.to_owned(), at_px, alignment, size: Size::Small, colour })
    }
}

/// Width that small words are given room for.
pub(super) fn width_px(words: &str) -> i32 {
    text::width_px(words, text::SMALL)
}
