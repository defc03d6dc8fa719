//! How much each feature of the program saves an annotator: one synthetic clip, labelled in five
//! ways by a simulated annotator. Each way is scored by the clicks that it needs and by the errors
//! that remain.

mod clip;
mod ways;

use crate::progress::{Progress, step_counter};
use crate::report::Report;
use crate::{ExperimentError, ExperimentOptions};
pub use clip::corners_apart_px;
use clip::{CLICK_SIGMA_PX, DrawnClip, frame_count};
use std::path::Path;
use std::time::Instant;
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::document::{Frame, FramePtz};
use touchline::geometry::Vec3;
use touchline::geometry::quantile;
use touchline::report::{Cell, Table};
use touchline::score::{SigmaCoverage, squared_mahalanobis};
use ways::{Labelled, Outcome, click_and_track, forest, no_click, two_clicks};

/// A camera is wrong if its overlay is off by more than this at a corner, px at 1920 px width.
const WRONG_PX: f64 = 10.0;

/// Wrong cameras with at least this confidence are counted separately.
const CERTAIN: f64 = 0.95;

/// The name of a way of labelling, and the function that labels with it.
type Way<'a> = (&'a str, &'a dyn Fn() -> Result<Outcome, ExperimentError>);

/// Labels a synthetic clip in five ways. `motion` is the folder with the published motion of a real
/// camera, if it is given.
///
/// # Errors
/// The motion cannot be read, or the pictures cannot be drawn.
pub fn run(
    options: &ExperimentOptions,
    motion: Option<&Path>,
    progress: Progress<'_>,
) -> Result<Report, ExperimentError> {
    // Drawn once: all ways label the same pictures, with the same noise of the clicks.
    let clip = DrawnClip::draw(
        options,
        motion,
        &step_counter(frame_count(options), progress),
    )?;
    let mut report = Report::new("annotator", "What each step is worth to the annotator");
    report.text(&format!(
        "{} frames of 1280 × 720 px, 25 a second, along {}, drawn with the preset `hard`, with a score bug that no mask covers. A simulated \
         annotator clicks landmarks with an error of {CLICK_SIGMA_PX} px (1-σ, each axis) and looks at a frame again where the program states \
         that its overlay may be off by more than 3 px at a corner. The field's size is known, and everywhere but in the last row the camera's base. \
         Errors are distances at the four corners of the picture; wrong is a frame with a corner off by more than {WRONG_PX} px at 1920 px width.",
        clip.truth.len(),
        clip.motion,
    ));
    let mut table = Table::new(&[
        ("way", "way of labelling"),
        ("clicked", "frames clicked of 100"),
        ("clicks", "clicks"),
        ("answered", "frames with a camera"),
        ("corner_median_px", "corners off, median (px)"),
        ("corner_90_px", "90 % (px)"),
        ("corner_99_px", "99 % (px)"),
        ("within_68", "within the stated 68 %"),
        ("error_over_sigma", "error over σ"),
        ("wrong", "wrong"),
        ("certain_and_wrong", "wrong at .95 or more"),
    ]);
    let mut frames = Table::new(&[
        ("way", "way of labelling"),
        ("frame", "frame"),
        ("clicked", "clicked"),
        ("worst_corner_px", "worst corner off (px)"),
        ("sigma_px", "stated, 1-σ (px)"),
        ("confidence", "confidence"),
    ]);
    let mut times = Table::new(&[("way", "way of labelling"), ("seconds", "s")]);
    // The ways of labelling, from two clicks on each frame to no click at all.
    let ways: [Way<'_>; 5] = [
        ("two clicks on every frame", &|| Ok(Ok(two_clicks(&clip)))),
        ("forest", &|| forest(&clip, false).map(Ok)),
        ("forest, aligned to the paint", &|| {
            forest(&clip, true).map(Ok)
        }),
        ("tracked through the clip", &|| {
            click_and_track(&clip).map(Ok)
        }),
        ("no click: base found, then tracked", &|| no_click(&clip)),
    ];
    let mut refusals = Vec::new();
    for (name, way) in ways {
        // Times depend on the machine and go to the file for times, apart from what repeats.
        let begun = Instant::now();
        let labelled = way()?;
        times.push(vec![
            name.into(),
            Cell::Number(begun.elapsed().as_secs_f64()),
        ]);
        // A way may abstain. Then its row is empty, and the reason follows below the table.
        let mut row = match labelled {
            Ok(labelled) => {
                let answers = answers(&clip, &labelled);
                add_frames(&mut frames, name, &answers);
                row(name, &clip, &labelled, &answers)
            }
            Err(why) => {
                refusals.push(format!("No answer for \"{name}\": {why}."));
                vec![
                    name.into(),
                    Cell::Number(0.0),
                    Cell::Count(0),
                    Cell::Count(0),
                ]
            }
        };
        // A row without an answer has no errors to state.
        row.resize(table.columns.len(), Cell::Empty);
        table.push(row);
    }
    report.table("ways", "One clip, labelled in five ways.", table);
    for refusal in refusals {
        report.text(&refusal);
    }
    report.data(
        "frames",
        "Every frame with a camera, by way of labelling.",
        frames,
    );
    report.time_table("times", "How long the program worked.", times);
    Ok(report)
}

/// The result of one frame.
struct FrameAccuracy {
    frame: usize,
    is_clicked: bool,
    /// Errors of the overlay at the four corners, px.
    corners: [f64; 4],
    is_wrong: bool,
    confidence: Option<f64>,
    /// The stated 1-σ of the overlay at the worst corner, px.
    sigma_px: Option<f64>,
    /// The squared error in stated sigmas; none if the base is an estimate, because the stated
    /// covariance then refers to another base.
    squared_sigmas: Option<f64>,
}

