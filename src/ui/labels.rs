//! Texts on plates over a picture, in the window's own font. The renderer draws shapes only.

use super::placement::Placement;
use egui::{Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, vec2};
use touchline_application::scene::drawing::{Colour, Label};
use touchline_core::geometry::ImagePoint;

/// Margin of the plate around the letters, points.
const PADDING: egui::Vec2 = vec2(4.0, 1.5);

/// Writes the labels of a drawing. Labels far outside the picture are skipped.
pub fn paint<'a>(
    painter: &Painter,
    placement: &Placement,
    labels: impl Iterator<Item = &'a Label>,
) {
    for label in labels {
        let [x, y] = label.at.map(f64::from);
        let at = placement.screen_from_image(ImagePoint::new(x, y)) + label.offset_pt.into();
        if placement.rect.expand(40.0).contains(at) {
            let font = FontId::proportional(label.size_pt);
            let style = PlateStyle::new(font, colour(label.colour), colour(label.plate));
            plate(painter, at, Align2::LEFT_CENTER, &label.text, style);
        }
    }
}

/// Font and colours of a text on a plate.
pub struct PlateStyle {
    font: FontId,
    letters: Color32,
    behind: Color32,
}

impl PlateStyle {
    /// Letters in a font and colour, on a plate of the second colour.
    pub const fn new(font: FontId, letters: Color32, behind: Color32) -> Self {
        Self {
            font,
            letters,
            behind,
        }
    }
}

/// Writes a text on a plate. Returns the rectangle of the plate.
pub fn plate(painter: &Painter, at: Pos2, align: Align2, text: &str, style: PlateStyle) -> Rect {
    let galley = painter.layout_no_wrap(text.to_owned(), style.font, style.letters);
    let rect = align.anchor_size(at, galley.size());
    let around = rect.expand2(PADDING);
    painter.rect_filled(around, CornerRadius::same(3), style.behind);
    painter.galley(rect.min, galley, style.letters);
    around
}

/// The colour of a drawing as an egui colour.
pub fn colour(colour: Colour) -> Color32 {
    Color32::from_rgba_unmultiplied(colour.r, colour.g, colour.b, colour.a)
}
