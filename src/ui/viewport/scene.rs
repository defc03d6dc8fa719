//! The overlay: the field, the clicks, the camera of a highlighted name, masks.

use super::pointer::Hold;
use crate::ui::masks;
use crate::ui::overlay::Overlay;
use std::sync::Arc;
use touchline_application::app::{App, session::Mode};
use touchline_application::scene::OverlayStyle;
use touchline_application::scene::overlay::{
    OverlayScene, Standing, click_overlay, field_overlay, mask_overlay,
};
use touchline_documents::document::FrameStatus;

/// The opacity of a camera that is only previewed.
const PREVIEW_OPACITY: f32 = 0.75;
/// The opacity of the frame's own camera while another one is previewed.
const BEHIND_PREVIEW: f32 = 0.35;

impl Overlay {
    /// The overlay of the shown frame at a zoom (physical px per px of the picture).
    pub fn new(app: &App, hold: &Hold, zoom: f64) -> Self {
        Self::without(app, None, hold, zoom)
    }

    /// The same around a click that the pointer holds, without its marker.
    pub fn around(app: &App, click: usize, zoom: f64) -> Self {
        Self::without(app, Some(click), &Hold::Nothing, zoom)
    }

    fn without(app: &App, left_out: Option<usize>, hold: &Hold, zoom: f64) -> Self {
        let mut drawings = Vec::new();
        if app.session.picture.held.hide_overlay {
            return Self::default();
        }
        if let (Some(frame), Some(field)) = (app.frame(), app.current().field()) {
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
            let compared = app
                .current()
                .alternative()
                .filter(|_| app.session.picture.held.compare);
            let preview = compared
                .as_ref()
                .or(app.current().preview.as_ref())
                .filter(|_| proposal.is_none());
            let style = app.overlay_style();
            let behind = OverlayStyle {
                opacity: style.opacity * BEHIND_PREVIEW,
                landmarks: false,
                ..style
            };
            let scene = OverlayScene {
                field,
                camera: camera.as_ref(),
                standing: if frame.status == FrameStatus::Suggested {
                    Standing::Proposed
                } else {
                    Standing::Solved
                },
                image_size: frame.image_size,
                clicks: &frame.clicks,
                selected: app.session.points.selected,
                disputed: app.shown().disputed,
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
                    standing: Standing::Proposed,
                    style: &style,
                    ..scene
                };
                drawings.push(field_overlay(&tried));
            }
            let mut boxes = app.asked_masks();
            boxes.extend(masks::shown(app).into_iter().map(|mask| mask.pixel_box));
            boxes.extend(hold.mask().map(|(_, mask)| mask));
            if !boxes.is_empty() {
                drawings.push(mask_overlay(&boxes));
            }
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

/// Whether a click of the frame has no name and is not being named.
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
