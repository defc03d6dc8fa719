//! The title of a figure, in lines that fit.

use super::{SMALL_TEXT, WIDTH};
use crate::report::figure::Figure;
use crate::report::figure::shape::{Anchor, Shape};
use crate::report::figure::typeface::Typeface;

/// A little larger than the axes' labels.
pub(super) const TITLE_TEXT: f64 = 15.0;
/// Height of a title of one line, and of each further line.
pub(super) const TITLE_ROW: f64 = 22.0;
pub(super) const TITLE_FURTHER_ROW: f64 = 16.0;
/// Left and right of a title, at least.
pub(super) const TITLE_MARGIN: f64 = 12.0;

impl Figure {
    /// Adds the title, centred at the top of the figure. Returns the height that it takes.
    ///
    /// A title that is too wide is shrunk, at most to the size of the smallest text; one that is
    /// too wide even then is broken at spaces. A word that is wider than the figure shrinks the
    /// title further.
    pub(super) fn add_title(&self, shapes: &mut Vec<Shape>, typeface: &Typeface) -> f64 {
        let title = self.title.trim();
        if title.is_empty() {
            return 0.0;
        }
        let room = WIDTH - 2.0 * TITLE_MARGIN;
        // Widths grow in proportion to the size, so one measurement gives the size that fits.
        let fitting = TITLE_TEXT * room / typeface.width(title, TITLE_TEXT);
        let (lines, size) = if fitting >= SMALL_TEXT {
            (vec![title.to_owned()], fitting.min(TITLE_TEXT))
        } else {
            let lines = break_lines(title, SMALL_TEXT, room, typeface);
            let widths = lines.iter().map(|line| typeface.width(line, SMALL_TEXT));
            let widest = widths.fold(room, f64::max);
            (lines, SMALL_TEXT * room / widest)
        };
        // The title is not empty, so there is at least one line.
        let height = TITLE_ROW + TITLE_FURTHER_ROW * (lines.len() - 1) as f64;
        for (row, text) in lines.into_iter().enumerate() {
            shapes.push(Shape::Text {
                text,
                at: [WIDTH / 2.0, 18.0 + TITLE_FURTHER_ROW * row as f64],
                size,
                anchor: Anchor::Middle,
                upright: false,
            });
        }
        height
    }
}

/// Breaks text at spaces into lines that are no wider than `room`, as far as its words allow.
fn break_lines(text: &str, size: f64, room: f64, typeface: &Typeface) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if typeface.width(&longer, size) <= room {
                *line = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    lines
}
