//! A shot: what one camera filmed without a cut.

use crate::document::{CameraId, Extra, FrameId};
use serde::{Deserialize, Serialize};

/// A shot of a video as a document lists it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Shot {
    /// Its first frame.
    pub from: ShotEnd,
    /// Its last frame.
    pub to: ShotEnd,
    /// The camera that filmed it, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraId>,
    /// How it was found.
    pub kind: ShotKind,
    /// What its pictures show, where that was examined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<ShotContent>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// Where a shot begins or ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum ShotEnd {
    /// A frame of the video, counted from 0.
    VideoFrame(u64),
    /// A frame of the document.
    Frame(FrameId),
}

/// How a shot was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ShotKind {
    /// By a hard cut.
    Cut,
    /// By a fade, dissolve or wipe before it.
    Fade,
    /// It is no shot, but the dissolve, wipe or fade between two: its frames show both or none, and
    /// get no camera.
    Transition,
    /// A person marked it.
    ByHand,
}

/// What the pictures of a shot show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ShotContent {
    /// The field with painted lines.
    Field,
    /// A close-up, the crowd, a studio, graphics: no lines of a field to measure.
    NoField,
}
