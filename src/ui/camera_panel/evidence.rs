//! The evidence for an estimated base: lens models, frames, landmarks, and clicks that disagree. A
//! click on a row shows the frame.
//!
//! Distances are px of the picture between a click and where the estimated base, with the frame's
//! own pan, tilt and focal length, projects its landmark.

use super::{position_view, remark, section};
use crate::ui::Panel;
use crate::ui::controls::bar::Bar;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{show_button, show_folded};
use crate::ui::controls::{symbol, theme};
use crate::ui::rows::menu::file_name;
use egui::{Button, Grid, Rect, RichText, Ui, pos2};
use touchline_application::app::EditAction;
use touchline_calibration::calibrate::EstimatedBase;
use touchline_core::field::Symmetry;
use touchline_core::geometry::pluralise;
use touchline_core::solve::base::{DisputedClick, MirroredFrame};
use touchline_documents::document::{Camera, CameraId, Frame, Target};

/// Number of frames that are shown before the list is expanded.
const FRAMES_SHOWN: usize = 12;
/// Maximum number of landmarks in the list.
const LANDMARKS_SHOWN: usize = 12;
/// Errors above this multiple of the median of all points are emphasised.
const LOUD: f64 = 3.0;

/// Shows the evidence of an estimate; what the user should correct comes first.
///
/// The estimate keeps the positions that frames and clicks had when it began. A frame that the
/// document lacks is passed over.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, found: &EstimatedBase) {
    disagreements(panel, ui, found);
    position_view::show(panel, ui, found);
    models(ui, found);
    frames(panel, ui, found);
    landmarks(panel, ui, found);
}

/// Shows the models that were compared, each with its cross-validated error, and why one was
/// chosen.
fn models(ui: &mut Ui, found: &EstimatedBase) {
    section(ui, "LENS MODELS, CROSS-VALIDATED");
    Grid::new("models").num_columns(3).spacing([8.0, 2.0]).show(ui, |ui| {
        for head in ["", "median", "90 %"] {
            theme::small_weak(ui, head);
        }
        ui.end_row();
        for score in &found.estimate.scores {
            let chosen = score.model == found.estimate.model;
            let colour = if chosen { ui.palette().strong } else { ui.palette().weak };
            let mark = if chosen { "•" } else { "  " };
            let tip = "The error of each model on points that it was not fitted to. The marked model was chosen.";
            let name = RichText::new(format!("{mark} {}", score.model)).small().color(colour);
            ui.label(name).on_hover_text(tip);
            // Infinite where nothing could be held out.
            for px in [score.median_px, score.p90_px] {
                let says = if px.is_finite() { format!("{px:.2} px") } else { "–".to_owned() };
                ui.label(RichText::new(says).small().color(colour));
            }
            ui.end_row();
        }
    });
    // Why the model was chosen, and which frame would make the choice more certain.
    let advice = found
        .estimate
        .one_more_frame
        .map_or_else(String::new, |frame| format!(" To pin it down: {frame}."));
    let reason = format!("Chosen: {}.{advice}", found.estimate.reason);
    theme::small_weak_text(ui, reason);
}

/// Shows each frame's median error as a bar, the worst first. A frame without a fit comes before
/// them all.
fn frames(panel: &mut Panel<'_>, ui: &mut Ui, found: &EstimatedBase) {
    section(ui, "FRAMES, MEDIAN");
    let mut fits: Vec<(usize, Option<f64>)> = found
        .frames
        .iter()
        .zip(&found.estimate.frames)
        .map(|(&index, fit)| (index, fit.map(|fit| fit.median_px)))
        .collect();
    fits.sort_by(|a, b| {
        b.1.unwrap_or(f64::INFINITY)
            .total_cmp(&a.1.unwrap_or(f64::INFINITY))
    });
    show_left_out_frames(panel, ui, &found.camera);
    list(panel, ui, &fits, LOUD * found.estimate.median_px);
}

/// Shows the frames that an estimate would use, with the errors of their present solutions.
pub fn frames_of_document(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let Some(open) = panel.app.open() else { return };
    let frames: Vec<(usize, Option<f64>)> = open
        .document
        .frames
        .iter()
        .enumerate()
        .filter(|(_, frame)| takes_part(frame, &camera.id))
        .map(|(index, frame)| {
            let solution = frame.solution.as_ref();
            (index, solution.and_then(|solution| solution.rms_px))
        })
        .collect();
    // In the order of the document and without emphasis: each error is that of the frame's own
    // solve, and there is no common fit to compare it with.
    if !frames.is_empty() {
        section(ui, "FRAMES, RMS");
        list(panel, ui, &frames, f64::INFINITY);
    }
    show_left_out_frames(panel, ui, &camera.id);
}

/// Whether an estimate of a camera would use a frame.
fn takes_part(frame: &Frame, camera: &CameraId) -> bool {
    frame.camera == *camera
        && frame.is_used_for_base()
        && frame.clicks.iter().any(|click| click.target.is_some())
}

