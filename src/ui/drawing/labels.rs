//! Texts in the window's own font: on plates over a picture, where the renderer draws shapes only,
//! and in one line of a panel, how wide they are and cut to a width.

use super::placement::Placement;
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, Color32, CornerRadius, FontId, Galley, Painter, Pos2, Rect, vec2};
use std::sync::Arc;
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
    // The anchor of a label may be a little outside while its text reaches into the picture: hence
    // the margin of 40 points.
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

/// Width of a text, points.
pub fn text_width(painter: &Painter, text: &str, font: FontId) -> f32 {
    let galley = painter.layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER);
    galley.size().x
}

/// Lays out a text in one line, which ends in an ellipsis if it is longer than `width` points.
pub fn lay_out_within(
    painter: &Painter,
    text: String,
    font: FontId,
    colour: Color32,
    width: f32,
) -> Arc<Galley> {
    let mut line = LayoutJob::simple_singleline(text, font, colour);
    line.wrap = TextWrapping::truncate_at_width(width);
    painter.layout_job(line)
}

/// The colour of a drawing as an egui colour.
pub fn colour(colour: Colour) -> Color32 {
    Color32::from_rgba_unmultiplied(colour.r, colour.g, colour.b, colour.a)
}
