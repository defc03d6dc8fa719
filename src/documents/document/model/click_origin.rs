//! Where a click comes from that no person placed: a point of another program's model.

use super::adapters::{self, finite};
use crate::document::Extra;
use serde::{Deserialize, Serialize};
use touchline_core::geometry::ImagePoint;

/// What the name of a model's origin begins with.
const MODEL: &str = "model:";

/// The origin of a click that a model gave, such as a network that finds landmarks.
///
/// Such a click is evidence with its own σ and counts as no person's work. It becomes a person's as
/// soon as one moves or renames it; then the origin keeps [where the model had it](Self::given).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ClickOrigin {
    /// `model:` and the model's name.
    pub name: String,
    /// The model's own name of the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// The probability that the model states.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// 1-σ of the point in each direction, px of the frame; none: as for a person's click.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    #[serde(
        default,
        with = "adapters::optional_positive",
        skip_serializing_if = "Option::is_none"
    )]
    pub sigma_px: Option<f64>,
    /// Where the model had it, px, once a person moved or renamed it.
    #[cfg_attr(feature = "schema", schemars(with = "Option<[f64; 2]>"))]
    #[serde(
        rename = "given_px",
        serialize_with = "finite",
        skip_serializing_if = "Option::is_none"
    )]
    pub given: Option<ImagePoint>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl ClickOrigin {
    /// The origin of a point of a model.
    pub fn from_model(model: &str) -> Self {
        Self {
            name: format!("{MODEL}{model}"),
            label: None,
            probability: None,
            sigma_px: None,
            given: None,
            extra: Extra::new(),
        }
    }

    /// The model's name.
    pub fn model(&self) -> &str {
        self.name.strip_prefix(MODEL).unwrap_or(&self.name)
    }
}
