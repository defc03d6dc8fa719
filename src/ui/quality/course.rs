//! Pan, tilt and focal length over time, with what stands around the plots: their buttons and
//! legend, the description of the frame under the pointer, and the frames that are out of line with
//! their neighbours. The plots themselves are in `course_plots.rs`.

use super::course_plots::CoursePlots;
use super::{card, legend};
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::rows::menu::file_name;
use egui::{Button, Label, RichText, Ui};
use touchline_application::app::quality::{Course, CoursePoint, PointKind, TimeAxis, within_whole};
use touchline_application::app::review::{DISAGREES_PX, percent};
use touchline_application::app::{Action, Command, ViewAction};
use touchline_core::geometry::Angle;
use touchline_documents::document::Frame;

/// Maximum number of frames that are named below the plots.
const NAMED: usize = 6;

/// The title of the card.
const TITLE: &str = "PAN, TILT, FOCAL LENGTH";
/// The text while no frame has a camera.
const NOTHING: &str = "Cameras are plotted here over time. Accept a few frames and let the forest propose cameras for the others.";

/// Shows the card: legend and buttons, the plots, the description of the frame under the pointer,
/// and the frames that are out of line.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    // A stored span may belong to an earlier state of the document, so it is limited to what there
    // is.
    let app = panel.app;
    let course = &app.quality().course;
    let Some(whole) = course.whole.filter(|_| !course.points.is_empty()) else {
        card(
            panel,
            ui,
            TITLE,
            |_, _| {},
            |_, ui| theme::weak_text(ui, NOTHING),
        );
        return;
    };
    let span = app
        .session
        .quality
        .span
        .and_then(|span| within_whole(span, whole))
        .unwrap_or(whole);
    card(
        panel,
        ui,
        TITLE,
        |panel, ui| beside(panel, ui, course, span != whole),
        |panel, ui| {
            let plots = CoursePlots::on_page(ui, course, span);
            let under = plots.show(panel, ui, course, whole);
            read_out(panel, ui, course, under);
            standing_out(panel, ui, course);
        },
    );
}

/// Height of one of the curves below the picture, points.
const CURVE: f32 = 32.0;
/// Height of the three with the numbers below them, points.
pub(super) const STRIP: f32 = 3.0 * (CURVE + 10.0) + 16.0;

/// Shows the curves alone, below the picture.
pub(super) fn strip(panel: &mut Panel<'_>, ui: &mut Ui) {
    let app = panel.app;
    let course = &app.quality().course;
    let Some(whole) = course.whole.filter(|_| !course.points.is_empty()) else {
        return theme::weak_text(ui, NOTHING);
    };
    let span = app.session.quality.span;
    let span = span
        .and_then(|span| within_whole(span, whole))
        .unwrap_or(whole);
    CoursePlots::new(ui, course, span, CURVE).show(panel, ui, course, whole);
}

/// Shows the zoom buttons, the choice of the time axis and the legend. The layout runs from right
/// to left, so the last button comes first.
fn beside(panel: &mut Panel<'_>, ui: &mut Ui, course: &Course, is_part: bool) {
    let actions = &mut *panel.actions;
    // The zoom buttons.
    let mut button = |ui: &mut Ui, says: &str, command: Command, enabled: bool, tip: &str| {
        let button = ui.add_enabled(enabled, Button::new(says).small());
        if button.on_hover_text(tip).clicked() {
            actions.push(Action::Command(command));
        }
    };
    button(
        ui,
        "All",
        Command::ZoomToFit,
        is_part,
        "Show the whole time axis.",
    );
    button(ui, "+", Command::ZoomIn, true, "Zoom into the time axis.");
    button(
        ui,
        "−",
        Command::ZoomOut,
        is_part,
        "Zoom out of the time axis.",
    );
    // The unit of time, if the frames have a time.
    if course.has_video_time {
        for (axis, says, tip) in [
            (TimeAxis::Video, "Video time", "Use the video's time."),
            (TimeAxis::Frame, "Frames", "Use frame numbers."),
        ] {
            if show_button(
                ui,
                Button::selectable(course.axis == axis, says).small(),
                tip,
            ) {
                actions.push(Action::View(ViewAction::SetTimeAxis(axis)));
            }
        }
    }
    // The legend, from left to right in the remaining space; drafts and outliers only if there are
    // any.
    ui.add_space(2.0 * theme::SPACE);
    ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.add_space(2.0 * theme::SPACE);
        for kind in [PointKind::Reference, PointKind::Suggested, PointKind::Draft] {
            let count = course.count(kind);
            if count > 0 {
                legend::entry(ui, &legend::describe_count(kind, count), |painter, at| {
                    legend::mark(painter, at, kind);
                });
            }
        }
        if !course.standing_out.is_empty() {
            legend::entry(
                ui,
                &format!("{} out of line with neighbours", course.standing_out.len()),
                legend::ring,
            );
        }
    });
}

