//! Attaches imported frames to the frames of a video.
//!
//! Most formats of cameras name frames by files (`camera_match_000017.json`), not by a video and a
//! frame of it. Where a document has the frames of one video, and the imported frames are of no
//! picture of their own, each gets the frame of its number.
//!
//! 1. The number of an imported frame is that of its video frame, where the format states one, else
//!    the number in its name (`numbers.rs`). Without numbers, the order counts if there are as many
//!    cameras as frames.
//! 2. Numbers may count from 0, from 1, or from the beginning of a longer video. `candidates.rs`
//!    lists what the numbers and counts allow. Which one is right only pictures can decide.
//!
//! A camera must never get to another picture. Where the counts contradict each other nothing is
//! attached, and [`NotAttached`] says why.

mod candidates;
mod numbers;
#[cfg(test)]
mod tests;

pub use candidates::{AttachedPair, AttachmentCandidate, Counting};

use super::imported::Imported;
use super::places::{Places, names_video};
use crate::document::{DocumentAt, Frame, Frames, Shared, VideoFrame, resolve_path};
use crate::exchange::files::{base_name, stem, without_ending};
use crate::exchange::format::Format;
use candidates::{NumberedCameras, is_most};
use numbers::{NameNumbers, numbers_in_names, without_word_ending};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::geometry::{ImageSize, pluralise};

/// What tells which frame of a video an imported frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatchedBy {
    /// The number of the video frame that the format states.
    Index,
    /// The number in its name.
    Number,
    /// Its position among the imported frames.
    Order,
}

/// Imported frames and the frames of a video that they may belong to.
#[derive(Clone, Debug, PartialEq)]
pub struct Attachment {
    matched_by: MatchedBy,
    video: OnlyVideo,
    candidates: Vec<AttachmentCandidate>,
}

/// Why imported frames are attached to no frame of a video.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum NotAttached {
    /// No way to count gives the cameras frames of the video.
    #[error(
        "nothing is attached to {video}: the numbers {first} to {last} of {} do not fit its {}; rename the files so that \
         their numbers count the video's frames",
        pluralise(*cameras, "camera"), pluralise(*frames, "frame")
    )]
    NumbersDoNotFit {
        /// The video's file name.
        video: String,
        /// The imported frames.
        cameras: usize,
        /// The frames of the video.
        frames: usize,
        /// The smallest number.
        first: u64,
        /// The largest number.
        last: u64,
    },
    /// Many cameras have the same number.
    #[error(
        "nothing is attached to {video}: {} have only {distinct} different numbers; import one camera at a time",
        pluralise(*cameras, "camera")
    )]
    NumbersRepeat {
        /// The video's file name.
        video: String,
        /// The imported frames.
        cameras: usize,
        /// The different numbers among theirs.
        distinct: usize,
    },
    /// Without numbers only equal counts tell which camera is of which frame.
    #[error(
        "nothing is attached to {video}: {} without frame numbers do not fit its {}; give each camera the number of its \
         frame",
        pluralise(*cameras, "camera"), pluralise(*frames, "frame")
    )]
    CountsDiffer {
        /// The video's file name.
        video: String,
        /// The imported frames.
        cameras: usize,
        /// The frames of the video.
        frames: usize,
    },
}

