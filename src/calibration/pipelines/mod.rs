//! Whole jobs that the window and the command line share. Each takes a document and reports on its way; none prints.

mod track_clips;

pub use track_clips::{TrackedFrames, TrackingEvent, TrackingOptions, WatchTracking, give_first_base, track_clips};
