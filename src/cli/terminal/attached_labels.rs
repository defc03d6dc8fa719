//! Labels of another program attached to the frames of a video, for the commands that read both.

use super::document::Loaded;
use super::messages::Messages;
use anyhow::{bail, ensure};
use std::num::NonZeroUsize;
use std::path::Path;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, FieldSpec, Frame, document_from_frames};
use touchline_documents::exchange::{
    Format, ImportOptions, Imported, import, join, recognize_format,
};
use touchline_vision::media::{FrameSource, VideoInfo};

/// The format of files: the given one, else that which their endings and contents show.
pub fn recognize(given: Option<Format>, path: &Path, messages: Messages) -> anyhow::Result<Format> {
    if let Some(format) = given {
        return Ok(format);
    }
    let format = recognize_format(path)?;
    note_format(format, messages);
    Ok(format)
}

/// Says which format was recognized.
pub fn note_format(format: Format, messages: Messages) {
    messages.note(&format!("the format is {format}: {}", format.about().title));
}

/// Reads the labels of another program.
///
/// # Errors
/// The files cannot be read or are damaged.
pub fn read_labels(
    path: &Path,
    format: Format,
    options: &ImportOptions,
    messages: Messages,
) -> anyhow::Result<Imported> {
    if format != Format::Json {
        return Ok(import(path, format, options)?);
    }
    // The last edits of a document of this program are in the journal beside it, not in its file.
    let Loaded { location, document } = Loaded::read(path, messages)?;
    Ok(Imported {
        document,
        folder: location.folder().to_path_buf(),
        format,
        notes: Vec::new(),
        failures: Vec::new(),
    })
}

/// A video whose frames cameras are attached to.
pub fn open_video(path: &Path, messages: Messages) -> anyhow::Result<VideoInfo> {
    let FrameSource::Video(info) = FrameSource::open(path)? else {
        bail!(
            "{} is no video; give the video that the cameras are of",
            path.display()
        );
    };
    messages.notes(&info.notices);
    Ok(info)
}

/// The note that labels of the first frames alone may be those of a sample of the whole video.
fn sampling_note(document: &Document) -> Option<String> {
    let is_labelled = |frame: &Frame| frame.ptz.is_some() || !frame.clicks.is_empty();
    let count = document.frames.len();
    let labelled = document
        .frames
        .iter()
        .take_while(|frame| is_labelled(frame));
    let first = labelled.count();
    let all = document.frames.iter().filter(|frame| is_labelled(frame));
    // A sample of one or two says nothing; one that is not of the beginning is none.
    let is_beginning = all.count() == first && first >= LEAST_SAMPLE;
    let every = count.checked_div(first).filter(|every| *every >= 2)?;
    is_beginning.then(|| {
        format!(
            "these are labels of the first {first} of {count} frames: if they were sampled from \
             all of the video, give --every {every}"
        )
    })
}

/// The least labels that may be a sample of a video.
const LEAST_SAMPLE: usize = 3;

/// The document of a video's frames with imported labels.
pub struct AttachedLabels {
    /// The document. Its paths start from the imported document's folder.
    pub document: Document,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// By how many frames the labels may come later in the video; the first is 0.
    pub shifts: Vec<i64>,
}

/// Makes a document of every n-th frame of a video and attaches imported labels to them.
///
/// # Errors
/// No label is of a frame of the video.
pub fn attach_to_video(
    video: VideoInfo,
    imported: &Imported,
    field: FieldSpec,
    every: NonZeroUsize,
) -> anyhow::Result<AttachedLabels> {
    let name = video.path.display().to_string();
    let source = FrameSource::Video(video);
    // The video's frames become a document without labels first. The labels are then joined with it
    // by the rules of an import into an open project: they are attached to the frames of its only
    // video in the most plausible way.
    let made = document_from_frames(
        &source,
        &imported.folder,
        field,
        every,
        &Progress::default(),
    );
    let open = made.document.at(&imported.folder);
    let mut joined = join(open, imported);
    // Without a plan the labels name their pictures themselves, so that no shift is possible.
    let shifts = joined.attachment?.map_or(vec![0], |plan| plan.shifts());
    if joined.other_size > 0 {
        joined.notes.push(format!(
            "{} left out: their pictures have other proportions than the video",
            pluralise(joined.other_size, "frame")
        ));
    }
    ensure!(
        // A document without a single label would pass for a success. The last note says why none
        // fits.
        joined.matched > 0,
        "{name} gets no label from {}{}",
        pluralise(imported.document.frames.len(), "frame"),
        joined
            .notes
            .last()
            .map(|note| format!("; {note}"))
            .unwrap_or_default()
    );
    joined.notes.extend(sampling_note(&joined.document));
    // The camera of the new document has no base; it stays only where frames have no other.
    let mut document = joined.document;
    let used = document.used_cameras();
    document.cameras.retain(|camera| used.contains(&camera.id));
    Ok(AttachedLabels {
        document,
        notes: joined.notes,
        shifts,
    })
}