/// Finds the frames of the only video of a document that imported frames may belong to; none where
/// the document has no video or several, or the imported frames have pictures of their own.
///
/// Frames have pictures of their own if one of them exists on disk, states its digest, names a
/// picture of the document, or comes from a document of this program.
///
/// # Errors
/// Numbers and counts contradict each other, so that no frame may be attached.
pub fn plan_attachment(
    open: DocumentAt<'_>,
    imported: &Imported,
) -> Result<Option<Attachment>, NotAttached> {
    let frames = &imported.document.frames;
    // A document of this program names its pictures itself.
    if imported.format == Format::Json || frames.is_empty() {
        return Ok(None);
    }
    let Some(video) = OnlyVideo::find(open) else {
        return Ok(None);
    };
    let places = Places::from_document(open);
    if frames
        .iter()
        .any(|frame| has_own_picture(frame, &imported.folder, &places))
    {
        return Ok(None);
    }
    // Without numbers only equal counts leave no doubt about which camera is of which frame.
    let (matched_by, runs) = match numbers_of(imported) {
        Some(known) => known,
        None if frames.len() == video.frames.len() => {
            (MatchedBy::Order, vec![only(video.indices_in_order())])
        }
        None => {
            return Err(NotAttached::CountsDiffer {
                video: video.name(),
                cameras: frames.len(),
                frames: video.frames.len(),
            });
        }
    };
    // Several cameras of one number are several cameras of one moment: files of two cameras in one
    // folder. All runs of the names have equally many numbers.
    let numbers = || {
        runs.iter()
            .take(1)
            .flat_map(|run| run.numbers.iter().flatten())
    };
    let distinct = numbers().collect::<BTreeSet<_>>().len();
    if !is_most(distinct, numbers().count()) {
        return Err(NotAttached::NumbersRepeat {
            video: video.name(),
            cameras: frames.len(),
            distinct,
        });
    }
    let indices = video.indices();
    let (mut candidates, mut range) = (Vec::new(), None);
    for NameNumbers { numbers, shown_at } in &runs {
        // This program's exports count from 0, stated numbers are those of video frames, and an
        // order begins with the first frame.
        let counts_from_zero =
            matched_by != MatchedBy::Number || are_names_of_exports(imported, &video, numbers);
        let Some(cameras) = NumberedCameras::new(numbers, &indices, counts_from_zero) else {
            continue;
        };
        range.get_or_insert(cameras.range());
        let of_run = cameras.candidates().into_iter();
        candidates.extend(of_run.map(|candidate| AttachmentCandidate {
            number: shown_at.clone(),
            ..candidate
        }));
    }
    // An order fits in one way; other candidates are of numbers that mean nothing here.
    if matched_by == MatchedBy::Order {
        candidates.truncate(1);
    }
    if candidates.is_empty() {
        let [first, last] = range.unwrap_or_default();
        return Err(NotAttached::NumbersDoNotFit {
            video: video.name(),
            cameras: frames.len(),
            frames: video.frames.len(),
            first,
            last,
        });
    }
    Ok(Some(Attachment {
        matched_by,
        video,
        candidates,
    }))
}

impl Attachment {
    /// What tells which frame of the video an imported frame is.
    pub const fn matched_by(&self) -> MatchedBy {
        self.matched_by
    }

    /// The ways to attach the frames, the most plausible first; at least one.
    pub fn candidates(&self) -> &[AttachmentCandidate] {
        &self.candidates
    }

    /// By how many frames the cameras come later in the video in each way than in the most plausible
    /// one, which is the first. Ways that count something else are left out.
    pub fn shifts(&self) -> Vec<i64> {
        let Some(first) = self.candidates.first() else {
            return vec![0];
        };
        self.candidates
            .iter()
            .filter(|other| (other.counting, &other.number) == (first.counting, &first.number))
            .filter_map(|other| {
                let [from, to] = [first, other].map(|way| i64::try_from(way.first_number).ok());
                from?.checked_sub(to?)
            })
            .collect()
    }

    /// The imported document with frames of the video in place of its own, in one of the ways.
    ///
    /// Frames without a frame of the video are left out; the notes say how many, and how the others
    /// are attached.
    pub fn apply(&self, imported: &Imported, candidate: &AttachmentCandidate) -> Imported {
        // Paths of the imported document start from its own folder; the result lies in that of the
        // video.
        let mut document = imported
            .document
            .clone()
            .relocate(&imported.folder, &self.video.folder);
        let before = std::mem::take(&mut document.frames);
        let names = names_of_files(&imported.document.frames);
        document.frames = candidate
            .pairs
            .iter()
            .filter_map(|pair| {
                let labels_name = names.get(pair.imported)?.clone();
                self.video
                    .attach(before.get(pair.imported)?, labels_name, pair.frame_index)
            })
            .collect();
        let kind = if before.iter().all(|frame| frame.ptz.is_some()) {
            "camera"
        } else {
            "frame"
        };
        let attached = document.frames.len();
        let mut notes = imported.notes.clone();
        notes.push(self.note(attached, kind, candidate));
        notes.extend(self.note_left_out(&before, kind, candidate));
        Imported {
            document,
            folder: self.video.folder.clone(),
            format: imported.format,
            notes,
            failures: imported.failures.clone(),
        }
    }

