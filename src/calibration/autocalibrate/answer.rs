//! The answer of autocalibration.

use crate::autocalibrate::Abstention;
use crate::calibrate::AutocalibratedCamera;
use touchline_core::field::LandmarkId;

/// The answer of a search that ran to its end.
#[derive(Clone, Debug, PartialEq)]
pub enum AutocalibrationAnswer {
    /// One camera passes all checks.
    Found(Box<AutocalibratedCamera>),
    /// No answer is certain enough.
    Abstained {
        /// Why.
        why: Abstention,
        /// The clicks that would most likely lead to an answer; none where clicks alone do not
        /// help.
        clicks: Option<WantedClicks>,
    },
}

/// Clicks on landmarks of the ground that a search without an answer wants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WantedClicks {
    /// Index of the frame in the document.
    pub frame: usize,
    /// The number of landmarks to click in it, as far apart as possible.
    pub landmarks: usize,
    /// Landmarks that the frame shows by the best answer: the one whose click decides between two
    /// answers, or two far apart. Empty where there is none, or where more are wanted than these.
    pub named: Vec<LandmarkId>,
}

impl WantedClicks {
    /// What to click, as a part of a sentence; `label` returns how to name a landmark.
    pub fn describe_landmarks(&self, label: impl Fn(&LandmarkId) -> String) -> String {
        match self.named.as_slice() {
            [one] => label(one),
            [one, other] => format!(
                "{} and {}, or two other landmarks far from each other,",
                label(one),
                label(other)
            ),
            _ => format!("{} landmarks far from each other", self.landmarks),
        }
    }
}
