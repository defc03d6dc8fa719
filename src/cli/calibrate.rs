//! `touchline calibrate`: makes a project with its camera from frames alone.

use super::Outcome;
use super::match_report::MatchReport;
use super::new::{parameter, read_field};
use super::shot_sheets::write_sheets;
use super::shot_table::{describe_shots, is_every_field_answered};
use super::venue::read_venues;
use crate::cli::terminal::document::{
    Destination, DocumentOutput, Loaded, is_document, refuse_unwritable,
};
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{
    encode_png, refuse_existing, refuse_existing_file, refuse_file, refuse_other_than_png,
    write_file,
};
use anyhow::{Context as _, bail, ensure};
use image::{DynamicImage, RgbaImage};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_application::scene::paint_map::{PaintMapFrame, PaintMapScene, paint_map_picture};
use touchline_calibration::calibrate::AutocalibratedCamera;
use touchline_calibration::pipelines::{
    LabelledMatch, MatchEvent, MatchLabels, MatchOptions, label_match,
};
use touchline_calibration::proposals::{WORK_FOLDER, WorkFolder};
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, document_from_frames};
use touchline_documents::store::PROJECT_FILE;
use touchline_vision::media::{CachedReader, FrameReader, FrameSource, KEPT_BYTES};

/// Makes a project from a folder of images or a video and finds its camera without a click: where
/// it stands, its lens, and each frame's pan, tilt and focal length, as suggestions. The frames
/// that were not looked at follow from those that were.
///
/// Where no answer is certain, the message names a frame and the number of landmarks to click in
/// it, and the project is made without a camera; with these clicks it is taken in place of the
/// images or the video.
///
/// Finished parts of the work are kept in the project's folder `.touchline/work`, by the content of
/// the video and the settings: after Ctrl-C or a crash the same command goes on from there, and
/// with another setting only what depends on it is done again. The folder may be deleted.
#[derive(clap::Args, Debug)]
pub struct CalibrateArgs {
    /// The folder of images, the video, or a document whose camera has no base yet.
    #[arg(value_name = "FRAMES_OR_VIDEO")]
    pub(super) frames: PathBuf,
    /// The project's folder; made if absent.
    #[arg(short, long, value_name = "PROJECT")]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) labelling: LabellingArgs,
    /// Also write a picture of what was found, over pan and tilt: the paint that stays in place
    /// while the camera pans, and the field's lines as the base projects them. Where the two
    /// coincide, the base is right.
    #[arg(long, value_name = "FILE.png")]
    pub(super) panorama: Option<PathBuf>,
    /// Also write contact sheets into this folder: a page with one row a shot, with its camera,
    /// what it shows, how many of its frames are right, and six of them with the field's lines.
    #[arg(long, value_name = "DIR")]
    pub(super) report: Option<PathBuf>,
    /// Make the project although the folder holds something; a project in it is kept as
    /// project.json.bak.
    #[arg(long)]
    pub(super) force: bool,
}

/// How a match is labelled without a click.
#[derive(clap::Args, Clone, Debug)]
pub struct LabellingArgs {
    /// The field's template, or a template file (`touchline fields` lists the templates); soccer by
    /// default.
    #[arg(long, value_name = "TEMPLATE")]
    pub(super) field: Option<String>,
    /// A parameter of the field, such as `length_m=105`; may be given several times. The field's
    /// size is then taken as known; else length and width are fitted where the usual size does not
    /// explain the paint.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = parameter)]
    pub(super) set: Vec<(String, f64)>,
    /// The camera is found from this many frames at most, spread over all of them.
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u32).range(3..=300))]
    look_at: u32,
    /// Answer only the frames that are looked at. Otherwise a video's other frames are tracked from
    /// them, and a forest that learns from them finds the cameras of other images.
    #[arg(long)]
    found_only: bool,
    /// A venue file, or a folder of venue files (`touchline venue` writes them); may be given
    /// several times. Its cameras are tried first, and a search follows where none of them took
    /// the frames: features have to recognise these, and their painted lines to confirm it.
    #[arg(long, value_name = "VENUE")]
    venue: Vec<PathBuf>,
}