    /// How many frames have no frame of the video, in one line; none where all have one.
    fn note_left_out(
        &self,
        before: &Frames,
        kind: &str,
        candidate: &AttachmentCandidate,
    ) -> Option<String> {
        // The first of them is named, so that the user sees of what kind they are.
        let used: BTreeSet<usize> = candidate.pairs.iter().map(|pair| pair.imported).collect();
        let mut left_out = (0..before.len()).filter(|index| !used.contains(index));
        let first = before.get(left_out.next()?)?.name();
        let first = base_name(&first);
        let others = left_out.count();
        let more = if others > 0 { ", …" } else { "" };
        Some(format!(
            "{} left out, because {} has no frame of their number or another has it: {first}{more}",
            pluralise(1 + others, kind),
            self.video.name()
        ))
    }

    /// How frames are attached, in one line.
    fn note(&self, attached: usize, kind: &str, candidate: &AttachmentCandidate) -> String {
        let verb = if attached == 1 { "is" } else { "are" };
        let by = match self.matched_by {
            MatchedBy::Index => "by their frame numbers",
            MatchedBy::Number => "by the numbers in their names",
            MatchedBy::Order => "in their order",
        };
        let which = |candidate: &AttachmentCandidate| {
            let number = candidate.number.as_ref();
            number.map_or_else(String::new, |number| format!(" ({number})"))
        };
        let mut note = format!(
            "{} {verb} attached to {} {by}{}",
            pluralise(attached, kind),
            self.video.name(),
            which(candidate)
        );
        if self.matched_by != MatchedBy::Order {
            // Writing to a string cannot fail.
            let _ = write!(note, ", {}", describe_counting(candidate));
            let other = self.candidates.iter().find(|other| *other != candidate);
            if let Some(other) = other {
                let counting = describe_counting(other);
                let which = if other.number == candidate.number {
                    String::new()
                } else {
                    which(other)
                };
                let _ = write!(note, "; {counting}{which} they fit, too");
            }
        }
        note
    }
}

/// What is counted, and from where.
fn describe_counting(candidate: &AttachmentCandidate) -> String {
    let over = match candidate.counting {
        Counting::VideoFrames => "",
        Counting::DocumentFrames => " among the document's frames",
    };
    format!("counted from {}{over}", candidate.first_number)
}

/// The size of the pictures of a document's only video; none where it has no video or several, or
/// its frames differ in size.
pub fn size_of_only_video(open: DocumentAt<'_>) -> Option<ImageSize> {
    OnlyVideo::find(open)?;
    let mut sizes = open
        .frames
        .iter()
        .filter(|frame| frame.video.is_some())
        .map(|frame| frame.image_size);
    let first = sizes.next()?;
    sizes.all(|size| size == first).then_some(first)
}

/// The only video of a document.
#[derive(Clone, Debug, PartialEq)]
struct OnlyVideo {
    /// The document's folder, from which the paths of the frames start.
    folder: PathBuf,
    /// The frames that the document has, by ascending index, each once.
    frames: Vec<VideoFrame>,
}

impl OnlyVideo {
    /// None where a document has no video or several.
    fn find(open: DocumentAt<'_>) -> Option<Self> {
        let mut frames: Vec<VideoFrame> = open
            .frames
            .iter()
            .filter_map(|frame| frame.video.clone())
            .collect();
        // To resolve a path takes the disk; most frames have the same.
        let paths: BTreeSet<&str> = frames.iter().map(|frame| frame.path.as_str()).collect();
        let files: BTreeSet<PathBuf> = paths
            .into_iter()
            .map(|path| resolve_path(&open.folder.join(path)))
            .collect();
        if files.len() != 1 {
            return None;
        }
        frames.sort_by_key(|frame| frame.frame_index);
        frames.dedup_by_key(|frame| frame.frame_index);
        Some(Self {
            folder: open.folder.to_path_buf(),
            frames,
        })
    }

    /// Its file name.
    fn name(&self) -> String {
        let path = self.frames.first().map_or("", |frame| &frame.path);
        base_name(path).to_owned()
    }

    /// The numbers of its frames, ascending.
    fn indices(&self) -> Vec<u64> {
        self.frames.iter().map(|frame| frame.frame_index).collect()
    }

