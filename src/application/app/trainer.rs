//! The background trainer as the application sees it: orders to it, its reports and its state.

use std::sync::Arc;
use std::time::Duration;
use touchline_calibration::proposals::{
    Coverage, Proposal, Quality, RefusedForests, Suspect, TrackedProposal, TrainingSampleError,
    UsedFeatures,
};
use touchline_core::progress::Share;
use touchline_documents::document::{Document, FrameId};

/// What the application stores about the trainer.
#[derive(Clone, Debug, Default)]
pub struct TrainerState {
    /// The last status that it reported.
    pub status: TrainerStatus,
    /// Whether the user has paused it.
    pub paused: bool,
    /// Whether the features of the shown frame are drawn.
    pub show_features: bool,
    /// The features of the frame that was examined last.
    pub features: Option<UsedFeatures>,
    /// The version of the document that the trainer has.
    pub(super) sent_version: Option<u64>,
    /// What the trainer has been asked for last.
    pub(super) sent: TrainerWishes,
}

/// How the trainer works.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TrainerWishes {
    /// The shown frame; its neighbours are answered first.
    pub frame: Option<FrameId>,
    /// Whether to report the features of the shown frame.
    pub features: bool,
    /// Whether the trainer rests.
    pub paused: bool,
    /// Whether proposals are aligned to the painted lines before they are shown.
    pub snapping: bool,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainerStatus {
    pub doing: TrainerActivity,
    /// Estimated remaining time of the activity; none if there is no estimate yet.
    pub left: Option<Duration>,
    /// Number of references in the document.
    pub references: usize,
    /// Number of references used for training.
    pub training_frames: usize,
    /// Number of references left out by choice, such as accepted suggestions. The remaining ones
    /// wait for the base of their camera.
    pub withheld: usize,
    /// Training frames from which no training sample could be made.
    pub failed: Arc<[UnusableReference]>,
    /// The forest in use.
    pub forest: Option<ForestFacts>,
    /// Number of frames with an answer.
    pub answered: usize,
    /// Number of frames without one.
    pub unanswered: usize,
    /// The accuracy of the forest.
    pub quality: Option<Arc<Quality>>,
    /// References with labels that contradict others.
    pub suspects: Arc<[Suspect]>,
    /// Coverage by the references of each camera that has any, and where one is missing.
    pub coverage: Arc<[Coverage]>,
    /// An error, in one line.
    pub trouble: Option<String>,
    /// Why nothing is stored on disk, if so.
    pub not_kept: Option<String>,
}

/// A reference from which no training sample could be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnusableReference {
    pub frame: FrameId,
    /// The reason.
    pub error: TrainingSampleError,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TrainerActivity {
    /// None: everything is up to date.
    #[default]
    Nothing,
    /// Waiting a moment for further references.
    Settling,
    /// Detecting features in references.
    Features(Share),
    /// Training the forest.
    Training(Share),
    /// Computing proposals for frames.
    Proposing(Share),
    /// Tracking cameras from key frames of videos to the frames between.
    Carrying(Share),
    /// Testing the forest on references that are left out of it.
    Measuring(Share),
    /// Paused by the user.
    Paused,
}

/// Facts about the forest in use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ForestFacts {
    /// The number of the forest; it grows with each training.
    pub generation: u64,
    /// Number of references on which it was trained.
    pub references: usize,
    /// Number of their features.
    pub features: usize,
    /// Number of trees, over all cameras.
    pub trees: usize,
    /// Number of leaves.
    pub leaves: usize,
    /// Duration of feature detection and training; none for a forest from an earlier session.
    pub took: Option<Duration>,
}

/// Identifies an answer of the trainer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnswerKey {
    pub frame: FrameId,
    /// The revision of the frame that was answered.
    pub revision: u64,
    /// The generation of the forest that answered, or from whose answers the camera was tracked.
    pub generation: u64,
    /// Whether the camera was tracked from other frames.
    pub is_tracked: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum TrainerOrder {
    /// The document has changed: references may be new, different or withdrawn. For changes by the
    /// trainer's own answers there is [`Self::Shown`].
    Document(Box<Document>),
    /// The document now shows these answers; nothing else has changed.
    Shown(Vec<AnswerKey>),
    /// Answers were discarded: these forests must not answer again.
    Refused(RefusedForests),
    /// It works in another way.
    Wishes(TrainerWishes),
}

impl TrainerActivity {
    /// The activity as text, with numbers.
    pub fn describe(self) -> String {
        match self {
            Self::Nothing => "Up to date".to_owned(),
            Self::Settling => "Waiting for further references".to_owned(),
            Self::Features(done) => describe_share("Finding features of references", done),
            Self::Training(done) => format!("Training: {:.0} %", 100.0 * done.fraction()),
            Self::Proposing(done) => describe_share("Proposing cameras", done),
            Self::Carrying(done) => describe_share("Tracking the frames between key frames", done),
            Self::Measuring(done) => describe_share("Measuring accuracy", done),
            Self::Paused => "Paused".to_owned(),
        }
    }