/// How the labelling of a match ended, if it did not fail.
pub(super) enum Labelling {
    /// As this outcome says.
    Ended(Outcome),
    /// No camera was found, which a message has said: the reason.
    NoCamera(String),
}

/// Makes the project, finds its camera, labels its frames and writes it. [`Outcome::SomeFailed`] if
/// no camera was found, an image cannot be read, or a frame of a field has no camera;
/// [`Outcome::Stopped`] after Ctrl-C, when the cameras found until then are written.
///
/// # Errors
/// The folder exists, the field is invalid, the frames cannot be read, or the result cannot be
/// written.
pub fn calibrate(args: &CalibrateArgs, messages: Messages) -> anyhow::Result<Outcome> {
    Ok(match label(args, messages)? {
        Labelling::Ended(outcome) => outcome,
        // Input and usage are right, so that the exit code is 1.
        Labelling::NoCamera(_) => Outcome::SomeFailed,
    })
}

/// Does what [`calibrate`] does, and says why no camera was found.
///
/// # Errors
/// Those of [`calibrate`].
pub(super) fn label(args: &CalibrateArgs, messages: Messages) -> anyhow::Result<Labelling> {
    // Check the output paths and the field before the long work begins.
    refuse_file(&args.output, "the project")?;
    let output = DocumentOutput {
        output: Some(args.output.clone()),
        force: args.force,
    };
    let output = output.reserve("calibrate", &[&args.frames], messages)?;
    if let Some(panorama) = &args.panorama {
        refuse_other_than_png("--panorama", panorama)?;
        refuse_existing_file(panorama, args.force)?;
    }
    if let Some(report) = &args.report {
        refuse_file(report, "the contact sheets")?;
        refuse_existing(report, args.force)?;
    }
    let venues = read_venues(&args.labelling.venue)?;
    // The document names its frames relative to the project's folder, which therefore must exist.
    // Its links are resolved: `..` in such a name goes up from where a link leads.
    let new_folder = NewFolder::make(&args.output)?;
    let folder = args.output.canonicalize()?;
    let (mut document, are_all_read) = if is_document(&args.frames) {
        (read_document(args, &folder, &output)?, true)
    } else {
        document_of_frames(args, &folder, messages)?
    };
    refuse_unwritable(&document, &folder)?;
    messages.name_video_backend(&document);
    // `read_document` refuses a second camera. Images of another size than the first one's have
    // one, and count as frames without an answer.
    let first = document.frames.first();
    let camera = first.context("not one image can be read")?.camera.clone();
    let options = MatchOptions {
        sampled_frames: args.labelling.look_at as usize,
        label_the_rest: !args.labelling.found_only,
        find_shots: true,
        work: Some(WorkFolder::beside(&folder.join(PROJECT_FILE))),
        venues,
    };
    let report = MatchReport::new(messages);
    let interrupt = Interrupt::listen();
    let progress = Progress::new(|event| {
        if let MatchEvent::Found { document, .. } | MatchEvent::Joined { document, .. } = &event
            && let Err(error) = output.write_draft(document, &folder)
        {
            messages.note(&format!("the project cannot be written yet: {error:#}"));
        }
        report.on_event(event);
        interrupt.check()
    });
    // Find the camera and label the frames.
    let mut reader = CachedReader::new(FrameReader::new(), KEPT_BYTES);
    let labels = label_match(
        &mut document,
        &folder,
        &camera,
        &mut reader,
        &options,
        &progress,
    );
    drop(progress);
    drop(report);
    if labels.is_err() && interrupt.is_pressed() {
        messages.note(
            "stopped; no camera was found yet, and no project was written; the same command goes \
             on from here",
        );
        return Ok(Labelling::Ended(Outcome::Stopped));
    }
    let labelled = match labels? {
        MatchLabels::Labelled(labelled) => labelled,
        MatchLabels::NoCamera(why) => {
            let text = why.describe(&document);
            messages.error(&format!("{}: {text}", args.frames.display()));
            // The clicks are made in a project, which has no camera yet. Where clicks do not help,
            // `new_folder` is removed, if this run made it.
            if why.asks_for_clicks() {
                output.write(document, &folder)?;
                new_folder.keep();
                let project = args.output.display();
                messages.note(&format!(
                    "{project}: the frames without a camera, to click in: touchline {project}; then touchline \
                     calibrate {project} -o {project} --force"
                ));
            } else {
                new_folder.clear();
            }
            return Ok(Labelling::NoCamera(text));
        }
    };
    // Write the project and the panoramas.
    let all = &labelled.cameras;
    output.write(document.clone(), &folder)?;
    new_folder.keep();
    let project = folder.join(PROJECT_FILE);
    let frames = pluralise(document.frames.len(), "frame");
    if all.is_empty() {
        messages.note(&format!("{}: {frames}", project.display()));
    } else {
        messages.note(&format!(
            "{}: {frames}, {} with a suggested camera, {} of them aligned to the painted lines",
            project.display(),
            all.iter().map(|found| found.frames.len()).sum::<usize>(),
            all.iter()
                .map(|found| found.aligned_frame_count())
                .sum::<usize>(),
        ));
    }
    let LabelledMatch {
        answered,
        unanswered,
        is_stopped,
        ..
    } = labelled;
    for line in describe_shots(&document) {
        messages.note(&line);
    }
    for line in describe_different_fields(all) {
        messages.note(&line);
    }
    if let Some(report) = &args.report {
        write_sheets(&document, &folder, &mut reader, report, args.force)?;
    }
    if is_stopped {
        messages.note(
            "stopped: what was found until then is written; the same command with --force goes on \
             from here",
        );
        return Ok(Labelling::Ended(Outcome::Stopped));
    }
    if !args.labelling.found_only && (answered, unanswered) != (0, 0) {
        messages.note(&format!(
            "of the other frames {answered} got a suggested camera, {unanswered} none"
        ));
    }
    if let Some(panorama) = &args.panorama {
        if all.is_empty() {
            messages.note("clicks gave the camera without a search, so there is no panorama");
        }
        for (number, found) in all.iter().enumerate() {
            write_file(
                &panorama_path(panorama, number),
                &panorama_png(&document, found)?,
                args.force,
            )?;
        }
    }
    // With --found-only the other frames are left out on purpose, which is no failure; nor is a
    // close-up without a camera.
    let is_whole =
        args.labelling.found_only || unanswered == 0 || is_every_field_answered(&document);
    let has_failed = !(are_all_read && is_whole);
    Ok(Labelling::Ended(Outcome::from_failure(has_failed)))
}

