//! The annotator's own click noise as a document keeps it, and what it makes of the clicks' sigmas.

use super::{Document, Extra, adapters};
use crate::field::FieldModel;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The hand's share of a template's `σ²`.
pub(crate) const HAND_SHARE: f64 = 0.5;

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

/// What a document keeps of the scatter of its clicks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ClickNoise {
    /// An annotator's own.
    Own(Hand),
    /// Something that is no click noise; it is kept, weighs nothing, and `check` names it.
    Unreadable(serde_json::Value),
}

impl From<serde_json::Value> for ClickNoise {
    fn from(value: serde_json::Value) -> Self {
        Hand::deserialize(&value).map_or(Self::Unreadable(value), Self::Own)
    }
}

impl ClickNoise {
    /// Why it weighs nothing; none if it can.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        match self {
            Self::Own(hand) if hand.is_plausible() => None,
            Self::Own(_) => Some("no hand is that much steadier or shakier than others".to_owned()),
            Self::Unreadable(value) => Hand::deserialize(value).err().map(|error| error.to_string()),
        }
    }
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
    /// The hand that it keeps, whether it is in use or not.
    #[must_use]
    pub const fn hand(&self) -> Option<&Hand> {
        match &self.click_noise {
            Some(ClickNoise::Own(hand)) => Some(hand),
            Some(ClickNoise::Unreadable(_)) | None => None,
        }
    }

    /// The hand whose noise its clicks are weighed by; none: everybody's.
    #[must_use]
    pub fn hand_in_use(&self) -> Option<Hand> {
        self.hand().filter(|hand| hand.in_use && hand.is_plausible()).cloned()
    }

    /// Keeps a hand.
    ///
    /// # Errors
    /// A number of it is not finite.
    pub fn set_hand(&mut self, hand: &Hand) -> Result<(), serde_json::Error> {
        serde_json::to_value(hand)?;
        self.click_noise = Some(ClickNoise::Own(hand.clone()));
        Ok(())
    }

    /// Gives a field the click noise that the document uses.
    pub(super) fn weigh_clicks(&self, field: &mut FieldModel) {
        if let Some(hand) = self.hand_in_use() {
            hand.apply(field);
        }
    }
}
