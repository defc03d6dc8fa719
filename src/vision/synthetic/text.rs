//! Words as coverage: glyphs rasterised at one size and made as bold as wanted.

use super::coverage::disc;
use ab_glyph::{Font, FontRef, GlyphId, PxScale, ScaleFont, point};

/// A rectangle of coverage, 0 to 1, row by row.
#[derive(Clone, Debug, Default)]
pub(super) struct GlyphCoverage {
    pub width: usize,
    pub height: usize,
    pub share: Vec<f32>,
}

impl GlyphCoverage {
    /// The coverage at a cell; nothing outside.
    pub fn at(&self, x: i64, y: i64) -> f32 {
        let inside = x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height;
        if inside {
            self.share[y as usize * self.width + x as usize]
        } else {
            0.0
        }
    }
}

/// A line of text with capitals `capital_px` high, its lines thickened by `weight_px` on each side;
/// the picture is cropped to the capitals' height (plus the weight) and the text's width.
pub(super) fn rasterise(text: &str, capital_px: f32, weight_px: f32) -> GlyphCoverage {
    // The font ships with the program; were it unreadable, boards would be blank and nothing else.
    let Ok(font) = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT) else {
        return GlyphCoverage::default();
    };
    // Ubuntu's capitals are 0.693 of an em; ab_glyph scales by ascent − descent.
    let em_px = capital_px / 0.693;
    let scale =
        PxScale::from(em_px * font.height_unscaled() / font.units_per_em().unwrap_or(1000.0));
    // Glyphs stand on a baseline below the capitals. The margin leaves room for the weight, and
    // each glyph advances by the weight more, lest thick letters touch.
    let scaled = font.as_scaled(scale);
    let margin = weight_px.ceil() + 1.0;
    let mut pen = margin;
    let mut previous: Option<GlyphId> = None;
    let mut outlines = Vec::new();
    for character in text.chars() {
        let id = scaled.glyph_id(character);
        if let Some(previous) = previous {
            pen += scaled.kern(previous, id);
        }
        let glyph = id.with_scale_and_position(scale, point(pen, capital_px + margin));
        pen += scaled.h_advance(id) + weight_px;
        previous = Some(id);
        outlines.extend(font.outline_glyph(glyph));
    }
    let mut thin = GlyphCoverage {
        width: (pen + margin).ceil() as usize,
        height: (capital_px + 2.0 * margin).ceil() as usize,
        share: Vec::new(),
    };
    thin.share = vec![0.0; thin.width * thin.height];
    for outline in outlines {
        let corner = outline.px_bounds().min;
        outline.draw(|x, y, share| {
            let (x, y) = (
                corner.x as i64 + i64::from(x),
                corner.y as i64 + i64::from(y),
            );
            if x >= 0 && y >= 0 && (x as usize) < thin.width && (y as usize) < thin.height {
                // Neighbouring glyphs may share a cell: the greater coverage counts.
                let cell = &mut thin.share[y as usize * thin.width + x as usize];
                *cell = cell.max(share);
            }
        });
    }
    embolden(&thin, weight_px)
}

/// Dilation by a disc with a soft rim.
fn embolden(thin: &GlyphCoverage, weight_px: f32) -> GlyphCoverage {
    if weight_px <= 0.0 {
        return thin.clone();
    }
    let disc = disc(weight_px);
    let mut bold = thin.clone();
    for y in 0..thin.height as i64 {
        for x in 0..thin.width as i64 {
            let share = disc
                .iter()
                .map(|(dx, dy, share)| share * thin.at(x + dx, y + dy))
                .fold(0.0, f32::max);
            bold.share[y as usize * thin.width + x as usize] = share;
        }
    }
    bold
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_have_ink_and_weight_adds_to_it() {
        let ink = |coverage: &GlyphCoverage| coverage.share.iter().sum::<f32>();
        let (thin, bold) = (
            rasterise("TWO POINTS", 30.0, 0.0),
            rasterise("TWO POINTS", 30.0, 2.0),
        );
        assert!(thin.height >= 30 && thin.height <= 36 && thin.width > 100);
        assert!(ink(&thin) > 200.0 && ink(&bold) > 1.5 * ink(&thin));
        assert_eq!(rasterise("", 30.0, 1.0).share.iter().sum::<f32>(), 0.0);
    }
}
