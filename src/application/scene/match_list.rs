//! The matches of a queue, as rows of a list: how far each has come, by its project.

use super::shot_list::{ShotShows, certainty};
use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::geometry::{pluralise, thousands};
use touchline_documents::document::{Document, FrameStatus, shots_of_frames};
use touchline_vision::media::{FrameRef, FrameSource};
use touchline_vision::relocalize::CERTAIN;

/// How far a match has come, and what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchState {
    pub stage: MatchStage,
    /// Length of its videos; none for images and where it is not known.
    pub minutes: Option<f64>,
    /// The picture of its first frame.
    pub picture: Option<FrameRef>,
}

/// How far a match has come.
#[derive(Clone, Debug, PartialEq)]
pub enum MatchStage {
    /// It has no project.
    NotBegun,
    /// It has a project.
    Begun(MatchCounts),
    /// It cannot be opened, or no camera was found in it: the reason.
    Failed(String),
}

/// The frames and cameras of a match's project.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MatchCounts {
    pub frames: usize,
    /// Number of cameras with a base.
    pub cameras: usize,
    pub accepted: usize,
    pub rejected: usize,
    /// Number of frames with a certain camera; accepted ones are certain.
    pub certain: usize,
    /// Number of frames with a camera that is not certain.
    pub uncertain: usize,
    /// Number of frames of a field without a camera that are not rejected.
    pub none: usize,
    /// Number of stretches of neighbouring frames of a field without a certain camera.
    pub doubts: usize,
}

impl MatchState {
    /// The state of a match that failed, without its own path at the head of the reason: the row
    /// names it.
    pub fn from_failure(reason: &str, path: &Path) -> Self {
        let stage = MatchStage::Failed(without_path(reason, path).to_owned());
        Self {
            stage,
            minutes: None,
            picture: None,
        }
    }

    /// The state of a match whose project is yet to be made.
    pub fn from_frames(frames: &FrameSource) -> Self {
        let seconds = match frames {
            FrameSource::Video(video) => video.pts_s(video.decoded_frames.saturating_sub(1)),
            FrameSource::Folder(_) => None,
        };
        Self {
            stage: MatchStage::NotBegun,
            minutes: seconds.map(|seconds| seconds / 60.0),
            picture: frames.frame(0),
        }
    }

    /// The state of a match by its project in a folder.
    pub fn from_document(document: &Document, folder: &Path) -> Self {
        let first = document.frames.first();
        Self {
            stage: MatchStage::Begun(MatchCounts::from_document(document)),
            minutes: minutes_of(document),
            picture: first.and_then(|frame| frame.picture_source(folder)),
        }
    }

    /// The counts of its project, if it has one.
    pub const fn counts(&self) -> Option<&MatchCounts> {
        match &self.stage {
            MatchStage::Begun(counts) => Some(counts),
            MatchStage::NotBegun | MatchStage::Failed(_) => None,
        }
    }

    /// How far it has come, in words.
    pub fn describe(&self) -> String {
        match &self.stage {
            MatchStage::NotBegun => "not begun".to_owned(),
            MatchStage::Failed(reason) => format!("failed: {reason}"),
            MatchStage::Begun(counts) => counts.describe(),
        }
    }

    /// Its length, such as "8.5 min", and the number of its doubts, as far as both are known.
    pub fn describe_rest(&self) -> String {
        let minutes = self.minutes.map(|minutes| format!("{minutes:.1} min"));
        let doubts = self.counts().filter(|counts| counts.cameras > 0);
        let doubts = doubts.map(|counts| pluralise(counts.doubts, "doubt"));
        minutes
            .into_iter()
            .chain(doubts)
            .collect::<Vec<_>>()
            .join(", ")
    }
}

