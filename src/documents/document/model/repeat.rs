//! A blind click: a landmark clicked again without a look at its label.

use super::adapters::{self, finite};
use crate::document::Extra;
use serde::{Deserialize, Serialize};
use touchline_core::field::LandmarkId;
use touchline_core::geometry::ImagePoint;

/// A landmark of a labelled frame, clicked again without a look at the label.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Repeat {
    /// The landmark to click again.
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    #[serde(with = "adapters::name")]
    pub landmark: LandmarkId,
    /// Where it was clicked, px of the frame.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 2]"))]
    #[serde(rename = "image_px", serialize_with = "finite")]
    pub image: ImagePoint,
    /// In which round of the document, from 1.
    pub round: u32,
    /// When, as in RFC 3339: `2026-05-01T18:30:00Z`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<String>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl Repeat {
    /// A blind click of a round, without its time.
    pub fn new(landmark: LandmarkId, image: ImagePoint, round: u32) -> Self {
        Self {
            landmark,
            image,
            round,
            at: None,
            extra: Extra::new(),
        }
    }
}
