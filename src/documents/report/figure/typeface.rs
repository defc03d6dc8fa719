//! The typeface of figures: where the glyphs of a text are, and their outlines.
//!
//! SVG and PNG both draw what [`Typeface::place_glyphs`] and [`Typeface::outline`] return, so that
//! their text agrees. Lengths are in font units, as the typeface states them: they are integers,
//! apart from some halves, and hold for all sizes.

use super::shape::Anchor;
use ab_glyph::{Font as _, FontRef, GlyphId, InvalidFont, OutlineCurve, Point};

const TYPEFACE: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;
/// For a typeface that does not state its own.
const USUAL_UNITS_PER_EM: f32 = 1000.0;

/// The typeface that is built into the program.
pub struct Typeface {
    font: FontRef<'static>,
}

/// A line of text. Lengths are in font units.
#[derive(Clone, Debug, PartialEq)]
pub struct TextLine {
    /// The glyphs, from left to right.
    pub glyphs: Vec<PlacedGlyph>,
    pub width: f64,
    /// The size of a font unit at the text's size.
    pub px_per_unit: f64,
}

/// A glyph of a line of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedGlyph {
    pub id: GlyphId,
    /// The position of the glyph's origin along the baseline, relative to the text's anchor.
    pub x: f64,
}

/// A piece of a glyph's outline, from the end of the piece before. Positions are in font units
/// relative to the glyph's origin, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlineSegment {
    Begin([f64; 2]),
    Line([f64; 2]),
    Quad([f64; 2], [f64; 2]),
    Cubic([f64; 2], [f64; 2], [f64; 2]),
}

impl Typeface {
    pub fn load() -> Result<Self, InvalidFont> {
        Ok(Self {
            font: FontRef::try_from_slice(TYPEFACE)?,
        })
    }

    /// The width of text, px.
    pub fn width(&self, text: &str, size: f64) -> f64 {
        let line = self.place_glyphs(text, size, Anchor::Start);
        line.width * line.px_per_unit
    }

    /// Places the glyphs of text. `size` is px per em, as SVG has it. A character that the typeface
    /// lacks gets its replacement glyph.
    pub fn place_glyphs(&self, text: &str, size: f64, anchor: Anchor) -> TextLine {
        let mut glyphs = Vec::new();
        let mut width = 0.0;
        for letter in text.chars() {
            let id = self.font.glyph_id(letter);
            glyphs.push(PlacedGlyph { id, x: width });
            width += f64::from(self.font.h_advance_unscaled(id));
        }
        // The anchor needs the width of the whole text. Advances alone are added: the typeface's
        // kerning is not applied, in SVG and PNG alike.
        let start = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -width / 2.0,
            Anchor::End => -width,
        };
        for glyph in &mut glyphs {
            glyph.x += start;
        }
        let units_per_em = self.font.units_per_em().unwrap_or(USUAL_UNITS_PER_EM);
        TextLine {
            glyphs,
            width,
            px_per_unit: size / f64::from(units_per_em),
        }
    }

    /// The outline of a glyph; empty for a space.
    pub fn outline(&self, glyph: GlyphId) -> Vec<OutlineSegment> {
        let curves = self.font.outline(glyph).map(|outline| outline.curves);
        let mut segments = Vec::new();
        let mut end = None;
        for curve in curves.unwrap_or_default() {
            let (from, segment, to) = match curve {
                OutlineCurve::Line(a, b) => (a, OutlineSegment::Line(flip_y(b)), b),
                OutlineCurve::Quad(a, b, c) => (a, OutlineSegment::Quad(flip_y(b), flip_y(c)), c),
                OutlineCurve::Cubic(a, b, c, d) => {
                    (a, OutlineSegment::Cubic(flip_y(b), flip_y(c), flip_y(d)), d)
                }
            };
            // The font's contours are closed by a line, which often has no length.
            if matches!(segment, OutlineSegment::Line(_)) && from == to {
                continue;
            }
            // A curve that does not start where the last one ended begins a new contour.
            if end != Some(from) {
                segments.push(OutlineSegment::Begin(flip_y(from)));
            }
            segments.push(segment);
            end = Some(to);
        }
        segments
    }
}

/// A point of the font, where y is up, as a figure has it.
fn flip_y(point: Point) -> [f64; 2] {
    [f64::from(point.x), -f64::from(point.y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_lies_at_its_anchor() {
        let typeface = Typeface::load().unwrap();
        let place = |anchor| typeface.place_glyphs("noise (px)", 13.0, anchor);
        let [start, middle, end] = [Anchor::Start, Anchor::Middle, Anchor::End].map(place);
        assert!(start.width > 0.0 && start.glyphs.len() == 10);
        for ((start, middle), end) in start.glyphs.iter().zip(&middle.glyphs).zip(&end.glyphs) {
            assert_eq!((start.id, start.id), (middle.id, end.id));
        }
        let first = [&start, &middle, &end].map(|line| line.glyphs[0].x);
        assert_eq!(first, [0.0, -start.width / 2.0, -start.width]);
        // Widths add up and grow with the size.
        let width = |text| typeface.width(text, 13.0);
        assert!((width("noise") + width(" (px)") - width("noise (px)")).abs() < 1e-9);
        assert!((2.0 * width("noise") - typeface.width("noise", 26.0)).abs() < 1e-9);
    }

    #[test]
    fn outlines_are_closed_contours_above_the_baseline() {
        let typeface = Typeface::load().unwrap();
        let glyph = |letter: &str| typeface.place_glyphs(letter, 1.0, Anchor::Start).glyphs[0].id;
        assert!(typeface.outline(glyph(" ")).is_empty());
        let letter = typeface.outline(glyph("B"));
        let begins = letter
            .iter()
            .filter(|stroke| matches!(stroke, OutlineSegment::Begin(_)));
        // The outer contour and two holes.
        assert_eq!(begins.count(), 3);
        for stroke in letter {
            let (OutlineSegment::Begin([_, y])
            | OutlineSegment::Line([_, y])
            | OutlineSegment::Quad(_, [_, y])
            | OutlineSegment::Cubic(_, _, [_, y])) = stroke;
            assert!((-1000.0..20.0).contains(&y), "{y}");
        }
    }
}
