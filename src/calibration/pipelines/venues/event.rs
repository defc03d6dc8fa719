//! What is reported while venues are tried.

use super::change::BaseChange;
use crate::autocalibrate::{Doubt, MIN_NATS};
use thiserror::Error;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::CameraId;

/// Events while the venues are tried.
#[derive(Clone, Debug)]
pub enum VenueEvent {
    /// Frames are compared with the features of a venue.
    Trying {
        /// The venue.
        venue: String,
    },
    /// A camera of a venue did not take the frames.
    Refused {
        /// The venue.
        venue: String,
        /// Its camera.
        camera: CameraId,
        /// Why not.
        why: VenueRefusal,
    },
    /// A camera of a venue took the frames.
    Recognised(RecognisedCamera),
}

/// A camera of a venue that was recognised.
#[derive(Clone, Debug)]
pub struct RecognisedCamera {
    /// The venue.
    pub venue: String,
    /// Its camera.
    pub camera: CameraId,
    /// How it stands now.
    pub change: BaseChange,
    /// Number of frames tried.
    pub tried: usize,
    /// Number of them that show what the camera saw.
    pub answered: usize,
    /// Number of them that lie on their own paint.
    pub aligned: usize,
    /// The evidence of their paint, nats.
    pub nats: f64,
}

/// Why a camera of a venue is not the one that took some frames.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum VenueRefusal {
    /// Its pictures have other proportions.
    #[error("its pictures are {} × {} px, of other proportions", size.width, size.height)]
    OtherSize {
        /// Their size, px.
        size: ImageSize,
    },
    /// It looks at the field of another sport, or one that cannot be had.
    #[error("its field is {template}")]
    OtherField {
        /// The template of its field.
        template: String,
    },
    /// Too few frames show its features.
    #[error("another camera: {answered} of {of} frames show what it saw")]
    NotRecognised {
        /// Number of frames that do.
        answered: usize,
        /// Number of frames tried.
        of: usize,
    },
    /// Its features are there, and the paint is not.
    #[error(
        "another camera: {aligned} of {answered} frames that look like its own lie on their paint"
    )]
    NotOnPaint {
        /// Number of frames that lie on their paint.
        aligned: usize,
        /// Number of frames that its features answer.
        answered: usize,
    },
    /// The paint speaks too little for it.
    #[error(
        "another camera: evidence of {nats:.0} nats ({MIN_NATS:.0} are needed), \
         {:.0} % of it contradicted",
        100.0 * contradicted
    )]
    LittleEvidence {
        /// The evidence, nats.
        nats: f64,
        /// The share that is contradicted.
        contradicted: f64,
    },
    /// A click of the match lies elsewhere.
    #[error("{0}")]
    Contradicted(Doubt),
    /// The frames are those of a camera that stands elsewhere.
    #[error("another camera: {0}")]
    Elsewhere(BaseChange),
    /// Another venue answers as well, from another place.
    #[error("{nats:.0} nats, and {other} from another place {of_other:.0}: neither is taken")]
    RunnerUp {
        /// The evidence for this one, nats.
        nats: f64,
        /// The other venue.
        other: String,
        /// The evidence for that one, nats.
        of_other: f64,
    },
}
