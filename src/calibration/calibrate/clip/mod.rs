//! Tracking of a clip: the cameras of known frames are propagated to all others and adjusted
//! jointly.

mod anchors;
mod certainty;
mod error;
mod evidence;
mod fit;
mod frames;
mod kept_clips;
mod options;
mod paint;
mod pictures;
mod readable;
mod record;
mod stretch;
mod track;
mod unmeasured;

pub use anchors::is_anchor;
pub use error::TrackClipError;
pub use evidence::ClipEvidence;
pub(crate) use evidence::EvidenceBytes;
pub use frames::{ClipFrame, ClipFrames, ClipSpan, clip_of_frame, clips};
pub use options::{ClipProgress, TrackClipOptions};
pub use readable::track_clip;
pub use record::record_tracked;
pub(crate) use record::record_tracked_frame;
pub use stretch::{is_doubtful, take_doubtful_stretch};
pub use track::{ClipStop, MovedReference, TrackedClip, TrackedFrame};
