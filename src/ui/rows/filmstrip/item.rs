//! One frame of the filmstrip: thumbnail, status and marks.

use super::super::menu::{self, file_name};
use super::strip::SHOT_GAP;
use crate::ui::Panel;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{symbol, theme};
use crate::ui::drawing::pictures::WHOLE;
use egui::{
    Align2, Color32, CornerRadius, FontId, Id, Rect, RectAlign, Response, Role, Sense, Stroke,
    StrokeKind, Tooltip, Ui, WidgetInfo, pos2, vec2,
};
use touchline_application::app::review::percent;
use touchline_application::app::selection::Selecting;
use touchline_application::app::session::{reason_label, status_label};
use touchline_application::app::{
    Command, LineCheckSummary, Navigation, OpenProject, ViewAction, sentence,
};
use touchline_documents::document::{Frame, FrameStatus, Solution};

/// Height of the line below a thumbnail, points.
pub const CAPTION: f32 = 14.0;
/// Colour of the mark of a gold frame.
const GOLD: Color32 = Color32::from_rgb(255, 208, 70);
/// Height of the status bar, points.
pub const BAR: f32 = 4.0;

/// Draws a thin line before the first frame of a shot, with the shot's name.
pub fn separator(ui: &Ui, first: Rect, name: String) {
    let x = first.left() - SHOT_GAP + 4.0;
    let painter = ui.painter();
    painter.vline(x, first.y_range(), Stroke::new(1.0, ui.palette().line));
    let galley =
        painter.layout_no_wrap(name, FontId::proportional(theme::SMALL), ui.palette().weak);
    let at = pos2(x + 1.0, first.bottom() - CAPTION - BAR - 2.0);
    // Written upwards along the line, so that a long name needs no width.
    painter.add(
        egui::epaint::TextShape::new(at, galley, ui.palette().weak)
            .with_angle(-std::f32::consts::FRAC_PI_2),
    );
}

/// Shows a frame. A click shows it in the picture; with Ctrl or Shift a click selects frames.
pub fn show(panel: &mut Panel<'_>, ui: &Ui, index: usize, place: Rect) {
    let app = panel.app;
    let Some((open, frame)) = app.open().and_then(|open| Some((open, open.frame(index)?))) else {
        return;
    };
    let response = ui.interact(
        place,
        Id::unique(("filmstrip frame", index)),
        Sense::click(),
    );
    let current = index == app.session.frame;
    response.widget_info(|| {
        let selected = if app.session.frames_selected.contains(&index) {
            ", selected"
        } else {
            ""
        };
        let status = status_label(frame.status);
        let label = format!(
            "Frame {}, {}, {status}{selected}",
            frame.number_at(index),
            file_name(&frame.name())
        );
        WidgetInfo::selected(Role::Button, true, current, label)
    });
    paint(
        panel,
        ui,
        &Item {
            open,
            index,
            frame,
            place,
            hovered: response.hovered(),
        },
    );
    // As in file managers: Shift selects up to here, Ctrl this one as well.
    if response.clicked() {
        let modifiers = ui.input(|input| input.modifiers);
        let how = match (modifiers.shift, modifiers.command) {
            (true, _) => Some(Selecting::Range),
            (false, true) => Some(Selecting::Toggle),
            (false, false) => None,
        };
        if let Some(how) = how {
            let select = Navigation::SelectFrame { frame: index, how };
            panel.navigate(select);
        } else {
            panel.view(ViewAction::SelectNoFrames);
            panel.go_to(index);
        }
    }
    // The commands of the context menu act on the shown frame, so a right click shows this one. It
    // keeps the selection, on which some of them act.
    if response.secondary_clicked() {
        panel.go_to(index);
    }
    response.context_menu(|ui| context_menu(panel, ui));
    tooltip(&response, index, frame, app.paint_says(index));
}

