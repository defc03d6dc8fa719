//! The review queue of a season: where a person's look is worth most.
//!
//! Neighbouring frames of one camera below the confidence are one entry, of the worst among them: a
//! correction there mends the others, for the window tracks it to them. A season of millions of
//! frames has thousands of entries.

use serde::{Deserialize, Serialize};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::files::{open_named, read_named_text};
use touchline_documents::document::{Document, Frame};
use touchline_documents::store::PROJECT_FILE;

/// The value of `format` in every queue.
const FORMAT: &str = "touchline queue";
/// The version of queues that this program writes and reads.
const VERSION: u64 = 1;
/// Maximum size of a queue's file, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// The frames of a season to look at, worst first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Queue {
    format: String,
    version: u64,
    /// Suggestions below this confidence are in it.
    pub below: f64,
    entries: Vec<QueueEntry>,
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
    #[error("{} is not a queue: {reason}; touchline collect writes one", path.display())]
    NotAQueue {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

impl Queue {
    pub(super) fn new(below: f64) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            below,
            entries: Vec::new(),
        }
    }

    /// Its entries, worst first.
    pub fn entries(&self) -> &[QueueEntry] {
        &self.entries
    }

    /// Whether the file at a path begins as a queue does.
    pub fn is_at(path: &Path) -> bool {
        // A queue may be large, so only its beginning is read: `to_text` writes these keys first
        // and without blanks.
        let mut beginning = Vec::new();
        let read = open_named(path).and_then(|file| file.take(64).read_to_end(&mut beginning));
        let begins = format!("{{\"format\":\"{FORMAT}\"");
        read.is_ok() && beginning.starts_with(begins.as_bytes())
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
        let refuse = |reason| QueueError::NotAQueue {
            path: path.to_path_buf(),
            reason,
        };
        let queue: Self = serde_json::from_str(&text).map_err(|error| refuse(error.to_string()))?;
        if queue.format == FORMAT && queue.version == VERSION {
            Ok(queue)
        } else {
            let (format, version) = (queue.format, queue.version);
            Err(refuse(format!("it is a {format:?} of version {version}")))
        }
    }

    /// Adds the doubtful frames of a match's project in a folder.
    pub(super) fn add_match(&mut self, name: &str, folder: &str, document: &Document) {
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
    pub(super) fn sort(&mut self) {
        let confidence = |entry: &QueueEntry| entry.confidence.unwrap_or(0.0);
        // The sort is stable, which leaves equals in the order of the season.
        self.entries.sort_by(|one, other| {
            confidence(one)
                .total_cmp(&confidence(other))
                .then(other.frames.cmp(&one.frames))
        });
    }

    /// Its file: JSON, an entry a line.
    pub(super) fn to_text(&self) -> String {
        let entries: Vec<String> = self
            .entries
            .iter()
            .map(|entry| serde_json::to_string(entry).unwrap_or_default())
            .collect();
        let separator = if entries.is_empty() { "" } else { "\n" };
        let head = format!("\"format\":\"{FORMAT}\",\"version\":{VERSION}");
        let (below, entries) = (self.below, entries.join(",\n"));
        format!("{{{head},\"below\":{below},\"entries\":[{separator}{entries}{separator}]}}\n")
    }
}

/// The stated confidence in a frame's camera.
pub(super) fn confidence_of(frame: &Frame) -> Option<f64> {
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
}