/// Compares the cameras of a labelled clip with the true ones. Frames without a camera are left
/// out.
fn answers(clip: &DrawnClip, labelled: &Labelled) -> Vec<FrameAccuracy> {
    let each = labelled.document.frames.iter().zip(&clip.truth).enumerate();
    each.filter_map(|(at, (frame, truth))| {
        let ptz = frame.ptz.as_ref().map(FramePtz::ptz)?;
        // If the base was estimated, pan and tilt are not comparable with the true ones. Errors in
        // the picture are.
        let base = labelled
            .document
            .camera_of(frame)
            .and_then(|camera| camera.base_for(frame));
        let corners = corners_apart_px(
            truth,
            &PtzCamera::new(base.unwrap_or(*truth.base()), ptz),
            frame.image_size,
        );
        // The limit is stated at 1920 px width, the corners are in px of the frame.
        let worst = corners.iter().copied().fold(0.0, f64::max);
        let solution = frame.solution.as_ref();
        Some(FrameAccuracy {
            frame: at,
            is_clicked: labelled.clicked.contains(&at),
            corners,
            is_wrong: worst > WRONG_PX * frame.image_size.scale_from_1920(),
            confidence: solution.and_then(|solution| solution.confidence),
            sigma_px: solution.and_then(|solution| solution.worst_corner_sigma_px),
            squared_sigmas: base
                .is_some_and(|base| is_same_base(&base, truth.base()))
                .then(|| in_sigmas(frame, ptz, truth.ptz()))
                .flatten(),
        })
    })
    .collect()
}

/// Whether two bases differ by rounding alone: a document orthogonalises rotations and keeps angles
/// in degrees, so that its base may differ from the true one in the last digits.
fn is_same_base(one: &CameraBase, other: &CameraBase) -> bool {
    /// In m, in px, and as a share of 1: far below what an estimate of a base reaches.
    const ROUNDING: f64 = 1e-9;
    // Lenses are functions of the focal length, and are compared at two of them.
    let is_same_lens = [1000.0, 5000.0].into_iter().all(|focal_px| {
        let apart = one.distortion.at(focal_px) - other.distortion.at(focal_px);
        apart.abs() <= ROUNDING
    });
    is_same_lens
        && (one.position_m - other.position_m).amax() <= ROUNDING
        && (one.base_from_world - other.base_from_world).amax() <= ROUNDING
        && one.principal_point.distance_px(other.principal_point) <= ROUNDING
}

/// A row of the table: clicks, corner errors, coverage of the stated sigmas, wrong cameras.
fn row(name: &str, clip: &DrawnClip, labelled: &Labelled, answers: &[FrameAccuracy]) -> Vec<Cell> {
    let wrong = || answers.iter().filter(|answer| answer.is_wrong);
    let certain = wrong()
        .filter(|answer| {
            answer
                .confidence
                .is_some_and(|confidence| confidence >= CERTAIN)
        })
        .count();
    let sigmas: Vec<f64> = answers
        .iter()
        .filter_map(|answer| answer.squared_sigmas)
        .collect();
    let mut corners: Vec<f64> = answers.iter().flat_map(|answer| answer.corners).collect();
    // All four corners of all frames together; `quantile` wants them in ascending order.
    corners.sort_by(f64::total_cmp);
    let mut cells = vec![
        name.into(),
        Cell::Number(100.0 * labelled.clicked.len() as f64 / clip.truth.len() as f64),
        labelled.clicks.into(),
        answers.len().into(),
    ];
    cells.extend([0.5, 0.9, 0.99].map(|share| Cell::Number(quantile(&corners, share))));
    match SigmaCoverage::from_squared_distances(&sigmas) {
        Some(coverage) => {
            cells.extend([coverage.within_68, coverage.error_over_sigma].map(Cell::Number));
        }
        None => cells.extend([Cell::Empty, Cell::Empty]),
    }
    cells.extend([wrong().count().into(), certain.into()]);
    cells
}

/// Adds a row for each frame with a camera.
fn add_frames(table: &mut Table, name: &str, answers: &[FrameAccuracy]) {
    for answer in answers {
        let worst = answer.corners.iter().copied().fold(0.0, f64::max);
        table.push(vec![
            name.into(),
            answer.frame.into(),
            usize::from(answer.is_clicked).into(),
            Cell::Number(worst),
            answer.sigma_px.into(),
            answer.confidence.into(),
        ]);
    }
}

/// The squared error (Mahalanobis) of a frame's pan, tilt and focal length, by its stated
/// covariance.
fn in_sigmas(frame: &Frame, ptz: Ptz, truth: Ptz) -> Option<f64> {
    // The covariance is that of pan (deg), tilt (deg) and focal length (px), so that the error has
    // these units. Pan is subtracted as an angle, for it wraps.
    let covariance = frame.solution.as_ref()?.covariance?;
    let error = Vec3::new(
        ptz.pan.turn_from(truth.pan).degrees(),
        (ptz.tilt - truth.tilt).degrees(),
        ptz.focal_px - truth.focal_px,
    );
    squared_mahalanobis(error, &covariance)
}

#[cfg(test)]
mod tests {
    use super::is_same_base;
    use crate::setting;

    #[test]
    fn a_base_is_the_same_after_rounding_and_another_where_it_is_estimated() {
        let base = setting::base();
        let (mut rounded, mut estimated) = (base, base);
        rounded.base_from_world[(0, 0)] += 1e-15;
        rounded.position_m.x += 1e-13;
        estimated.position_m.x += 1e-4;
        assert_ne!(rounded, base);
        assert!(is_same_base(&rounded, &base));
        assert!(!is_same_base(&estimated, &base));
    }
}
