//! The length of a field that was assumed, measured on the paint of frames that were tracked.
//!
//! Autocalibration that has seen only one end of a field cannot determine its length, and the
//! frames tracked from there are right at that end only. As soon as one of them shows the field's
//! middle, its paint determines the length: it is searched over all lengths that the rules allow,
//! each with the base moved along with the seen end so that this end projects as before. The right
//! length puts the lines of the middle onto their paint. The frames keep pan, tilt and focal
//! length.

use super::base_on_paint::PictureOf;
use super::field_size::set_field_size;
use super::size_fit::OpenSize;
use super::unseen_length::{LENGTH, UnseenLength};
use crate::calibrate::paint::LINE_CHECK;
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::{FieldError, FieldModel};
use touchline_core::geometry::{Vec3, mean, subsample};
use touchline_core::solve::base::FittedSize;
use touchline_documents::document::{
    Camera, CameraId, Document, DocumentAt, FieldSize, FieldSpec, Frame, FrameStatus,
};
use touchline_vision::paint::{GroundPicture, check_lines};
use touchline_vision::relocalize::CERTAIN;

/// The code of a warning that the lines of a field's middle may be off because its length was not
/// measured.
pub(crate) const LENGTH_UNSEEN: &str = "length_unseen";

/// Maximum number of suspect frames that are read, and of certain ones.
const FRAMES: usize = 16;

/// Fewer suspect frames are no evidence: a player's legs can look like a line.
const FEWEST: usize = 3;

/// A frame with less confidence than this is suspect.
const DOUBTED: f64 = 0.5;

/// Steps of the search, first over all allowed lengths, then around the best, m.
const COARSE_M: f64 = 0.5;
const FINE_M: f64 = 0.1;

/// The best length must explain this many times as much paint as any length more than `PEAK_M` (m)
/// away, the assumed one included. On a pitch of 101.8 m that was assumed to be 105 m long, it
/// explained 1.5 times as much.
const PEAK: f64 = 1.2;
const PEAK_M: f64 = 2.0;

/// The score of the certain frames may drop by this much: that is noise.
const NOISE: f64 = 0.05;

/// A frame determines the length if its score varies by at least this much over the lengths.
const TELLING: f64 = 0.1;

/// Minimum 1-σ of the length, m: the error of the base is common to all frames.
const FLOOR_M: f64 = 0.3;

/// A field length measured on paint.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthOnLines {
    /// The measured length with its 1-σ, and the assumed one.
    pub size: FittedSize,
    /// By how much each camera of the field moves with the end that it has seen, m.
    pub shifts: Vec<(CameraId, Vec3)>,
    /// Number of suspect frames that were measured.
    pub frames: usize,
    /// Whether a person or a file prescribes another length.
    pub is_prescribed: bool,
}

/// The picture of a frame, and its camera at the assumed length.
struct PosedPicture<'a> {
    ground: GroundPicture,
    ptz: Ptz,
    frame: &'a Frame,
}

/// Measures the length of the field of a document's cameras, where frames suggest that the assumed
/// one is wrong. None where no frame does, where the length was fitted before, or where no length
/// agrees with the paint.
///
/// # Errors
/// The field is not valid. Frames that cannot be read are left out.
pub fn length_on_lines(
    at: DocumentAt<'_>,
    picture: PictureOf<'_>,
) -> Result<Option<LengthOnLines>, FieldError> {
    // Each camera measures the length by itself; the one with most suspect frames decides.
    let mut best: Option<(LengthOnLines, &FieldSpec)> = None;
    for camera in &at.document.cameras {
        let spec = at.document.field_of_camera(&camera.id);
        if *spec.size() == FieldSize::Fitted {
            continue;
        }
        let found = length_by_camera(at, camera, spec, picture)?;
        if let Some(found) = found.filter(|found| {
            best.as_ref()
                .is_none_or(|(best, _)| best.frames < found.frames)
        }) {
            best = Some((found, spec));
        }
    }
    let Some((mut found, spec)) = best else {
        return Ok(None);
    };
    // The other cameras of the stadium see the same field. Each moves with the end that it has seen
    // itself.
    for camera in &at.document.cameras {
        let other = at.document.field_of_camera(&camera.id);
        let is_same_length =
            other.template == spec.template && other.params.get(LENGTH) == spec.params.get(LENGTH);
        if is_same_length && found.shifts.iter().all(|(id, _)| *id != camera.id) {
            let unseen = unseen_length(at, camera)?;
            found.shifts.extend(
                unseen.map(|unseen| (camera.id.clone(), unseen.base_shift(found.size.value_m))),
            );
        }
    }
    Ok(Some(found))
}

