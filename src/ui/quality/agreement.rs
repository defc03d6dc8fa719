//! Two annotators on the same frames: how far apart their clicks are, which points they name
//! differently, and how much their cameras differ.
//!
//! Distances are px at 1920 px width.

use super::card;
use super::scatter::Scatter;
use crate::ui::Panel;
use crate::ui::controls::bar::Bar;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::rows::menu::file_name;
use egui::{Button, Label, RichText, Ui, vec2};
use std::fmt::Write as _;
use std::sync::Arc;
use touchline_application::app::operations::ComparisonResult;
use touchline_application::app::{Action, App, Command};
use touchline_calibration::evaluate::{Agreement, ClickPair, FrameAgreement, NameDispute};
use touchline_core::geometry::pluralise;
use touchline_documents::document::Target;

/// Maximum number of rows in a list.
const SHOWN: usize = 9;
/// Bars end at this multiple of the median, so that one outlier does not flatten all others.
const BAR_LIMIT: f64 = 4.0;
/// Width of a column, points.
const COLUMN: f32 = 330.0;

/// The text before a comparison.
const NOTHING: &str = "Choose another annotator's document of the same frames to see distances by landmark, points that were \
                       named differently, how the cameras differ, and the click noise.";

/// Shows the card: a scatter plot of offsets on the left, distances by landmark in the middle,
/// names and frames that differ on the right.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let (is_running, made) = (
        panel.app.operations.comparison.is_running(),
        panel.app.operations.comparison.last_result().cloned(),
    );
    card(
        panel,
        ui,
        "TWO ANNOTATORS",
        |panel, ui| beside(panel, ui, made.as_ref()),
        |panel, ui| match &made {
            Some(compared) => show_agreement(panel, ui, &compared.agreement),
            None if is_running => theme::weak_text(ui, "Comparing…"),
            None => theme::weak_text(ui, NOTHING),
        },
    );
}

/// Shows the button that chooses the other document, and with which document the result was
/// computed. If this document has changed since, a second button compares again.
fn beside(panel: &mut Panel<'_>, ui: &mut Ui, compared: Option<&Arc<ComparisonResult>>) {
    // The layout runs from right to left, so the button at the end comes first.
    let choose = Button::new("Compare with…").small();
    panel.command_button(ui, choose, Command::CompareAnnotators);
    let Some(compared) = compared else { return };
    let stale = panel
        .app
        .open()
        .is_some_and(|open| open.revision != compared.revision);
    if stale
        && show_button(
            ui,
            Button::new("Again").small(),
            "Compare this document as it is now.",
        )
    {
        panel.act(Action::Compare(compared.file.clone()));
    }
    let name = file_name(&compared.file.to_string_lossy());
    let text = if stale {
        format!("with {name}, before the last changes")
    } else {
        format!("with {name}")
    };
    theme::small_weak(ui, text).on_hover_text(compared.file.display().to_string());
}

/// Shows the result of a comparison.
fn show_agreement(panel: &mut Panel<'_>, ui: &mut Ui, agreement: &Agreement) {
    // A copied click says nothing about an annotator's precision.
    let pairs: Vec<(&FrameAgreement, &ClickPair)> = agreement
        .frames
        .iter()
        .flat_map(|frame| {
            frame
                .clicks
                .iter()
                .filter(|pair| !pair.is_copy())
                .map(move |pair| (frame, pair))
        })
        .collect();
    // Index 0 of each pair of indices is this document's, 1 the other one's. Frames and clicks of
    // this document can be shown.
    ui.horizontal_top(|ui| {
        let offsets: Vec<_> = pairs.iter().map(|(_, pair)| pair.offset_px).collect();
        // The offset between two independent clicks has √2 times the σ of one click.
        let sigma_px = agreement
            .noise
            .map(|noise| noise.sigma * std::f64::consts::SQRT_2);
        let pointed = Scatter {
            name: "The other's clicks around these",
            offsets: &offsets,
            sigma_px,
        }
        .show(ui);
        ui.vertical(|ui| {
            ui.set_width(COLUMN);
            describe(ui, agreement);
            if let Some(((frame, pair), clicked)) =
                pointed.and_then(|(index, clicked)| Some((pairs.get(index)?, clicked)))
            {
                let label = panel.app.label(&Target::Landmark(pair.landmark.clone()));
                let text = format!(
                    "{}: {label}, {:.1} px",
                    file_name(&frame.name),
                    pair.apart_px()
                );
                theme::strong(ui, text);
                if clicked {
                    panel.look_at(frame.frames[0], Some(pair.clicks[0]));
                }
            }
            landmarks(panel, ui, agreement);
        });
        ui.vertical(|ui| {
            ui.set_width(COLUMN.min(ui.available_width()));
            names(panel, ui, agreement);
            frames(panel, ui, agreement);
        });
    });
}

