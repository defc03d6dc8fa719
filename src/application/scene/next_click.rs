//! Where to click next: the landmarks in view, ranked by what a click on them would gain.

use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::markings::project_landmarks;
use touchline_core::solve::FrameSolution;
use touchline_documents::document::{Click, Target};

/// A landmark nearer to the border than this is hard to hit, px at 1920 px width.
const MARGIN_PX: f64 = 15.0;
/// A click that leaves more than this share of the worst corner's 1-σ is not worth proposing.
const WORTHWHILE: f64 = 0.9;

/// A landmark to click next.
#[derive(Clone, Debug, PartialEq)]
pub struct NextClick {
    /// The landmark.
    pub id: LandmarkId,
    /// Where the solution has it, px.
    pub at: ImagePoint,
    /// 1-σ of the lines at the picture's worst corner with a click on it, px.
    pub worst_corner_px: f64,
    /// What is left of the 1-σ now: 0.5 halves it.
    pub share_left: f64,
}

impl NextClick {
    /// What it gains, in words.
    #[must_use]
    pub fn gain(&self) -> String {
        match self.share_left {
            share if share < 0.4 => format!("error {:.0} times smaller", 1.0 / share),
            share if share < 0.55 => "halves the error".to_owned(),
            share => format!("{:.0} % less error", 100.0 * (1.0 - share)),
        }
    }
}

/// The landmarks on the ground that a solved frame shows and nobody has clicked, the most useful
/// first; those that gain little are left out.
#[must_use]
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
    let well_inside = |at: ImagePoint| {
        (margin_px..=f64::from(image_size.width) - margin_px).contains(&at.x)
            && (margin_px..=f64::from(image_size.height) - margin_px).contains(&at.y)
    };
    let mut found: Vec<NextClick> = project_landmarks(field, camera, image_size, 0.0)
        .into_iter()
        .map(|projected| (&field.landmarks[projected.landmark], projected.image))
        .filter(|(landmark, at)| landmark.nominal_m.z == 0.0 && well_inside(*at))
        .filter(|(landmark, _)| {
            !clicks
                .iter()
                .any(|click| click.target == Some(Target::Landmark(landmark.id.clone())))
        })
        .filter_map(|(landmark, at)| {
            let with =
                solved
                    .uncertainty
                    .with_click_at(camera, at, landmark.click_sigma_px * scale)?;
            let worst_corner_px = with.worst_corner_sigma_px(camera, image_size);
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
