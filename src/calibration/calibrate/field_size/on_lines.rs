//! An open length of a field, measured on the paint of tracked frames.
//!
//! Known cameras that have seen one part of a field do not determine its length, and frames tracked
//! from there are right at that part only. As soon as some of them show another part, their paint
//! determines the length: it is searched over all lengths that the rules allow, each with the base
//! moved along with what the known cameras saw so that this projects as before. The right length
//! puts the other lines onto their paint. The frames keep pan, tilt and focal length. These come
//! from tracked points alone: a camera that was aligned to the paint in question, with the assumed
//! length, has turned by most of the length's error, and confirms what was assumed.

use super::unseen::{SeenLines, UnseenSize, move_base};
use super::written::set_field_size;
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera, SizeError};
use touchline_core::field::FieldError;
use touchline_core::geometry::{Vec3, mean, median};
use touchline_core::solve::base::FittedSize;
use touchline_documents::document::{CameraId, Document, DocumentAt, Frame};
use touchline_vision::paint::{GroundPicture, check_lines};

/// The code of a warning that lines may be off because the size of their field was not measured.
pub(crate) const LENGTH_UNSEEN: &str = "length_unseen";

/// Maximum number of frames that a length is measured on.
pub(in crate::calibrate) const FRAMES: usize = 16;

/// Fewer frames are no evidence: a player's legs can look like a line.
const MIN_FRAMES: usize = 3;

/// Steps of the search, first over all allowed lengths, then around the best, as shares of the
/// length: 0.5 and 0.1 m on a soccer pitch.
const COARSE_SHARE: f64 = 0.5 / 105.0;
const FINE_SHARE: f64 = 0.1 / 105.0;

/// The best length must explain this many times as much paint as any length that is farther away
/// than a share of it. On a pitch of 101.8 m that was assumed to be 105 m long, it explained 1.5
/// times as much.
const MIN_PEAK: f64 = 1.2;
const PEAK_SHARE: f64 = 2.0 / 105.0;

/// A frame shows the length if its score varies by at least this much over the lengths.
const MIN_VARIATION: f64 = 0.1;

/// A measured length is another one than the assumed if it differs by this many 1-σ.
const OTHER_SIGMAS: f64 = 2.0;

/// A length of a field measured on paint.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthOnLines {
    /// The measured length with its 1-σ, and the assumed one.
    pub size: FittedSize,
    /// By how much each camera of the field moves with what it has seen, m.
    pub shifts: Vec<(CameraId, Vec3)>,
    /// Number of frames that it was measured on.
    pub frames: usize,
    /// Whether a person or a file prescribes another length.
    pub is_prescribed: bool,
}

/// The picture of a frame, and its camera at the assumed length, which owes nothing to its paint.
pub(in crate::calibrate) struct PosedPicture {
    pub ground: GroundPicture,
    pub base: CameraBase,
    pub ptz: Ptz,
    /// 1-σ of the direction in which the camera looks, px.
    pub turn_sigma_px: f64,
}

/// Measures an open length on frames that show other lines than the known cameras. None where the
/// paint decides for no length.
pub(in crate::calibrate) fn measure_length(
    unseen: &UnseenSize,
    looks: &[PosedPicture],
) -> Option<FittedSize> {
    // A base that goes with nothing cannot be moved to what it has seen.
    if looks.len() < MIN_FRAMES || !unseen.is_base_held() {
        return None;
    }
    // Coarse search. The score of a length is the mean over the frames.
    let param = unseen.param();
    let (min_m, max_m) = (param.min_m, param.max_m);
    let rate = |lengths: &[f64]| -> Vec<Vec<f64>> {
        let worths = lengths
            .iter()
            .map(|length_m| worths(unseen, looks, *length_m));
        worths.collect()
    };
    let coarse_m = steps(min_m, max_m, COARSE_SHARE * param.assumed_m);
    let means = means_of_rows(&rate(&coarse_m));
    let best = index_of_largest(means.iter().copied());
    let best_m = coarse_m[best];
    // Accept only a clear peak. Lengths near the best belong to the same peak.
    let elsewhere = means
        .iter()
        .zip(&coarse_m)
        .filter(|(_, length_m)| (**length_m - best_m).abs() > PEAK_SHARE * param.assumed_m)
        .map(|(worth, _)| *worth);
    if !(means[best] > 0.0 && means[best] >= MIN_PEAK * elsewhere.fold(0.0, f64::max)) {
        return None;
    }
    // Fine search around the peak, between the neighbours of the best.
    let around_m = 2.0 * COARSE_SHARE * param.assumed_m;
    let (from_m, to_m) = (
        (best_m - around_m).max(min_m),
        (best_m + around_m).min(max_m),
    );
    let lengths = steps(from_m, to_m, FINE_SHARE * param.assumed_m);
    let table = rate(&lengths);
    let value_m = lengths[index_of_largest(means_of_rows(&table).into_iter())];
    // The σ is the scatter of the single frames' best lengths, or what the directions of their
    // cameras leave open if that is more. Neither is divided by √n, since errors of the base are
    // common to all frames, and neighbours have been tracked along the same points.
    let squares: Vec<f64> = (0..looks.len())
        .filter_map(|look| Some((peak_of(&lengths, &table, look)? - value_m).powi(2)))
        .collect();
    let spread_m = mean(&squares)
        .filter(|_| squares.len() >= MIN_FRAMES)?
        .sqrt();
    let mut by_turns: Vec<f64> = looks
        .iter()
        .map(|look| {
            let motion_px = unseen.motion_px(&look.base, look.ptz, look.ground.size());
            look.turn_sigma_px / motion_px
        })
        .collect();
    let by_turn_m = median(&mut by_turns).unwrap_or(f64::INFINITY);
    Some(FittedSize {
        value_m,
        error: SizeError::alone(spread_m.max(by_turn_m).max(unseen.least_sigma_m())),
        is_open: false,
        ..param.unseen()
    })
}

