//! The painted lines of a frame's picture: aligns its camera to them, or checks the camera against
//! them.

use super::observations;
use thiserror::Error;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::markings::LineVerdict;
use touchline_core::progress::Progress;
use touchline_core::solve::ObservationError;
use touchline_documents::document::{
    Click, Document, Frame, FrameStatus, PaintEvidence, Solution, SolutionSource, SolutionWarning,
    Target,
};
use touchline_vision::media::Picture;
use touchline_vision::paint::{
    FindError, FindOptions, GroundPicture, LineCheck, PaintSearchResult, PointSnapOptions,
    SnapError, SnapOptions, Snapped, SnappedPoint, check_lines, find_camera, snap, snap_point,
};

/// The code of a warning that the paint contradicts a camera.
pub const LINE_CHECK: &str = "line_check";

/// The code of a warning that a camera could not be aligned to the paint.
pub const NOT_SNAPPED: &str = "not_snapped";

/// The code of a warning that no camera was found from the paint alone.
pub const NOT_FOUND: &str = "not_found_by_paint";

/// The code of a warning that a camera's lines moved because its base changed.
pub(super) const BASE_MOVED: &str = "base_moved";

/// Why a frame's camera was not aligned to the paint.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SnapFrameError {
    /// The frame has no camera to begin with.
    #[error("it has no camera yet, or its camera has no base: solve it first")]
    Unsolved,
    /// An own k₁ of the frame was requested, but its camera has a lens.
    #[error(
        "its camera has lens distortion, which all its frames share: refine-base --markings estimates it from all of them"
    )]
    HasLens,
    /// A click names a landmark or line that the field lacks.
    #[error(transparent)]
    Observation(#[from] ObservationError),
    /// The paint is not decisive.
    #[error(transparent)]
    Paint(#[from] SnapError),
    /// The aligned camera fits the paint less well than the one before.
    #[error("the painted lines agree better with the camera that it has")]
    Worse,
}

/// Checks a solved frame's camera against the paint of its picture; none without a camera.
pub fn check_frame(
    document: &Document,
    frame: &Frame,
    field: &FieldModel,
    picture: &Picture,
) -> Option<LineCheck> {
    let camera = document.ptz_camera(frame)?;
    Some(check_lines(
        &GroundPicture::new(picture, &document.masks_of(frame)),
        field,
        &camera,
    ))
}

/// Aligns a solved frame's camera to the paint of its picture, with its clicks as further
/// constraints.
///
/// # Errors
/// The frame is not solved, a click names something that the field lacks, or the paint is not
/// decisive.
pub fn snap_frame(
    document: &Document,
    frame: &Frame,
    field: &FieldModel,
    picture: &Picture,
    options: &SnapOptions,
) -> Result<(CameraBase, Snapped), SnapFrameError> {
    let ground = GroundPicture::new(picture, &document.masks_of(frame));
    snap_on_ground(document, frame, field, &ground, options)
}

/// [`snap_frame`] on a prepared picture.
fn snap_on_ground(
    document: &Document,
    frame: &Frame,
    field: &FieldModel,
    ground: &GroundPicture,
    options: &SnapOptions,
) -> Result<(CameraBase, Snapped), SnapFrameError> {
    // On the base of its camera, also where the frame was imported beside that.
    let known = document.camera_of(frame);
    let camera = known
        .and_then(|known| known.ptz_camera_on_base(frame))
        .ok_or(SnapFrameError::Unsolved)?;
    // The lens of a base applies to all frames; a k₁ of one frame would contradict it.
    if options.own_k1 && known.is_some_and(|known| known.curve().is_some()) {
        return Err(SnapFrameError::HasLens);
    }
    // Clicks constrain the alignment where paint is sparse; each is weighted by its σ.
    let clicks = observations(frame, field)?;
    let snapped = snap(ground, field, camera.base(), camera.ptz(), &clicks, options)?;
    let distortion = snapped.own_lens.unwrap_or(camera.base().distortion);
    Ok((
        CameraBase {
            distortion,
            ..*camera.base()
        },
        snapped,
    ))
}

/// Why no camera was found for a frame from its paint alone.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FindFrameError {
    /// The frame's camera has no base.
    #[error("its camera has no base yet: refine the base first")]
    NoBase,
    /// A click names a landmark or line that the field lacks.
    #[error(transparent)]
    Observation(#[from] ObservationError),
    /// The paint is not decisive.
    #[error(transparent)]
    Paint(#[from] FindError),
}

/// Searches a camera for a frame that has none, from the paint of its picture and the clicks that
/// it has. `progress` receives the share that is done, from 0 to 1.
///
/// # Errors
/// The frame's camera has no base, a click names something that the field lacks, the paint is not
/// decisive, or `progress` cancelled it.
pub fn find_frame(
    document: &Document,
    frame: &Frame,
    field: &FieldModel,
    picture: &Picture,
    options: &FindOptions,
    progress: &Progress<'_, f64>,
) -> Result<(CameraBase, PaintSearchResult), FindFrameError> {
    let base = document
        .camera_of(frame)
        .and_then(|camera| camera.base_for(frame))
        .ok_or(FindFrameError::NoBase)?;
    let clicks = observations(frame, field)?;
    let ground = GroundPicture::new(picture, &document.masks_of(frame));
    Ok((
        base,
        find_camera(&ground, field, &base, &clicks, options, progress)?,
    ))
}

/// Why a frame got no camera from its paint.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OnPaintError {
    /// The camera that it has was not aligned.
    #[error(transparent)]
    Snap(#[from] SnapFrameError),
    /// It has no camera, and none was found.
    #[error(transparent)]
    Find(#[from] FindFrameError),
}

/// The camera of a frame from the paint of its picture: aligns the camera that it has
/// ([`snap_frame`]), or, with `from_nothing`, searches for one ([`find_frame`]).
///
/// # Errors
/// Those of [`snap_frame`] or [`find_frame`].
pub fn camera_on_paint(
    document: &Document,
    frame: &Frame,
    field: &FieldModel,
    picture: &Picture,
    (options, from_nothing): (&FindOptions, bool),
    progress: &Progress<'_, f64>,
) -> Result<(CameraBase, Snapped), OnPaintError> {
    if from_nothing {
        let (base, found) = find_frame(document, frame, field, picture, options, progress)?;
        Ok((base, found.snapped))
    } else {
        let ground = GroundPicture::new(picture, &document.masks_of(frame));
        let (base, snapped) = snap_on_ground(document, frame, field, &ground, &options.snap)?;
        // An alignment can end on the wrong lines, so the result must explain the paint at least as
        // well as the camera that the frame has.
        let earlier = document
            .ptz_camera(frame)
            .map(|camera| check_lines(&ground, field, &camera));
        if earlier.is_some_and(|earlier| !may_replace(&earlier, &snapped.check)) {
            return Err(SnapFrameError::Worse.into());
        }
        Ok((base, snapped))
    }
}

/// Writes the result of [`camera_on_paint`] into a frame: the camera, or the reason why there is
/// none.
pub fn record_on_paint(
    frame: &mut Frame,
    found: &Result<(CameraBase, Snapped), OnPaintError>,
    from_nothing: bool,
) {
    match found {
        Ok((base, found)) if from_nothing => record_found_by_paint(frame, base, found),
        Ok((base, snapped)) => record_snapped(frame, base, snapped),
        Err(OnPaintError::Snap(reason)) => record_refusal(frame, reason),
        Err(OnPaintError::Find(reason)) => record_not_found_by_paint(frame, reason),
    }
}

/// Writes a found camera into its frame. A frame that no person has processed becomes a suggestion.
pub fn record_found_by_paint(frame: &mut Frame, base: &CameraBase, found: &Snapped) {
    record_snapped(frame, base, found);
    if frame.status == FrameStatus::New {
        frame.status = FrameStatus::Suggested;
    }
}

/// Those of some clicks of a frame whose landmark is certainly painted nearby: the click's index,
/// and where the landmark is. `camera` may be approximate.
pub fn snap_clicks(
    document: &Document,
    frame: &Frame,
    field: &FieldModel,
    camera: &PtzCamera,
    picture: &Picture,
    clicks: &[usize],
) -> Vec<(usize, SnappedPoint)> {
    let ground = GroundPicture::new(picture, &document.masks_of(frame));
    clicks
        .iter()
        .filter_map(|index| {
            let click = frame.clicks.get(*index)?;
            Some((*index, snap_click(&ground, field, camera, click)?))
        })
        .collect()
}

/// Where the landmark of a click is painted; none for a click on a line, or if it is not certain.
fn snap_click(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
    click: &Click,
) -> Option<SnappedPoint> {
    let Some(Target::Landmark(id)) = &click.target else {
        return None;
    };
    let landmark = field.landmark(id.as_str())?;
    let options = PointSnapOptions::default();
    snap_point(ground, field, camera, landmark, click.image, &options)
}

/// The scores of two cameras that are the same answer differ by at most about this, because paint
/// is localised to half a pixel.
const SCORE_NOISE: f64 = 0.05;

/// Whether a computed camera (tracked, aligned to paint, or proposed by a forest) may replace an
/// earlier one: it must be as probable, within the noise of the score. Both are compared with the
/// same picture, and the new one is checked where its adjustment ended: a check made before an
/// adjustment does not apply to its result.
pub(crate) fn may_replace(earlier: &LineCheck, now: &LineCheck) -> bool {
    now.score >= earlier.score - SCORE_NOISE
}

/// A line check in the document's form; values that are not finite are left out.
pub(crate) fn paint_evidence(check: &LineCheck) -> PaintEvidence {
    PaintEvidence {
        score: check.score,
        predicted: check.predicted,
        found: check.found,
        bare: check.bare,
        // Without any paint found these distances are infinite, which JSON cannot express.
        offset_px: Some(check.offset_px).filter(|offset| offset.is_finite()),
        bias_px: Some(check.bias_px).filter(|bias| bias.is_finite()),
        halves_px: Some(check.halves_px).filter(|halves| halves.is_finite()),
        unexplained: check.unexplained,
        ..PaintEvidence::default()
    }
}

/// Writes an aligned camera into its frame. The status and the warnings from clicks stay.
pub fn record_snapped(frame: &mut Frame, base: &CameraBase, snapped: &Snapped) {
    let camera = PtzCamera::new(*base, snapped.ptz);
    frame.point(snapped.ptz, camera.lens());
    // The fields from clicks stay; uncertainty, residual, confidence and line check are replaced by
    // the alignment's.
    let mut solution = frame.solution.take().unwrap_or_default();
    drop_settled_warnings(&mut solution);
    frame.solution = Some(Solution {
        covariance: Some(snapped.uncertainty.ptz_covariance_deg()),
        own_covariance: Some(snapped.uncertainty.own_covariance_deg()),
        rms_px: Some(snapped.rms_px),
        worst_corner_sigma_px: snapped
            .uncertainty
            .corner_sigma_px_if_known(&camera, frame.image_size),
        source: Some(SolutionSource::Markings),
        confidence: Some(snapped.check.score),
        samples: Some(snapped.samples),
        line_check: Some(paint_evidence(&snapped.check)),
        ..solution
    });
}

/// Writes into a frame why its camera was not aligned to the paint; the camera stays.
fn record_refusal(frame: &mut Frame, reason: &SnapFrameError) {
    warn_once(
        frame,
        NOT_SNAPPED,
        format!("not aligned to the painted lines: {reason}"),
    );
}

/// Writes into a frame why no camera was found for it.
fn record_not_found_by_paint(frame: &mut Frame, reason: &FindFrameError) {
    warn_once(
        frame,
        NOT_FOUND,
        format!("not found by the painted lines: {reason}"),
    );
}

fn warn_once(frame: &mut Frame, code: &str, message: String) {
    replace_warning(frame.solution.get_or_insert_default(), code, Some(message));
}

/// Replaces the warnings with a code by one with this message, or by none.
pub(super) fn replace_warning(solution: &mut Solution, code: &str, message: Option<String>) {
    solution.warnings.retain(|warning| warning.code != code);
    let warning = message.map(|message| SolutionWarning::new(code, message));
    solution.warnings.extend(warning);
}

/// Writes a line check into a frame, with a warning if the paint contradicts its camera.
pub fn record_line_check(frame: &mut Frame, check: &LineCheck) {
    let solution = frame.solution.get_or_insert_default();
    solution.line_check = Some(paint_evidence(check));
    let is_contradicted = check.verdict() == LineVerdict::Contradicts;
    replace_warning(
        solution,
        LINE_CHECK,
        is_contradicted.then(|| against(check)),
    );
}

/// The warning for the user where the paint contradicts a camera.
fn against(check: &LineCheck) -> String {
    format!(
        "the painted lines are not where this camera projects them: paint at {} of {} open places",
        check.found,
        check.num_open()
    )
}

/// Drops the warnings about the camera that an alignment replaces; those about clicks stay.
fn drop_settled_warnings(solution: &mut Solution) {
    use SolutionSource::{Forest, Tracking};
    // All that a forest or tracking says is about its camera, or why it found none. Once clicks
    // have corrected the camera, the warnings are theirs.
    if matches!(solution.source, Some(Forest | Tracking)) && solution.proposed.is_none() {
        solution.warnings.clear();
    }
    let settled = [NOT_SNAPPED, NOT_FOUND, LINE_CHECK, BASE_MOVED];
    solution
        .warnings
        .retain(|warning| !settled.contains(&warning.code.as_str()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::{Mat3, Vec3};
    use touchline_core::solve::Uncertainty;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::testing::new_frame;

    /// The codes of the warnings that are left of these once the frame is aligned to its paint.
    fn codes_after_alignment(source: SolutionSource, codes: &[&str]) -> Vec<String> {
        let base = base_at([0.0, -62.0, 17.0], SIZE);
        let ptz = Ptz::from_degrees(3.0, -12.0, 2600.0);
        let camera = PtzCamera::new(base, ptz);
        let covariance = Mat3::from_diagonal(&Vec3::new(1e-8, 1e-8, 4.0));
        let snapped = Snapped {
            ptz,
            own_lens: None,
            samples: 90,
            rms_px: 0.5,
            halves_px: 0.5,
            uncertainty: Uncertainty::from_covariance(&camera, covariance, SIZE).unwrap(),
            check: LineCheck {
                predicted: 90,
                found: 80,
                bare: 5,
                offset_px: 0.5,
                bias_px: 0.0,
                halves_px: 0.5,
                unexplained: None,
                emptiest: None,
                agreement: 0.9,
                score: 0.97,
            },
        };
        let warnings = codes
            .iter()
            .map(|code| SolutionWarning::new(code, "why".to_owned()));
        let mut frame = new_frame("1.jpg", SIZE);
        frame.solution = Some(Solution {
            source: Some(source),
            warnings: warnings.collect(),
            ..Solution::default()
        });
        record_snapped(&mut frame, &base, &snapped);
        let left = frame.solution.unwrap().warnings.into_iter();
        left.map(|warning| warning.code).collect()
    }

    #[test]
    fn an_alignment_settles_what_was_said_of_the_camera_before_it() {
        assert_eq!(
            codes_after_alignment(SolutionSource::Clicks, &["wrong_line", BASE_MOVED]),
            ["wrong_line"]
        );
        for source in [SolutionSource::Forest, SolutionSource::Tracking] {
            assert_eq!(codes_after_alignment(source, &["coverage"]), [""; 0]);
        }
    }
}