/// The commands for the frame, or for all selected frames.
fn context_menu(panel: &mut Panel<'_>, ui: &mut Ui) {
    // Commands for all selected frames stand apart, under their number.
    let selected = panel.app.session.frames_selected.len();
    if selected > 1 {
        theme::strong(ui, format!("{selected} frames selected"));
        menu::entries(
            panel,
            ui,
            &[Command::AcceptStretch, Command::AssignToCamera],
        );
        ui.separator();
        theme::weak(ui, "This frame");
    }
    menu::entries(
        panel,
        ui,
        &[
            Command::AcceptAndStay,
            Command::Reject,
            Command::RejectShot,
            Command::Comment,
            Command::UseForTraining,
            Command::UseForBase,
            Command::MarkGold,
            Command::SelectShot,
        ],
    );
    if selected <= 1 {
        menu::entries(panel, ui, &[Command::AssignToCamera]);
    }
}

/// A frame of the open project and its place on the screen.
struct Item<'a> {
    open: &'a OpenProject,
    index: usize,
    frame: &'a Frame,
    place: Rect,
    hovered: bool,
}

/// Draws the frame. Marks are in the corners of the thumbnail:
///
/// * upper left: a comment;
/// * upper right: a warning;
/// * lower left: selected;
/// * lower right: the line check, and whether the frame is gold.
fn paint(panel: &mut Panel<'_>, ui: &Ui, item: &Item<'_>) {
    let &Item {
        open,
        index,
        frame,
        place,
        hovered,
    } = item;
    let painter = ui.painter();
    let (letter, colour) = (
        theme::status_letter(frame.status),
        ui.palette().status(frame.status),
    );
    let picture = Rect::from_min_max(
        place.min,
        pos2(place.right(), place.bottom() - CAPTION - BAR - 2.0),
    );
    // The thumbnail, darker for a rejected frame.
    painter.rect_filled(picture, CornerRadius::same(3), ui.palette().raised);
    if let Some(texture) = panel.pictures.thumbnail(open, index) {
        let shape = fit_within(texture.size_vec2(), picture);
        let rejected = frame.status == FrameStatus::Rejected;
        let tint = if rejected {
            Color32::from_gray(90)
        } else {
            Color32::WHITE
        };
        painter.image(texture.id(), shape, WHOLE, tint);
    } else if panel.pictures.has_no_thumbnail(open, index) {
        painter.text(
            picture.center(),
            Align2::CENTER_CENTER,
            "no picture",
            FontId::proportional(theme::SMALL),
            ui.palette().weak,
        );
    }
    // Below the thumbnail: the status bar, the number at the left, confidence and status letter at
    // the right.
    let bar = Rect::from_min_size(
        pos2(place.left(), picture.bottom() + 2.0),
        vec2(place.width(), BAR),
    );
    theme::paint_status_bar(painter, bar, frame.status, confidence(frame));
    let line = place.bottom() - CAPTION / 2.0;
    let small = FontId::proportional(theme::SMALL);
    let current = index == panel.app.session.frame;
    let number = if current {
        ui.palette().strong
    } else {
        ui.palette().weak
    };
    painter.text(
        pos2(place.left() + 1.0, line),
        Align2::LEFT_CENTER,
        frame.number_at(index),
        small.clone(),
        number,
    );
    let mark = match confidence(frame) {
        // Whole per cent, because a decimal would touch the next frame's number. At most 99 %: a
        // suggestion is never certain.
        Some(confidence) => format!("{:.0} % {}", (100.0 * confidence).round().min(99.0), letter),
        None => letter.to_string(),
    };
    painter.text(
        pos2(place.right() - 1.0, line),
        Align2::RIGHT_CENTER,
        mark,
        small,
        colour,
    );
    // The marks on the thumbnail.
    if frame
        .solution
        .as_ref()
        .is_some_and(|solution| solution.warnings_of_frame().next().is_some())
    {
        let corner =
            Rect::from_center_size(picture.right_top() + vec2(-9.0, 9.0), vec2(16.0, 16.0));
        symbol::paint(painter, Symbol::Warning, corner, theme::ON_PICTURE.caution);
    }
    if frame.comment.is_some() {
        let note = Rect::from_min_size(picture.left_top() + vec2(4.0, 4.0), vec2(10.0, 8.0));
        painter.rect_filled(note, CornerRadius::same(1), theme::ON_PICTURE.strong);
        for line in [2.5, 5.5] {
            painter.hline(
                note.left() + 2.0..=note.right() - 2.0,
                note.top() + line,
                Stroke::new(1.0, theme::ON_PICTURE.backdrop),
            );
        }
    }
    // The line check moves to the left where a gold mark takes the corner.
    if let Some(says) = panel.app.paint_says(index) {
        let mark = picture.right_bottom() + vec2(if frame.gold { -21.0 } else { -8.0 }, -8.0);
        theme::paint_line_mark(painter, mark, says.verdict);
    }
    if frame.gold {
        let mark = picture.right_bottom() + vec2(-7.0, -7.0);
        painter.circle_filled(mark, 5.0, theme::ON_PICTURE.backdrop);
        painter.circle_filled(mark, 3.5, GOLD);
    }
    if panel.app.session.frames_selected.contains(&index) {
        painter.rect_filled(
            picture,
            CornerRadius::same(3),
            theme::ON_PICTURE.accent.gamma_multiply(0.35),
        );
        let mark = picture.left_bottom() + vec2(9.0, -9.0);
        painter.circle_filled(mark, 6.0, theme::ON_PICTURE.accent);
        symbol::paint(
            painter,
            Symbol::Tick,
            Rect::from_center_size(mark, vec2(12.0, 12.0)),
            theme::ON_PICTURE.strong,
        );
    }
    // The border: the shown frame, or the one under the pointer.
    let frame_line = match (current, hovered) {
        (true, _) => Stroke::new(2.0, ui.palette().accent),
        (false, true) => Stroke::new(1.0, ui.palette().weak),
        (false, false) => return,
    };
    painter.rect_stroke(
        picture.expand(1.0),
        CornerRadius::same(4),
        frame_line,
        StrokeKind::Outside,
    );
}

