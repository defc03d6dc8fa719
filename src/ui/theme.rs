//! Colours, spacing and type of the window.
//!
//! One accent colour. Everything is aligned to a grid of 4 points. A status or a verdict is never shown by colour alone:
//! each has a letter or a word and, on the filmstrip, its own pattern; the hues are distinguishable for colour-blind users
//! (Okabe and Ito's set, lightened for a dark ground).

use crate::document::FrameStatus;
use crate::paint::LineVerdict;
use crate::solve::Verdict;
use egui::{
    Color32, CornerRadius, FontFamily, FontId, Margin, Painter, Pos2, Rect, Shadow, Stroke, TextStyle, Vec2, pos2, vec2,
};

/// The grid, points.
pub const SPACE: f32 = 4.0;

/// Behind the picture.
pub const BACKDROP: Color32 = Color32::from_rgb(13, 15, 17);
/// The panels.
pub const PANEL: Color32 = Color32::from_rgb(24, 26, 29);
/// What lies on a panel: cards, fields.
pub const RAISED: Color32 = Color32::from_rgb(33, 36, 40);
/// A control.
const CONTROL: Color32 = Color32::from_rgb(43, 47, 53);
/// A control under the pointer.
const HOVERED: Color32 = Color32::from_rgb(55, 60, 68);
/// Lines between things.
pub const LINE: Color32 = Color32::from_rgb(48, 52, 58);
/// Ordinary text.
pub const TEXT: Color32 = Color32::from_rgb(208, 213, 219);
/// Titles and values.
pub const STRONG: Color32 = Color32::from_rgb(242, 244, 247);
/// Secondary text; at least 4.5 to 1 on every ground.
pub const WEAK: Color32 = Color32::from_rgb(162, 170, 180);
/// The accent: what is selected, and the main action.
pub const ACCENT: Color32 = Color32::from_rgb(64, 146, 255);
/// The accent as a background.
pub const ACCENT_GROUND: Color32 = Color32::from_rgb(31, 56, 90);
/// Good.
pub const GOOD: Color32 = Color32::from_rgb(44, 196, 150);
/// To be checked.
pub const CAUTION: Color32 = Color32::from_rgb(242, 183, 64);
/// Wrong.
pub const BAD: Color32 = Color32::from_rgb(255, 112, 84);

/// The size of the verdict's word.
pub const VERDICT: f32 = 20.0;

/// How a status looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatusLook {
    /// Its colour.
    pub colour: Color32,
    /// Its letter.
    pub letter: char,
}

/// How a status looks.
pub const fn status_look(status: FrameStatus) -> StatusLook {
    match status {
        FrameStatus::New => StatusLook { colour: Color32::from_rgb(140, 147, 158), letter: 'N' },
        FrameStatus::Draft => StatusLook { colour: Color32::from_rgb(98, 184, 240), letter: 'D' },
        FrameStatus::Suggested => StatusLook { colour: CAUTION, letter: 'S' },
        FrameStatus::Reference => StatusLook { colour: GOOD, letter: 'R' },
        FrameStatus::Rejected => StatusLook { colour: Color32::from_rgb(214, 134, 178), letter: 'X' },
    }
}

/// The colour of a verdict; its word is always shown with it.
pub const fn verdict_colour(verdict: Verdict) -> Color32 {
    match verdict {
        Verdict::Good => GOOD,
        Verdict::Check => CAUTION,
        Verdict::Wrong => BAD,
    }
}

