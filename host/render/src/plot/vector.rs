//! Shapes as an SVG document: plain elements, presentation attributes, no identifiers (documents
//! may stand on one page) and nothing to fetch.

use std::fmt::{self, Write};

use embedded_graphics::text::Alignment;

use super::{
    INK, PAPER,
    shape::{Area, DASH_PX, GAP_PX, Pen, Shape, Size, Words},
};

/// The document of a page of this size.
pub(super) fn document(page: Area, title: &str, shapes: &[Shape]) -> String {
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = write_document(&mut out, page, title, shapes);
    out
}

fn write_document(out: &mut String, page: Area, title: &str, shapes: &[Shape]) -> fmt::Result {
    let [width, height] = [page.width(), page.height()];
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" role=\"img\" stroke=\"none\" fill=\"{}\" font-size=\"13\" \
         font-family=\"system-ui, Helvetica, Arial, DejaVu Sans, sans-serif\">",
        Hex(INK)
    )?;
    writeln!(out, "<title>{}</title>", Escaped(title))?;
    write_fill(out, page, PAPER)?;
    for shape in shapes {
        match shape {
            Shape::Fill { area, colour } => write_fill(out, *area, *colour)?,
            Shape::Line { points_px, pen } => write_line(out, points_px, *pen)?,
            Shape::Polygon { corners_px, colour } => {
                write!(out, "<polygon points=\"")?;
                write_points(out, corners_px)?;
                writeln!(out, "\" fill=\"{}\"/>", Hex(*colour))?;
            }
            Shape::Words(words) => write_words(out, words)?,
        }
    }
    writeln!(out, "</svg>")
}