/// Measures the length of the field on the frames of one camera.
fn length_by_camera(
    at: DocumentAt<'_>,
    camera: &Camera,
    spec: &FieldSpec,
    picture: PictureOf<'_>,
) -> Result<Option<LengthOnLines>, FieldError> {
    let document = at.document;
    // Frames with little confidence whose paint is off its lines suggest another length. Certain
    // frames must fit at that length as well as before.
    let doubted = frames_of(document, &camera.id, |frame, confidence| {
        confidence < DOUBTED && is_off_paint(frame)
    });
    if doubted.len() < FEWEST {
        return Ok(None);
    }
    let Some(unseen) = unseen_length(at, camera)? else {
        return Ok(None);
    };
    let agreeing = frames_of(document, &camera.id, |_, confidence| confidence >= CERTAIN);
    let doubted = looks(at, &doubted, picture);
    let agreeing = looks(at, &agreeing, picture);
    // Pictures that cannot be read are left out, and what is left may be too little.
    if doubted.len() < FEWEST {
        return Ok(None);
    }
    // Coarse search. The score of a length is the mean over the suspect frames.
    let assumed_m = unseen.assumed_length_m();
    let (min_m, max_m) = unseen.limits_m();
    let rated: Vec<(f64, f64)> = steps(min_m, max_m, COARSE_M)
        .into_iter()
        .map(|length_m| (mean_worth(&unseen, &doubted, length_m), length_m))
        .collect();
    let Some(&(best, best_m)) = rated.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Ok(None);
    };
    // Accept only a clear peak. Lengths near the best belong to the same peak; the assumed length
    // always counts as another one.
    let elsewhere = rated
        .iter()
        .filter(|(_, length_m)| (length_m - best_m).abs() > PEAK_M)
        .map(|(worth, _)| *worth);
    let assumed_worth = mean_worth(&unseen, &doubted, assumed_m);
    let is_peak = best > 0.0 && best >= PEAK * elsewhere.fold(assumed_worth, f64::max);
    if !is_peak {
        return Ok(None);
    }
    // The certain frames must not lose more than noise.
    let worth_before = mean_worth(&unseen, &agreeing, assumed_m);
    if mean_worth(&unseen, &agreeing, best_m) < worth_before - NOISE {
        return Ok(None);
    }
    // Fine search around the peak.
    let lengths = steps(
        (best_m - PEAK_M).max(min_m),
        (best_m + PEAK_M).min(max_m),
        FINE_M,
    );
    let table: Vec<Vec<f64>> = lengths
        .iter()
        .map(|length_m| worths(&unseen, &doubted, *length_m))
        .collect();
    let value_m =
        lengths[index_of_largest(table.iter().map(|of_length| mean(of_length).unwrap_or(0.0)))];
    // The σ is the scatter of the single frames' best lengths. It is not divided by √n, since
    // errors of the base are common to all of them.
    let peaks: Vec<f64> = (0..doubted.len())
        .filter_map(|look| peak_of(&lengths, &table, look))
        .collect();
    let spread_m = mean(
        &peaks
            .iter()
            .map(|peak_m| (peak_m - value_m).powi(2))
            .collect::<Vec<_>>(),
    )
    .unwrap_or(0.0)
    .sqrt();
    let sigma_m = spread_m.max(FLOOR_M);
    let name = LENGTH.to_owned();
    let size = FittedSize {
        name,
        assumed_m,
        value_m,
        sigma_m,
        position_sigma_m: Vec3::zeros(),
        is_open: false,
    };
    // The size is not marked as open: once it is written, the length counts as measured.
    let shifts = vec![(camera.id.clone(), unseen.base_shift(value_m))];
    let is_prescribed = *spec.size() != FieldSize::Assumed;
    Ok(Some(LengthOnLines {
        size,
        shifts,
        frames: doubted.len(),
        is_prescribed,
    }))
}