/// Shows the summary: distances, click noise, frames that only one of the two has labelled.
fn describe(ui: &mut Ui, agreement: &Agreement) {
    let mut text = String::new();
    if let Some(distances) = &agreement.distances {
        text = format!(
            "{} in {}, median distance {:.2} px (90 %: {:.2} px). ",
            pluralise(distances.count, "point"),
            pluralise(agreement.frames.len(), "frame"),
            distances.median,
            distances.p90
        );
    }
    text.push_str(&agreement.describe_noise());
    let here = agreement.lone.iter().filter(|lone| lone.by_first).count();
    let there = agreement.lone.len() - here;
    if here + there > 0 {
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            " Frames labelled only here: {here}, only there: {there}."
        );
    }
    ui.add(Label::new(text).wrap()).on_hover_text(
        "px at 1920 px width. The rings are one and two σ of the distance between the two clicks.",
    );
}

/// Shows the median distance for each landmark, the largest first.
fn landmarks(panel: &Panel<'_>, ui: &mut Ui, agreement: &Agreement) {
    if agreement.landmarks.is_empty() {
        return;
    }
    ui.add_space(theme::SPACE);
    theme::title(ui, "LANDMARKS, MEDIAN DISTANCE");
    ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
    let largest = agreement
        .landmarks
        .iter()
        .map(|landmark| landmark.median_px)
        .fold(1e-9, f64::max);
    for landmark in agreement.landmarks.iter().take(SHOWN) {
        let name = panel
            .app
            .label(&Target::Landmark(landmark.landmark.clone()));
        let value = format!("{:.1} px", landmark.median_px);
        let share = landmark.median_px / largest;
        let (_, response) = Bar {
            name: &name,
            value: &value,
            share,
            ..Bar::default()
        }
        .show(ui);
        let noise = landmark
            .noise
            .map(|noise| format!(" Click noise {:.2} px.", noise.sigma))
            .unwrap_or_default();
        response.on_hover_text(format!(
            "{name}: {}, 90 % within {:.1} px; median offset of the other ({:+.1}, {:+.1}) px.{noise}",
            pluralise(landmark.pairs, "frame"),
            landmark.p90_px,
            landmark.offset_px.x,
            landmark.offset_px.y
        ));
    }
}

/// Lists the points that the two named differently, one row for each frame.
fn names(panel: &mut Panel<'_>, ui: &mut Ui, agreement: &Agreement) {
    let count: usize = agreement.frames.iter().map(|frame| frame.names.len()).sum();
    if count == 0 {
        return;
    }
    theme::title(ui, &format!("NAMED DIFFERENTLY  {count}"));
    for frame in agreement
        .frames
        .iter()
        .filter(|frame| !frame.names.is_empty())
        .take(SHOWN)
    {
        // The row shows the first difference, the tooltip all of them.
        let text = format!(
            "{}: {}, {}",
            file_name(&frame.name),
            pluralise(frame.names.len(), "point"),
            describe_dispute(panel.app, &frame.names[0])
        );
        let all: Vec<String> = frame
            .names
            .iter()
            .map(|dispute| describe_dispute(panel.app, dispute))
            .collect();
        if show_button(
            ui,
            Button::new(RichText::new(text).color(ui.palette().caution))
                .frame(false)
                .truncate(),
            format!("{}\nClick to look at it.", all.join("\n")),
        ) {
            panel.look_at(frame.frames[0], Some(frame.names[0].clicks[0]));
        }
    }
    ui.add_space(theme::SPACE);
}