impl MatchCounts {
    fn from_document(document: &Document) -> Self {
        let with_base = document
            .cameras
            .iter()
            .filter(|camera| camera.base().is_some());
        let mut counts = Self {
            frames: document.frames.len(),
            cameras: with_base.count(),
            ..Self::default()
        };
        let mut was_doubtful = None;
        for (frame, shot) in document.frames.iter().zip(shots_of_frames(document)) {
            let shows = shot.map_or(ShotShows::Field, |shot| {
                ShotShows::from_shot(&document.shots[shot])
            });
            let is_rejected = frame.status == FrameStatus::Rejected;
            let certainty = certainty(frame);
            let is_certain = certainty.is_some_and(|certainty| certainty >= CERTAIN);
            let is_wanted = shows == ShotShows::Field && !is_rejected;
            counts.accepted += usize::from(frame.status == FrameStatus::Reference);
            counts.rejected += usize::from(is_rejected);
            counts.certain += usize::from(is_certain);
            counts.uncertain += usize::from(certainty.is_some() && !is_certain);
            counts.none += usize::from(certainty.is_none() && is_wanted);
            // A stretch ends with a certain frame, a shot or a camera.
            let doubtful = (is_wanted && !is_certain).then_some((shot, &frame.camera));
            counts.doubts += usize::from(doubtful.is_some() && doubtful != was_doubtful);
            was_doubtful = doubtful;
        }
        counts
    }

    /// Number of frames that are neither accepted nor rejected.
    pub const fn to_do(&self) -> usize {
        self.frames - self.accepted - self.rejected
    }

    fn describe(&self) -> String {
        let accepted = thousands(self.accepted);
        match (self.cameras, self.accepted, self.to_do()) {
            (_, 1.., 0) => format!("done, {accepted} accepted"),
            (_, 1.., _) => format!("{accepted} of {} accepted", pluralise(self.frames, "frame")),
            (0, ..) => "no camera yet".to_owned(),
            (cameras, ..) => format!("{} found", pluralise(cameras, "camera")),
        }
    }
}

/// A reason without a path at its head.
pub fn without_path<'a>(reason: &'a str, path: &Path) -> &'a str {
    let head = format!("{}: ", path.display());
    reason.strip_prefix(&head).unwrap_or(reason)
}

/// The length of a document's videos from their first to their last frames in it; none without
/// one.
fn minutes_of(document: &Document) -> Option<f64> {
    let mut spans: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
    for video in document
        .frames
        .iter()
        .filter_map(|frame| frame.video.as_ref())
    {
        let Some(pts_s) = video.pts_s else { continue };
        let span = spans.entry(&video.path).or_insert([pts_s; 2]);
        *span = [span[0].min(pts_s), span[1].max(pts_s)];
    }
    let seconds: f64 = spans.values().map(|[first, last]| last - first).sum();
    (!spans.is_empty()).then_some(seconds / 60.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::Camera;
    use touchline_documents::testing::broadcast;

    #[test]
    fn what_a_person_has_to_look_at_is_counted_by_stretches() {
        let mut document = broadcast();
        let counts = MatchCounts::from_document(&document);
        assert_eq!(
            (counts.frames, counts.certain, counts.uncertain, counts.none),
            (20, 5, 1, 6)
        );
        assert_eq!(
            counts.doubts, 2,
            "the uncertain frame, and the shot without a camera"
        );
        for index in 14..20 {
            document.frames[index].status = FrameStatus::Rejected;
        }
        let counts = MatchCounts::from_document(&document);
        assert_eq!(
            (counts.rejected, counts.none, counts.doubts, counts.to_do()),
            (6, 0, 1, 14)
        );
    }

    #[test]
    fn the_state_is_that_of_the_project() {
        let mut document = broadcast();
        let says =
            |document: &Document| MatchState::from_document(document, Path::new("/m")).describe();
        let size = ImageSize::new(64, 36);
        document
            .cameras
            .push(Camera::new("main".into(), size).into());
        assert_eq!(says(&document), "no camera yet");
        let base = touchline_core::testing::base_at([0.0, -60.0, 18.0], size);
        document.cameras[0].set_base(&base);
        assert_eq!(says(&document), "1 camera found");
        document.frames[0].status = FrameStatus::Reference;
        assert_eq!(says(&document), "1 of 20 frames accepted");
        for frame in &mut document.frames {
            frame.status = FrameStatus::Reference;
        }
        assert_eq!(says(&document), "done, 20 accepted");
    }
}
