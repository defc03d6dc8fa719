//! The background trainer as the window sees it: what it is doing, what it has found out.

use std::sync::Arc;
use std::time::Duration;
use touchline_calibration::proposals::{
    CarriedProposal, Coverage, Proposal, Quality, RefusedForests, Suspect, TrainingSampleError,
    UsedFeatures,
};
use touchline_core::progress::Share;
use touchline_documents::document::{Document, FrameId};

/// What the app knows of the trainer.
#[derive(Clone, Debug, Default)]
pub struct TrainerState {
    /// The last it reported.
    pub status: TrainerStatus,
    /// The user has it rest.
    pub paused: bool,
    /// The features of the shown frame lie over the picture.
    pub show_features: bool,
    /// Those of the frame that was looked at last.
    pub features: Option<UsedFeatures>,
    /// The version of the document that it knows.
    pub(super) told_version: Option<u64>,
    /// The frame that it knows to be shown.
    pub(super) told_frame: Option<FrameId>,
    /// It knows that proposals are to be snapped.
    pub(super) told_snapping: bool,
}

/// What the trainer reports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainerStatus {
    /// What it is doing.
    pub doing: Doing,
    /// How long that will take by its pace so far; none before there is a pace.
    pub left: Option<Duration>,
    /// References of the document.
    pub references: usize,
    /// Those that are used for training.
    pub training_frames: usize,
    /// Those that are left out by choice, such as accepted suggestions. The rest waits for the base
    /// of its camera.
    pub withheld: usize,
    /// Training frames that cannot be used.
    pub failed: Arc<[UnusableReference]>,
    /// The forest that answers.
    pub forest: Option<ForestFacts>,
    /// Frames that it has answered.
    pub answered: usize,
    /// Frames that it has no answer for.
    pub unanswered: usize,
    /// Its accuracy.
    pub quality: Option<Arc<Quality>>,
    /// References whose labels contradict others.
    pub suspects: Arc<[Suspect]>,
    /// Where the references of each camera look that has any, and where one is missing.
    pub coverage: Arc<[Coverage]>,
    /// What went wrong: one line.
    pub trouble: Option<String>,
    /// Why nothing is kept on disk, if so.
    pub not_kept: Option<String>,
}

/// A reference that gives no training sample.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnusableReference {
    /// Which frame.
    pub frame: FrameId,
    /// Why it gives none.
    pub error: TrainingSampleError,
}

/// What the trainer is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Doing {
    /// Nothing: there is nothing to do.
    #[default]
    Nothing,
    /// It waits a moment for further references.
    Settling,
    /// It finds the features of references.
    Features(Share),
    /// It trains.
    Training(Share),
    /// It asks the forest for cameras of frames.
    Proposing(Share),
    /// It carries cameras from key frames of videos to the frames between.
    Carrying(Share),
    /// It tests the forest on references that are left out.
    Measuring(Share),
    /// It rests.
    Paused,
}

/// The forest that answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ForestFacts {
    /// Later forests have greater numbers.
    pub generation: u64,
    /// References that it was trained on.
    pub references: usize,
    /// Their features.
    pub features: usize,
    /// Its trees, over all cameras.
    pub trees: usize,
    /// Their leaves.
    pub leaves: usize,
    /// What features and training took; none for one that was kept from an earlier session.
    pub took: Option<Duration>,
}

/// An answer of the trainer, named by what was asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnswerKey {
    /// The frame that was asked for.
    pub frame: FrameId,
    /// Its revision then.
    pub revision: u64,
    /// The forest that answered, or whose answers were carried to the frame.
    pub generation: u64,
    /// The camera was carried to the frame.
    pub is_carried: bool,
}

/// A message to the trainer.
#[derive(Clone, Debug, PartialEq)]
pub enum TrainerOrder {
    /// The document as it is now: references may be new, changed or withdrawn. What the trainer
    /// itself answered is told by [`Self::Shown`] instead.
    Document(Box<Document>),
    /// The document shows these answers now, and is otherwise as the trainer has it.
    Shown(Vec<AnswerKey>),
    /// Answers were discarded: forests that may not be asked again.
    Refused(RefusedForests),
    /// The frame that is shown now: its neighbours come first.
    Frame(FrameId),
    /// The features of the shown frame are wanted, or not any more.
    Features(bool),
    /// It rests, or goes on.
    Pause(bool),
    /// Proposals are snapped to the painted lines before they are shown, or left as the forest
    /// gives them.
    Snap(bool),
}

