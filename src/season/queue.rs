//! The queue of several matches: which matches, and where a person's look is worth most.
//!
//! A queue lists matches, each with its project or the video of which one is to be made, frames, or
//! both. How far a match has come is never in the queue: its project says so.
//!
//! Neighbouring frames of one camera below the confidence are one entry, of the worst among them: a
//! correction there mends the others, for the window tracks it to them. A season of millions of
//! frames has thousands of entries.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::files::{folder_of, open_named, read_named_text};
use touchline_documents::document::{Document, Frame};
use touchline_documents::store::{Location, PROJECT_FILE, PROJECT_SUFFIX};
use touchline_vision::relocalize::CERTAIN;

/// The value of `format` in every queue.
const FORMAT: &str = "touchline queue";
/// The version of queues that this program writes and reads.
const VERSION: u64 = 1;
/// Maximum size of a queue's file, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// Matches to work through, and the frames of a season to look at, worst first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Queue {
    format: String,
    version: u64,
    /// Suggestions below this confidence are in it.
    #[serde(default = "certain")]
    pub below: f64,
    /// Whole matches, in the order in which they are worked through.
    #[serde(default)]
    pub matches: Vec<QueuedMatch>,
    #[serde(default)]
    entries: Vec<QueueEntry>,
}

const fn certain() -> f64 {
    CERTAIN
}

/// A match to work through.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QueuedMatch {
    #[serde(rename = "match")]
    pub name: String,
    /// The file of its project, relative to the queue's folder or absolute. It may be missing as
    /// long as `frames` are named.
    pub project: PathBuf,
    /// The video or the folder of images of which the project is made, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frames: Option<PathBuf>,
    /// Why the last labelling without a click came to no good end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

impl QueuedMatch {
    /// The match at a path: a project or dataset, or else frames whose project is beside them.
    pub fn from_path(path: &Path) -> Self {
        let resolved = resolve(path);
        let is_document = path.join(PROJECT_FILE).exists()
            || path
                .extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        let project = Location::find(&resolved).ok().filter(|_| is_document);
        let (project, frames) = match project {
            Some(location) => (location.file().to_path_buf(), None),
            None if is_document => (resolved, None),
            None => (project_beside(&resolved).join(PROJECT_FILE), Some(resolved)),
        };
        Self {
            name: name_of(frames.as_ref().unwrap_or(&project)),
            project,
            frames,
            failed: None,
        }
    }

    /// What it is made of, or else its project.
    pub fn source(&self) -> &Path {
        self.frames.as_ref().unwrap_or(&self.project)
    }

    /// The same with the paths that start from a folder.
    fn below(mut self, folder: &Path) -> Self {
        self.project = resolve(&folder.join(&self.project));
        self.frames = self.frames.map(|frames| resolve(&folder.join(frames)));
        self
    }

    /// The same with paths relative to a folder, as far as they lie below it.
    fn relative_to(mut self, folder: &Path) -> Self {
        for path in std::iter::once(&mut self.project).chain(&mut self.frames) {
            if let Ok(shorter) = path.strip_prefix(folder) {
                *path = shorter.to_path_buf();
            }
        }
        self
    }
}

/// A path without links; as far as it does not exist, absolute.
fn resolve(path: &Path) -> PathBuf {
    let resolved = std::fs::canonicalize(path).or_else(|_| std::path::absolute(path));
    resolved.unwrap_or_else(|_| path.to_path_buf())
}

/// The folder of the project of a video or of a folder of images, beside it.
pub fn project_beside(frames: &Path) -> PathBuf {
    let mut name = frames.file_name().unwrap_or_default().to_owned();
    name.push(PROJECT_SUFFIX);
    folder_of(frames).join(name)
}

/// The name of a match: that of its frames, or of its project's folder.
fn name_of(path: &Path) -> String {
    let is_project = path.file_name().is_some_and(|name| name == PROJECT_FILE);
    let named = if is_project { folder_of(path) } else { path };
    let name = named
        .file_name()
        .unwrap_or(named.as_os_str())
        .to_string_lossy();
    name.strip_suffix(PROJECT_SUFFIX)
        .unwrap_or(&name)
        .to_owned()
}

