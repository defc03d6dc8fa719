//! The verdict on the solution in one word, its main reason, and at most one remedy.
//!
//! Further warnings are only counted here; the details list them. Below the verdict stand the line
//! check and the switch for training.

use crate::ui::Panel;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{replace_remembered, show_button};
use crate::ui::controls::{symbol, theme};
use crate::ui::drawing::labels::lay_out_within;
use egui::{
    Align2, Button, Label, Rect, RichText, Role, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2,
    vec2,
};
use touchline_application::app::review::percent;
use touchline_application::app::selection::Scope;
use touchline_application::app::{
    Action, App, BESIDE_PX, CameraChoice, Command, EditAction, Navigation, SettingsAction, sentence,
};
use touchline_calibration::calibrate::CalibrationError;
use touchline_core::geometry::pluralise;
use touchline_core::solve::{SolveError, Verdict, Warning, WarningCode};
use touchline_documents::document::{Frame, FrameStatus, Target};

/// Minimum height of the verdict, points. With it the layout rarely changes from frame to frame.
pub const HEIGHT: f32 = 78.0;

/// Shows the verdict. The cases come in order of precedence: another picture, a verdict on the
/// solution, an error, a proposal, a frame without an answer, a camera without points, nothing.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let app = panel.app;
    ui.vertical(|ui| {
        ui.set_min_height(HEIGHT);
        ui.set_width(ui.available_width());
        let shown = app.shown_values();
        if let Some(says) = app.other_picture(app.session.frame) {
            other_picture(says, ui);
            return;
        }
        match (&shown.judgement, shown.solution) {
            (Some(judgement), _) => {
                let colour = ui.palette().verdict(judgement.verdict);
                ui.horizontal(|ui| {
                    // A good verdict needs no symbol.
                    if judgement.verdict != Verdict::Good {
                        symbol::show(ui, Symbol::Warning, colour);
                    }
                    let word = judgement.verdict.to_string();
                    ui.label(RichText::new(word).size(theme::TITLE).color(colour).strong()).on_hover_text(
                        "Good: no evidence against it. Check: look before you accept. Wrong: something contradicts it.",
                    );
                });
                theme::text(ui, sentence(&judgement.reason));
                if !shown.is_estimated {
                    ways_out(panel, ui, &judgement.reason);
                }
            }
            (None, Some(Err(error))) => theme::weak_text(ui, describe_error(error)),
            (None, None) if shown.is_estimated => {
                theme::weak_text(ui, "This frame has no points to check the estimated base with.");
            }
            (None, _) if app.frame().is_some_and(is_proposal) => proposal(panel.app, ui),
            (None, _) if app.frame().is_some_and(Frame::is_unanswered) => {
                let reason = app.frame().and_then(Frame::no_answer).unwrap_or("the forest does not recognise it");
                theme::weak_text(ui, format!("No proposal: {reason}."));
                search_lines(panel, ui);
            }
            (None, _) if app.frame().is_some_and(|frame| frame.ptz.is_some()) => {
                theme::weak_text(ui, "From the document. This frame has no points to check it with.");
            }
            (None, _) => {
                let none = "There is no verdict until there is a solution.";
                let says = app.awaited_answer().unwrap_or_else(|| none.to_owned());
                theme::weak_text(ui, says);
            }
        }
        if !shown.is_estimated {
            paint(app, ui);
            line_bars(app, ui);
        }
        training_switch(panel, ui);
    });
}

/// Says that the picture is not the one that was labelled. No verdict on the label would mean
/// anything.
fn other_picture(says: &str, ui: &mut Ui) {
    let palette = ui.palette();
    ui.horizontal(|ui| {
        symbol::show(ui, Symbol::Warning, palette.bad);
        ui.label(
            RichText::new("Another picture")
                .size(theme::TITLE)
                .color(palette.bad)
                .strong(),
        );
    });
    ui.add(Label::new(RichText::new(sentence(says)).color(palette.text)).wrap());
}

/// Whether the frame's camera is a proposal that the user has not changed.
fn is_proposal(frame: &Frame) -> bool {
    matches!(
        frame.status,
        FrameStatus::Suggested | FrameStatus::Reference
    ) && frame.is_suggestion()
}

/// Shows the confidence of a proposal, and whether it is accepted.
fn proposal(app: &App, ui: &mut Ui) {
    let Some(frame) = app.frame() else { return };
    let confidence = frame.confidence();
    let certain = confidence.map(|confidence| format!(", confidence {}", percent(confidence)));
    let accepted = frame.status == FrameStatus::Reference;
    let state = if accepted {
        "Accepted unchanged."
    } else {
        "Not reviewed yet."
    };
    let why = frame
        .why_unlikely()
        .map(|why| format!(" {}", sentence(why)))
        .unwrap_or_default();
    let certain = certain.unwrap_or_default();
    theme::weak_text(ui, format!("Proposed{certain}. {state}{why}"));
}

