//! The search for the camera of a court in a document: which pictures are looked at, with which
//! principal points, and what would help where none decides.

use super::{CourtFrame, TriedLens, find_court_camera};
use crate::autocalibrate::adjustment::refine::SearchedCamera;
use crate::autocalibrate::frames::by_shot::spread_over_shots;
use crate::autocalibrate::frames::sampled_frames::{PictureOfFrame, read_pictures};
use crate::autocalibrate::progress::report;
use crate::autocalibrate::{AutocalibrationError, AutocalibrationProgress, WantedClicks};
use crate::calibrate::AutocalibratedCamera;
use touchline_core::camera::StatedLens;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::progress::Progress;
use touchline_documents::document::Camera;
use touchline_vision::paint::GroundPicture;

/// Number of pictures that are looked at.
const MAX_PICTURES: usize = 7;

/// Clicked landmarks in one frame that give the camera of a court in place of the search.
const SUFFICIENT_CLICKS: usize = 4;

/// Proportions of pictures that are not cut out of others, width to height, and how far others may
/// be from them.
const USUAL_PROPORTIONS: [f64; 6] = [16.0 / 9.0, 4.0 / 3.0, 3.0 / 2.0, 1.0, 9.0 / 16.0, 3.0 / 4.0];
const SAME_PROPORTION: f64 = 0.02;

/// Guesses of how far below the middle the principal point of a picture lies that is cut out of
/// another, in its widths. Each holds for half a step around it.
const GUESSES_BELOW: [f64; 4] = [-0.1, 0.1, -0.2, 0.2];

/// What the pictures of a court say.
pub enum CourtAnswer {
    Found(Box<AutocalibratedCamera>),
    /// No picture decides; the clicks that would, where a picture has any line.
    NotFound(Option<WantedClicks>),
}

/// Searches the camera of a court in the pictures of some frames of a document.
///
/// # Errors
/// The search was stopped.
pub fn search_court(
    searched: SearchedCamera<'_>,
    field: &FieldModel,
    of_camera: &[usize],
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<CourtAnswer, AutocalibrationError> {
    let SearchedCamera {
        document, camera, ..
    } = searched;
    let chosen = spread_over_shots(document.document, of_camera, MAX_PICTURES);
    let of = chosen.len();
    report(progress, AutocalibrationProgress::Looking { done: 0, of })?;
    let mut pictures = read_pictures(&chosen, picture);
    // Pictures of another size are another camera's.
    let Some(size) = pictures.first().map(|(_, picture)| picture.size()) else {
        return Ok(CourtAnswer::NotFound(None));
    };
    pictures.retain(|(_, picture)| picture.size() == size);
    let frames: Vec<CourtFrame> = pictures
        .iter()
        .map(|(index, picture)| {
            let masks = document.masks_of(&document.frames[*index]);
            CourtFrame::new(*index, GroundPicture::new(picture, &masks))
        })
        .collect();
    let stated = document
        .document
        .camera(camera)
        .filter(|camera| camera.image_size == size);
    let stated = stated.map(Camera::stated_lens).unwrap_or_default();
    let mut best: Option<AutocalibratedCamera> = None;
    for lens in tried_lenses(stated, size) {
        report(progress, AutocalibrationProgress::Looking { done: of, of })?;
        let found = find_court_camera(&frames, field, lens);
        if found.is_some() && !lens.is_guess {
            best = found;
            break;
        }
        // Half a step beside the truth, all lines lie on paint as well, but less well.
        best = best
            .into_iter()
            .chain(found)
            .max_by(|a, b| a.evidence.nats.total_cmp(&b.evidence.nats));
    }
    if let Some(found) = best {
        return Ok(CourtAnswer::Found(Box::new(found)));
    }
    let fullest = frames
        .iter()
        .filter(|frame| frame.length_px() > 0.0)
        .max_by(|a, b| a.length_px().total_cmp(&b.length_px()));
    Ok(CourtAnswer::NotFound(fullest.map(|frame| WantedClicks {
        frame: frame.index,
        landmarks: SUFFICIENT_CLICKS,
        named: Vec::new(),
    })))
}

/// The lens that is stated, and the same with guessed principal points where the picture is cut out
/// of another and the one stated is but its middle.
fn tried_lenses(stated: StatedLens, size: ImageSize) -> impl Iterator<Item = TriedLens> {
    let [width, height] = [size.width, size.height].map(f64::from);
    let middle = size.centre();
    let is_usual = USUAL_PROPORTIONS
        .iter()
        .any(|usual| (width / height / usual - 1.0).abs() <= SAME_PROPORTION);
    let is_cut = stated.principal_point_in(size) == middle && !is_usual;
    let guesses = is_cut.then_some(GUESSES_BELOW).into_iter().flatten();
    std::iter::once(TriedLens {
        stated,
        is_guess: false,
    })
    .chain(guesses.map(move |below| TriedLens {
        stated: StatedLens {
            principal_point: Some(ImagePoint::new(middle.x, middle.y + below * width)),
            ..stated
        },
        is_guess: true,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pictures_that_are_cut_out_of_others_have_guessed_principal_points() {
        let num_lenses = |width, height, x: f64| {
            let size = ImageSize::new(width, height);
            let stated = StatedLens::from_principal_point(ImagePoint::new(x, size.centre().y));
            tried_lenses(stated, size).count()
        };
        assert_eq!(num_lenses(1280, 720, 640.0), 1);
        assert_eq!(num_lenses(1440, 1080, 720.0), 1);
        assert_eq!(num_lenses(540, 960, 270.0), 1);
        assert_eq!(num_lenses(1280, 640, 640.0), 5);
        // It is stated.
        assert_eq!(num_lenses(1280, 640, 648.0), 1);
    }
}