/// A frame to look at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QueueEntry {
    #[serde(rename = "match")]
    pub of_match: String,
    /// Its project, relative to the queue's folder.
    pub project: String,
    /// The id of the frame in the project.
    pub frame: String,
    /// Its number in the video, or its position in the project.
    pub number: u64,
    /// The confidence of its camera, 0 to 1; none if none is stated, which counts as 0.
    pub confidence: Option<f64>,
    /// Number of neighbouring frames below the confidence, this one included.
    pub frames: usize,
}

/// Why a file is no queue.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum QueueError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// It is something else.
    #[error("{} is not a queue: {reason}; touchline queue writes one", path.display())]
    NotAQueue {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

impl Queue {
    pub(crate) fn new(below: f64) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            below,
            matches: Vec::new(),
            entries: Vec::new(),
        }
    }

    /// The queue of matches at these paths, each once; of a queue among them its matches.
    ///
    /// # Errors
    /// A queue among the paths cannot be read.
    pub fn from_paths(paths: &[PathBuf]) -> Result<Self, QueueError> {
        let mut queue = Self::new(CERTAIN);
        for path in paths {
            if Self::is_at(path) {
                queue.add_new(Self::read(path)?.all_matches(folder_of(path)));
            } else {
                queue.add_new([QueuedMatch::from_path(path)]);
            }
        }
        Ok(queue)
    }

    /// Its matches, first those that it lists, then those of its frames; with paths that start from
    /// its folder.
    pub fn all_matches(&self, folder: &Path) -> Vec<QueuedMatch> {
        let mut all = Self::new(self.below);
        all.add_new(
            self.matches
                .iter()
                .map(|queued| queued.clone().below(folder)),
        );
        let of_frames = self.entries.iter().map(|entry| QueuedMatch {
            name: entry.of_match.clone(),
            project: resolve(&folder.join(&entry.project)),
            frames: None,
            failed: None,
        });
        all.add_new(of_frames);
        all.matches
    }

    /// Adds the matches that it has not yet.
    fn add_new(&mut self, matches: impl IntoIterator<Item = QueuedMatch>) {
        let mut known: BTreeSet<_> = self.matches.iter().map(|it| it.project.clone()).collect();
        let matches = matches.into_iter();
        self.matches
            .extend(matches.filter(|queued| known.insert(queued.project.clone())));
    }

    /// The same with paths relative to a folder, as far as they lie below it.
    #[must_use]
    pub fn relative_to(mut self, folder: &Path) -> Self {
        let matches = self.matches.into_iter();
        self.matches = matches.map(|queued| queued.relative_to(folder)).collect();
        self
    }

    /// Its entries, worst first.
    pub fn entries(&self) -> &[QueueEntry] {
        &self.entries
    }

    /// Whether the file at a path begins as a queue does, however it is laid out.
    pub fn is_at(path: &Path) -> bool {
        // A queue may be large, so only its beginning is read: this key comes first.
        let mut beginning = Vec::new();
        let read = open_named(path).and_then(|file| file.take(256).read_to_end(&mut beginning));
        beginning.retain(|byte| !byte.is_ascii_whitespace());
        let mut begins = format!("{{\"format\":\"{FORMAT}\"").into_bytes();
        begins.retain(|byte| !byte.is_ascii_whitespace());
        read.is_ok() && beginning.starts_with(&begins)
    }

    /// Reads a queue's file.
    ///
    /// # Errors
    /// It cannot be read, or is no queue.
    pub fn read(path: &Path) -> Result<Self, QueueError> {
        let text = read_named_text(path, MAX_BYTES).map_err(|source| QueueError::Io {
            path: path.to_path_buf(),
            source,
        })?;
        let read: Result<Self, _> = serde_json::from_str(&text);
        let reason = match read {
            Ok(queue) if queue.format == FORMAT && queue.version == VERSION => return Ok(queue),
            Ok(Self {
                format, version, ..
            }) => format!("it is a {format:?} of version {version}"),
            Err(error) => error.to_string(),
        };
        Err(QueueError::NotAQueue {
            path: path.to_path_buf(),
            reason,
        })
    }

    /// Adds the doubtful frames of a match's project in a folder.
    pub(crate) fn add_match(&mut self, name: &str, folder: &str, document: &Document) {
        let frames: Vec<(usize, &Frame)> = document
            .frames
            .iter()
            .map(|frame| &**frame)
            .enumerate()
            .collect();
        // Stretches of frames that are all doubtful, or all not, and of one camera. A suggestion
        // without a stated confidence counts as the worst.
        let stretches = frames.chunk_by(|(_, one), (_, next)| {
            let is_doubtful = [one, next].map(|frame| self.is_doubtful(frame));
            is_doubtful[0] == is_doubtful[1] && one.camera == next.camera
        });
        let mut entries = Vec::new();
        for stretch in stretches {
            let doubtful = stretch.iter().filter(|(_, frame)| self.is_doubtful(frame));
            let worst = doubtful.min_by(|(_, one), (_, other)| {
                least_confidence(one).total_cmp(&least_confidence(other))
            });
            let Some((position, frame)) = worst else {
                continue;
            };
            entries.push(QueueEntry {
                of_match: name.to_owned(),
                project: format!("{folder}/{PROJECT_FILE}"),
                frame: frame.id.as_str().to_owned(),
                number: frame.number_at(*position),
                confidence: confidence_of(frame),
                frames: stretch.len(),
            });
        }
        self.entries.append(&mut entries);
    }

    /// Whether a frame has a suggested camera below the confidence.
    fn is_doubtful(&self, frame: &Frame) -> bool {
        frame.is_open() && frame.ptz.is_some() && least_confidence(frame) < self.below
    }

    /// Puts the worst first; of equals the larger stretch, then the order of the season.
    pub(crate) fn sort(&mut self) {
        // The sort is stable, which leaves equals in the order of the season.
        self.entries.sort_by(|one, other| {
            let [one_is, other_is] = [one, other].map(|entry| entry.confidence.unwrap_or(0.0));
            one_is
                .total_cmp(&other_is)
                .then(other.frames.cmp(&one.frames))
        });
    }

    /// Its file: JSON, a match or an entry a line.
    pub fn to_text(&self) -> String {
        let head = format!("\"format\":\"{FORMAT}\",\"version\":{VERSION}");
        let (below, entries) = (self.below, lines_of(&self.entries));
        let matches = if self.matches.is_empty() {
            String::new()
        } else {
            format!("\"matches\":{},", lines_of(&self.matches))
        };
        format!("{{{head},\"below\":{below},{matches}\"entries\":{entries}}}\n")
    }
}

