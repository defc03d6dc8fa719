//! `touchline mend`: puts the cameras of another program on one camera and its painted lines.

use super::Outcome;
use super::export::{format_parser, parse_size};
use super::new::{parameter, read_field};
use super::track::TrackingReport;
use crate::cli::terminal::attached_labels::{
    AttachedLabels, attach_to_video, note_format, open_video, read_labels, recognize,
};
use crate::cli::terminal::document::{Destination, DocumentOutput, Loaded};
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::{Messages, StepBar};
use crate::cli::terminal::output::print;
use anyhow::ensure;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use touchline_calibration::pipelines::{
    MendError, MendEvent, MendOptions, Mended, MendedNumbers, mend as mend_document, mend_numbers,
};
use touchline_core::geometry::{ImageSize, pluralise};
use touchline_core::progress::{Progress, Share};
use touchline_core::solve::base::SharedPlace;
use touchline_documents::document::Document;
use touchline_documents::exchange::{Direction, Format, ImportOptions, import, recognize_format};
use touchline_documents::report::{Cell, Table};
use touchline_vision::media::{CachedReader, FrameReader, FrameSource, KEPT_BYTES};

/// Mends the cameras that another program gave the frames of a video: all get one place, base and
/// lens, each frame is aligned to its painted lines, and impossible cameras are replaced by
/// tracking from neighbouring frames.
///
/// VIDEO and CAMERAS give a new document; without CAMERAS, VIDEO is a document whose frames have
/// imported cameras. Cameras alone, without a video, are compared with each other only: each goes
/// to the place at which it stands with others, if it fits there; frames that follow each other in
/// time by the numbers in their names are compared, and those out of line replaced. What came stays
/// with each frame. Exit code 1 if frames are left for a person, or more than a tenth was moved by
/// over 20 px.
#[derive(clap::Args, Debug)]
pub struct MendArgs {
    /// The video, a document with imported cameras, or cameras alone.
    #[arg(value_name = "VIDEO")]
    video: PathBuf,
    /// The file or folder of the cameras.
    #[arg(value_name = "CAMERAS")]
    cameras: Option<PathBuf>,
    #[command(flatten)]
    output: DocumentOutput,
    /// The format of the cameras; without it the format is recognized by endings and contents.
    #[arg(long, value_parser = format_parser(Direction::Import))]
    format: Option<Format>,
    /// The field's template.
    #[arg(long, default_value = "soccer")]
    field: String,
    /// A parameter of the field, such as `length_m=105`; may be given several times.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = parameter)]
    set: Vec<(String, f64)>,
    /// The size of the pictures, for cameras without a video whose files do not say it.
    #[arg(long, conflicts_with = "cameras", value_parser = parse_size)]
    size: Option<ImageSize>,
}

/// Cameras to be mended.
struct CamerasToMend {
    document: Document,
    /// Where the document's relative paths start.
    folder: PathBuf,
    /// By how many frames the cameras may be shifted against the video.
    shifts: Vec<i64>,
}

/// Mends the cameras and writes the document.
///
/// # Errors
/// The video or the cameras cannot be read, there is nothing to mend, or the document cannot be
/// written.
pub fn mend(args: &MendArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let output = args.output.reserve("mend", &[&args.video], messages)?;
    if let Some(format) = format_of_cameras_alone(args)? {
        return mend_cameras_alone(args, format, output, messages);
    }
    let CamerasToMend {
        mut document,
        folder,
        shifts,
    } = match &args.cameras {
        Some(cameras) => read_cameras(args, cameras, messages)?,
        None => read_document(&args.video, &output)?,
    };
    messages.name_video_backend(&document);
    // What differs from it at the end counts as edited.
    let before = document.clone();
    let interrupt = Interrupt::listen();
    let report = Mutex::new(MendReport::new(messages));
    let progress = Progress::new(|event| {
        let mut report = report.lock().unwrap_or_else(PoisonError::into_inner);
        report.on_event(event);
        interrupt.check()
    });
    let options = MendOptions { shifts };
    let mut reader = CachedReader::new(FrameReader::new(), KEPT_BYTES);
    let mended = mend_document(&mut document, &folder, &mut reader, &options, &progress);
    // The bar goes before the messages.
    drop(progress);
    drop(report);
    let mended = match mended {
        Ok(mended) => mended,
        Err(MendError::Stopped) => {
            messages.note("stopped; nothing was written");
            return Ok(Outcome::Stopped);
        }
        Err(error) => return Err(error.into()),
    };
    document.count_edits_since(&before);
    messages.notes(&mended.common);
    messages.notes(&mended.not_aligned);
    let left = report_left(&document, &mended, messages);
    output.write(document, &folder)?;
    // Without -o the document itself goes to standard output, where a table would damage it.
    if args.output.output.is_some() {
        print(&tally_table(&mended).to_text())?;
    }
    Ok(Outcome::from_failure(left > 0))
}

