//! Where to click next: the landmarks in view, ranked by what a click on them would gain.

use super::overlay::is_clicked;
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::markings::project_landmarks;
use touchline_core::solve::FrameSolution;
use touchline_documents::document::Click;

/// Minimum distance of a proposed landmark from the border of the picture, px at 1920 px width.
/// Nearer ones are hard to click.
const MARGIN_PX: f64 = 15.0;
/// Maximum ratio of the worst corner's 1-σ with the click to that without it. Clicks that gain less
/// are not proposed.
const WORTHWHILE: f64 = 0.9;

/// A landmark that is worth clicking next.
#[derive(Clone, Debug, PartialEq)]
pub struct NextClick {
    pub id: LandmarkId,
    /// Where the solution predicts it, px.
    pub at: ImagePoint,
    /// 1-σ of the overlay at the worst corner of the picture with a click on the landmark, px.
    pub worst_corner_px: f64,
    /// That 1-σ divided by the present one: 0.5 halves it.
    pub share_left: f64,
}

impl NextClick {
    /// The gain, as a phrase for the user.
    pub fn gain(&self) -> String {
        match self.share_left {
            share if share < 0.4 => format!("error {:.0} times smaller", 1.0 / share),
            share if share < 0.55 => "halves the error".to_owned(),
            share => format!("{:.0} % less error", 100.0 * (1.0 - share)),
        }
    }
}

/// The unclicked landmarks on the ground in the view of a solved frame, the most useful first.
/// Landmarks that gain too little are left out.
pub fn next_clicks(
    field: &FieldModel,
    camera: &PtzCamera,
    solved: &FrameSolution,
    clicks: &[Click],
    image_size: ImageSize,
) -> Vec<NextClick> {
    let now_px = solved.worst_corner_sigma_px;
    let scale = image_size.scale_from_1920();
    let margin_px = MARGIN_PX * scale;
    let mut found: Vec<NextClick> = project_landmarks(field, camera, image_size, 0.0)
        .into_iter()
        .map(|projected| (&field.landmarks[projected.landmark], projected.image))
        .filter(|(landmark, at)| {
            landmark.is_on_ground()
                && is_well_inside(*at, image_size, margin_px)
                && !is_clicked(clicks, &landmark.id)
        })
        .filter_map(|(landmark, at)| {
            // In the linearised problem, the covariance after a click depends on its σ and
            // predicted position only.
            let with =
                solved
                    .uncertainty
                    .with_click_at(camera, at, landmark.click_sigma_px * scale)?;
            let worst_corner_px = with.worst_corner_sigma_px(camera, image_size);
            // If the frame has no uncertainty, the share is infinite or NaN: nothing is proposed.
            let share_left = worst_corner_px / now_px;
            (share_left < WORTHWHILE).then(|| NextClick {
                id: landmark.id.clone(),
                at,
                worst_corner_px,
                share_left,
            })
        })
        .collect();
    found.sort_by(|a, b| a.worst_corner_px.total_cmp(&b.worst_corner_px));
    found
}

/// Whether a point of the picture is at least `margin_px` away from each border.
fn is_well_inside(at: ImagePoint, image_size: ImageSize, margin_px: f64) -> bool {
    (margin_px..=f64::from(image_size.width) - margin_px).contains(&at.x)
        && (margin_px..=f64::from(image_size.height) - margin_px).contains(&at.y)
}
