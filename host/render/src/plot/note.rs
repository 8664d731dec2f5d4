//! Where the words beside points go: where they cover least.

use embedded_graphics::text::Alignment;

use super::{
    mark,
    shape::{Area, Shape, width_px},
};

const LETTER_HEIGHT: i32 = 12;
const GAP: i32 = 6;

/// Words that belong to a point.
pub(super) struct Note<'a> {
    pub(super) at_px: [f64; 2],
    pub(super) words: &'a str,
    pub(super) colour: [u8; 3],
}

/// The `notes` within `area`, each at that side of its point where it covers the fewest of the
/// `marks` and of the notes before it.
pub(super) fn shapes(notes: &[Note<'_>], marks_px: &[[f64; 2]], area: Area) -> Vec<Shape> {
    let mut taken: Vec<Area> = marks_px.iter().map(|at_px| around_mark(*at_px)).collect();
    let mut shapes = Vec::new();
    for note in notes.iter().filter(|note| !note.words.is_empty()) {
        let covers = |place: &Area| taken.iter().filter(|other| place.meets(**other)).count();
        let room = places(note).into_iter().filter(|place| area.holds(*place)).min_by_key(covers);
        if let Some(place) = room {
            // Letters may be narrower or wider than their room: the end at the point is fixed.
            let is_left = f64::from(place.right) < note.at_px[0];
            let (x, alignment) = if is_left {
                (place.right, Alignment::Right)
            } else {
                (place.left, Alignment::Left)
            };
            shapes.push(Shape::words(note.words, [x, place.top], alignment, note.colour));
            taken.push(place);
        }
    }
    shapes
}

fn around_mark([x, y]: [f64; 2]) -> Area {
    let reach = mark::REACH_PX;
    let [left, right] = [x - reach, x + reach].map(|px| px as i32);
    let [top, bottom] = [y - reach, y + reach].map(|px| px as i32);
    Area { left, top, right, bottom }
}

/// The best first: curves of error over work fall, so above on the right and below on the left
/// is where they leave room.
fn places(note: &Note<'_>) -> [Area; 6] {
    let width = width_px(note.words);
    let [x, y] = note.at_px.map(|px| px as i32);
    let [right, left] = [x + GAP, x - GAP - width];
    let [above, level, below] = [y - GAP - LETTER_HEIGHT, y - LETTER_HEIGHT / 2, y + GAP];
    let beside = 3;
    [
        [right, above],
        [left, below],
        [right + beside, level],
        [left - beside, level],
        [left, above],
        [right, below],
    ]
    .map(|[left, top]| Area { left, top, right: left + width, bottom: top + LETTER_HEIGHT })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_avoid_marks_each_other_and_the_border() {
        let area = Area { left: 0, top: 0, right: 200, bottom: 100 };
        let marks_px = [[100.0, 50.0], [112.0, 40.0], [195.0, 50.0]];
        let note = |at_px| Note { at_px, words: "n=32", colour: [0; 3] };
        let notes = marks_px.map(note);
        let placed: Vec<Area> = shapes(&notes, &marks_px, area)
            .into_iter()
            .filter_map(|shape| match shape {
                Shape::Words(words) => Some(words),
                _ => None,
            })
            .map(|words| {
                let [x, top] = words.at_px;
                let left = if words.alignment == Alignment::Right { x - 32 } else { x };
                Area { left, top, right: left + 32, bottom: top + LETTER_HEIGHT }
            })
            .collect();
        assert_eq!(placed.len(), 3);
        for (number, place) in placed.iter().enumerate() {
            assert!(area.holds(*place), "{place:?}");
            assert!(!placed[..number].iter().any(|other| place.meets(*other)), "{placed:?}");
            assert!(!marks_px.iter().any(|mark| place.meets(around_mark(*mark))), "{place:?}");
        }
    }
}
