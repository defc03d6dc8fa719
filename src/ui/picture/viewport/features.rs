//! The image features of the shown frame, coloured by how the forest used them.

use crate::ui::controls::theme;
use crate::ui::drawing::labels::{PlateStyle, plate};
use crate::ui::drawing::placement::Placement;
use egui::{Align2, Color32, FontId, Painter, Stroke, vec2};
use touchline_application::app::App;
use touchline_calibration::proposals::{FeatureUse, UsedFeatures};

/// Radius of a drawn feature, points.
const RADIUS: f32 = 2.5;

/// Draws the features, if they are switched on, and a legend. The features of another frame are not
/// drawn: the result of a background job may arrive after the user has gone on.
pub fn show(app: &App, painter: &Painter, placement: &Placement) {
    let trainer = &app.session.trainer;
    if !trainer.show_features {
        return;
    }
    // Features kept, matched and agreeing are drawn differently in size and kind, not in colour
    // alone.
    let visible = placement.rect;
    let shown = app.frame().map(|frame| &frame.id);
    let used = trainer
        .features
        .as_ref()
        .filter(|used| Some(&used.frame) == shown);
    for (point, used) in used.into_iter().flat_map(|used| &used.features) {
        let at = placement.screen_from_image(*point);
        if !visible.expand(RADIUS).contains(at) {
            continue;
        }
        match used {
            FeatureUse::Kept => {
                painter.circle_filled(at, RADIUS - 1.0, Color32::from_white_alpha(110))
            }
            FeatureUse::Matched => {
                painter.circle_stroke(at, RADIUS, Stroke::new(1.2, theme::ON_PICTURE.caution))
            }
            FeatureUse::Agrees => painter.circle_filled(at, RADIUS, theme::ON_PICTURE.good),
        };
    }
    // The upper left corner: messages about the picture are below it.
    let at = visible.left_top() + vec2(10.0, 16.0);
    let behind = Color32::from_black_alpha(170);
    plate(
        painter,
        at,
        Align2::LEFT_CENTER,
        &legend(used),
        PlateStyle::new(FontId::proportional(12.0), theme::ON_PICTURE.strong, behind),
    );
}

/// The legend, with the number of features of each kind. A kind includes the next one: a feature
/// that agrees was also matched and kept.
fn legend(used: Option<&UsedFeatures>) -> String {
    let Some(used) = used else {
        return "Looking for features…".to_owned();
    };
    let [kept, matched, agree] = [FeatureUse::Kept, FeatureUse::Matched, FeatureUse::Agrees]
        .map(|at_least| used.count(at_least));
    format!(
        "{kept} features (white), {matched} look like the references (yellow), {agree} agree (green)"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImagePoint;

    #[test]
    fn each_kind_contains_the_next() {
        let at = ImagePoint::new(1.0, 2.0);
        let features = [
            FeatureUse::Kept,
            FeatureUse::Agrees,
            FeatureUse::Matched,
            FeatureUse::Agrees,
        ];
        let used = UsedFeatures {
            frame: "1".into(),
            features: features.map(|used| (at, used)).to_vec(),
        };
        assert_eq!(
            legend(Some(&used)),
            "4 features (white), 3 look like the references (yellow), 2 agree (green)"
        );
        assert_eq!(legend(None), "Looking for features…");
    }
}
