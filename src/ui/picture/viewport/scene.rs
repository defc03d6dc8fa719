//! The overlay on the picture: the field, the clicks, a second camera to compare with, masks.

use super::super::masks;
use super::pointer::DragTarget;
use crate::ui::controls::theme;
use crate::ui::drawing::canvas::Overlay;
use crate::ui::drawing::labels::{PlateStyle, plate};
use crate::ui::drawing::placement::Placement;
use egui::{Align2, Color32, FontId, Painter, Stroke, vec2};
use std::sync::Arc;
use touchline_application::app::App;
use touchline_application::app::session::Mode;
use touchline_application::scene::OverlayStyle;
use touchline_application::scene::overlay::{
    CameraStatus, OverlayScene, click_overlay, field_overlay, mask_overlay,
};
use touchline_calibration::proposals::{FeatureUse, UsedFeatures};

/// Opacity of a camera that is only previewed.
const PREVIEW_OPACITY: f32 = 0.75;
/// Opacity of the frame's own camera while another one is previewed.
const BEHIND_PREVIEW: f32 = 0.35;

impl Overlay {
    /// The overlay of the shown frame. `zoom` is in physical px per px of the picture.
    pub fn new(app: &App, hold: &DragTarget, zoom: f64) -> Self {
        Self::without(app, None, hold, zoom)
    }

    /// The overlay for the loupe around a dragged click, without the marker of that click, which
    /// would hide what is below it.
    pub fn around(app: &App, click: usize, zoom: f64) -> Self {
        Self::without(app, Some(click), &DragTarget::Nothing, zoom)
    }

    /// The overlay, without the marker of one click if given. Drawings are in the order from back
    /// to front.
    fn without(app: &App, left_out: Option<usize>, hold: &DragTarget, zoom: f64) -> Self {
        let mut drawings = Vec::new();
        if app.session.picture.held.hide_overlay {
            return Self::default();
        }
        if let (Some(frame), Some(field)) = (app.frame(), app.current().field()) {
            // The camera of the lines: an estimated base that is not applied yet, the camera before
            // snapping while its key is down, or the frame's own.
            let proposal = app
                .current()
                .proposal
                .as_ref()
                .filter(|_| !app.session.picture.held.compare);
            let field = proposal.map_or(field, |proposal| &proposal.field);
            let camera = match proposal {
                Some(proposal) => proposal.camera,
                None if app.session.picture.held.before_snap => {
                    app.before_snap().copied().or(app.current().camera)
                }
                None => app.current().camera,
            };
            // A second camera beside it: the other solution while its key is down, or the one that
            // a highlighted name would give.
            let compared = app
                .current()
                .alternative()
                .filter(|_| app.session.picture.held.compare);
            let preview = compared
                .as_ref()
                .or(app.current().preview.as_ref())
                .filter(|_| proposal.is_none());
            // While there are two cameras, the frame's own steps back and neither has the rings of
            // the landmarks, which would be confused with each other.
            let style = app.overlay_style();
            let behind = OverlayStyle {
                opacity: style.opacity * BEHIND_PREVIEW,
                landmarks: false,
                ..style
            };
            let scene = OverlayScene {
                field,
                camera: camera.as_ref(),
                standing: CameraStatus::from_frame(frame),
                image_size: frame.image_size,
                clicks: &frame.clicks,
                selected: app.session.points.selected,
                disputed: app.shown_values().disputed,
                style: if preview.is_some() { &behind } else { &style },
                zoom,
            };
            drawings.push(field_overlay(&scene));
            if let Some(preview) = preview {
                let style = OverlayStyle {
                    opacity: style.opacity * PREVIEW_OPACITY,
                    landmarks: false,
                    ..style
                };
                let tried = OverlayScene {
                    camera: Some(preview),
                    standing: CameraStatus::Proposed,
                    style: &style,
                    ..scene
                };
                drawings.push(field_overlay(&tried));
            }
            // Masks: those to be confirmed, the stored ones if shown, and the one being drawn.
            let mut boxes = app.masks_in_question();
            boxes.extend(
                masks::shown_masks(app)
                    .into_iter()
                    .map(|mask| mask.pixel_box),
            );
            boxes.extend(hold.mask().map(|(_, mask)| mask));
            if !boxes.is_empty() {
                drawings.push(mask_overlay(&boxes));
            }
            // Clicks come last, above everything else.
            // The marker of the dragged click is found by its position: markers do not say to which
            // click they belong.
            let mut clicks = click_overlay(&scene);
            if let Some(held) = left_out.and_then(|click| frame.clicks.get(click)) {
                let at = [held.image.x as f32, held.image.y as f32];
                clicks.markers.retain(|marker| marker.at != at);
            }
            drawings.push(clicks);
        }
        Self {
            drawings: drawings.into_iter().map(Arc::new).collect(),
        }
    }
}

/// Whether a click of the frame has no name and is neither being named nor dragged.
pub fn waits_for_name(app: &App, click: usize) -> bool {
    let busy = match &app.session.mode {
        Mode::Naming(naming) => naming.click == click,
        Mode::Dragging { click: held, .. } => *held == click,
        _ => false,
    };
    !busy
        && app
            .frame()
            .and_then(|frame| frame.clicks.get(click))
            .is_some_and(|click| click.target.is_none())
}

/// Radius of a drawn feature, points.
const RADIUS: f32 = 2.5;

/// Draws the features, if they are switched on, and a legend. The features of another frame are not
/// drawn: the result of a background job may arrive after the user has gone on.
pub fn show_features(app: &App, painter: &Painter, placement: &Placement) {
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
        PlateStyle::new(
            FontId::proportional(theme::SMALL),
            theme::ON_PICTURE.strong,
            behind,
        ),
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