/// What to say of cameras of which one measures a length of the field that another contradicts:
/// they are of two stadiums, or one of them is wrong.
fn describe_different_fields(cameras: &[Arc<AutocalibratedCamera>]) -> Vec<String> {
    /// Measured lengths that are farther apart than this many 1-σ are of two fields.
    const DIFFERENT_SIGMAS: f64 = 3.0;
    let mut lines = Vec::new();
    for (number, camera) in cameras.iter().enumerate() {
        for (before, other) in cameras[..number].iter().enumerate() {
            let measured = |camera: &AutocalibratedCamera| {
                let sizes = camera.sizes.iter().filter(|size| !size.is_open);
                sizes.cloned().collect::<Vec<_>>()
            };
            for size in measured(camera) {
                let of_other = measured(other).into_iter().find(|it| it.name == size.name);
                let Some(of_other) = of_other else { continue };
                let apart_m = (size.value_m - of_other.value_m).abs();
                let sigma_m = size.error.sigma_m.hypot(of_other.error.sigma_m);
                if apart_m > DIFFERENT_SIGMAS * sigma_m {
                    lines.push(format!(
                        "cameras {} and {}: their fields differ, {} {:.2} ± {:.2} m and {:.2} ± {:.2} m; \
                         they stand in two stadiums, or one of them is wrong",
                        before + 1,
                        number + 1,
                        size.name.trim_end_matches("_m"),
                        of_other.value_m,
                        of_other.error.sigma_m,
                        size.value_m,
                        size.error.sigma_m
                    ));
                }
            }
        }
    }
    lines
}

