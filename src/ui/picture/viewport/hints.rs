//! Texts on the picture: names of points, what the next click places, and why there is no picture.

use super::super::{rejecting, typing};
use super::scene::waits_for_name;
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::drawing::labels::{PlateStyle, colour, plate, text_width};
use crate::ui::drawing::placement::Placement;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Vec2, vec2};
use touchline_application::app::session::{Mode, reason_label};
use touchline_application::app::{Command, Tool};
use touchline_application::scene::overlay::{CLICK, UNNAMED};
use touchline_documents::document::FrameStatus;

/// Colour of the plate behind a text.
pub const PLATE: Color32 = Color32::from_black_alpha(200);
/// How long a name or a note about a point stays, s.
const NAME_SHOWN_S: f64 = 4.0;
/// Offset from a point to the text about it, points.
const TEXT_OFFSET: Vec2 = vec2(20.0, 16.0);
/// Minimum distance between such a text and the border of the picture, points.
const BORDER: f32 = 8.0;

/// Draws all texts over the picture.
pub fn over_picture(panel: &mut Panel<'_>, ui: &mut egui::Ui, placement: &Placement) {
    let painter = ui.painter_at(placement.rect);
    pulse(panel, ui, placement, &painter);
    names(panel, ui, placement, &painter);
    let session = &panel.app.session;
    if let Mode::Rejecting { whole_shot } = session.mode {
        rejecting::show(panel, ui, placement.rect, whole_shot);
    } else if let Some(text) = banner(panel) {
        let at = placement.rect.center_top() + vec2(0.0, 18.0);
        plate(
            &painter,
            at,
            Align2::CENTER_CENTER,
            &text,
            PlateStyle::new(FontId::proportional(theme::BODY), Color32::WHITE, PLATE),
        );
    }
}

/// The text about the whole picture, if any; the first case that applies.
fn banner(panel: &Panel<'_>) -> Option<String> {
    // From what the user does at this moment (masks, a key that is down) over the state of the
    // camera and the frame to what the next click would do.
    let session = &panel.app.session;
    let frame = panel.app.frame()?;
    let keys = &panel.app.settings.keys;
    if session.picture.tool == Tool::Mask {
        let key = keys.with_key(Command::ShowMasks, |key| format!("{key} or "));
        return Some(format!(
            "Masks: drag a box for this frame, Shift-drag for every frame of the camera. {key}Esc when done."
        ));
    }
    if session.picture.held.compare {
        let current = panel.app.current();
        let is_imported = current.other_names().is_none() && current.other_root().is_none();
        let shown = if has_proposal(panel) {
            "The current base"
        } else if is_imported {
            "Dashed: as imported"
        } else {
            "The other solution"
        };
        return Some(shown.to_owned());
    }
    if session.picture.held.before_snap && panel.app.before_snap().is_some() {
        return Some("Before it was snapped".to_owned());
    }
    if has_proposal(panel) {
        let drawn = panel.app.shown_values().camera.is_some();
        let text = if drawn {
            "The estimated base, not applied yet"
        } else {
            "No points here to draw the estimated base with"
        };
        return Some(text.to_owned());
    }
    if frame.status == FrameStatus::Rejected {
        // A document may reject a frame without a reason.
        let reason = frame
            .reason
            .map(|reason| format!(": {}", reason_label(reason)))
            .unwrap_or_default();
        let key = keys.with_key(Command::Reject, |key| format!(" {key} removes the mark."));
        return Some(format!("Not calibratable{reason}.{key}"));
    }
    if session.mode != Mode::Idle {
        return None;
    }
    match session.picture.tool {
        Tool::Select => {
            Some("Drag points or the picture; nothing is placed. Esc when done.".to_owned())
        }
        Tool::Line => Some("Every click is a point on a line. Esc when done.".to_owned()),
        Tool::Check => Some("Every click is a check point. Esc when done.".to_owned()),
        Tool::Point | Tool::Mask => session.points.next_on_line.then(|| {
            let key = keys.with_key(Command::PlaceOnLine, |key| format!(" {key} changes that."));
            format!("The next click is a point on a line.{key}")
        }),
    }
}

/// Whether an estimated base is shown that is not applied yet.
fn has_proposal(panel: &Panel<'_>) -> bool {
    panel.app.current().proposal.is_some()
}