impl Doing {
    /// In words, with numbers.
    #[must_use]
    pub fn describe(self) -> String {
        let share = |what: &str, Share { done, of }: Share| format!("{what}: {done} of {of}");
        match self {
            Self::Nothing => "Up to date".to_owned(),
            Self::Settling => "Waiting for further references".to_owned(),
            Self::Features(done) => share("Finding features of references", done),
            Self::Training(done) => format!("Training: {:.0} %", 100.0 * done.fraction()),
            Self::Proposing(done) => share("Proposing cameras", done),
            Self::Carrying(done) => share("Carrying cameras to the frames between", done),
            Self::Measuring(done) => share("Measuring accuracy", done),
            Self::Paused => "Paused".to_owned(),
        }
    }

    /// In a word or two with a number, while something goes on.
    #[must_use]
    pub fn in_brief(self) -> Option<String> {
        Some(match self {
            Self::Nothing | Self::Settling => return None,
            Self::Features(share) => format!("features {}/{}", share.done, share.of),
            Self::Training(share) => format!("training {:.0} %", 100.0 * share.fraction()),
            Self::Proposing(share) => format!("proposing {}/{}", share.done, share.of),
            Self::Carrying(share) => format!("carrying {}/{}", share.done, share.of),
            Self::Measuring(share) => format!("measuring {}/{}", share.done, share.of),
            Self::Paused => "trainer paused".to_owned(),
        })
    }

    /// How much longer it takes at the pace at which it came here from an earlier state, some time
    /// ago; none where they are not parts of the same, or so little was done since that it says
    /// nothing.
    #[must_use]
    pub fn left_since(self, earlier: Self, elapsed: Duration) -> Option<Duration> {
        /// A pace is that of some seconds.
        const LEAST: Duration = Duration::from_secs(4);
        let (now, then) = (self.share()?, earlier.share()?);
        let done = now.done.checked_sub(then.done).filter(|done| *done > 0)?;
        let is_paced = self.is_kind_of(earlier) && elapsed >= LEAST;
        is_paced.then(|| elapsed.mul_f64(now.of.saturating_sub(now.done) as f64 / done as f64))
    }

    /// How far it has come, where that is known.
    #[must_use]
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

    /// Whether two are of the same kind, however far they have come.
    #[must_use]
    pub fn is_kind_of(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }
}

/// A time that is left, in words: as rough as it is known.
#[must_use]
pub fn describe_left(left: Duration) -> String {
    match left.as_secs() {
        0..=9 => "a few seconds left".to_owned(),
        seconds @ 10..=89 => format!("about {}\u{a0}s left", seconds.next_multiple_of(10)),
        seconds @ 90..=5_399 => format!("about {}\u{a0}min left", seconds.div_ceil(60)),
        seconds => format!("about {:.1}\u{a0}h left", seconds as f64 / 3600.0),
    }
}

/// A report of the trainer.
#[derive(Clone, Debug, PartialEq)]
pub enum TrainerReport {
    /// What it is doing and has found out, when that changed.
    Status(Box<TrainerStatus>),
    /// What the forest proposes.
    Proposals(Vec<Proposal>),
    /// Cameras carried from key frames of a video to those between them.
    Carried(Vec<CarriedProposal>),
    /// How the forest used the shown frame's features.
    Features(Box<UsedFeatures>),
    /// An internal error stopped it; there is no trainer any more.
    Broken {
        /// The panic's message.
        message: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_follows_from_the_pace() {
        let at = |done: usize| Doing::Proposing(Share { done, of: 100 });
        let left = |now: Doing, then: Doing, seconds: u64| {
            now.left_since(then, Duration::from_secs(seconds))
        };
        assert_eq!(left(at(30), at(10), 10), Some(Duration::from_secs(35)));
        assert_eq!(left(at(100), at(10), 10), Some(Duration::ZERO));
        assert_eq!(left(at(30), at(10), 2), None, "two seconds are no pace");
        assert_eq!(left(at(10), at(10), 10), None);
        assert_eq!(left(at(5), at(10), 10), None);
        assert_eq!(
            left(at(30), Doing::Carrying(Share { done: 10, of: 100 }), 10),
            None
        );
        assert_eq!(left(Doing::Nothing, at(10), 10), None);
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
