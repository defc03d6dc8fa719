//! The annotator's own click noise as a document keeps it, and what it makes of the clicks' sigmas.

use super::{Document, Extra, adapters};
use crate::field::FieldModel;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The hand's share of a template's `σ²`.
pub(crate) const HAND_SHARE: f64 = 0.5;
/// The document's key for what its clicks scatter by.
const CLICK_NOISE: &str = "click_noise";

/// A hand's factor is within these, or something else is wrong.
const PLAUSIBLE_FACTOR: std::ops::RangeInclusive<f64> = 0.05..=20.0;

/// An annotator's hand as a document keeps it (`click_noise`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::struct_field_names, reason = "the fields are named as the document's keys are")]
pub struct Hand {
    /// The solve uses it.
    #[serde(rename = "use")]
    pub in_use: bool,
    /// Its scatter as a multiple of the usual hand's.
    #[serde(with = "adapters::positive")]
    pub hand_factor: f64,
    /// The same for single landmarks.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", with = "adapters::numbers_by_name")]
    pub hand_factor_by_landmark: BTreeMap<String, f64>,
    /// 1-σ of a click in each direction, px at 1920 px width, for people.
    #[serde(with = "adapters::positive")]
    pub sigma_px: f64,
    /// Its 95 % interval, px.
    pub sigma_interval_95_px: [f64; 2],
    /// How many repeats it rests on.
    pub repeats: usize,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl Hand {
    /// The 1-σ of a click, px at 1920 px width, from what the template states.
    fn sigma_px(&self, stated_px: f64, landmark: Option<&str>) -> f64 {
        let own = landmark.and_then(|landmark| self.hand_factor_by_landmark.get(landmark)).copied();
        let factor = own.unwrap_or(self.hand_factor);
        stated_px * (1.0 - HAND_SHARE + HAND_SHARE * factor * factor).sqrt()
    }

    /// What the clicks are weighed by, in a sentence.
    #[must_use]
    pub fn describe(&self) -> String {
        let [low, high] = self.sigma_interval_95_px;
        format!(
            "points are weighed by their annotator's own click noise: {:.2} px (95 %: {low:.2} to {high:.2}) from {} blind clicks",
            self.sigma_px, self.repeats
        )
    }

    /// Whether its factors can be those of a hand.
    #[must_use]
    pub fn is_plausible(&self) -> bool {
        let mut factors = self.hand_factor_by_landmark.values().chain([&self.hand_factor]);
        factors.all(|factor| PLAUSIBLE_FACTOR.contains(factor))
    }

    fn apply(&self, field: &mut FieldModel) {
        for landmark in &mut field.landmarks {
            landmark.click_sigma_px = self.sigma_px(landmark.click_sigma_px, Some(landmark.id.as_str()));
        }
        field.line_click_sigma_px = self.sigma_px(field.line_click_sigma_px, None);
    }
}

impl Document {
    /// The hand that it keeps.
    ///
    /// # Errors
    /// What it keeps is no hand: one line.
    pub fn hand(&self) -> Result<Option<Hand>, String> {
        let Some(value) = self.extra.get(CLICK_NOISE) else { return Ok(None) };
        Hand::deserialize(value).map(Some).map_err(|error| error.to_string())
    }

    /// The hand whose noise its clicks are weighed by; none: everybody's.
    #[must_use]
    pub fn hand_in_use(&self) -> Option<Hand> {
        self.hand().ok().flatten().filter(|hand| hand.in_use && hand.is_plausible())
    }

    /// Keeps a hand.
    ///
    /// # Errors
    /// A number of it is not finite.
    pub fn set_hand(&mut self, hand: &Hand) -> Result<(), serde_json::Error> {
        let value = serde_json::to_value(hand)?;
        self.extra.insert(CLICK_NOISE.to_owned(), value);
        Ok(())
    }

    /// Gives a field the click noise that the document uses.
    pub(super) fn weigh_clicks(&self, field: &mut FieldModel) {
        if let Some(hand) = self.hand_in_use() {
            hand.apply(field);
        }
    }
}
