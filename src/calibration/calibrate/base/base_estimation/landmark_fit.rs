//! How well each landmark fits an estimated base, over all frames that show it. A landmark that
//! never fits is probably named wrongly, or not where the field's model has it.

use super::BaseProblem;
use std::collections::BTreeMap;
use touchline_core::camera::PtzCamera;
use touchline_core::field::LandmarkId;
use touchline_core::geometry::median;
use touchline_core::solve::base::BaseEstimate;
use touchline_documents::document::{Document, Target};

/// The residuals of the clicks on one landmark, over all frames.
#[derive(Clone, Debug, PartialEq)]
pub struct LandmarkFit {
    /// The landmark.
    pub id: LandmarkId,
    /// Median residual, px.
    pub median_px: f64,
    /// Number of clicks.
    pub clicks: usize,
    /// The click with the largest residual: its frame's index in the document, and its index in the
    /// frame.
    pub worst: (usize, usize),
    /// The residual of that click, px.
    pub worst_px: f64,
}

/// The fit of one landmark from its residuals (px) with the indices of frame and click; none
/// without a residual. The median is robust against a single wrong click, which `worst` names.
fn landmark_fit(id: &LandmarkId, mut errors: Vec<(f64, usize, usize)>) -> Option<LandmarkFit> {
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (worst_px, frame, click) = *errors.last()?;
    let median_px = median(&mut errors.iter().map(|error| error.0).collect::<Vec<_>>())?;
    Some(LandmarkFit {
        id: id.clone(),
        median_px,
        clicks: errors.len(),
        worst: (frame, click),
        worst_px,
    })
}

impl BaseProblem {
    /// The distance of the clicks on each landmark from its projection with the new base, crown and
    /// frame cameras. Landmarks are sorted by their median, the worst first.
    pub(super) fn landmark_fits(
        &self,
        document: &Document,
        estimate: &BaseEstimate,
    ) -> Vec<LandmarkFit> {
        // The crown raises the middle of the field, so landmarks are projected from the surface
        // that the estimate found.
        let field = self.field.with_crown_m(estimate.crown_m);
        // Residuals in px by landmark, with the indices of frame and click. Check clicks count for
        // nothing.
        let mut errors: BTreeMap<&LandmarkId, Vec<(f64, usize, usize)>> = BTreeMap::new();
        for (index, fit) in self.frames.iter().zip(&estimate.frames) {
            let (Some(fit), Some(frame)) = (fit, document.frames.get(*index)) else {
                continue;
            };
            let camera = PtzCamera::new(estimate.base, fit.ptz);
            for (number, click) in frame
                .clicks
                .iter()
                .enumerate()
                .filter(|(_, click)| !click.check)
            {
                if let Some(Target::Landmark(id)) = &click.target
                    && let Some(landmark) = field.landmark(id.as_str())
                    && let Ok(image) = camera.image_from_world(field.landmark_in_world(landmark))
                {
                    errors.entry(id).or_default().push((
                        image.distance_px(click.image),
                        *index,
                        number,
                    ));
                }
            }
        }
        let mut fits: Vec<LandmarkFit> = errors
            .into_iter()
            .filter_map(|(id, errors)| landmark_fit(id, errors))
            .collect();
        fits.sort_by(|a, b| b.median_px.total_cmp(&a.median_px));
        fits
    }
}
