//! Contact sheets: many pictures on one page, each with a line of words under it.

use embedded_graphics::text::Alignment;

use crate::{
    canvas::Canvas,
    text::{self, SMALL},
};

/// A picture on a sheet.
#[derive(Clone, Copy, Debug)]
pub struct Thumbnail<'a> {
    /// The picture at any size; it is made smaller to fit, never larger.
    pub picture: &'a Canvas,
    /// What stands below it, say the time in the scene: `"t = 1.50 s"`.
    pub label: &'a str,
}

/// No sheet is wider than this, in pixels, unless it has more columns than that leaves room for.
pub const MOST_WIDTH: usize = 1600;

const GAP: usize = 8;
const LABEL_HEIGHT: usize = 20;
const LEAST_WIDTH: usize = 16;
const PAGE: [u8; 3] = [24, 24, 26];
const INK: [u8; 3] = [225, 225, 225];

/// Puts `thumbnails` on a page in rows of `columns` (at least one). All get the same room: that
/// of the first picture, or what a page of [`MOST_WIDTH`] has for each.
#[must_use]
pub fn contact_sheet(thumbnails: &[Thumbnail], columns: usize) -> Canvas {
    let columns = columns.clamp(1, thumbnails.len().max(1));
    let rows = thumbnails.len().div_ceil(columns);
    let [width, height] = room(thumbnails, columns);
    let (step_x, step_y) = (width + GAP, height + LABEL_HEIGHT + GAP);
    let mut sheet = Canvas::new(GAP + columns * step_x, GAP + rows * step_y, PAGE);
    for (number, thumbnail) in thumbnails.iter().enumerate() {
        let left = GAP + step_x * (number % columns);
        let top = GAP + step_y * (number / columns);
        let [fit_width, fit_height] = fit(thumbnail.picture, [width, height]);
        sheet.paste(&thumbnail.picture.resized(fit_width, fit_height), left, top);
        let below = [left as i32 + 2, (top + fit_height) as i32 + 4];
        text::write(&mut sheet, thumbnail.label, below, (SMALL, INK, Alignment::Left));
    }
    sheet
}

/// Width and height that every picture has on the page.
fn room(thumbnails: &[Thumbnail], columns: usize) -> [usize; 2] {
    let most = (MOST_WIDTH.saturating_sub(GAP) / columns).saturating_sub(GAP).max(LEAST_WIDTH);
    match thumbnails.first() {
        Some(first) => fit(first.picture, [most, usize::MAX]),
        None => [LEAST_WIDTH, 0],
    }
}

/// The size of `picture` once it fits `room`, its shape kept.
fn fit(picture: &Canvas, room: [usize; 2]) -> [usize; 2] {
    let [width, height] = [picture.width().max(1), picture.height().max(1)];
    let scale = (room[0] as f64 / width as f64).min(room[1] as f64 / height as f64).min(1.0);
    [width, height].map(|side| ((side as f64 * scale).round() as usize).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_in_rows_and_the_page_is_not_too_wide() {
        let picture = Canvas::new(480, 360, [200, 0, 0]);
        let thumbnails = [Thumbnail { picture: &picture, label: "t = 0 s" }; 7];
        let sheet = contact_sheet(&thumbnails, 5);
        assert!(sheet.width() <= MOST_WIDTH && sheet.width() > MOST_WIDTH - 16);
        let red = sheet.pixels().filter(|pixel| *pixel == [200, 0, 0]).count();
        assert_eq!(red, 7 * 310 * 233);
    }

    #[test]
    fn small_pictures_stay_small_and_none_is_a_page_too() {
        let picture = Canvas::new(40, 30, [1; 3]);
        let sheet = contact_sheet(&[Thumbnail { picture: &picture, label: "" }], 0);
        assert_eq!((sheet.width(), sheet.height()), (56, 66));
        let _ = contact_sheet(&[], 3);
        let nothing = Canvas::new(0, 0, [0; 3]);
        let _ = contact_sheet(&[Thumbnail { picture: &nothing, label: "none" }], 3);
    }
}
