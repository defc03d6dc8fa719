//! A blind click: a landmark clicked again without a look at its label.

use super::{Extra, adapters};
use crate::field::LandmarkId;
use crate::geometry::ImagePoint;
use serde::{Deserialize, Serialize};

/// A landmark of a labelled frame, clicked again without a look at the label.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Repeat {
    /// What was asked for.
    #[serde(with = "adapters::name")]
    pub landmark: LandmarkId,
    /// Where it was clicked, px of the frame.
    #[serde(rename = "image_px", with = "adapters::image_point")]
    pub image: ImagePoint,
    /// In which round of the document, from 1.
    pub round: u32,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl Repeat {
    /// A blind click of a round.
    #[must_use]
    pub fn new(landmark: LandmarkId, image: ImagePoint, round: u32) -> Self {
        Self { landmark, image, round, extra: Extra::new() }
    }
}