    /// The activity in a word or two with a number; none while there is no activity.
    pub fn in_brief(self) -> Option<String> {
        Some(match self {
            Self::Nothing | Self::Settling => return None,
            Self::Features(share) => format!("features {}/{}", share.done, share.of),
            Self::Training(share) => format!("training {:.0} %", 100.0 * share.fraction()),
            Self::Proposing(share) => format!("proposing {}/{}", share.done, share.of),
            Self::Carrying(share) => format!("tracking {}/{}", share.done, share.of),
            Self::Measuring(share) => format!("measuring {}/{}", share.done, share.of),
            Self::Paused => "trainer paused".to_owned(),
        })
    }

    /// Estimated time until this activity ends, from the progress since an earlier state. None if
    /// the two are different activities, or the pace cannot be estimated yet.
    pub fn estimate_time_left(self, earlier: Self, elapsed: Duration) -> Option<Duration> {
        /// Minimum time from which a pace is estimated.
        const MIN_ELAPSED: Duration = Duration::from_secs(4);
        let (now, then) = (self.share()?, earlier.share()?);
        // The pace since `earlier`, continued: the remaining share takes as long per part.
        let done = now.done.checked_sub(then.done).filter(|done| *done > 0)?;
        let is_paced = self.is_kind_of(earlier) && elapsed >= MIN_ELAPSED;
        is_paced.then(|| elapsed.mul_f64(now.of.saturating_sub(now.done) as f64 / done as f64))
    }

    /// The progress of the activity, if it has one.
    pub const fn share(self) -> Option<Share> {
        match self {
            Self::Features(share)
            | Self::Training(share)
            | Self::Proposing(share)
            | Self::Carrying(share)
            | Self::Measuring(share) => Some(share),
            Self::Nothing | Self::Settling | Self::Paused => None,
        }
    }

    /// Whether two are the same activity, regardless of progress.
    pub fn is_kind_of(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }
}

fn describe_share(what: &str, Share { done, of }: Share) -> String {
    format!("{what}: {done} of {of}")
}

/// A remaining time as text.
pub fn describe_left(left: Duration) -> String {
    format!("{} left", describe_estimate(left))
}

/// An estimated time as text, rounded according to its uncertainty.
pub fn describe_estimate(time: Duration) -> String {
    match time.as_secs() {
        0..=9 => "a few seconds".to_owned(),
        seconds @ 10..=89 => format!("about {}\u{a0}s", seconds.next_multiple_of(10)),
        seconds @ 90..=5_399 => format!("about {}\u{a0}min", seconds.div_ceil(60)),
        seconds => format!("about {:.1}\u{a0}h", seconds as f64 / 3600.0),
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum TrainerReport {
    /// The status, after every change.
    Status(Box<TrainerStatus>),
    /// Proposals of the forest.
    Proposals(Vec<Proposal>),
    /// Cameras that were tracked from key frames of a video to the frames between.
    Tracked(Vec<TrackedProposal>),
    /// How the forest used the features of the shown frame.
    Features(Box<UsedFeatures>),
    /// The trainer stopped by an internal error and does not restart.
    Broken {
        /// The message of the panic.
        message: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_follows_from_the_pace() {
        let at = |done: usize| TrainerActivity::Proposing(Share { done, of: 100 });
        let left = |now: TrainerActivity, then: TrainerActivity, seconds: u64| {
            now.estimate_time_left(then, Duration::from_secs(seconds))
        };
        assert_eq!(left(at(30), at(10), 10), Some(Duration::from_secs(35)));
        assert_eq!(left(at(100), at(10), 10), Some(Duration::ZERO));
        assert_eq!(left(at(30), at(10), 2), None, "two seconds are no pace");
        assert_eq!(left(at(10), at(10), 10), None);
        assert_eq!(left(at(5), at(10), 10), None);
        assert_eq!(
            left(
                at(30),
                TrainerActivity::Carrying(Share { done: 10, of: 100 }),
                10
            ),
            None
        );
        assert_eq!(left(TrainerActivity::Nothing, at(10), 10), None);
        let words =
            [3, 41, 119, 3600, 7200].map(|seconds| describe_left(Duration::from_secs(seconds)));
        let expected = [
            "a few seconds left",
            "about 50\u{a0}s left",
            "about 2\u{a0}min left",
            "about 60\u{a0}min left",
            "about 2.0\u{a0}h left",
        ];
        assert_eq!(words, expected);
    }
}
