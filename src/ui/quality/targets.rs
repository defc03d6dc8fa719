//! The errors of clicks by landmark and line, the worst first. A click shows the worst click on
//! one.
//!
//! Errors are px at 1920 px width.

use super::card;
use super::errors::{describe_most, px};
use crate::ui::Panel;
use crate::ui::controls::bar::Bar;
use crate::ui::controls::show_folded;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::rows::menu::file_name;
use egui::Ui;
use touchline_application::app::quality::TargetErrors;
use touchline_core::geometry::pluralise;

/// Number of landmarks that are shown before the list is expanded.
const SHOWN: usize = 11;

/// The text while no frame has enough clicks for its errors to be evidence.
const NOTHING: &str =
    "Errors by landmark and line appear here once some frames have three clicks or more.";

/// Shows the card.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let targets = &panel.app.quality().targets;
    card(
        panel,
        ui,
        "ERRORS BY LANDMARK",
        |_, ui| explain_bars(ui, targets.is_empty()),
        |panel, ui| {
            if targets.is_empty() {
                theme::weak_text(ui, NOTHING);
                return;
            }
            let largest = bar_end_px(targets);
            ui.spacing_mut().item_spacing.y = 0.0;
            let all = format!("All {}", targets.len());
            let lengths = (targets.len(), SHOWN);
            show_folded(
                ui,
                "all landmarks of the quality page",
                lengths,
                &all,
                |ui, at| {
                    row(panel, ui, &targets[at], largest);
                },
            );
        },
    );
}

/// The error at which bars end, px at 1920 px width.
///
/// It is set by the landmarks with enough clicks and by the expected medians; one outlier must not
/// make all other bars invisible. A median is infinite where cameras do not see what was clicked.
fn bar_end_px(targets: &[TargetErrors]) -> f64 {
    let known = targets
        .iter()
        .filter(|errors| errors.is_known() && errors.median_px.is_finite())
        .map(|errors| errors.median_px);
    known
        .chain(targets.iter().map(|errors| 2.0 * errors.expected_px))
        .fold(0.1, f64::max)
}

/// Explains the numbers and marks of the bars.
fn explain_bars(ui: &mut Ui, is_empty: bool) {
    let tip = "The stroke marks the median expected of correct clicks, from how precisely people hit this landmark. A landmark that is off in every frame may be named wrongly, or the field's size is wrong.";
    let words = if is_empty { "" } else { "median; | expected" };
    theme::small_weak(ui, words).on_hover_text(tip);
}

/// Shows one landmark or line: its median as a bar, with a stroke at the median expected of correct
/// clicks. The worst click is named in the tooltip.
fn row(panel: &mut Panel<'_>, ui: &mut Ui, errors: &TargetErrors, largest_px: f64) {
    let label = panel.app.label(&errors.target);
    // Weak with too few clicks, emphasised if worse than expected.
    let colour = match (errors.is_known(), errors.is_bad()) {
        (true, true) => Some(ui.palette().caution),
        (true, false) => None,
        (false, _) => Some(ui.palette().weak),
    };
    let median = if errors.median_px.is_finite() {
        format!("{:.1} px", errors.median_px)
    } else {
        "unseen".to_owned()
    };
    let bar = Bar {
        name: &format!("{} × {label}", errors.clicks),
        value: &median,
        share: errors.median_px / largest_px,
        expected: Some(errors.expected_px / largest_px),
        colour,
        width: (0.28 * ui.available_width()).min(160.0),
        ..Bar::default()
    };
    let (_, response) = bar.show(ui);
    let Some(&(frame, click, worst_px)) = errors.worst.first() else {
        return;
    };
    let name = panel
        .app
        .open()
        .and_then(|open| open.frame(frame))
        .map(|frame| file_name(&frame.name()))
        .unwrap_or_default();
    let tip = format!(
        "{label}: {} The worst, {}, is in {name}: click to go there.",
        describe(errors),
        px(worst_px)
    );
    if response.on_hover_text(tip).clicked() {
        panel.look_at(frame, Some(click));
    }
}

/// Describes the errors of one landmark or line, and what correct clicks would have.
fn describe(errors: &TargetErrors) -> String {
    format!(
        "{}, median {}, {}; correct ones would have a median of {:.1} px.",
        pluralise(errors.clicks, "click"),
        px(errors.median_px),
        describe_most(errors.most_px),
        errors.expected_px
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::document::Target;

    #[test]
    fn bars_fit_known_medians_and_no_outlier() {
        let errors = |clicks: usize, median_px: f64| TargetErrors {
            target: Target::Landmark("centre_mark".into()),
            clicks,
            median_px,
            most_px: median_px,
            expected_px: 1.0,
            worst: Vec::new(),
        };
        let mut targets = vec![errors(5, 7.0), errors(1, 90.0)];
        assert_eq!(bar_end_px(&targets), 7.0);
        targets.push(errors(5, f64::INFINITY));
        assert_eq!(bar_end_px(&targets), 7.0);
        assert_eq!(bar_end_px(&targets[1..]), 2.0);
        let hardly_seen = TargetErrors {
            most_px: f64::INFINITY,
            ..errors(1, 1.5)
        };
        assert_eq!(
            describe(&hardly_seen),
            "1 click, median 1.5 px, 10 % or more out of view; \
             correct ones would have a median of 1.0 px."
        );
    }
}
