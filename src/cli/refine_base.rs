//! `touchline refine-base`: estimates the cameras' positions, base rotations and lenses from the
//! clicks of all frames.

use super::Outcome;
use super::export::parse_finite;
use super::solve::{DecidedArg, solve_and_report};
use super::track::{describe_renamed, track_and_report};
use crate::cli::terminal::document::{DocumentArg, DocumentOutput, Loaded};
use crate::cli::terminal::messages::Messages;
use clap::ValueEnum;
use std::collections::BTreeSet;
use std::path::Path;
use touchline_calibration::calibrate::{
    BaseEstimationError, BaseOnPaint, BaseProblem, EstimatedBase, FRAMES_FOR_PAINT,
    describe_mirrored, describe_size, estimate_on_paint, follow_all_bases,
};
use touchline_calibration::pipelines::{TrackingOptions, give_first_base};
use touchline_calibration::proposals::read_picture;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseOptions, CrownModel, HeldOutErrors, LensModel};
use touchline_documents::document::{CameraId, Document, DocumentAt, Frame};
use touchline_vision::media::{CachedReader, FrameReader, KEPT_BYTES, Picture};

/// Camera position, base rotation, lens and the pitch's crown from the clicks of all frames but the
/// rejected ones; every frame is solved with them, statuses stay. A camera that was set by hand,
/// aligned to paint or accepted from another source is not solved again.
#[derive(clap::Args, Debug)]
pub struct RefineBaseArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    output: DocumentOutput,
    /// The lens; auto compares all by cross-validation.
    #[arg(long, value_enum, default_value_t = Distortion::Auto)]
    distortion: Distortion,
    /// How much higher the middle of the pitch is than its touchlines, m; auto finds it where that
    /// is worth it.
    #[arg(long, value_name = "auto|METRES", default_value = "auto", value_parser = crown, allow_negative_numbers = true)]
    crown: Crown,
    /// Whether the principal point is found as well; a prior holds it near the middle where the
    /// frames do not show it.
    #[arg(long, value_name = "true|false", num_args = 0..=1, require_equals = true, default_value_t = true, default_missing_value = "true")]
    principal_point: bool,
    /// Also find the field's length and width, within what the rules allow (unstable with few
    /// frames).
    #[arg(long)]
    field_size: bool,
    /// Also use the painted lines that the frames' pictures show, clicked or only solved, in one
    /// adjustment with the clicks; each frame is then pulled onto its lines.
    #[arg(long)]
    markings: bool,
    #[command(flatten)]
    decided: DecidedArg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Distortion {
    /// Chosen by cross-validation.
    Auto,
    /// A pinhole.
    None,
    /// One k₁ at every focal length.
    K1,
    /// k₁ linear in the focal length.
    K1Focal,
    /// The same with k₂ = 2 k₁², which folds at no focal length.
    K1FocalK2,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Crown {
    Auto,
    Metres(f64),
}

fn crown(text: &str) -> Result<Crown, String> {
    if text == "auto" {
        return Ok(Crown::Auto);
    }
    parse_finite(text)
        .map(Crown::Metres)
        .ok_or_else(|| "auto or a number of metres".to_owned())
}

/// Estimates every camera's base, solves all frames with it and writes the document.
/// [`Outcome::SomeFailed`] if a camera or a frame failed.
///
/// # Errors
/// The document cannot be read, no camera's base can be estimated, or the result cannot be written.
pub fn refine_base(args: &RefineBaseArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let input = &args.document.document;
    let output = args.output.reserve("refine-base", &[input], messages)?;
    let Loaded {
        location,
        mut document,
    } = output.read(input)?;
    messages.name_video_backend(&document);
    // Compared with the result at the end, for the count of edits. `before`, below, has the tracked
    // cameras too, and shows which proposals were made with the old bases.
    let original = document.clone();
    if let Some(noise) = document.click_noise_in_use() {
        messages.note(&noise.describe());
    }
    let options = BaseOptions {
        lens: match args.distortion {
            // None compares the models by cross-validation.
            Distortion::Auto => None,
            Distortion::None => Some(LensModel::Pinhole),
            Distortion::K1 => Some(LensModel::K1),
            Distortion::K1Focal => Some(LensModel::K1Focal),
            Distortion::K1FocalK2 => Some(LensModel::K1FocalK2),
        },
        crown: match args.crown {
            Crown::Auto => None,
            Crown::Metres(metres) => Some(CrownModel::Fixed(metres)),
        },
        principal_point: args.principal_point,
        ..BaseOptions::default()
    };
    let cameras = document.cameras.iter().map(|camera| camera.id.clone());
    let cameras: Vec<CameraId> = cameras.collect();
    // With few known frames, track their clips first: more frames show more lines.
    if args.markings {
        carry_few(
            &mut document,
            location.folder(),
            &cameras,
            &options,
            messages,
        )?;
    }
    // Estimate the base of each camera; one that fails does not stop the others.
    let before = document.clone();
    let mut estimates = Vec::new();
    let mut on_paint = Vec::new();
    let mut errors = Vec::new();
    let mut pictures = Pictures::new(location.folder(), messages);
    for camera in &cameras {
        let document = document.at(location.folder());
        // The estimate from paint is needed twice: for the base, as from clicks alone, and later
        // for the frames that are aligned with it.
        let estimated = if args.markings {
            let found = pictures.estimate(document, camera, &options, args.field_size);
            found.map(|found| {
                let estimate = found.estimated.clone();
                on_paint.push(found);
                estimate
            })
        } else {
            estimate(document, camera, &options, args.field_size).map_err(anyhow::Error::from)
        };
        match estimated {
            Ok(estimate) => estimates.push(estimate),
            Err(error) => errors.push(format!("camera {:?}: {error}", camera.as_str())),
        }
    }
    if estimates.is_empty() {
        anyhow::bail!(if errors.is_empty() {
            "the document has no camera".to_owned()
        } else {
            errors.join("; ")
        });
    }
    messages.notes(&errors);
    // Write the bases and solve all frames with them.
    for estimate in &estimates {
        report(estimate, &document, messages);
        estimate.write_camera(&mut document);
    }
    let counts = solve_and_report(
        &mut document,
        location.folder(),
        (&args.decided).into(),
        messages,
    )?;
    // Align the frames to their painted lines, with the new base.
    for found in &on_paint {
        report_on_paint(found, messages);
        let field = document.field_of_camera(&found.estimated.camera);
        let field = document.at(location.folder()).model_of(field)?;
        let pulled = found.write_frames(&mut document, &before, &field, &mut |frame| {
            pictures.read(frame)
        });
        messages.note(&format!(
            "{}: {} of {} frames pulled onto their painted lines",
            found.estimated.camera.as_str(),
            pulled.on_paint,
            pulled.solved
        ));
    }
    // The angles of a proposal are those in one base. Under another base they point elsewhere.
    let withdrawn = follow_all_bases(&mut document, &before);
    if withdrawn > 0 {
        messages.note(&format!(
            "{} for the base before withdrawn: relocalize or track again",
            pluralise(withdrawn, "proposal")
        ));
    }
    let failed = errors.len() + counts.failed + pictures.unreadable.len();
    for estimate in &estimates {
        // After the frames are solved, for solving writes their warnings again.
        estimate.mark_disputes(&mut document);
    }
    document.count_edits_since(&original);
    output.write(document, location.folder())?;
    messages.note(&format!(
        "{} estimated, {} solved",
        pluralise(estimates.len(), "camera"),
        pluralise(counts.solved, "frame")
    ));
    Ok(Outcome::from_failure(failed > 0))
}

/// Propagates cameras through videos in which fewer than [`FRAMES_FOR_PAINT`] frames are known,
/// after a first estimate of the base from those frames. So few frames show too few lines for the
/// base; the frames of the whole clip show enough.
fn carry_few(
    document: &mut Document,
    folder: &Path,
    cameras: &[CameraId],
    options: &BaseOptions,
    messages: Messages,
) -> anyhow::Result<()> {
    let mut is_any = false;
    for camera in cameras {
        let of_camera = || {
            document
                .frames
                .iter()
                .filter(|frame| frame.camera == *camera)
        };
        // A frame is known if it has a camera or two clicks.
        let known = of_camera()
            .filter(|frame| frame.ptz.is_some() || frame.clicks.len() > 1)
            .count();
        let is_clip = of_camera().any(|frame| frame.video.is_some() || frame.clip.is_some());
        if known == 0 || known >= FRAMES_FOR_PAINT || !is_clip {
            continue;
        }
        // The estimate that follows says why the clicks give no base.
        match give_first_base(document, folder, camera, options) {
            Ok(Some(names)) => messages.note(&describe_renamed(camera, &names)),
            Ok(None) => {}
            Err(_) => continue,
        }
        let known = pluralise(known, "frame");
        messages.note(&format!(
            "{}: only {known} known: tracking the clip first",
            camera.as_str()
        ));
        is_any = true;
    }
    if is_any {
        // All cameras at once: tracking uses every known frame of a clip.
        track_and_report(
            document,
            folder,
            None,
            &TrackingOptions::default(),
            None,
            messages,
        )?;
    }
    Ok(())
}

/// Estimates the base of a camera from clicks; with `size` also the size of its field.
fn estimate(
    document: DocumentAt<'_>,
    camera: &CameraId,
    options: &BaseOptions,
    size: bool,
) -> Result<EstimatedBase, BaseEstimationError> {
    let problem = BaseProblem::from_document(document, camera)?;
    if size {
        problem.estimate_with_size(document, options, &Progress::default())
    } else {
        problem.estimate(&document, options, &Progress::default())
    }
}

/// Reads the pictures of a document's frames. Reports each unreadable frame once.
struct Pictures<'a> {
    folder: &'a Path,
    messages: Messages,
    reader: CachedReader<FrameReader>,
    unreadable: BTreeSet<String>,
}