/// Paints the bar of a status: empty, half, dashed, full or crossed out. The bar of a suggestion is filled up to its
/// confidence.
pub fn paint_status_bar(painter: &Painter, bar: Rect, status: FrameStatus, confidence: Option<f64>) {
    let colour = status_look(status).colour;
    let fill = |from: f32, to: f32| {
        let part =
            Rect::from_x_y_ranges(bar.left() + from * bar.width()..=bar.left() + to * bar.width(), bar.y_range());
        painter.rect_filled(part, CornerRadius::same(1), colour);
    };
    match status {
        FrameStatus::New => {
            painter.rect_stroke(bar, CornerRadius::same(1), Stroke::new(1.0, colour), egui::StrokeKind::Inside);
        }
        FrameStatus::Draft => {
            painter.rect_stroke(bar, CornerRadius::same(1), Stroke::new(1.0, colour), egui::StrokeKind::Inside);
            fill(0.0, 0.5);
        }
        FrameStatus::Suggested => {
            let certain = confidence.unwrap_or(1.0).clamp(0.0, 1.0) as f32;
            for dash in 0..5 {
                let (from, to) = (dash as f32 * 0.21, dash as f32 * 0.21 + 0.15);
                let outline = Rect::from_x_y_ranges(
                    bar.left() + from * bar.width()..=bar.left() + to * bar.width(),
                    bar.y_range(),
                );
                painter.rect_stroke(outline, 1.0, Stroke::new(1.0, colour), egui::StrokeKind::Inside);
                if certain > from {
                    fill(from, to.min(certain));
                }
            }
        }
        FrameStatus::Reference => fill(0.0, 1.0),
        FrameStatus::Rejected => {
            let step = 2.0 * bar.height();
            let mut x = bar.left();
            while x + bar.height() <= bar.right() {
                painter
                    .line_segment([pos2(x, bar.bottom()), pos2(x + bar.height(), bar.top())], Stroke::new(1.5, colour));
                x += step * 0.5 + 1.0;
            }
        }
    }
}

/// A small title above a group.
pub fn title(ui: &mut egui::Ui, text: &str) {
    ui.label(egui::RichText::new(text).small().color(WEAK).strong());
}

/// Applies the theme to a window.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Small, 11.0, FontFamily::Proportional),
            (TextStyle::Body, 13.0, FontFamily::Proportional),
            (TextStyle::Button, 13.0, FontFamily::Proportional),
            (TextStyle::Heading, 16.0, FontFamily::Proportional),
            (TextStyle::Monospace, 12.0, FontFamily::Monospace),
        ]
        .into_iter()
        .map(|(name, size, family)| (name, FontId::new(size, family)))
        .collect();
        style.drag_value_text_style = TextStyle::Body;
        style.always_scroll_the_only_direction = true;
        style.explanation_tooltips = false;
        style.animation_time = 0.08;
        style.interaction.selectable_labels = false;
        style.interaction.tooltip_delay = 0.4;
        space(&mut style.spacing);
        colour(&mut style.visuals);
    });
}

fn space(spacing: &mut egui::Spacing) {
    spacing.item_spacing = vec2(2.0 * SPACE, SPACE);
    spacing.button_padding = vec2(2.0 * SPACE, 2.0);
    spacing.interact_size = vec2(36.0, 20.0);
    spacing.menu_margin = Margin::same(SPACE as i8);
    spacing.window_margin = Margin::same(3 * SPACE as i8);
    spacing.indent = 3.0 * SPACE;
    spacing.icon_width = 14.0;
    spacing.icon_width_inner = 8.0;
    spacing.tooltip_width = 360.0;
    spacing.slider_width = 140.0;
    spacing.combo_width = 96.0;
    spacing.scroll = egui::style::ScrollStyle::thin();
}