/// How the unknown length of a camera's field affects its pictures, judging by the certain frames;
/// none where these determine the length.
fn unseen_length(at: DocumentAt<'_>, camera: &Camera) -> Result<Option<UnseenLength>, FieldError> {
    let Some(base) = camera.base() else {
        return Ok(None);
    };
    let spec = at.document.field_of_camera(&camera.id);
    let field = at.model_of(spec)?;
    let open = OpenSize::new(spec.template(at.folder)?, &field);
    let certain = frames_of(at.document, &camera.id, |_, confidence| {
        confidence >= CERTAIN
    })
    .into_iter();
    let certain: Vec<_> = certain
        .filter_map(|frame| Some((frame.ptz.as_ref()?.ptz(), frame.image_size)))
        .collect();
    Ok(UnseenLength::new(open, &field, &base, &certain))
}

/// Whether a frame carries a warning that its paint is off its lines, or may be.
fn is_off_paint(frame: &Frame) -> bool {
    let warnings = frame
        .solution
        .iter()
        .flat_map(|solution| &solution.warnings);
    warnings
        .into_iter()
        .any(|warning| warning.code == LINE_CHECK || warning.code == LENGTH_UNSEEN)
}

/// The solved frames of a camera that satisfy a condition on frame and confidence, without rejected
/// ones. A camera without a stated confidence counts as certain (1).
fn frames_of<'a>(
    document: &'a Document,
    camera: &CameraId,
    is_included: impl Fn(&Frame, f64) -> bool,
) -> Vec<&'a Frame> {
    let solved = document
        .frames
        .iter()
        .map(|frame| &**frame)
        .filter(|frame| frame.ptz.is_some() && frame.status != FrameStatus::Rejected);
    let of_camera = solved.filter(|frame| frame.camera == *camera);
    of_camera
        .filter(|frame| {
            let solution = frame.solution.as_ref();
            let confidence = solution.and_then(|solution| solution.confidence);
            is_included(frame, confidence.unwrap_or(1.0))
        })
        .collect()
}

/// The pictures of at most [`FRAMES`] of these frames, spread evenly.
fn looks<'a>(
    at: DocumentAt<'_>,
    frames: &[&'a Frame],
    picture: PictureOf<'_>,
) -> Vec<PosedPicture<'a>> {
    subsample(frames, FRAMES)
        .filter_map(|frame| {
            let ground = GroundPicture::new(&picture(frame)?, &at.document.masks_of(frame));
            Some(PosedPicture {
                ground,
                ptz: frame.ptz.as_ref()?.ptz(),
                frame,
            })
        })
        .collect()
}