    /// The numbers of its frames as numbers of cameras in the same order.
    fn indices_in_order(&self) -> Vec<Option<u64>> {
        self.indices().into_iter().map(Some).collect()
    }

    /// An imported frame as a frame of this video.
    fn attach(
        &self,
        imported: &Frame,
        labels_name: Option<String>,
        frame_index: u64,
    ) -> Option<Shared<Frame>> {
        let at = self
            .frames
            .binary_search_by_key(&frame_index, |frame| frame.frame_index)
            .ok()?;
        // The identity is that of the frame of the video, all labels are the imported ones. The
        // name of the imported file is kept beside them, so that an export can give it back.
        let (camera, size) = (imported.camera.clone(), imported.image_size);
        let frame = Frame::from_video(self.frames[at].clone(), camera, size);
        let labelled = Frame {
            id: frame.id,
            image: None,
            video: frame.video,
            labels_name,
            ..imported.clone()
        };
        Some(labelled.into())
    }
}

/// The names of the files of imported frames; none for a frame without a file of its own, such as a
/// row of an array. Folders are in them where the files have the same names in each.
fn names_of_files(frames: &Frames) -> Vec<Option<String>> {
    let images = frames.iter().map(|frame| frame.image.as_deref());
    let stems: BTreeSet<&str> = images.clone().flatten().map(stem).collect();
    let are_different = stems.len() == images.clone().flatten().count();
    let names = images.map(|image| {
        let image = image?;
        Some(if are_different {
            stem(image).to_owned()
        } else {
            path_as_name(image)
        })
    });
    names.collect()
}

/// A path without its ending as a single name: its parts with `_` between them.
fn path_as_name(path: &str) -> String {
    let parts = without_ending(path).split(['/', '\\']);
    let parts: Vec<&str> = parts
        .filter(|part| !matches!(*part, "" | "." | ".."))
        .collect();
    parts.join("_")
}

/// Whether a frame belongs to a picture that is not a frame of an unnamed video.
fn has_own_picture(frame: &Frame, folder: &Path, places: &Places<'_>) -> bool {
    let has_image = frame.image_path(folder).is_some_and(|path| path.is_file());
    let named = frame
        .video
        .as_ref()
        .filter(|video| names_video(&video.path));
    let has_video = named.is_some_and(|video| video.file_path(folder).is_file());
    // A track without the name of a video is of the only video, but it may count otherwise.
    let is_track = frame.image.is_none() && frame.video.is_some() && named.is_none();
    let is_in_document = !is_track && places.find(frame, folder).is_some();
    frame.sha256.is_some() || has_image || has_video || is_in_document
}

/// The numbers of imported frames and where they are from; none where they have none.
fn numbers_of(imported: &Imported) -> Option<(MatchedBy, Vec<NameNumbers>)> {
    // Rows of arrays and packets have no numbers, and frames without a camera have none of them.
    if matches!(imported.format, Format::Fifa | Format::FreeD) {
        return None;
    }
    let frames = &imported.document.frames;
    let stated: Vec<Option<u64>> = frames
        .iter()
        .map(|frame| frame.video_frame_index())
        .collect();
    if stated.iter().all(Option::is_some) {
        return Some((MatchedBy::Index, vec![only(stated)]));
    }
    let names: Vec<String> = frames.iter().map(|frame| frame.name()).collect();
    let mut runs = numbers_in_names(&names);
    for run in &mut runs {
        for (number, stated) in run.numbers.iter_mut().zip(&stated) {
            *number = stated.or(*number);
        }
    }
    (!runs.is_empty()).then_some((MatchedBy::Number, runs))
}

/// Numbers beside which there are no others.
const fn only(numbers: Vec<Option<u64>>) -> NameNumbers {
    NameNumbers {
        numbers,
        shown_at: None,
    }
}

/// Whether names are those that this program's exports give the frames of a video:
/// `match_000017`, counted from 0.
fn are_names_of_exports(imported: &Imported, video: &OnlyVideo, numbers: &[Option<u64>]) -> bool {
    let video = video.name();
    let stem = without_word_ending(&video);
    let frames = imported.document.frames.iter();
    frames.zip(numbers).all(|(frame, number)| {
        let name = frame.name();
        let name = without_word_ending(base_name(&name));
        number.is_some_and(|number| name == format!("{stem}_{number:06}"))
    })
}