/// The confidence of a suggestion; `None` for a frame of another status.
fn confidence(frame: &Frame) -> Option<f64> {
    let suggested = frame.status == FrameStatus::Suggested;
    frame.confidence().filter(|_| suggested)
}

/// The largest rectangle of a picture's shape in the middle of a box.
fn fit_within(size: egui::Vec2, within: Rect) -> Rect {
    let scale = (within.width() / size.x.max(1.0)).min(within.height() / size.y.max(1.0));
    Rect::from_center_size(within.center(), size * scale)
}

/// Describes a frame: name, number, status, confidence, line check, time, warnings, comment.
/// It stands above the frame: below it are the messages.
fn tooltip(response: &Response, index: usize, frame: &Frame, paint: Option<LineCheckSummary>) {
    let mut tooltip = Tooltip::for_enabled(response);
    tooltip.popup = tooltip.popup.align(RectAlign::TOP_START);
    tooltip.show(|ui| {
        theme::strong(ui, file_name(&frame.name()));
        let reason = frame
            .reason
            .map(|reason| format!(": {}", reason_label(reason).to_lowercase()));
        ui.label(format!(
            "Frame {} · {}: {}{}",
            frame.number_at(index),
            theme::status_letter(frame.status),
            status_label(frame.status),
            reason.unwrap_or_default()
        ));
        if let Some(confidence) = confidence(frame) {
            ui.label(format!("Confidence {}", percent(confidence)));
        }
        if let Some(says) = paint {
            ui.label(sentence(&says.describe()));
        }
        if let Some(time) = frame.video.as_ref().and_then(|video| video.pts_s) {
            theme::weak(ui, format!("{time:.3} s"));
        }
        for warning in frame.solution.iter().flat_map(Solution::warnings_of_frame) {
            ui.label(egui::RichText::new(&warning.message).color(ui.palette().caution));
        }
        if let Some(comment) = &frame.comment {
            ui.label(egui::RichText::new(format!("“{comment}”")).italics());
        }
    });
}
