//! Drawn marks: letter and bar of a frame's status, and the result of the line check. Status and
//! result differ in shape as well as in colour.

use super::palette::{Palette, Themed as _};
use egui::{Color32, CornerRadius, Painter, Pos2, Rect, Stroke, Vec2, pos2};
use touchline_core::markings::LineVerdict;
use touchline_documents::document::FrameStatus;

pub const fn status_letter(status: FrameStatus) -> char {
    match status {
        FrameStatus::New => 'N',
        FrameStatus::Draft => 'D',
        FrameStatus::Suggested => 'S',
        FrameStatus::Reference => 'R',
        FrameStatus::Rejected => 'X',
    }
}

/// Draws the bar of a status: empty for new, half for a draft, dashes for a suggestion (filled up
/// to its confidence), full for a reference, hatched for a rejected frame.
pub fn paint_status_bar(
    painter: &Painter,
    bar: Rect,
    status: FrameStatus,
    confidence: Option<f64>,
) {
    let colour = painter.palette().status(status);
    let fill = |from: f32, to: f32| {
        let part = Rect::from_x_y_ranges(
            bar.left() + from * bar.width()..=bar.left() + to * bar.width(),
            bar.y_range(),
        );
        painter.rect_filled(part, CornerRadius::same(1), colour);
    };
    match status {
        FrameStatus::New => {
            painter.rect_stroke(
                bar,
                CornerRadius::same(1),
                Stroke::new(1.0, colour),
                egui::StrokeKind::Inside,
            );
        }
        FrameStatus::Draft => {
            painter.rect_stroke(
                bar,
                CornerRadius::same(1),
                Stroke::new(1.0, colour),
                egui::StrokeKind::Inside,
            );
            fill(0.0, 0.5);
        }
        FrameStatus::Suggested => {
            // A suggestion without a stated confidence has full dashes: the gaps between them still
            // distinguish it from a reference.
            let certain = confidence.unwrap_or(1.0).clamp(0.0, 1.0) as f32;
            // Five dashes of 0.15 with gaps of 0.06 fill the bar: 4 · 0.21 + 0.15 = 0.99.
            for dash in 0..5 {
                let (from, to) = (dash as f32 * 0.21, dash as f32 * 0.21 + 0.15);
                let outline = Rect::from_x_y_ranges(
                    bar.left() + from * bar.width()..=bar.left() + to * bar.width(),
                    bar.y_range(),
                );
                painter.rect_stroke(
                    outline,
                    1.0,
                    Stroke::new(1.0, colour),
                    egui::StrokeKind::Inside,
                );
                if certain > from {
                    fill(from, to.min(certain));
                }
            }
        }
        FrameStatus::Reference => fill(0.0, 1.0),
        FrameStatus::Rejected => {
            // Hatching at 45°, with lines one point farther apart than the bar is high, so that
            // they do not overlap. Only lines that end within the bar are drawn.
            let mut x = bar.left();
            while x + bar.height() <= bar.right() {
                painter.line_segment(
                    [pos2(x, bar.bottom()), pos2(x + bar.height(), bar.top())],
                    Stroke::new(1.5, colour),
                );
                x += bar.height() + 1.0;
            }
        }
    }
}

/// The colour of a verdict of the paint where colour alone shows it.
pub const fn verdict_colour(palette: &Palette, verdict: LineVerdict) -> Color32 {
    match verdict {
        LineVerdict::Supports => palette.good,
        LineVerdict::CannotSay => palette.caution,
        LineVerdict::Contradicts => palette.bad,
    }
}

/// Draws the result of the line check: a disc if the paint supports the camera, a cross if it
/// contradicts it, a ring if it does not decide.
pub fn paint_line_mark(painter: &Painter, centre: Pos2, verdict: LineVerdict) {
    let palette = painter.palette();
    // The mark lies on a thumbnail, so a disc of the backdrop separates it from the picture.
    painter.circle_filled(centre, 6.0, palette.backdrop);
    match verdict {
        LineVerdict::Supports => {
            painter.circle_filled(centre, 4.0, palette.good);
        }
        LineVerdict::Contradicts => {
            let arm = Rect::from_center_size(centre, Vec2::splat(6.0));
            let stroke = Stroke::new(2.0, palette.bad);
            painter.line_segment([arm.left_top(), arm.right_bottom()], stroke);
            painter.line_segment([arm.right_top(), arm.left_bottom()], stroke);
        }
        LineVerdict::CannotSay => {
            painter.circle_stroke(centre, 3.5, Stroke::new(1.0, palette.weak));
        }
    }
}