/// A list as JSON, an item a line.
fn lines_of(items: &[impl Serialize]) -> String {
    let items: Vec<String> = items
        .iter()
        .map(|item| serde_json::to_string(item).unwrap_or_default())
        .collect();
    let separator = if items.is_empty() { "" } else { "\n" };
    format!("[{separator}{}{separator}]", items.join(",\n"))
}

/// The stated confidence in a frame's camera.
pub(crate) fn confidence_of(frame: &Frame) -> Option<f64> {
    frame.solution.as_ref()?.confidence
}

/// The confidence in a frame's camera; 0 if none is stated.
fn least_confidence(frame: &Frame) -> f64 {
    confidence_of(frame).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{FrameStatus, Solution};
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    fn document(confidences: &[Option<f64>]) -> Document {
        let mut document = soccer_document();
        for (index, confidence) in confidences.iter().enumerate() {
            let size = ImageSize::new(64, 36);
            let mut frame = new_frame(&format!("{index}.png"), size);
            if confidence.is_some() {
                frame.status = FrameStatus::Suggested;
                frame.ptz = ptz_at(1.0, -9.0, 900.0);
                frame.solution = Some(Solution {
                    confidence: *confidence,
                    ..Solution::default()
                });
            }
            document.frames.push(frame.into());
        }
        document
    }

    #[test]
    fn the_worst_frame_of_each_stretch_is_in_the_queue_worst_first() {
        let mut queue = Queue::new(0.9);
        let one = [0.95, 0.8, 0.7, 0.99, 0.3].map(Some);
        queue.add_match("one", "one", &document(&one));
        let mut other = document(&[Some(0.5), None, Some(0.5), Some(0.6)]);
        other.frames[0].status = FrameStatus::Reference;
        queue.add_match("other", "earlier", &other);
        queue.sort();
        let shown = |entry: &QueueEntry| (entry.of_match.clone(), entry.number, entry.frames);
        let found: Vec<_> = queue.entries().iter().map(shown).collect();
        let wanted = [("one", 4, 1), ("other", 2, 2), ("one", 2, 2)];
        let wanted: Vec<_> = wanted
            .map(|(name, number, frames)| (name.to_owned(), number, frames))
            .to_vec();
        assert_eq!(found, wanted);
        assert_eq!(queue.entries()[1].project, "earlier/project.json");

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("queue.json");
        for queue in [queue, Queue::new(0.5)] {
            std::fs::write(&path, queue.to_text()).unwrap();
            assert!(Queue::is_at(&path));
            assert_eq!(Queue::read(&path).unwrap(), queue);
        }
        std::fs::write(&path, "{}").unwrap();
        assert!(!Queue::is_at(&path) && !Queue::is_at(folder.path()));
        let refusal = Queue::read(&path).unwrap_err().to_string();
        assert!(refusal.contains("is not a queue"), "{refusal}");
    }
    #[test]
    fn a_queue_of_matches_is_read_however_it_is_laid_out() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let at = |name: &str| root.join(name);
        std::fs::create_dir(at("old.touchline")).unwrap();
        std::fs::write(at("old.touchline/project.json"), "{}").unwrap();
        let clip = at("clip.mp4");
        let paths = [clip.clone(), at("old.touchline"), clip.clone()];
        let queue = Queue::from_paths(&paths).unwrap();
        let names: Vec<_> = queue.matches.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["clip.mp4", "old"], "each once");
        assert_eq!(queue.matches[0].frames, Some(clip));
        assert_eq!(queue.matches[1].frames, None);

        let written = queue.clone().relative_to(&root);
        assert_eq!(
            written.matches[0].project,
            Path::new("clip.mp4.touchline/project.json")
        );
        let file = at("queue.json");
        let value: serde_json::Value = serde_json::from_str(&written.to_text()).unwrap();
        let pretty = serde_json::to_string_pretty(&value).unwrap();
        for text in [written.to_text(), format!("\n{pretty}")] {
            std::fs::write(&file, text).unwrap();
            assert!(Queue::is_at(&file));
            let read = Queue::read(&file).unwrap();
            assert_eq!(
                (&read, read.all_matches(&root)),
                (&written, queue.matches.clone())
            );
            assert_eq!(
                Queue::from_paths(std::slice::from_ref(&file)).unwrap(),
                queue
            );
        }
        for bad in [
            r#"{"format":"touchline queue""#,
            r#"{"format":"touchline queue","version":2}"#,
            r#"{"format":"touchline queue","version":1,"matches":[{"match":"a"}]}"#,
        ] {
            std::fs::write(&file, bad).unwrap();
            assert!(
                matches!(Queue::read(&file), Err(QueueError::NotAQueue { .. })),
                "{bad}"
            );
            assert!(
                Queue::from_paths(std::slice::from_ref(&file)).is_err(),
                "{bad}"
            );
        }
        assert!(matches!(
            Queue::read(&at("none")),
            Err(QueueError::Io { .. })
        ));
    }
}
