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

pub use forest_labels::{
    ForestRequest, LearnForestError, LearningProgress, LearntForest, PictureFiles, label_frames,
    learn_forest, propose_on_lines,
};
pub use match_labels::{
    LabelMatchError, LabelledMatch, MatchEvent, MatchLabels, MatchOptions, NoCamera, label_match,
    learn_from_found,
};
pub use mend::{
    CameraSurvey, CommonError, GivenCamera, GivenFault, ImpossibleCamera, LeftFrame, MENDED,
    MendError, MendEvent, MendOptions, Mended, MendedFrame, MendedNumbers, NO_PLACE, NotAligned,
    Outcome, Tally, mend, mend_numbers, survey_cameras,
};
pub use shots::{mark_shots, shot_starts};
pub use track_clips::{
    TrackedFrames, TrackingEvent, TrackingOptions, give_first_base, track_clips,
};
