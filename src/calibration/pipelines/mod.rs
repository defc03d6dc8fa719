//! Complete jobs that the window and the command line share. Each takes a document and reports its
//! progress; none prints.
//!
//! | job | function |
//! |---|---|
//! | a match, from its pictures to the cameras of all frames, without clicks or from few | [`label_match`] |
//! | the shots of a document's videos, and what they show | `mark_shots` |
//! | frames labelled by a forest: train, propose, check, record | [`learn_forest`], [`learn_from_found`], [`propose_on_lines`], [`label_frames`] |
//! | cameras of another program, one for each frame of a video, put on one camera and its paint | [`mend`] |
//! | a venue's cameras, known again in another match | [`make_venue`], [`MatchOptions::venues`] |
//! | clips tracked from known frames, with base and field corrected where needed | [`track_clips`] |

mod clicked_match;
mod clip_evidence;
mod find_cameras;
mod forest_labels;
mod kept_search;
mod kept_work;
mod match_labels;
mod mend;
mod no_camera;
mod other_cameras;
mod same_camera;
mod shots;
mod track_clips;
mod venue_choice;
mod venue_trial;
mod venues;

pub use forest_labels::{LearnForestError, LearningProgress};
pub use match_labels::{
    LabelMatchError, LabelledMatch, MatchEvent, MatchLabels, MatchOptions, label_match,
};
pub use mend::{
    CommonError, GivenCamera, GivenFault, MendError, MendEvent, MendOptions, Mended, MendedFrame,
    NotAligned, Outcome, Tally, mend,
};
pub use no_camera::NoCamera;
pub use track_clips::TrackingEvent;
pub use track_clips::track_clips;
pub use venues::{
    BaseChange, NewVenue, RecognisedCamera, VENUE_ENDING, Venue, VenueError, VenueEvent,
    VenueRefusal, Whereabouts, make_venue,
};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    forest_labels::ForestRequest, forest_labels::LearntForest, forest_labels::PictureFiles,
    forest_labels::label_frames, forest_labels::learn_forest, forest_labels::propose_on_lines,
    match_labels::learn_from_found, mend::CameraSurvey, mend::ImpossibleCamera, mend::LeftFrame,
    mend::MENDED, mend::MendedNumbers, mend::NO_PLACE, mend::mend_numbers, mend::survey_cameras,
    shots::shot_starts, track_clips::TrackedFrames, track_clips::TrackingOptions,
    track_clips::give_first_base,
};