/// The two names of a point, here and there.
fn describe_dispute(app: &App, dispute: &NameDispute) -> String {
    let [here, there] = dispute
        .names
        .clone()
        .map(|id| app.label(&Target::Landmark(id)));
    format!("{here} is {there} there")
}

/// Lists the frames that differ most: by the worst corner of their cameras, or by the farthest
/// click where a camera is missing.
fn frames(panel: &mut Panel<'_>, ui: &mut Ui, agreement: &Agreement) {
    // A frame without a distance has neither two cameras nor a common click.
    let mut sorted: Vec<&FrameAgreement> = agreement
        .frames
        .iter()
        .filter(|frame| apart_px(frame) > 0.0)
        .collect();
    if sorted.is_empty() {
        return;
    }
    sorted.sort_by(|a, b| apart_px(b).total_cmp(&apart_px(a)));
    let by_camera = sorted.iter().any(|frame| frame.cameras.is_some());
    theme::title(
        ui,
        if by_camera {
            "FRAMES, WORST CORNER"
        } else {
            "FRAMES, FARTHEST CLICK"
        },
    );
    ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
    let largest = bar_end_px(sorted.iter().map(|frame| apart_px(frame)));
    for frame in sorted.into_iter().take(SHOWN) {
        let name = file_name(&frame.name);
        let px = apart_px(frame);
        let value = if px.is_finite() {
            format!("{px:.1} px")
        } else {
            "elsewhere".to_owned()
        };
        let selected = panel.app.session.frame == frame.frames[0];
        let colour = (px > largest).then_some(ui.palette().caution);
        let (_, response) = Bar {
            name: &name,
            value: &value,
            share: px / largest,
            colour,
            selected,
            ..Bar::default()
        }
        .show(ui);
        if response.on_hover_text(tip(frame)).clicked() {
            panel.look_at(frame.frames[0], None);
        }
    }
}

/// The distance at which bars end, px: the largest one, but at most [`BAR_LIMIT`] times the median.
///
/// Distances are in descending order. A frame with cameras that look in different directions has an
/// infinite one, which does not count.
fn bar_end_px(descending: impl Iterator<Item = f64>) -> f64 {
    let finite: Vec<f64> = descending.filter(|px| px.is_finite()).collect();
    let usual = finite.get(finite.len() / 2).copied().unwrap_or(0.0);
    let largest = finite.first().copied().unwrap_or(0.0);
    largest.min(BAR_LIMIT * usual).max(1e-9)
}

/// How far apart a frame's cameras are, px, or its clicks if one has no camera.
fn apart_px(frame: &FrameAgreement) -> f64 {
    frame
        .cameras
        .map(|cameras| cameras.worst_corner_px)
        .or_else(|| frame.largest_px())
        .unwrap_or(0.0)
}

/// The tooltip of a frame: numbers of points, distances, difference of the cameras.
fn tip(frame: &FrameAgreement) -> String {
    let cameras = frame.cameras.map(|cameras| {
        let iou = cameras
            .iou_part
            .map(|iou| format!(", IoU {iou:.3}"))
            .unwrap_or_default();
        format!(
            " Their cameras: pan {:+.2}°, tilt {:+.2}°, focal length {:+.1} %{iou}.",
            cameras.pan.degrees(),
            cameras.tilt.degrees(),
            cameras.focal_percent
        )
    });
    let farthest = frame
        .largest_px()
        .map(|px| format!(", farthest {px:.1} px"))
        .unwrap_or_default();
    format!(
        "{}: {} of both{farthest}.{} Click to look at it.",
        frame.name,
        pluralise(frame.clicks.len(), "point"),
        cameras.unwrap_or_default()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_end_at_a_multiple_of_the_median_whatever_looks_elsewhere() {
        let end_px = |px: &[f64]| bar_end_px(px.iter().copied());
        assert_eq!(end_px(&[9.0, 4.0, 2.0]), 9.0);
        assert_eq!(end_px(&[90.0, 4.0, 2.0]), 16.0);
        assert_eq!(end_px(&[f64::INFINITY, f64::INFINITY, 3.0, 2.0]), 3.0);
        assert_eq!(end_px(&[f64::INFINITY]), 1e-9);
    }
}