/// Draws a pulsing ring around each point without a name.
fn pulse(panel: &Panel<'_>, ui: &egui::Ui, placement: &Placement, painter: &Painter) {
    if panel.app.session.picture.held.hide_overlay {
        return;
    }
    let clicks = panel
        .app
        .frame()
        .map(|frame| frame.clicks.as_slice())
        .unwrap_or_default();
    for (index, click) in clicks
        .iter()
        .enumerate()
        .filter(|(index, _)| waits_for_name(panel.app, *index))
    {
        // Neighbouring points pulse out of phase.
        let phase = (ui.input(|input| input.time) * 2.5 + index as f64).sin() as f32;
        let ring = colour(UNNAMED).gamma_multiply(0.55 + 0.25 * phase);
        let radius = 15.0 + 1.5 * phase;
        painter.circle_stroke(
            placement.screen_from_image(click.image),
            radius,
            Stroke::new(1.5, ring),
        );
        ui.ctx().request_repaint_after_secs(0.05);
    }
}

/// Draws the name of the point that was just placed or named, or of the landmark that the next
/// click places.
fn names(panel: &Panel<'_>, ui: &egui::Ui, placement: &Placement, painter: &Painter) {
    let session = &panel.app.session;
    just_snapped(panel, ui, placement, painter);
    // In every mode: after the next press a point of the same index counts anew.
    let named = session.points.named_automatically;
    let is_recent = recently(ui, "named automatically", named);
    let (click, hint) = match &session.mode {
        Mode::Dragging {
            click,
            placed: true,
        } => (*click, String::new()),
        // Idle: the point that was named automatically, for a few seconds, or for as long as its
        // name can be typed over.
        Mode::Idle => {
            let names = typing::names_placed(ui.ctx());
            let Some(click) = named.filter(|_| is_recent || names) else {
                return;
            };
            let hint = if names {
                "type to change it, Enter keeps it".to_owned()
            } else {
                let keys = &panel.app.settings.keys;
                keys.with_key(Command::RenameClick, |key| format!("{key} changes it"))
            };
            (click, hint)
        }
        Mode::Placing(target) => {
            let pointer = ui
                .input(|input| input.pointer.hover_pos())
                .filter(|at| placement.rect.contains(*at));
            if let Some(at) = pointer {
                let text = format!("{}: click it", panel.app.label(target));
                beside(painter, placement.rect, at, &text, "");
            }
            return;
        }
        _ => return,
    };
    // The name beside the click.
    let Some(click) = panel.app.frame().and_then(|frame| frame.clicks.get(click)) else {
        return;
    };
    if let Some(target) = &click.target {
        let at = placement.screen_from_image(click.image);
        beside(painter, placement.rect, at, &panel.app.label(target), &hint);
    }
}

/// Draws a note above each point that was just aligned to the paint.
fn just_snapped(panel: &Panel<'_>, ui: &egui::Ui, placement: &Placement, painter: &Painter) {
    let session = &panel.app.session;
    let clicks = panel
        .app
        .frame()
        .map(|frame| frame.clicks.as_slice())
        .unwrap_or_default();
    // Points may be aligned in one batch; the time counts from the latest.
    let newest = session.points.just_snapped.last().copied();
    if !recently(ui, "just snapped", newest) {
        return;
    }
    for click in session
        .points
        .just_snapped
        .iter()
        .filter_map(|click| clicks.get(*click))
    {
        let at = placement.screen_from_image(click.image) + vec2(0.0, -26.0);
        let style = PlateStyle::new(
            FontId::proportional(theme::SMALL),
            theme::ON_PICTURE.text,
            PLATE,
        );
        plate(painter, at, Align2::CENTER_CENTER, "snapped", style);
    }
}

/// Draws a name and a weaker hint beside `at`: below and to the right, or on the other side at the
/// right or lower border of `bounds`.
pub fn beside(painter: &Painter, bounds: Rect, at: Pos2, name: &str, hint: &str) {
    let [name_font, hint_font] = [theme::BODY, theme::SMALL].map(FontId::proportional);
    let width = text_width(painter, name, name_font.clone()).max(text_width(
        painter,
        hint,
        hint_font.clone(),
    ));
    let fits = at.x + TEXT_OFFSET.x + width + BORDER < bounds.right();
    let (side, align) = if fits {
        (1.0, Align2::LEFT_CENTER)
    } else {
        (-1.0, Align2::RIGHT_CENTER)
    };
    let down = if at.y + TEXT_OFFSET.y + 40.0 < bounds.bottom() {
        1.0
    } else {
        -1.0
    };
    let first = at + vec2(side * TEXT_OFFSET.x, down * TEXT_OFFSET.y);
    // The hint comes after the name, away from the point.
    let written = plate(
        painter,
        first,
        align,
        name,
        PlateStyle::new(name_font, colour(CLICK), PLATE),
    );
    if !hint.is_empty() {
        let second = first + vec2(0.0, down * written.height());
        plate(
            painter,
            second,
            align,
            hint,
            PlateStyle::new(hint_font, theme::ON_PICTURE.text, PLATE),
        );
    }
}