/// A document that a person clicked in, with its paths as seen from the new project's folder.
fn read_document(
    args: &CalibrateArgs,
    folder: &Path,
    output: &Destination,
) -> anyhow::Result<Document> {
    ensure!(
        args.labelling.field.is_none() && args.labelling.set.is_empty(),
        "{}: a document states its field; leave out --field and --set",
        args.frames.display()
    );
    let Loaded { location, document } = output.read(&args.frames)?;
    let with_base = document
        .cameras
        .iter()
        .find(|camera| camera.base().is_some());
    // This command begins without a base. One that is known is a better start.
    if let Some(camera) = with_base {
        bail!(
            "{}: camera {} has a base already; refine-base --markings improves it",
            args.frames.display(),
            camera.id.as_str()
        );
    }
    let cameras = document.used_cameras().len();
    ensure!(
        cameras == 1,
        "{}: its frames are of {cameras} cameras; give a document with one",
        args.frames.display()
    );
    Ok(document.relocate(location.folder(), folder))
}

/// A new document of a video or of the images in a folder, and whether all images could be read.
fn document_of_frames(
    args: &CalibrateArgs,
    folder: &Path,
    messages: Messages,
) -> anyhow::Result<(Document, bool)> {
    let template = args.labelling.field.as_deref().unwrap_or("soccer");
    let field = read_field(template, &args.labelling.set)?;
    let source = FrameSource::open(&args.frames)?;
    messages.notes(source.notices());
    ensure!(
        !source.is_empty(),
        "{} holds no image",
        args.frames.display()
    );
    let made = document_from_frames(
        &source,
        folder,
        field,
        NonZeroUsize::MIN,
        &Progress::default(),
    );
    messages.frames_failed(made.left_out.iter().map(|(name, error)| (name, error)));
    Ok((made.document, made.left_out.is_empty()))
}

/// The file for the panorama of a camera: as named for the first one, with a number for others.
fn panorama_path(panorama: &Path, number: usize) -> PathBuf {
    if number == 0 {
        return panorama.to_path_buf();
    }
    let stem = panorama.file_stem().unwrap_or_default().to_string_lossy();
    panorama.with_file_name(format!("{stem}_{}.png", number + 1))
}

/// The panorama of a camera, with paint and lines, as PNG.
fn panorama_png(document: &Document, found: &AutocalibratedCamera) -> anyhow::Result<Vec<u8>> {
    let frames: Vec<_> = found
        .frames
        .iter()
        .map(|frame| (frame.ptz, document.frames[frame.index].image_size))
        .collect();
    let scene = PaintMapScene {
        base: &found.base,
        field: Some(&found.field),
        frames: &frames,
        paint: &found.paint,
    };
    let picture =
        PaintMapFrame::from_scene(&scene).and_then(|frame| paint_map_picture(&scene, &frame));
    let picture = picture.context("there is no frame for a panorama")?;
    let size = picture.size();
    let image = RgbaImage::from_raw(size.width, size.height, picture.rgba().to_vec());
    let image = image.context("a panorama without pixels")?;
    encode_png(DynamicImage::from(image).into_rgb8())
}

/// The project's folder, which must exist while frames are read because they are named relative to
/// it. A folder that was created and got no project is removed.
struct NewFolder(Option<PathBuf>);

impl NewFolder {
    fn make(folder: &Path) -> anyhow::Result<Self> {
        let made = !folder.exists();
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make {}", folder.display()))?;
        Ok(Self(made.then(|| folder.to_path_buf())))
    }

    fn keep(mut self) {
        self.0 = None;
    }
}

impl NewFolder {
    /// Removes the kept work from a new folder, so that nothing stays where there is no project.
    fn clear(self) {
        if let Some(folder) = &self.0 {
            let _ = std::fs::remove_dir_all(folder.join(WORK_FOLDER));
        }
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        if let Some(folder) = &self.0 {
            // This removes the folder only if it is empty.
            let _ = std::fs::remove_dir(folder);
        }
    }
}