fn colour(visuals: &mut egui::Visuals) {
    *visuals = egui::Visuals::dark();
    let corner = CornerRadius::same(4);
    visuals.panel_fill = PANEL;
    visuals.window_fill = Color32::from_rgb(29, 32, 36);
    visuals.window_stroke = Stroke::new(1.0, Color32::from_rgb(62, 67, 75));
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.extreme_bg_color = BACKDROP;
    visuals.faint_bg_color = Color32::from_rgb(29, 31, 35);
    visuals.code_bg_color = RAISED;
    visuals.hyperlink_color = Color32::from_rgb(112, 176, 255);
    visuals.warn_fg_color = CAUTION;
    visuals.error_fg_color = BAD;
    visuals.weak_text_color = Some(WEAK);
    visuals.selection.bg_fill = ACCENT_GROUND;
    visuals.selection.stroke = Stroke::new(1.0, STRONG);
    visuals.window_shadow = Shadow { offset: [0, 6], blur: 24, spread: 0, color: Color32::from_black_alpha(120) };
    visuals.popup_shadow = Shadow { offset: [0, 4], blur: 12, spread: 0, color: Color32::from_black_alpha(100) };
    visuals.slider_trailing_fill = true;
    visuals.disabled_alpha = 0.45;
    let widgets = &mut visuals.widgets;
    for (widget, ground, border, text) in [
        (&mut widgets.noninteractive, PANEL, LINE, TEXT),
        (&mut widgets.inactive, CONTROL, CONTROL, TEXT),
        (&mut widgets.hovered, HOVERED, Color32::from_rgb(84, 91, 101), STRONG),
        (&mut widgets.active, ACCENT_GROUND, ACCENT, STRONG),
        (&mut widgets.open, CONTROL, LINE, STRONG),
    ] {
        widget.bg_fill = ground;
        widget.weak_bg_fill = ground;
        widget.bg_stroke = Stroke::new(1.0, border);
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = corner;
        widget.expansion = 0.0;
    }
}

/// The height of a row of the lists.
pub const LIST_ROW: f32 = 22.0;

/// The size of a button that is only a symbol.
pub const SYMBOL: Vec2 = vec2(20.0, 20.0);

/// The mark of what the painted lines say about a camera: a disc where they support it, a cross where they contradict it, a
/// ring where they do not decide.
pub fn paint_line_mark(painter: &Painter, centre: Pos2, verdict: LineVerdict) {
    painter.circle_filled(centre, 6.0, BACKDROP);
    match verdict {
        LineVerdict::Supports => {
            painter.circle_filled(centre, 4.0, GOOD);
        }
        LineVerdict::Contradicts => {
            let arm = Rect::from_center_size(centre, Vec2::splat(6.0));
            let stroke = Stroke::new(2.0, BAD);
            painter.line_segment([arm.left_top(), arm.right_bottom()], stroke);
            painter.line_segment([arm.right_top(), arm.left_bottom()], stroke);
        }
        LineVerdict::CannotSay => {
            painter.circle_stroke(centre, 3.5, Stroke::new(1.0, WEAK));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contrast of WCAG 2.2: from 1 to 21.
    fn contrast(one: Color32, other: Color32) -> f64 {
        let luminance = |colour: Color32| {
            let linear = |value: u8| {
                let value = f64::from(value) / 255.0;
                if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
            };
            0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
        };
        let (one, other) = (luminance(one), luminance(other));
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    #[test]
    fn text_is_readable_on_every_ground_that_it_stands_on() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        let window = Color32::from_rgb(29, 32, 36);
        let mut pairs = Vec::new();
        for text in [TEXT, STRONG, WEAK] {
            pairs.extend(
                [BACKDROP, PANEL, RAISED, CONTROL, HOVERED, ACCENT_GROUND, window].map(|ground| (text, ground)),
            );
        }
        let statuses = [FrameStatus::New, FrameStatus::Draft, FrameStatus::Suggested, FrameStatus::Rejected];
        for text in [ACCENT, GOOD, CAUTION, BAD].into_iter().chain(statuses.map(|status| status_look(status).colour)) {
            pairs.extend([BACKDROP, PANEL, RAISED, window].map(|ground| (text, ground)));
        }
        // Letters on coloured buttons.
        pairs.extend([ACCENT, CAUTION, BAD].map(|ground| (BACKDROP, ground)));
        for (text, ground) in pairs {
            let found = contrast(text, ground);
            assert!(found >= 4.5, "{text:?} on {ground:?}: {found:.2}");
        }
    }
}