fn write_fill(out: &mut String, area: Area, colour: [u8; 3]) -> fmt::Result {
    let (x, y) = (area.left, area.top);
    let (width, height) = (area.width().max(0), area.height().max(0));
    write!(out, "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" ")?;
    writeln!(out, "fill=\"{}\"/>", Hex(colour))
}

fn write_line(out: &mut String, points_px: &[[f64; 2]], pen: Pen) -> fmt::Result {
    write!(out, "<polyline points=\"")?;
    write_points(out, points_px)?;
    write!(out, "\" fill=\"none\" stroke=\"{}\" ", Hex(pen.colour))?;
    write!(out, "stroke-width=\"{}\" stroke-linejoin=\"round\"", pen.width_px)?;
    if pen.is_dashed {
        write!(out, " stroke-dasharray=\"{DASH_PX} {GAP_PX}\"")?;
    }
    writeln!(out, "/>")
}

/// To a tenth of a pixel.
fn write_points(out: &mut String, points_px: &[[f64; 2]]) -> fmt::Result {
    for (number, point) in points_px.iter().enumerate() {
        let [x, y] = point.map(|px| (10.0 * px).round() / 10.0);
        write!(out, "{}{x},{y}", if number == 0 { "" } else { " " })?;
    }
    Ok(())
}

fn write_words(out: &mut String, words: &Words) -> fmt::Result {
    if words.words.is_empty() {
        return Ok(());
    }
    let [x, top] = words.at_px;
    let y = top + if words.size == Size::Large { 16 } else { 11 };
    write!(out, "<text x=\"{x}\" y=\"{y}\"")?;
    match words.alignment {
        Alignment::Left => {}
        Alignment::Center => write!(out, " text-anchor=\"middle\"")?,
        Alignment::Right => write!(out, " text-anchor=\"end\"")?,
    }
    if words.size == Size::Large {
        write!(out, " font-size=\"18\"")?;
    }
    if words.colour != INK {
        write!(out, " fill=\"{}\"", Hex(words.colour))?;
    }
    writeln!(out, ">{}</text>", Escaped(&words.words))
}

/// `#rrggbb`.
struct Hex([u8; 3]);

impl fmt::Display for Hex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// Words as XML has them: no markup in them, and no character that XML 1.0 forbids.
struct Escaped<'a>(&'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|letter| match letter {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '\t' | '\n' | '\r' => f.write_char(' '),
            '\0'..' ' | '\u{fffe}' | '\u{ffff}' => f.write_char(char::REPLACEMENT_CHARACTER),
            _ => f.write_char(letter),
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::plot::{Axis, Panel, Plot, Series, Span, Style};

    /// Follows the tags as a parser would: each is closed in its turn, values are quoted, no
    /// markup is left in words. Returns all words.
    fn words_of(document: &str) -> Vec<String> {
        let (mut open, mut words) = (Vec::new(), Vec::new());
        for piece in document.split('<').skip(1) {
            let (tag, text) = piece.split_once('>').expect("a tag ends");
            let name = tag.trim_matches('/').split(' ').next();
            if tag.starts_with('/') {
                assert_eq!(open.pop(), name, "{piece}");
            } else {
                assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
                assert_eq!(tag.matches("=\"").count(), tag.matches('=').count(), "{tag}");
                open.extend(name.filter(|_| !tag.ends_with('/')));
            }
            for entity in text.split('&').skip(1) {
                assert!(["amp;", "lt;", "gt;"].iter().any(|e| entity.starts_with(e)), "{text}");
            }
            words.extend(Some(text.trim().to_owned()).filter(|text| !text.is_empty()));
        }
        assert!(open.is_empty(), "{open:?}");
        words
    }

    fn dozen() -> Plot {
        let series = (0..12).map(|number| Series {
            style: Style::MarkedLine,
            notes: (0..12).map(|power| format!("n={}", 1 << power)).collect(),
            ..Series::line(
                format!("method {number}"),
                (0..12).map(|i| [2_f64.powi(i), 1.5_f64.powi(-i * number as i32)]).collect(),
                number,
            )
        });
        Plot {
            title: "work & precision".to_owned(),
            shares_x: false,
            panels: vec![Panel {
                x: Axis::log10("time [ms]"),
                y: Axis::log10("error"),
                series: series.collect(),
                spans: vec![Span::at_most("target", 10.0, 1e-3)],
            }],
        }
    }

    #[test]
    fn a_work_precision_diagram_is_small_and_all_words_are_in_it() {
        let document = dozen().svg(900, 600);
        assert!(document.len() < 60 * 1024, "{} bytes", document.len());
        let words = words_of(&document);
        for wanted in ["time [ms]", "error", "target", "method 0", "method 11", "1e1", "n=2048"] {
            assert!(words.iter().any(|word| word == wanted), "{wanted}: {words:?}");
        }
        assert_eq!(words.iter().filter(|word| *word == "work &amp; precision").count(), 2);
        assert!(document.contains("viewBox=\"0 0 900 600\""));
        assert!(
            document
                .contains("<rect x=\"0\" y=\"0\" width=\"900\" height=\"600\" fill=\"#ffffff\"/>")
        );
        // In the legend and at the points: filled and open marks are one polygon each.
        assert_eq!(document.matches("<polygon").count(), 12 * 13);
    }

    #[test]
    fn no_words_are_markup() {
        let mut plot = dozen();
        plot.title = "</svg><script>\"'&\u{0}\u{1b}\u{ffff}\n".to_owned();
        plot.panels[0].series[0].label = "a < b & b > \"c\"".to_owned();
        let words = words_of(&plot.svg(900, 600));
        assert!(words.iter().any(|word| word == "a &lt; b &amp; b &gt; \"c\""), "{words:?}");
        let title = "&lt;/svg&gt;&lt;script&gt;\"'&amp;\u{fffd}\u{fffd}\u{fffd}";
        assert_eq!(words[0], title);
    }

    #[test]
    fn points_far_off_the_page_are_written_in_short() {
        let mut plot = dozen();
        plot.panels[0].x = Axis { range: Some([1.0, 2.0]), ..Axis::linear("") };
        plot.panels[0].series[0].points = vec![[-1e299, 1.0], [1e299, 1.0]];
        let longest = plot.svg(900, 600).split([' ', ',']).map(str::len).max();
        assert!(longest < Some(80), "{longest:?}");
    }
}