/// Shows the switch for using an accepted proposal for training.
fn training_switch(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(before) = panel
        .app
        .frame()
        .filter(|frame| frame.status == FrameStatus::Reference && frame.is_suggestion())
        .map(Frame::is_used_for_training)
    else {
        return;
    };
    let mut used = before;
    let switch = ui.checkbox(&mut used, "Use for training");
    switch.on_hover_text(
        "By default the forest is not trained with accepted proposals. Use them where no clicked reference looks.",
    );
    if used != before {
        panel.edit(EditAction::SetUseForTraining {
            frame: panel.app.session.frame,
            used,
        });
    }
}

/// Shows the result of the line check: whether the picture has paint where the camera predicts it.
fn paint(app: &App, ui: &mut Ui) {
    let Some(says) = app.paint_says(app.session.frame) else {
        return;
    };
    let text = sentence(&says.describe());
    ui.horizontal(|ui| {
        let (mark, _) = ui.allocate_exact_size(egui::Vec2::splat(12.0), egui::Sense::hover());
        theme::paint_line_mark(ui.painter(), mark.center(), says.verdict);
        let label = ui.add(Label::new(RichText::new(text).small().color(ui.palette().text)).wrap());
        label.on_hover_text(
            "The picture is searched for paint where the camera predicts painted lines.",
        );
    });
}

/// Height of the row of a line, and width of its name and of its number, points.
const LINE_ROW: f32 = 15.0;
const LINE_NAME: f32 = 118.0;
const LINE_NUMBER: f32 = 34.0;
/// Offset at the ends of the bars, px at 1920 px width.
const BARS_END_PX: f64 = 8.0;
/// Windows at least this high always show the bars; in lower ones they stand where a line lies
/// beside its paint, points.
const ROOMY: f32 = 860.0;

/// Shows how far the paint lies from each drawn line: bars with a sign, farthest line first.
fn line_bars(app: &App, ui: &mut Ui) {
    let frame = app.session.frame;
    let beside = app.line_beside_paint(frame);
    if beside.is_none() && ui.ctx().content_rect().height() < ROOMY {
        return;
    }
    let Some(size) = app.frame().map(|frame| frame.image_size) else {
        return;
    };
    let scale = size.scale_from_1920();
    let palette = ui.palette();
    for line in app.line_offsets(frame) {
        let (row, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), LINE_ROW), Sense::hover());
        let says = format!("{}: paint {:+.1} px", line.line, line.offset_px);
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &says));
        let painter = ui.painter_at(row);
        let font = TextStyle::Small.resolve(ui.style());
        let name = row.with_max_x(row.left() + LINE_NAME);
        let galley = lay_out_within(
            &painter,
            line.line.clone(),
            font.clone(),
            palette.text,
            LINE_NAME,
        );
        painter.galley(
            pos2(name.left(), row.center().y - galley.size().y / 2.0),
            galley,
            palette.text,
        );
        // The bar begins in the middle: to the right, the paint lies below the line.
        let bars = row
            .with_min_x(row.left() + LINE_NAME + theme::SPACE)
            .with_max_x(row.right() - LINE_NUMBER);
        let middle = bars.center().x;
        let reach = (line.offset_px / (BARS_END_PX * scale)).clamp(-1.0, 1.0) as f32;
        let end = middle + reach * bars.width() / 2.0;
        let bar = Rect::from_x_y_ranges(
            middle.min(end)..=middle.max(end),
            row.center().y - 3.0..=row.center().y + 3.0,
        );
        let is_beside = line.offset_px.abs() >= BESIDE_PX * scale;
        let colour = if is_beside {
            palette.caution
        } else {
            palette.accent
        };
        painter.rect_filled(bar, 1.0, colour);
        let axis = Stroke::new(1.0, palette.weak);
        painter.vline(middle, row.y_range(), axis);
        painter.text(
            row.right_center(),
            Align2::RIGHT_CENTER,
            format!("{:+.1}", line.offset_px),
            font,
            if is_beside {
                palette.caution
            } else {
                palette.text
            },
        );
        response.on_hover_text(format!(
            "{says}, at {}. Nine in ten lie nearer; plus: the paint lies below the drawn line, or \
             to its right.",
            pluralise(line.places, "place")
        ));
    }
}

/// Shows the button that searches the painted lines for a camera, if that is possible.
fn search_lines(panel: &mut Panel<'_>, ui: &mut Ui) {
    let command = Command::SearchLines;
    if panel.app.why_not(command).is_none() {
        panel.run_on_click(ui.button(command.name()), command);
    }
}

