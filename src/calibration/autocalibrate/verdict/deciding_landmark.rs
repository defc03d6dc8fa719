//! The landmark whose click decides between two answers.

use crate::autocalibrate::WantedClicks;
use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_documents::document::Document;

/// A click cannot separate projections closer together than this, px at 1920 px width.
const MIN_APART_PX: f64 = 40.0;

/// The click on the landmark of the ground whose projections by two answers are farthest apart,
/// among those that both show within one picture. None if no pair is at least [`MIN_APART_PX`]
/// apart.
pub fn deciding_landmark(
    document: &Document,
    best: &AutocalibratedCamera,
    other: &AutocalibratedCamera,
) -> Option<WantedClicks> {
    let mut farthest: Option<(f64, WantedClicks)> = None;
    for one in &best.frames {
        let Some(two) = other.frames.iter().find(|two| two.index == one.index) else {
            continue;
        };
        let size = document.frames[one.index].image_size;
        let cameras = [(best, one), (other, two)].map(
            |(found, frame): (&AutocalibratedCamera, &AutocalibratedFrame)| {
                PtzCamera::new(found.base, frame.ptz)
            },
        );
        for landmark in best
            .field
            .landmarks
            .iter()
            .filter(|landmark| landmark.is_on_ground())
        {
            // Each answer has its own field size, so the landmark differs in position as well.
            let id = landmark.id.as_str();
            let (Some(here), Some(there)) = (
                image_of_landmark(id, &best.field, &cameras[0], size),
                image_of_landmark(id, &other.field, &cameras[1], size),
            ) else {
                continue;
            };
            let apart_px = here.distance_px(there) / size.scale_from_1920();
            if apart_px >= MIN_APART_PX
                && farthest.as_ref().is_none_or(|(most, _)| apart_px > *most)
            {
                let clicks = WantedClicks {
                    frame: one.index,
                    landmarks: 1,
                    named: vec![landmark.id.clone()],
                };
                farthest = Some((apart_px, clicks));
            }
        }
    }
    farthest.map(|(_, clicks)| clicks)
}

/// Where a camera shows a landmark of its field, px; none outside its picture.
fn image_of_landmark(
    id: &str,
    field: &FieldModel,
    camera: &PtzCamera,
    image_size: ImageSize,
) -> Option<ImagePoint> {
    let landmark = field.landmark(id)?;
    let at = camera
        .image_from_world(field.landmark_in_world(landmark))
        .ok()?;
    image_size.contains(at).then_some(at)
}