/// The format of the cameras, where neither a video nor a document is given with them.
fn format_of_cameras_alone(args: &MendArgs) -> anyhow::Result<Option<Format>> {
    if args.cameras.is_some() {
        return Ok(None);
    }
    // A video without cameras is an easy mistake. Reading it as a document would fail with a
    // message about documents.
    let is_video = args.video.is_file() && FrameSource::open(&args.video).is_ok();
    ensure!(
        !is_video,
        "{}: give the cameras of this video as the second argument",
        args.video.display()
    );
    // What has no known format may still be a document. If it is none, reading it says why, so that
    // the error here is dropped. A document of this program is mended with its pictures.
    let format = args.format.or_else(|| recognize_format(&args.video).ok());
    Ok(format.filter(|format| *format != Format::Json))
}

/// Mends cameras by their numbers alone and writes the document.
fn mend_cameras_alone(
    args: &MendArgs,
    format: Format,
    output: Destination,
    messages: Messages,
) -> anyhow::Result<Outcome> {
    note_format(format, messages);
    let options = ImportOptions {
        size: args.size,
        field: read_field(&args.field, &args.set)?,
        ..ImportOptions::default()
    };
    let imported = import(&args.video, format, &options)?;
    messages.notes(&imported.notes);
    messages.failures(&imported.failures);
    let (mut document, folder) = (imported.document, imported.folder);
    let before = document.clone();
    let mended = mend_numbers(&mut document, &folder)?;
    document.count_edits_since(&before);
    messages.note(&describe_places(&mended.places));
    messages.note(
        "without a video nothing was compared with a picture: a stretch that is wrong alike stays",
    );
    let left = mended.left.iter().filter_map(|left| {
        let frame = document.frames.by_id(&left.id)?;
        Some((frame.name(), &left.why))
    });
    messages.frames_failed(left);
    // One frame in ten may be wrong. Where more were moved far, a person has to see which.
    let has_moved_many = mended.has_moved_many();
    for (id, moved_px) in mended.moved_far.iter().filter(|_| has_moved_many) {
        if let Some(frame) = document.frames.by_id(id) {
            let why = format!("its camera was moved by {moved_px:.0} px (at 1920 px width)");
            messages.frame_failed(&frame.name(), &why);
        }
    }
    output.write(document, &folder)?;
    // As above: standard output may have the document.
    if args.output.output.is_some() {
        print(&numbers_table(&mended).to_text())?;
    }
    Ok(Outcome::from_failure(
        has_moved_many || !mended.left.is_empty() || !imported.failures.is_empty(),
    ))
}

/// The frames of the video with the cameras of another program.
fn read_cameras(
    args: &MendArgs,
    cameras: &Path,
    messages: Messages,
) -> anyhow::Result<CamerasToMend> {
    let format = recognize(args.format, cameras, messages)?;
    let video = open_video(&args.video, messages)?;
    let field = read_field(&args.field, &args.set)?;
    let options = ImportOptions {
        video_size: Some(video.size),
        field: field.clone(),
        ..ImportOptions::default()
    };
    let imported = read_labels(cameras, format, &options, messages)?;
    let AttachedLabels {
        document,
        notes,
        shifts,
    } = attach_to_video(video, &imported, field, NonZeroUsize::MIN)?;
    messages.notes(&notes);
    messages.failures(&imported.failures);
    Ok(CamerasToMend {
        document,
        folder: imported.folder,
        shifts,
    })
}