/// A list of frames without gaps. Errors above `loud_px` are emphasised.
fn list(panel: &mut Panel<'_>, ui: &mut Ui, frames: &[(usize, Option<f64>)], loud_px: f64) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        rows_of_frames(panel, ui, frames, loud_px);
    });
}

/// One row for each frame: name, error as a bar, and a button that leaves the frame out.
fn rows_of_frames(
    panel: &mut Panel<'_>,
    ui: &mut Ui,
    frames: &[(usize, Option<f64>)],
    loud_px: f64,
) {
    // The scale of the bars is that of all frames, so that it stays when the list is expanded.
    let largest = frames.iter().filter_map(|(_, px)| *px).fold(1e-9, f64::max);
    let all = format!("All {} frames", frames.len());
    let lengths = (frames.len(), FRAMES_SHOWN);
    show_folded(ui, "all frames of the camera", lengths, &all, |ui, at| {
        let (index, px) = frames[at];
        let Some(frame) = panel.app.open().and_then(|open| open.frame(index)) else {
            return;
        };
        let name = short_name(frame);
        let landmarks = frame.landmark_clicks();
        let points = pluralise(landmarks, "pt");
        let value = px.map_or(points, |px| format!("{px:.1} px"));
        let bar = Bar {
            name: &name,
            value: &value,
            share: px.map_or(0.0, |px| px / largest),
            colour: px
                .is_some_and(|px| px > loud_px)
                .then_some(ui.palette().caution),
            selected: index == panel.app.session.frame,
            tail: theme::SYMBOL.x,
            ..Bar::default()
        };
        let (rect, response) = bar.show(ui);
        let response = response.on_hover_text(format!(
            "{}: {}. Click to go there.",
            frame.name(),
            pluralise(landmarks, "landmark")
        ));
        if response.clicked() {
            panel.go_to(index);
        }
        // The button is a widget of its own on top of the row. It comes after the row, because egui
        // gives a click to the widget that was added last.
        let place = Rect::from_min_max(pos2(rect.right() - theme::SYMBOL.x, rect.top()), rect.max);
        ui.scope_builder(egui::UiBuilder::new().max_rect(place), |ui| {
            let palette = ui.palette();
            let leave = symbol::button(
                ui,
                Symbol::Cross,
                &format!("Leave {name} out"),
                palette.weak,
            );
            if leave
                .on_hover_text("Leave this frame out of the estimation.")
                .clicked()
            {
                panel.edit(EditAction::UseForBase {
                    frame: index,
                    used: false,
                });
            }
        });
    });
}

/// Shows the frames that are left out, each with a button that puts it back.
fn show_left_out_frames(panel: &mut Panel<'_>, ui: &mut Ui, camera: &CameraId) {
    let Some(open) = panel.app.open() else { return };
    let frames = open.document.frames.iter().enumerate();
    let out: Vec<(usize, String)> = frames
        .filter(|(_, frame)| frame.camera == *camera && !frame.use_for_base)
        .map(|(index, frame)| (index, short_name(frame)))
        .collect();
    for (index, name) in out {
        ui.horizontal(|ui| {
            if ui
                .add(Button::new(RichText::new(&name).color(ui.palette().weak)).frame(false))
                .clicked()
            {
                panel.go_to(index);
            }
            theme::small_weak(ui, "left out");
            if show_button(
                ui,
                Button::new("Put back").small(),
                "Use this frame in the estimation again.",
            ) {
                panel.edit(EditAction::UseForBase {
                    frame: index,
                    used: true,
                });
            }
        });
    }
}

/// Shows each landmark's median error as a bar, the worst first.
fn landmarks(panel: &mut Panel<'_>, ui: &mut Ui, found: &EstimatedBase) {
    section(ui, "LANDMARKS, MEDIAN");
    // A scope, so that the spacing of rows ends with the list.
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        rows_of_landmarks(panel, ui, found);
    });
}

/// One row for each landmark; a click selects its worst click.
fn rows_of_landmarks(panel: &mut Panel<'_>, ui: &mut Ui, found: &EstimatedBase) {
    let largest = found
        .landmarks
        .iter()
        .map(|fit| fit.median_px)
        .fold(1e-9, f64::max);
    for fit in found.landmarks.iter().take(LANDMARKS_SHOWN) {
        let name = panel.app.label(&Target::Landmark(fit.id.clone()));
        let value = format!("{:.1} px", fit.median_px);
        let loud = fit.median_px > LOUD * found.estimate.median_px;
        let bar = Bar {
            name: &name,
            value: &value,
            share: fit.median_px / largest,
            colour: loud.then_some(ui.palette().caution),
            ..Bar::default()
        };
        let (_, response) = bar.show(ui);
        let tip = format!(
            "{name}: {}, the worst {:.1} px off. Click to go there.",
            pluralise(fit.clicks, "point"),
            fit.worst_px
        );
        if response.on_hover_text(tip).clicked() {
            panel.go_to_click(fit.worst.0, fit.worst.1);
        }
    }
    // The estimate sorts the landmarks, the worst first.
    let more = found.landmarks.len().saturating_sub(LANDMARKS_SHOWN);
    if more > 0 {
        theme::small_weak(ui, format!("{more} more, all with smaller errors"));
    }
}

