//! The typeface of figures: width and outlines of text.

use super::shape::Anchor;
use ab_glyph::{Font as _, FontRef, InvalidFont, OutlineCurve, PxScale, ScaleFont as _};

const TYPEFACE: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;

/// The typeface that is built into the program.
pub struct Typeface {
    font: FontRef<'static>,
}

/// A piece of a letter's outline, from the end of the piece before; px, y down.
pub enum Stroke {
    Begin([f32; 2]),
    Line([f32; 2]),
    Quad([f32; 2], [f32; 2]),
    Cubic([f32; 2], [f32; 2], [f32; 2]),
}

impl Typeface {
    pub fn load() -> Result<Self, InvalidFont> {
        Ok(Self {
            font: FontRef::try_from_slice(TYPEFACE)?,
        })
    }

    /// The scale for a font size in px per em, as SVG has it. `ab_glyph` scales by the font's
    /// height (ascent minus descent) instead.
    fn scale(&self, size: f64) -> PxScale {
        let em = self.font.units_per_em().unwrap_or(1000.0);
        PxScale::from(size as f32 * self.font.height_unscaled() / em)
    }

    /// The width of text, px.
    pub fn width(&self, text: &str, size: f64) -> f64 {
        let font = self.font.as_scaled(self.scale(size));
        text.chars()
            .map(|letter| f64::from(font.h_advance(font.glyph_id(letter))))
            .sum()
    }

    /// The outlines of text, px, y down, with the anchor at the origin of the baseline.
    pub fn outlines(&self, text: &str, size: f64, anchor: Anchor) -> Vec<Stroke> {
        let scale = self.scale(size);
        let factor = scale.y / self.font.height_unscaled();
        let scaled = self.font.as_scaled(scale);
        let width = self.width(text, size) as f32;
        let mut x = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -width / 2.0,
            Anchor::End => -width,
        };
        let mut strokes = Vec::new();
        for letter in text.chars() {
            let glyph = scaled.glyph_id(letter);
            if let Some(outline) = self.font.outline(glyph) {
                let at = |point: ab_glyph::Point| [x + point.x * factor, -point.y * factor];
                let mut end = None;
                for curve in outline.curves {
                    let (from, stroke, to) = match curve {
                        OutlineCurve::Line(a, b) => (a, Stroke::Line(at(b)), b),
                        OutlineCurve::Quad(a, b, c) => (a, Stroke::Quad(at(b), at(c)), c),
                        OutlineCurve::Cubic(a, b, c, d) => {
                            (a, Stroke::Cubic(at(b), at(c), at(d)), d)
                        }
                    };
                    // A curve that does not start where the last one ended begins a new contour.
                    if end != Some(from) {
                        strokes.push(Stroke::Begin(at(from)));
                    }
                    strokes.push(stroke);
                    end = Some(to);
                }
            }
            x += scaled.h_advance(glyph);
        }
        strokes
    }
}
