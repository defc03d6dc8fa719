//! Why a search gave no camera, and what would help.

use crate::autocalibrate::{Abstention, DecidingLandmark, WantedClicks};
use crate::calibrate::AutocalibratedCamera;
use touchline_documents::document::Document;

/// Why a search gave no camera.
#[derive(Debug)]
pub enum NoCamera {
    /// Two cameras explain the paint about equally well.
    Two {
        /// The camera that explains a little more.
        best: Box<AutocalibratedCamera>,
        /// The other camera.
        other: Box<AutocalibratedCamera>,
        /// A click that decides between the two.
        deciding: Option<DecidingLandmark>,
    },
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
    /// Whether clicks that it names would lead to an answer.
    pub const fn asks_for_clicks(&self) -> bool {
        match self {
            Self::Two { .. } => true,
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
            Self::Two {
                best,
                other,
                deciding,
            } => describe_two(document, best, other, deciding.as_ref()),
            Self::Before { message, .. } => message.clone(),
            Self::Abstained { why, clicks } => {
                format!("{why}{}", describe_clicks(document, clicks.as_ref()))
            }
        }
    }
}

/// A message for two candidates, with the click that decides between them.
fn describe_two(
    document: &Document,
    best: &AutocalibratedCamera,
    other: &AutocalibratedCamera,
    deciding: Option<&DecidingLandmark>,
) -> String {
    let click = deciding.map_or_else(
        || "click 4 landmarks on 2 frames".to_owned(),
        |deciding| {
            let frame = document.frames[deciding.frame].name();
            let [here, there] = deciding
                .image
                .map(|image| format!("({:.0}, {:.0})", image.x, image.y));
            format!(
                "one click decides: {} on {frame} is at {here} or at {there} px",
                deciding.landmark.as_str()
            )
        },
    );
    format!(
        "two places for the camera explain the paint, {} and {}, so none is given; {click}",
        format_position(best),
        format_position(other)
    )
}

fn format_position(found: &AutocalibratedCamera) -> String {
    let at = found.base.position_m;
    format!("({:.1}, {:.1}, {:.1}) m", at.x, at.y, at.z)
}

/// The clicks that would help after an abstention, as a part of a sentence.
fn describe_clicks(document: &Document, clicks: Option<&WantedClicks>) -> String {
    clicks.map_or_else(String::new, |clicks| {
        let frame = document.frames[clicks.frame].name();
        let landmarks = clicks.describe_landmarks(|id| id.as_str().to_owned());
        format!("; click {landmarks} on {frame} in the window, and search again with them")
    })
}
