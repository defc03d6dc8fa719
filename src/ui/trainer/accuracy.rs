//! The accuracy of the forest, measured on references that were left out of its training.

use super::place_and_name;
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{
    Color32, Galley, Label, RichText, Sense, TextStyle, TextWrapMode, Ui, WidgetInfo, WidgetText,
    vec2,
};
use std::sync::Arc;
use touchline_application::app::review::percent;
use touchline_application::app::where_to_label::whole_degrees;
use touchline_calibration::proposals::{LeftOut, LeftOutBy, Quality, WRONG_PX};

/// Number of the worst results that are listed.
const SHOWN: usize = 6;

/// Shows the accuracy, and the references with the largest errors.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, quality: &Quality) {
    ui.add(Label::new(summary(quality)).wrap()).on_hover_text(
        "A forest is trained without these references and tested on them. Errors are those of the worst point of the overlay, px at 1920 px width.",
    );
    // References that were not found count as infinitely far off and come first.
    let mut worst: Vec<&LeftOut> = quality.tested.iter().collect();
    worst.sort_by(|a, b| error_px(b).total_cmp(&error_px(a)));
    for tested in worst.into_iter().take(SHOWN) {
        row(panel, ui, tested);
    }
}

/// The accuracy in words: what was left out, how many references were found, median error, how many
/// are wrong.
fn summary(quality: &Quality) -> String {
    let without = match quality.left_out_by {
        LeftOutBy::Shot => "other references of the shot",
        LeftOutBy::Time => "neighbours (5 s)",
        LeftOutBy::Neighbours => "adjacent references",
    };
    let median = quality
        .median_px()
        .map(|px| format!(", median error {px:.1} px"))
        .unwrap_or_default();
    let wrong = quality.wrong().count();
    let wrong = if wrong > 0 {
        format!(" {wrong} with more than {WRONG_PX:.0} px.")
    } else {
        String::new()
    };
    format!(
        "Test without {without}: {} of {} references found{median}.{wrong}",
        quality.found_count(),
        quality.tested.len()
    )
}

/// The error at the worst point of the overlay, px at 1920 px width; infinite if the forest did not
/// find the frame.
fn error_px(tested: &LeftOut) -> f64 {
    tested.found.map_or(f64::INFINITY, |found| found.error_px)
}

/// Shows a reference with its error; a click shows the frame.
fn row(panel: &mut Panel<'_>, ui: &mut Ui, tested: &LeftOut) {
    let Some((place, name)) = place_and_name(panel, &tested.frame) else {
        return;
    };
    let (says, colour): (String, Color32) = match tested.found {
        Some(found) if found.error_px <= WRONG_PX => {
            (format!("{:.1} px", found.error_px), ui.palette().text)
        }
        Some(found) if found.error_px.is_finite() => {
            (format!("{:.0} px", found.error_px), ui.palette().bad)
        }
        Some(_) => ("elsewhere".to_owned(), ui.palette().bad),
        None => ("not found".to_owned(), ui.palette().caution),
    };
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), theme::LIST_ROW), Sense::click());
    response
        .widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("{name}: {says}")));
    if response.hovered() || response.has_focus() || panel.app.session.frame == place {
        ui.painter().rect_filled(rect, 4.0, ui.palette().raised);
    }
    // The number at the right keeps its room; name and pan are cut to the rest.
    let number = lay_out_truncated(ui, &says, colour, 90.0);
    let left = lay_out_truncated(
        ui,
        &format!("{name}  pan {}", whole_degrees(tested.pan_deg)),
        ui.palette().text,
        rect.width() - number.size().x - 16.0,
    );
    let middle = |height: f32| rect.center().y - height / 2.0;
    let number_at = egui::pos2(
        rect.right() - 4.0 - number.size().x,
        middle(number.size().y),
    );
    ui.painter().galley(number_at, number, colour);
    let left_at = egui::pos2(rect.left() + 4.0, middle(left.size().y));
    ui.painter().galley(left_at, left, ui.palette().text);
    let confidence = tested
        .found
        .map(|found| format!(" Its confidence was {}.", percent(found.confidence)));
    let tip = format!("Go to this reference.{}", confidence.unwrap_or_default());
    if response.on_hover_text(tip).clicked() {
        panel.go_to(place);
    }
}

/// A text in one line, cut to a width in points.
fn lay_out_truncated(ui: &Ui, text: &str, colour: Color32, width: f32) -> Arc<Galley> {
    WidgetText::from(RichText::new(text).color(colour)).into_galley(
        ui,
        Some(TextWrapMode::Truncate),
        width,
        TextStyle::Body,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_calibration::proposals::FoundAgain;
    use touchline_documents::document::FrameId;

    #[test]
    fn the_summary_counts_found_and_wrong_references() {
        let tested = |error_px: Option<f64>| LeftOut {
            frame: FrameId::default(),
            pan_deg: 0.0,
            tilt_deg: -9.0,
            found: error_px.map(|error_px| FoundAgain {
                error_px,
                confidence: 0.9,
            }),
        };
        let tested = vec![
            tested(Some(1.0)),
            tested(None),
            tested(Some(3.0)),
            tested(Some(250.0)),
        ];
        let quality = Quality {
            left_out_by: LeftOutBy::Shot,
            groups: 2,
            tested,
        };
        assert_eq!(
            summary(&quality),
            "Test without other references of the shot: 3 of 4 references found, median error 3.0 px. 1 with more than 20 px."
        );
        assert_eq!(error_px(&quality.tested[1]), f64::INFINITY);
    }
}