/// The measured length as the document's cameras take it: each moves with what its known frames
/// have seen.
/// None if the assumed length agrees with it.
pub(in crate::calibrate) fn other_length(
    at: DocumentAt<'_>,
    camera: &CameraId,
    unseen: &UnseenSize,
    size: FittedSize,
    frames: usize,
    seen: &dyn Fn(usize, &Frame) -> Option<SeenLines>,
) -> Result<Option<LengthOnLines>, FieldError> {
    if (size.value_m - size.assumed_m).abs() <= OTHER_SIGMAS * size.error.sigma_m {
        return Ok(None);
    }
    let spec = at.document.field_of_camera(camera);
    let mut shifts = vec![(camera.clone(), unseen.base_shift(size.value_m))];
    for other in at.document.cameras.iter().filter(|it| it.id != *camera) {
        let other_spec = at.document.field_of_camera(&other.id);
        let is_same_length = other_spec.template == spec.template
            && other_spec.params.get(&size.name) == spec.params.get(&size.name);
        if is_same_length {
            let seen = UnseenSize::from_known_frames(at, other, seen)?;
            let seen = seen.into_iter().find(|seen| seen.param().name == size.name);
            shifts.extend(seen.map(|seen| (other.id.clone(), seen.base_shift(size.value_m))));
        }
    }
    Ok(Some(LengthOnLines {
        size,
        shifts,
        frames,
        is_prescribed: spec.is_size_stated(),
    }))
}

/// The score of a length in each frame; zeros where the template has no field of that length.
fn worths(unseen: &UnseenSize, looks: &[PosedPicture], length_m: f64) -> Vec<f64> {
    let Some((field, shift_m)) = unseen.at_length(length_m) else {
        return vec![0.0; looks.len()];
    };
    // The agreement of the lines with paint, times the share of paint that lies on lines. Neither
    // factor suffices alone: each is highest at a length at which the lines in question leave the
    // picture.
    let worth = |look: &PosedPicture| {
        let camera = PtzCamera::new(move_base(&look.base, shift_m), look.ptz);
        let check = check_lines(&look.ground, &field, &camera);
        check.agreement * (1.0 - check.unexplained.unwrap_or(0.0))
    };
    looks.par_iter().map(worth).collect()
}

fn means_of_rows(table: &[Vec<f64>]) -> Vec<f64> {
    table.iter().map(|row| mean(row).unwrap_or(0.0)).collect()
}

/// The length with the highest score in one frame; none if the frame's score hardly depends on the
/// length.
fn peak_of(lengths: &[f64], table: &[Vec<f64>], look: usize) -> Option<f64> {
    let worths = || table.iter().map(|of_length| of_length[look]);
    let (least, most) = worths().fold((f64::INFINITY, 0.0), |(least, most), worth| {
        (worth.min(least), worth.max(most))
    });
    (most - least >= MIN_VARIATION).then(|| lengths[index_of_largest(worths())])
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

/// Applies a measured length: the field of each camera gets it, and the camera moves with
/// what it has seen. Frames keep their pan, tilt and focal length.
pub fn take_length(document: &mut Document, found: &LengthOnLines) {
    for (camera, shift) in &found.shifts {
        set_field_size(document, camera, std::slice::from_ref(&found.size));
        if let Some(known) = document.camera_mut(camera)
            && let Some(mut base) = known.base()
        {
            base.position_m += shift;
            let open = &mut base.sigma.size[found.size.axis()];
            open.sigma_m = open.sigma_m.min(found.size.error.sigma_m);
            known.set_base(&base);
        }
    }
}