/// Describes an error. The frequent ones name the next step.
fn describe_error(error: &CalibrationError) -> String {
    match error {
        // Three unknowns: one named point gives two equations, so one more is missing.
        CalibrationError::Solve(SolveError::TooFewObservations { equations: 2 }) => {
            "One more point is needed.".to_owned()
        }
        CalibrationError::Solve(SolveError::TooFewObservations { .. }) => {
            "Two points are needed.".to_owned()
        }
        error => sentence(&error.to_string()),
    }
}

/// Shows the remedy for the warning that is the verdict's reason, and how many more warnings there
/// are.
///
/// The first that applies: assign the frame to a camera that fits better, a command that mends the
/// cause, an action from [`way_out`].
fn ways_out(panel: &mut Panel<'_>, ui: &mut Ui, reason: &str) {
    let more = hidden(panel.app, reason);
    let mend = panel.app.mend();
    let better = panel.app.current().better_camera.as_ref();
    // The last resort, an action for the dominant warning, applies only without the other two.
    let way = panel
        .app
        .cause()
        .filter(|cause| mend.is_none() && better.is_none() && cause.message == reason)
        .and_then(|cause| way_out(panel.app, cause));
    if more == 0 && mend.is_none() && better.is_none() && way.is_none() {
        return;
    }
    ui.horizontal(|ui| {
        if let Some(better) = better {
            let says = format!("Assign to {}", better.camera);
            if show_button(
                ui,
                Button::new(says).truncate(),
                "This frame fits that camera better.",
            ) {
                let camera = CameraChoice::Known(better.camera.clone());
                panel.edit(EditAction::AssignToCamera {
                    scope: Scope::Frame,
                    camera,
                });
            }
        } else if let Some((command, word)) = mend {
            panel.run_on_click(ui.button(word), command);
            compare(panel, ui);
        } else if let Some(way) = way
            && show_button(ui, Button::new(way.word), way.about)
        {
            panel.actions.extend(way.actions);
        }
        if more > 0 {
            let rest =
                Button::new(RichText::new(format!("{more} more")).color(ui.palette().caution))
                    .frame(false);
            if show_button(ui, rest, "Show all warnings in the details.") {
                panel.set(SettingsAction::Details(true));
            }
        }
    });
}

/// A remedy: the word on its button, the tooltip, and what it does.
struct WayOut {
    word: &'static str,
    about: String,
    actions: Vec<Action>,
}

/// The remedy for the dominant warning: labels for an uncertain base, the next point where it
/// reduces the uncertainty most, or the point that contradicts the others.
fn way_out(app: &App, cause: &Warning) -> Option<WayOut> {
    // Only warnings that a single action answers; a contradiction is one if it comes down to one
    // point.
    match (cause.code, cause.clicks.as_slice()) {
        (WarningCode::BaseUncertain, _) => Some(WayOut {
            word: "Show which",
            about: app.settings.keys.tooltip(Command::ShowForBase),
            actions: vec![Action::Command(Command::ShowForBase)],
        }),
        (WarningCode::Separation | WarningCode::Extrapolation, _) => {
            let next = app.current().next_clicks.first()?;
            let target = Target::Landmark(next.id.clone());
            let about = format!(
                "{}: {}. Then click it in the picture.",
                app.label(&target),
                next.gain()
            );
            Some(WayOut {
                word: "Next point",
                about,
                actions: vec![Action::Edit(EditAction::Pick(target))],
            })
        }
        (WarningCode::Contradiction, [click]) => Some(WayOut {
            word: "Show point",
            about: format!("Select point {} and zoom in on it.", click + 1),
            actions: vec![
                Action::Navigate(Navigation::Select(Some(*click))),
                Action::Command(Command::ZoomToClick),
            ],
        }),
        _ => None,
    }
}

/// A button that shows the other solution while it is pressed, like its key.
fn compare(panel: &mut Panel<'_>, ui: &mut Ui) {
    let response = ui
        .button("Compare")
        .on_hover_text(panel.app.settings.keys.tooltip(Command::Compare));
    let pressed = egui::Id::unique("compare is pressed");
    // Only changes are reported, as for a key that goes down and up.
    let down = response.is_pointer_button_down_on();
    if down != replace_remembered(ui, pressed, down).unwrap_or(false) {
        panel.act(Action::Hold(Command::Compare, down));
    }
}

/// The number of warnings besides the one that is the verdict's reason.
fn hidden(app: &App, reason: &str) -> usize {
    let warnings = app
        .current()
        .click_solution()
        .map_or(&[][..], |solved| &solved.warnings);
    warnings
        .iter()
        .filter(|warning| warning.message != reason)
        .count()
}
