//! What a frame's camera is good for on the ground, as exports state it.

use super::adapters::finite;
use crate::document::Extra;
use serde::{Deserialize, Serialize};

/// What a frame's camera is good for on the ground. A result that exports compute and write; it is
/// never an input.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ground {
    /// What places on the ground that are taken from its picture can be used for.
    #[serde(default)]
    pub grade: GroundGrade,
    /// 1-σ of a place on the field in the picture's middle third, the largest there, m; absent
    /// where the camera states no uncertainty, or no field is there.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub sigma_m: Option<f64>,
    /// The part of the field that the picture shows, as the corners of a polygon (`world` x and y,
    /// m); the last is joined to the first. Empty where it shows none.
    #[serde(default)]
    pub visible_area_m: Vec<[f64; 2]>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// What places on the ground that are taken from a frame's picture can be used for.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    strum::IntoStaticStr,
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum GroundGrade {
    /// Neither is known.
    #[default]
    None,
    /// They are right within 0.5 m at 95 %.
    Map,
    /// What stands seems to move by at most 0.1 m/s at 95 %, too, taken over a second.
    Speed,
}

impl GroundGrade {
    /// Its name in documents and tables.
    pub fn as_str(self) -> &'static str {
        self.into()
    }
}