/// Whether `click` became the subject of `done` less than [`NAME_SHOWN_S`] ago.
///
/// `done` is the key under which click and time are remembered. Requests a repaint for the moment
/// when the time is over.
fn recently(ui: &egui::Ui, done: &str, click: Option<usize>) -> bool {
    let now = ui.input(|input| input.time);
    // The time is measured here, because the state of the application does not depend on the clock
    // of the window.
    let id = super::id().with(done);
    let (known, since) = ui.data_mut(|data| {
        let seen = data.get_temp_mut_or_insert_with(id, || (click, now));
        if seen.0 != click {
            *seen = (click, now);
        }
        *seen
    });
    let left = NAME_SHOWN_S - (now - since);
    if left > 0.0 {
        ui.ctx().request_repaint_after_secs(left as f32);
    }
    known.is_some() && left > 0.0
}

/// Shows in place of the picture why there is none.
pub fn show_failure(painter: &Painter, rect: Rect, reason: &str) {
    // A title and the reason, wrapped, in the middle of the picture's place.
    let wrap = (rect.width() - 80.0).clamp(120.0, 560.0);
    let lay_out = |text: &str, size, colour| {
        painter.layout(text.to_owned(), FontId::proportional(size), colour, wrap)
    };
    let title = lay_out(
        "This picture cannot be shown",
        theme::TITLE,
        theme::ON_PICTURE.strong,
    );
    let text = lay_out(reason, theme::BODY, theme::ON_PICTURE.text);
    let height = title.size().y + 8.0 + text.size().y;
    let top = (rect.center() - vec2(text.size().x.max(title.size().x) / 2.0, height / 2.0)).round();
    let below = top + vec2(0.0, title.size().y + 8.0);
    painter.galley(top, title, Color32::WHITE);
    painter.galley(below, text, Color32::WHITE);
}

/// Says that a project has no frames.
pub fn no_frames(painter: &Painter, rect: Rect) {
    let text = "This project has no frames.";
    painter.text(
        rect.center(),
        Align2::CENTER_CENTER,
        text,
        FontId::proportional(theme::BODY),
        theme::ON_PICTURE.weak,
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::{Pictures, open_with_click};
    use std::sync::Arc;
    use touchline_application::app::App;
    use touchline_application::app::session::PictureView;
    use touchline_core::geometry::{ImagePoint, ImageSize};

    /// Whether any text is drawn at a time, s.
    fn says_something(app: &App, ctx: &egui::Context, time_s: f64) -> bool {
        let input = egui::RawInput {
            time: Some(time_s),
            ..egui::RawInput::default()
        };
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 720.0));
        let size = ImageSize::new(1280, 720);
        let placement = Placement::new(rect, 1.0, size, PictureView::Fit);
        let mut pictures = Pictures::start(Arc::new(|| ())).unwrap();
        let panel = Panel {
            app,
            pictures: &mut pictures,
            actions: &mut Vec::new(),
            adapter: "",
        };
        let mut output = ctx.run_ui(input, |ui| names(&panel, ui, &placement, ui.painter()));
        output.textures_delta.clear();
        let mut shapes = output.shapes.iter().map(|clipped| &clipped.shape);
        shapes.any(|shape| matches!(shape, egui::Shape::Text(_)))
    }

    #[test]
    fn a_point_that_is_snapped_again_says_so_again() {
        let ctx = egui::Context::default();
        let mut app = open_with_click(ImagePoint::new(400.0, 300.0));
        app.session.points.just_snapped = vec![0];
        assert!(says_something(&app, &ctx, 1.0));
        assert!(!says_something(&app, &ctx, 9.0));
        // The next press clears the mark.
        app.session.points.just_snapped.clear();
        app.session.mode = Mode::Dragging {
            click: 0,
            placed: false,
        };
        assert!(!says_something(&app, &ctx, 20.0));
        app.session.points.just_snapped = vec![0];
        app.session.mode = Mode::Idle;
        assert!(says_something(&app, &ctx, 21.0));
    }
}
