//! What each step of the program is worth to the person who labels: one drawn clip, labelled in several ways by a simulated
//! annotator.

mod clip;
mod ways;

use super::progress::{Progress, counted};
use super::{ExperimentError, ExperimentOptions};
use crate::camera::{Ptz, PtzCamera};
use crate::document::{Frame, FramePtz};
use crate::geometry::Vec3;
use crate::report::{Cell, Report, Table};
use crate::score::{SigmaCoverage, quantile, squared_sigmas};
use clip::{CLICK_SIGMA_PX, DrawnClip, corners_apart_px, frame_count};
use std::path::Path;
use std::time::Instant;
use ways::{Labelled, carried, forest, no_click, two_clicks};

/// A camera whose picture is off by more at a corner is wrong, px at 1920 px width.
const WRONG_PX: f64 = 10.0;

/// Wrong cameras that state at least this confidence are certain and wrong.
const CERTAIN: f64 = 0.95;

/// A way of labelling by its name; nothing comes of it where the program does not dare to answer.
type Way<'a> = (&'a str, &'a dyn Fn() -> Result<Option<Labelled>, ExperimentError>);

/// Labels a drawn clip in several ways; `motion` is the folder with the published motion of a real camera.
///
/// # Errors
/// The motion cannot be read, or the pictures cannot be drawn.
pub fn run(
    options: &ExperimentOptions,
    motion: Option<&Path>,
    progress: Progress<'_>,
) -> Result<Report, ExperimentError> {
    let clip = DrawnClip::drawn(options, motion, &counted(frame_count(options), progress))?;
    let mut report = Report::new("annotator", "What each step is worth to the annotator");
    report.text(&format!(
        "{} frames of 1280 × 720 px, 25 a second, along {}, drawn with the preset `hard`, with a score bug that no mask covers. A simulated \
         annotator clicks landmarks with an error of {CLICK_SIGMA_PX} px (1-σ, each axis) and looks at a frame again where the program states \
         that its overlay may be off by more than 3 px at a corner. Everywhere but in the last row the camera's base is known. \
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
    let mut times = Table::new(&[("way", "way of labelling"), ("seconds", "s")]);
    let ways: [Way<'_>; 5] = [
        ("two clicks on every frame", &|| Ok(Some(two_clicks(&clip)))),
        ("forest", &|| forest(&clip, false).map(Some)),
        ("forest, snapped to the paint", &|| forest(&clip, true).map(Some)),
        ("carried through the clip", &|| carried(&clip, Labelled::nothing(&clip)).map(Some)),
        ("no click: base found, then carried", &|| no_click(&clip)),
    ];
    for (name, way) in ways {
        let begun = Instant::now();
        let labelled = way()?;
        times.push(vec![name.into(), Cell::Number(begun.elapsed().as_secs_f64())]);
        let nothing = || vec![name.into(), Cell::Number(0.0), Cell::Count(0), Cell::Count(0)];
        let mut row = labelled.map_or_else(nothing, |labelled| row(name, &clip, &labelled));
        row.resize(table.columns.len(), Cell::Empty);
        table.push(row);
    }
    report.table("ways", "One clip, labelled in five ways.", table);
    report.time_table("times", "How long the program worked.", times);
    Ok(report)
}

fn row(name: &str, clip: &DrawnClip, labelled: &Labelled) -> Vec<Cell> {
    let (mut corners, mut sigmas) = (Vec::new(), Vec::new());
    let [mut answered, mut wrong, mut certain] = [0; 3];
    for (frame, truth) in labelled.document.frames.iter().zip(&clip.truth) {
        let Some(ptz) = frame.ptz.as_ref().map(FramePtz::ptz) else { continue };
        answered += 1;
        // A base that was found is not the true one; what counts is where the picture is.
        let base = labelled.document.camera_of(frame).and_then(|camera| camera.base_for(frame));
        let apart = corners_apart_px(truth, &PtzCamera::new(base.unwrap_or(*truth.base()), ptz), frame.image_size);
        let worst = apart.iter().copied().fold(0.0, f64::max);
        let is_wrong = worst > WRONG_PX * frame.image_size.scale_from_1920();
        wrong += usize::from(is_wrong);
        let confidence = frame.solution.as_ref().and_then(|solution| solution.confidence);
        certain += usize::from(is_wrong && confidence.is_some_and(|confidence| confidence >= CERTAIN));
        corners.extend(apart);
        if base == Some(*truth.base()) {
            sigmas.extend(in_sigmas(frame, ptz, truth.ptz()));
        }
    }
    corners.sort_by(f64::total_cmp);
    let mut cells = vec![
        name.into(),
        Cell::Number(100.0 * labelled.clicked.len() as f64 / clip.truth.len() as f64),
        labelled.clicks.into(),
        answered.into(),
    ];
    cells.extend([0.5, 0.9, 0.99].map(|share| Cell::Number(quantile(&corners, share))));
    match SigmaCoverage::of(&sigmas) {
        Some(coverage) => cells.extend([coverage.within_68, coverage.error_over_sigma].map(Cell::Number)),
        None => cells.extend([Cell::Empty, Cell::Empty]),
    }
    cells.extend([wrong.into(), certain.into()]);
    cells
}

/// The square of a frame's error in its stated sigmas.
fn in_sigmas(frame: &Frame, ptz: Ptz, truth: Ptz) -> Option<f64> {
    let covariance = frame.solution.as_ref()?.covariance?;
    let error = Vec3::new(
        ptz.pan.turn_from(truth.pan).degrees(),
        (ptz.tilt - truth.tilt).degrees(),
        ptz.focal_px - truth.focal_px,
    );
    squared_sigmas(error, &covariance)
}