impl<'a> Pictures<'a> {
    fn new(folder: &'a Path, messages: Messages) -> Self {
        Self {
            folder,
            messages,
            reader: CachedReader::new(FrameReader::new(), KEPT_BYTES),
            unreadable: BTreeSet::new(),
        }
    }

    fn read(&mut self, frame: &Frame) -> Option<Picture> {
        match read_picture(&mut self.reader, frame, self.folder) {
            Ok(picture) => Some(picture),
            Err(error) => {
                let name = frame.name();
                if self.unreadable.insert(name.clone()) {
                    self.messages.frame_failed(&name, &error.to_string());
                }
                None
            }
        }
    }

    /// Estimates the base of a camera from clicks and painted lines.
    fn estimate(
        &mut self,
        document: DocumentAt<'_>,
        camera: &CameraId,
        options: &BaseOptions,
        size: bool,
    ) -> anyhow::Result<BaseOnPaint> {
        let bar = self.messages.progress(1, "Looking at painted lines");
        let found = estimate_on_paint(
            document,
            camera,
            options,
            size,
            &mut |frame| self.read(frame),
            &Progress::default(),
        );
        bar.finish_and_clear();
        Ok(found?)
    }
}

/// Reports the residuals of clicks and paint, with the new base and the one before.
fn report_on_paint(found: &BaseOnPaint, messages: Messages) {
    let (name, seen) = (found.estimated.camera.as_str(), &found.seen);
    messages.note(&format!(
        "{name}: painted lines: {} on {} in {}",
        pluralise(seen.places, "place"),
        pluralise(seen.lines, "line"),
        pluralise(seen.frames, "frame")
    ));
    for (what, before, after) in [
        ("paint", seen.before.paint, seen.after.paint),
        ("clicks", seen.before.clicks, seen.after.clicks),
    ] {
        messages.note(&format!(
            "{name}: {what} held out: {}; before {}",
            describe_errors(after),
            describe_errors(before)
        ));
    }
}