/// Shows the description of the frame under the pointer; without one, how to use the plots.
fn read_out(panel: &Panel<'_>, ui: &mut Ui, course: &Course, under: Option<&CoursePoint>) {
    let Some((point, frame)) =
        under.and_then(|point| Some((point, panel.app.open()?.frame(point.frame)?)))
    else {
        let time = if course.axis == TimeAxis::Frame {
            "Frame number"
        } else {
            "Time of the video"
        };
        let text = format!(
            "{time} to the right. Click to go to the frame, drag its ringed point up or down to correct it, Ctrl and wheel or + and − to zoom, drag elsewhere to move."
        );
        theme::small_weak(ui, text);
        return;
    };
    let text = describe_point(point, frame, course.axis);
    let colour = if point.stands_out {
        ui.palette().bad
    } else {
        ui.palette().strong
    };
    ui.add(Label::new(RichText::new(text).small().color(colour)).truncate());
}

/// The description of a frame: name, number, shot, time, camera, confidence, and how far it is out
/// of line.
fn describe_point(point: &CoursePoint, frame: &Frame, axis: TimeAxis) -> String {
    let [pan_deg, tilt, focal] = point.values;
    let pan = Angle::from_degrees(pan_deg).wrap();
    let shot = frame
        .clip
        .as_ref()
        .map(|clip| format!(", shot {clip}"))
        .unwrap_or_default();
    let time = if axis == TimeAxis::Video {
        format!(", {:.2} s", point.at)
    } else {
        String::new()
    };
    let confidence = frame.confidence();
    // Parts that a frame may lack are empty.
    let right = confidence
        .map(|confidence| format!(", confidence {}", percent(confidence)))
        .unwrap_or_default();
    let apart = point.apart_px.filter(|px| *px >= 1.0);
    let apart = apart
        .map(|px| format!(", {px:.0} px out of line with its neighbours"))
        .unwrap_or_default();
    let (name, number) = (file_name(&frame.name()), frame.number_at(point.frame));
    format!(
        "{name}, frame {number}{shot}{time}: pan {pan:.2}, tilt {tilt:.2}°, focal length {focal:.0} px{right}{apart}"
    )
}

/// Names the frames that are out of line with their neighbours, the farthest first, each as a
/// button that shows it.
fn standing_out(panel: &mut Panel<'_>, ui: &mut Ui, course: &Course) {
    if course.standing_out.is_empty() {
        return;
    }
    let app = panel.app;
    // A few by name, each as a button, and the number of the others.
    let tip = format!(
        "Farther than {DISAGREES_PX:.0} px (at 1920 px width) off the line between the frames before and after, and farther off than these are apart."
    );
    ui.horizontal(|ui| {
        ui.label(
            RichText::new("Out of line with neighbours:")
                .small()
                .color(ui.palette().bad),
        )
        .on_hover_text(tip);
        for point in course
            .standing_out
            .iter()
            .take(NAMED)
            .map(|&place| &course.points[place])
        {
            let Some(frame) = app.open().and_then(|open| open.frame(point.frame)) else {
                continue;
            };
            let says = format!(
                "{} {:.0} px",
                file_name(&frame.name()),
                point.apart_px.unwrap_or(0.0)
            );
            if show_button(
                ui,
                Button::new(says).small(),
                format!("Look at frame {}.", frame.number_at(point.frame)),
            ) {
                panel.look_at(point.frame, None);
            }
        }
        let more = course.standing_out.len().saturating_sub(NAMED);
        if more > 0 {
            theme::small_weak(ui, format!("and {more} more"));
        }
    });
}