/// A document whose frames have imported cameras.
fn read_document(path: &Path, output: &Destination) -> anyhow::Result<CamerasToMend> {
    let Loaded { location, document } = output.read(path)?;
    Ok(CamerasToMend {
        document,
        folder: location.folder().to_path_buf(),
        shifts: vec![0],
    })
}

/// What is said while cameras are mended: a bar for each step, and where the cameras stand.
struct MendReport {
    messages: Messages,
    tracking: TrackingReport,
    bar: StepBar,
}

impl MendReport {
    const fn new(messages: Messages) -> Self {
        Self {
            messages,
            tracking: TrackingReport::new(messages),
            bar: StepBar::new(messages),
        }
    }

    fn on_event(&mut self, event: MendEvent) {
        match event {
            MendEvent::Cuts(share) => self.show("Cuts", share),
            MendEvent::Sampling(share) => self.show("Sample", share),
            MendEvent::Checking(share) => self.show("Check", share),
            MendEvent::Aligning(_, share) => self.show("Painted lines", share),
            MendEvent::Places(places) => {
                self.bar.clear();
                self.messages.note(&describe_places(&places));
            }
            MendEvent::Tracking(event) => {
                self.bar.clear();
                self.tracking.on_event(event);
            }
        }
    }

    /// Shows how far a step has come.
    fn show(&mut self, step: &'static str, share: Share) {
        let bar = self.bar.of(step, share.of);
        bar.set_position(share.done as u64);
    }
}

/// Where the given cameras stand.
fn describe_places(places: &[SharedPlace]) -> String {
    let count = pluralise(places.len(), "place");
    let places: Vec<String> = places.iter().map(ToString::to_string).collect();
    format!("the cameras agree on {count}: {}", places.join("; "))
}

/// Names the frames that are left for a person, and returns their number.
fn report_left(document: &Document, mended: &Mended, messages: Messages) -> usize {
    // The outcomes are in the order of the document's frames.
    let frames = document.frames.iter().zip(&mended.frames);
    let left: Vec<_> = frames
        .filter_map(|(frame, mended)| Some((frame.name(), mended.outcome.why_left()?)))
        .collect();
    let count = left.len();
    messages.frames_failed(left);
    count
}

/// How many frames came without a video, and what became of them.
fn numbers_table(mended: &MendedNumbers) -> Table {
    counts_table(&[
        ("came with a camera", mended.came),
        ("of these impossible", mended.impossible),
        ("of these mirrored", mended.mirrored),
        ("out of line with their neighbours", mended.out_of_line),
        ("interpolated", mended.interpolated),
        ("moved by more than 20 px", mended.moved_far.len()),
        ("left for a person", mended.left.len()),
    ])
}

/// How many frames came, and what became of them.
fn tally_table(mended: &Mended) -> Table {
    let tally = mended.tally();
    counts_table(&[
        ("came with a camera", tally.came),
        ("of these impossible", tally.impossible),
        ("of these mirrored", tally.mirrored),
        ("decided by a person, untouched", tally.decided),
        ("as they came, within 3 px", tally.as_they_came),
        ("mended on their painted lines", tally.aligned),
        ("mended by their neighbours", tally.tracked),
        ("left for a person", tally.left),
    ])
}

fn counts_table(counts: &[(&str, usize)]) -> Table {
    let mut table = Table::new(&[("frames", "Frames"), ("count", "Count")]);
    for (what, count) in counts {
        table.push(vec![Cell::Text((*what).to_owned()), Cell::Count(*count)]);
    }
    table
}
