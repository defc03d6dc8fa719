//! Complete jobs that the window and the command line share. Each takes a document and reports its
//! progress; none prints.
//!
//! | job | function |
//! |---|---|
//! | a match, from its pictures to the cameras of all frames, without clicks or from few | [`label_match`] |
//! | the shots of a document's videos, and what they show | [`mark_shots`] |
//! | frames labelled by a forest: train, propose, check, record | [`learn_forest`], [`learn_from_found`], [`propose_on_lines`], [`label_frames`] |
//! | cameras of another program, one for each frame of a video, put on one camera and its paint | [`mend`] |
//! | clips tracked from known frames, with base and field corrected where needed | [`track_clips`] |

mod clicked_match;
mod forest_labels;
mod match_labels;
mod mend;
mod other_cameras;
mod shots;
mod track_clips;

pub use forest_labels::{LearnForestError, LearningProgress};
pub use match_labels::{
    LabelMatchError, LabelledMatch, MatchEvent, MatchLabels, MatchOptions, NoCamera, label_match,
};
pub use mend::{
    CommonError, GivenCamera, GivenFault, MendError, MendEvent, MendOptions, Mended, MendedFrame,
    NotAligned, Outcome, Tally, mend,
};
pub use track_clips::TrackingEvent;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    forest_labels::{
        ForestRequest, LearntForest, PictureFiles, label_frames, learn_forest, propose_on_lines,
    },
    match_labels::learn_from_found,
    mend::{
        CameraSurvey, ImpossibleCamera, LeftFrame, MENDED, MendedNumbers, NO_PLACE, mend_numbers,
        survey_cameras,
    },
    shots::{mark_shots, shot_starts},
    track_clips::{TrackedFrames, TrackingOptions, give_first_base, track_clips},
};