/// The mean score of a length over some frames.
fn mean_worth(unseen: &UnseenLength, looks: &[PosedPicture<'_>], length_m: f64) -> f64 {
    mean(&worths(unseen, looks, length_m)).unwrap_or(0.0)
}

/// The score of a length in each frame; zeros where the template has no field of that length.
fn worths(unseen: &UnseenLength, looks: &[PosedPicture<'_>], length_m: f64) -> Vec<f64> {
    let Some((field, base)) = unseen.at_length(length_m) else {
        return vec![0.0; looks.len()];
    };
    looks
        .par_iter()
        .map(|look| worth_in_frame(look, &field, &base))
        .collect()
}

/// The score of a field in one frame: the agreement of its lines with paint, times the share of its
/// paint that lies on lines. Neither factor suffices alone: each is highest at a length at which
/// the lines in question leave the picture.
fn worth_in_frame(look: &PosedPicture<'_>, field: &FieldModel, base: &CameraBase) -> f64 {
    let camera = PtzCamera::new(look.frame.base_from(base), look.ptz);
    let check = check_lines(&look.ground, field, &camera);
    check.agreement * (1.0 - check.unexplained.unwrap_or(0.0))
}

/// The length with the highest score in one frame; none if the frame's score hardly depends on the
/// length.
fn peak_of(lengths: &[f64], table: &[Vec<f64>], look: usize) -> Option<f64> {
    let worths = || table.iter().map(|of_length| of_length[look]);
    let (least, most) = worths().fold((f64::INFINITY, 0.0), |(least, most), worth| {
        (worth.min(least), worth.max(most))
    });
    (most - least >= TELLING).then(|| lengths[index_of_largest(worths())])
}

/// Evenly spaced values from `from` to `to`, both included, about `step` apart.
fn steps(from: f64, to: f64, step: f64) -> Vec<f64> {
    let count = ((to - from) / step).round().max(1.0) as usize;
    (0..=count)
        .map(|index| from + (to - from) * index as f64 / count as f64)
        .collect()
}

fn index_of_largest(values: impl Iterator<Item = f64>) -> usize {
    values
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0, |(index, _)| index)
}

/// Applies a measured length: the field of each camera gets it, and the camera moves with the end
/// that it has seen. Frames keep their pan, tilt and focal length.
pub fn take_length(document: &mut Document, found: &LengthOnLines) {
    for (camera, shift) in &found.shifts {
        set_field_size(document, camera, std::slice::from_ref(&found.size));
        if let Some(known) = document.camera_mut(camera)
            && let Some(mut base) = known.base()
        {
            base.position_m += shift;
            known.set_base(&base);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::fixtures::document_with;
    use std::path::Path;
    use touchline_core::camera::BaseAngles;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{FramePtz, Solution, SolutionWarning};

    /// Three frames in doubt, and four certain ones that show the right end alone.
    fn right_end_seen() -> Document {
        const SIZE: ImageSize = ImageSize::new(640, 360);
        let base = CameraBase::new(
            Vec3::new(3.0, -62.0, 17.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        );
        let mut document = document_with(&base, SIZE);
        for (pan_deg, confidence) in [
            (13.0, 0.3),
            (15.0, 0.3),
            (17.0, 0.3),
            (33.0, 0.97),
            (35.0, 0.97),
            (37.0, 0.97),
            (39.0, 0.97),
        ] {
            let mut frame = Frame::from_image(&format!("{pan_deg}.png"), "main".into(), SIZE);
            let ptz = Ptz::from_degrees(pan_deg, -12.0, 1066.0);
            frame.ptz = Some(FramePtz::new(ptz, None));
            frame.status = FrameStatus::Suggested;
            frame.solution = Some(Solution {
                confidence: Some(confidence),
                warnings: vec![SolutionWarning::new(LENGTH_UNSEEN, "off".to_owned())],
                ..Solution::default()
            });
            document.frames.push(frame.into());
        }
        document
    }

    #[test]
    fn the_camera_of_a_rejected_frame_is_not_certain() {
        let mut document = right_end_seen();
        for frame in document.frames.iter_mut().skip(3) {
            frame.status = FrameStatus::Rejected;
        }
        let at = document.at(Path::new(""));
        assert!(unseen_length(at, &document.cameras[0]).unwrap().is_none());
    }

    #[test]
    fn pictures_that_cannot_be_read_give_no_length() {
        let document = right_end_seen();
        let at = document.at(Path::new(""));
        let unseen = unseen_length(at, &document.cameras[0]).unwrap();
        assert!(
            unseen.is_some(),
            "the certain frames do not show the length"
        );
        assert_eq!(length_on_lines(at, &mut |_| None).unwrap(), None);
    }
}