fn describe_errors(errors: Option<HeldOutErrors>) -> String {
    errors.map_or_else(
        || "none".to_owned(),
        |HeldOutErrors {
             median_px, p90_px, ..
         }| format!("{median_px:.2} px, 90 % {p90_px:.2} px"),
    )
}

/// Reports the base, the models that were compared, and clicks that disagree.
fn report(estimated: &EstimatedBase, document: &Document, messages: Messages) {
    let found = &estimated.estimate;
    let name = estimated.camera.as_str();
    let (at, sigma, angles) = (
        found.base.position_m,
        found.base.sigma.position_m,
        found.base.angles(),
    );
    messages.note(&format!(
        "{name}: position ({:.2}, {:.2}, {:.2}) ± ({:.2}, {:.2}, {:.2}) m, pitch {:.2}, roll {:.2}",
        at.x, at.y, at.z, sigma.x, sigma.y, sigma.z, angles.pitch, angles.roll
    ));
    for score in &found.scores {
        let chosen = if score.model == found.model {
            " (chosen)"
        } else {
            ""
        };
        messages.note(&format!(
            "{name}: {}: {:.2} px cross-validated, 90 % {:.2} px{chosen}",
            score.model, score.median_px, score.p90_px
        ));
    }
    messages.note(&format!("{name}: {}: {}", found.model, found.reason));
    if let Some(frame) = &found.one_more_frame {
        messages.note(&format!("{name}: {frame}"));
    }
    let before = found
        .previous_median_px
        .map_or_else(String::new, |before| format!(", {before:.2} px before"));
    // A base from paint alone has no error at clicks.
    let clicks = if found.median_px.is_finite() {
        format!(
            "all clicks {:.2} px, 90 % {:.2} px{before}; ",
            found.median_px, found.p90_px
        )
    } else {
        String::new()
    };
    messages.note(&format!("{name}: {clicks}crown {:.2} m", found.crown_m));
    for size in &estimated.sizes {
        messages.note(&format!("{name}: field {}", describe_size(size)));
    }
    if let Some(reason) = found.one_view() {
        messages.note(&format!("{name}: {reason}"));
    }
    if let Some(aspect) = &found.pixel_aspect {
        messages.note(&format!("{name}: {aspect}"));
    }
    for click in &found.disputed {
        let error = click.error_px.map_or_else(
            || "behind the camera".to_owned(),
            |error| format!("{error:.0} px off"),
        );
        let better = click
            .fits_better
            .as_ref()
            .map_or_else(String::new, |(id, _)| format!(", {id} would fit"));
        messages.note(&format!(
            "{}: point {} is {error}{better}",
            document.frames[click.frame].name(),
            click.click + 1
        ));
    }
    for frame in &found.mirrored {
        let words = describe_mirrored(frame);
        messages.note(&format!(
            "{}: the names look mirrored: {words}",
            document.frames[frame.frame].name()
        ));
    }
}
