//! The card of a camera without a base: the ways to one. *Find it* needs no click; three clicked
//! frames fill the places left, centre and right. A way that cannot work says why in its place.

use super::card;
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::drawing::pictures::WHOLE;
use egui::{
    Align, Button, Color32, CornerRadius, Frame, Label, Layout, Margin, Rect, RichText, Role,
    Sense, Stroke, StrokeKind, Ui, UiBuilder, WidgetInfo, vec2,
};
use touchline_application::app::{Command, MissingBase};
use touchline_documents::document::FrameId;

/// Height of the two tiles, points.
const TILE: f32 = 92.0;
/// The same where one says why there is no search, points.
const TILE_WITH_REASON: f32 = 140.0;
/// Height of a thumbnail, points.
const THUMBNAIL: f32 = 24.0;
/// The parts of the field that the three frames should show.
const PARTS: [&str; 3] = ["left", "centre", "right"];

/// Shows the card. Nothing if the camera has a base, or if one is being looked for.
pub(super) fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    if let Some(missing) = panel.app.missing_base() {
        card(ui, |ui| show_ways(panel, ui, &missing));
    }
}

fn show_ways(panel: &mut Panel<'_>, ui: &mut Ui, missing: &MissingBase) {
    theme::title(ui, "WHERE DOES THE CAMERA STAND?");
    if let Some((why, frame)) = &missing.no_answer {
        ui.add(Label::new(RichText::new(why).color(ui.palette().caution)).wrap());
        if let Some(frame) = frame {
            go_there(panel, ui, frame, "Go to the frame in which clicks help.");
        }
    }
    let gap = ui.spacing().item_spacing.x;
    let height = if missing.why_no_search.is_some() {
        TILE_WITH_REASON
    } else {
        TILE
    };
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let width = (row.width() - gap) / 2.0;
    let left = row.with_max_x(row.left() + width);
    ui.scope_builder(UiBuilder::new().max_rect(left), |ui| {
        find_tile(panel, ui, missing);
    });
    let right = row.with_min_x(row.right() - width);
    ui.scope_builder(UiBuilder::new().max_rect(right), |ui| {
        click_tile(panel, ui, missing);
    });
    if missing.ready.wide > 0 {
        estimate_button(panel, ui, missing);
    }
    ui.horizontal(|ui| {
        panel.run_on_click(ui.add(Button::new("Load…").small()), Command::LoadCamera);
        panel.run_on_click(
            ui.add(Button::new("Import cameras…").small()),
            Command::Import,
        );
    });
    if missing.lines_from_this_frame {
        let text =
            "The dashed lines come from this frame alone; they say nothing about the others.";
        theme::small_weak_text(ui, text);
    }
}

/// The tile that starts the search without a click, or says why there is none.
fn find_tile(panel: &mut Panel<'_>, ui: &mut Ui, missing: &MissingBase) {
    let finds_all = panel.app.why_not(Command::FindCameras).is_none();
    let command = if finds_all {
        Command::FindCameras
    } else {
        Command::FindCamera
    };
    let says = if missing.no_answer.is_some() {
        "Look again"
    } else {
        "Find it"
    };
    tile(ui, |ui| {
        let button =
            Button::new(RichText::new(says).strong()).min_size(vec2(ui.available_width(), 24.0));
        let button = if missing.why_no_search.is_none() && !missing.ready.is_enough() {
            button.fill(ui.palette().accent_ground)
        } else {
            button
        };
        ui.vertical_centered_justified(|ui| panel.command_button(ui, button, command));
        let text = match missing.why_no_search {
            Some(why) => why,
            None if finds_all => "All cameras and frames, without a click. Some minutes.",
            None => "From the pictures, without a click. About a minute.",
        };
        note(ui, text);
    });
}

/// The tile of the three clicked frames: where they look, and how many there are.
fn click_tile(panel: &mut Panel<'_>, ui: &mut Ui, missing: &MissingBase) {
    tile(ui, |ui| {
        ui.label(
            RichText::new("Click 3 frames")
                .strong()
                .color(ui.palette().strong),
        );
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = theme::SPACE;
            let width = (ui.available_width() - 2.0 * theme::SPACE) / 3.0;
            for (part, view) in PARTS.into_iter().zip(missing.views) {
                thumbnail(panel, ui, vec2(width, THUMBNAIL), part, view);
            }
        })
        .response
        .on_hover_text(missing.ready.describe());
        note(ui, "4 landmarks in each: left, centre, right.");
    });
}

/// One of the three places: the thumbnail of a frame with enough clicks, which leads to the frame,
/// or the name of the part that is missing.
fn thumbnail(
    panel: &mut Panel<'_>,
    ui: &mut Ui,
    size: egui::Vec2,
    part: &'static str,
    view: Option<usize>,
) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let painter = ui.painter_at(rect.expand(1.0));
    let app = panel.app;
    let Some((open, index)) = app.open().zip(view) else {
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("{part}: missing")));
        let line = Stroke::new(1.0, ui.palette().hovered_line);
        painter.rect_stroke(rect, CornerRadius::same(3), line, StrokeKind::Inside);
        let font = egui::TextStyle::Small.resolve(ui.style());
        let centre = egui::Align2::CENTER_CENTER;
        painter.text(rect.center(), centre, part, font, ui.palette().weak);
        return;
    };
    let says = format!("{part}: frame {}", open.frame_number(index));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &says));
    match panel.pictures.thumbnail(open, index) {
        Some(texture) => {
            painter.image(texture.id(), rect, WHOLE, Color32::WHITE);
        }
        None => {
            painter.rect_filled(rect, CornerRadius::same(3), ui.palette().control);
        }
    }
    let line = Stroke::new(1.5, ui.palette().good);
    painter.rect_stroke(rect, CornerRadius::same(3), line, StrokeKind::Inside);
    if response.on_hover_text(says).clicked() {
        panel.go_to(index);
    }
}

/// The one button that estimates the base from clicks.
fn estimate_button(panel: &mut Panel<'_>, ui: &mut Ui, missing: &MissingBase) {
    let is_enough = missing.ready.is_enough();
    let says = if is_enough {
        "Estimate the base"
    } else {
        "Estimate anyway"
    };
    let mut button =
        Button::new(RichText::new(says).strong()).min_size(vec2(ui.available_width(), 28.0));
    if is_enough {
        button = button.fill(ui.palette().accent_ground);
    }
    ui.vertical_centered_justified(|ui| panel.command_button(ui, button, Command::EstimateBase));
}

/// Shows the button that goes to a frame, unless the frame was removed.
fn go_there(panel: &mut Panel<'_>, ui: &mut Ui, frame: &FrameId, tip: &str) {
    let open = panel.app.open();
    let Some(index) = open.and_then(|open| open.document.frames.position_of(frame)) else {
        return;
    };
    if show_button(ui, Button::new("Go there"), tip) {
        panel.go_to(index);
    }
}

/// A tile: a ground of its own, as large as the place that it is given.
fn tile(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let place: Rect = ui.max_rect();
    Frame::new()
        .fill(ui.palette().panel)
        .corner_radius(4)
        .inner_margin(Margin::same(6))
        .show(ui, |ui| {
            ui.set_min_size(place.size() - vec2(12.0, 12.0));
            ui.with_layout(Layout::top_down(Align::Min), contents);
        });
}

/// A small text that wraps.
fn note(ui: &mut Ui, text: &str) {
    theme::small_weak_text(ui, text);
}
