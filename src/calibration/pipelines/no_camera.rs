//! Why a search gave no camera, and what would help.

use crate::autocalibrate::{Abstention, WantedClicks};
use crate::calibrate::AutocalibratedCamera;
use touchline_documents::document::Document;

/// Why a search gave no camera.
#[derive(Debug)]
pub enum NoCamera {
    /// No answer was certain when the same search was made before.
    Before {
        /// The message of that search.
        message: String,
        /// Whether clicks that it names would lead to an answer.
        asks_for_clicks: bool,
    },
    /// No answer is certain.
    Abstained {
        /// Why.
        why: Abstention,
        /// The clicks that would most likely lead to an answer.
        clicks: Option<WantedClicks>,
    },
}

impl NoCamera {
    /// The best answer of the search, although it is not certain.
    pub(super) fn best(&self) -> Option<&AutocalibratedCamera> {
        match self {
            Self::Abstained { why, .. } => why.best(),
            Self::Before { .. } => None,
        }
    }

    /// Whether clicks that it names would lead to an answer.
    pub const fn asks_for_clicks(&self) -> bool {
        match self {
            Self::Before {
                asks_for_clicks, ..
            } => *asks_for_clicks,
            Self::Abstained { clicks, .. } => clicks.is_some(),
        }
    }

    /// A message for the user: why no camera is given, and what would help. `document` is the one
    /// whose frames were searched.
    pub fn describe(&self, document: &Document) -> String {
        match self {
            Self::Before { message, .. } => message.clone(),
            Self::Abstained { why, clicks } => {
                format!("{why}{}", describe_clicks(document, clicks.as_ref()))
            }
        }
    }
}

/// The clicks that would help after an abstention, as a part of a sentence.
fn describe_clicks(document: &Document, clicks: Option<&WantedClicks>) -> String {
    clicks.map_or_else(String::new, |clicks| {
        let frame = document.frames[clicks.frame].name();
        let landmarks = clicks.describe_landmarks(|id| id.as_str().to_owned());
        format!("; click {landmarks} on {frame} in the window, and search again with them")
    })
}
