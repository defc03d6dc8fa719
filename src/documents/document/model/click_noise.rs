//! The annotator's own click noise as a document stores it, and its effect on the clicks' sigmas.

use super::adapters::{self, finite};
use crate::document::Extra;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use touchline_core::field::{CLICKING_SHARE, FieldModel};

/// The plausible range of factors.
const PLAUSIBLE_FACTOR: std::ops::RangeInclusive<f64> = 0.05..=20.0;

/// An annotator's own click noise as a document keeps it (`click_noise`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ClickNoise {
    /// The solve uses it.
    #[serde(rename = "use")]
    pub in_use: bool,
    /// The annotator's scatter as a multiple of the usual one.
    #[cfg_attr(feature = "schema", schemars(with = "f64", extend("exclusiveMinimum" = 0)))]
    #[serde(rename = "hand_factor", with = "adapters::positive")]
    pub factor: f64,
    /// The same for single landmarks.
    #[serde(
        rename = "hand_factor_by_landmark",
        default,
        skip_serializing_if = "BTreeMap::is_empty",
        serialize_with = "finite"
    )]
    pub factor_by_landmark: BTreeMap<String, f64>,
    /// 1-σ of a click in each direction, px at 1920 px width, for people.
    #[cfg_attr(feature = "schema", schemars(with = "f64", extend("exclusiveMinimum" = 0)))]
    #[serde(with = "adapters::positive")]
    pub sigma_px: f64,
    /// Its 95 % interval, px.
    #[serde(serialize_with = "finite")]
    pub sigma_interval_95_px: [f64; 2],
    /// How many repeats it rests on.
    pub repeats: usize,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// What a document keeps of the scatter of its clicks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum StoredClickNoise {
    /// An annotator's own.
    Own(ClickNoise),
    /// A value that is not readable as click noise; it is kept unused, and `check` reports it.
    Unreadable(serde_json::Value),
}

impl StoredClickNoise {
    /// Why it cannot be used; none if it can.
    pub fn fault(&self) -> Option<String> {
        match self {
            Self::Own(noise) if noise.is_plausible() => None,
            Self::Own(_) => Some(
                "click noise 20 times larger or smaller than usual is not plausible".to_owned(),
            ),
            Self::Unreadable(value) => ClickNoise::deserialize(value)
                .err()
                .map(|error| error.to_string()),
        }
    }
}

impl ClickNoise {
    /// The 1-σ of a click, px at 1920 px width, from what the template states.
    fn sigma_px(&self, stated_px: f64, landmark: Option<&str>) -> f64 {
        // Only the share s of the stated variance σ² comes from clicking (`CLICKING_SHARE`). The
        // factor f scales that share; the rest, the landmark's position, remains:
        // σ √(1 − s + s f²).
        let own = landmark
            .and_then(|landmark| self.factor_by_landmark.get(landmark))
            .copied();
        let factor = own.unwrap_or(self.factor);
        stated_px * (1.0 - CLICKING_SHARE + CLICKING_SHARE * factor * factor).sqrt()
    }

    /// One sentence for the user: which click noise weights the clicks.
    pub fn describe(&self) -> String {
        let [low, high] = self.sigma_interval_95_px;
        format!(
            "points are weighted by their annotator's own click noise: {:.2} px (95 %: {low:.2} to {high:.2}) from {} blind clicks",
            self.sigma_px, self.repeats
        )
    }

    /// Whether all factors are within the plausible range.
    pub fn is_plausible(&self) -> bool {
        let mut factors = self.factor_by_landmark.values().chain([&self.factor]);
        factors.all(|factor| PLAUSIBLE_FACTOR.contains(factor))
    }

    /// Sets the click sigmas of a field's landmarks and lines by it.
    pub(in crate::document) fn apply(&self, field: &mut FieldModel) {
        for landmark in &mut field.landmarks {
            landmark.click_sigma_px =
                self.sigma_px(landmark.click_sigma_px, Some(landmark.id.as_str()));
        }
        field.line_click_sigma_px = self.sigma_px(field.line_click_sigma_px, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::soccer_document;

    #[test]
    fn no_number_that_json_lacks_is_stored() {
        let noise = ClickNoise {
            in_use: true,
            factor: 1.0,
            factor_by_landmark: BTreeMap::new(),
            sigma_px: 2.0,
            sigma_interval_95_px: [1.8, 2.2],
            repeats: 40,
            extra: Extra::new(),
        };
        let mut document = soccer_document();
        document.set_click_noise(&noise).unwrap();
        let unbounded = ClickNoise {
            sigma_interval_95_px: [1.8, f64::INFINITY],
            ..noise.clone()
        };
        assert!(document.set_click_noise(&unbounded).is_err());
        assert_eq!(document.own_click_noise(), Some(&noise));
    }
}