/// Shows frames that look mirrored and clicks that contradict the others, each with its remedy.
fn disagreements(panel: &mut Panel<'_>, ui: &mut Ui, found: &EstimatedBase) {
    // Only what is left to decide: the estimate itself stays as it was computed.
    let open: Vec<&DisputedClick> = found
        .estimate
        .disputed
        .iter()
        .filter(|disputed| is_unsettled(panel, disputed))
        .collect();
    if open.is_empty() && found.estimate.mirrored.is_empty() {
        return;
    }
    section(
        ui,
        &format!("DISAGREE  {}", open.len() + found.estimate.mirrored.len()),
    );
    for mirrored in &found.estimate.mirrored {
        show_mirrored_frame(panel, ui, mirrored);
    }
    for disputed in open {
        show_disputed_click(panel, ui, disputed);
    }
}

/// Whether a disputed click still has its name and still counts, so that the user has something to
/// decide.
fn is_unsettled(panel: &Panel<'_>, disputed: &DisputedClick) -> bool {
    let click = panel
        .app
        .open()
        .and_then(|open| open.frame(disputed.frame)?.clicks.get(disputed.click));
    let better = disputed
        .fits_better
        .as_ref()
        .map(|(id, _)| Target::Landmark(id.clone()));
    // The user settles a dispute by making the click a check point, removing its name, or giving it
    // the better name. A click that was deleted is settled, too.
    click.is_some_and(|click| {
        !click.check && click.target.is_some() && (better.is_none() || click.target != better)
    })
}

/// A frame that fits much better if all its names are mirrored, and the button that mirrors them.
fn show_mirrored_frame(panel: &mut Panel<'_>, ui: &mut Ui, mirrored: &MirroredFrame) {
    let Some(name) = panel
        .app
        .open()
        .and_then(|open| open.frame(mirrored.frame))
        .map(short_name)
    else {
        return;
    };
    // World x runs along the field to the right of the main camera, y away from it.
    let (sides, tip) = match mirrored.symmetry {
        Symmetry::MirrorX => (
            "left and right",
            "Swap left and right in every name of this frame.",
        ),
        Symmetry::MirrorY => (
            "near and far",
            "Swap near and far in every name of this frame.",
        ),
        Symmetry::Turn180 => (
            "both sides",
            "Replace every name of this frame with that of the opposite corner.",
        ),
    };
    // Infinite without a camera.
    let named = match mirrored.median_px {
        px if px.is_finite() => format!("{px:.0} px as named"),
        _ => "no camera as named".to_owned(),
    };
    let text = format!(
        "{name} looks mirrored ({sides}): {named}, {:.1} px mirrored.",
        mirrored.median_mirrored_px
    );
    remark(ui, &text, |ui| {
        if ui.add(Button::new("Go there").small()).clicked() {
            panel.go_to(mirrored.frame);
        }
        if show_button(ui, Button::new(format!("Mirror {sides}")).small(), tip) {
            panel.edit(EditAction::MirrorNames {
                frame: mirrored.frame,
                symmetry: mirrored.symmetry,
            });
        }
    });
    ui.add_space(theme::SPACE);
}

/// A click that contradicts the others, and the name that would fit better, if there is one.
fn show_disputed_click(panel: &mut Panel<'_>, ui: &mut Ui, disputed: &DisputedClick) {
    let Some(frame) = panel.app.open().and_then(|open| open.frame(disputed.frame)) else {
        return;
    };
    let target = frame
        .clicks
        .get(disputed.click)
        .and_then(|click| click.target.clone());
    let what = target
        .map(|target| panel.app.label(&target))
        .unwrap_or_default();
    let off = disputed
        .error_px
        .map_or_else(|| "out of view".to_owned(), |px| format!("{px:.0} px off"));
    let better = disputed
        .fits_better
        .as_ref()
        .map(|(id, px)| (Target::Landmark(id.clone()), *px));
    let hint = better
        .as_ref()
        .map(|(target, px)| format!(" “{}” would fit to {px:.1} px.", panel.app.label(target)))
        .unwrap_or_default();
    let text = format!(
        "Point {} of {}, {what}: {off}.{hint}",
        disputed.click + 1,
        short_name(frame)
    );
    remark(ui, &text, |ui| {
        let goes = ui.add(Button::new("Go there").small()).clicked();
        let renames = better.is_some()
            && show_button(
                ui,
                Button::new("Rename").small(),
                "Rename this point to the name that fits.",
            );
        if goes || renames {
            panel.go_to_click(disputed.frame, disputed.click);
        }
        // The application changes a name in the shown frame, so the frame is shown first.
        if let Some((target, _)) = better.filter(|_| renames) {
            panel.edit(EditAction::Name {
                click: disputed.click,
                target,
            });
        }
    });
    ui.add_space(theme::SPACE);
}

/// The name of a frame in lists: the last part of its path.
fn short_name(frame: &Frame) -> String {
    file_name(&frame.name())
}
