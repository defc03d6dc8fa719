//! Another frame or click, or more of the label.

use crate::app::choices::{Scope, Selecting};
use crate::app::place::Place;

/// Another frame or click is shown, or more of the label.
#[derive(Debug, PartialEq)]
pub enum Navigation {
    /// A click was selected, or none.
    Select(Option<usize>),
    /// Another frame.
    GoTo(usize),
    /// A frame of the filmstrip is added to the selection, or taken out.
    SelectFrame {
        /// Its place.
        frame: usize,
        /// How.
        how: Selecting,
    },
    /// The dialog that assigns frames is about another scope.
    AskCamera(Scope),
    /// The quality page makes way for a frame and one of its clicks.
    LookAt {
        /// Which frame.
        frame: usize,
        /// Which of its clicks, if one.
        click: Option<usize>,
    },
    /// What is typed while a point waits for its name.
    TypeName(String),
    /// What is typed right after a point was named by itself: other names for it are offered.
    RefineName(String),
    /// The name that a point was given by itself is right.
    ConfirmName,
    /// A candidate on offer is under the pointer.
    HighlightName(usize),
    /// Landmarks or lines are offered.
    OfferLines(bool),
    /// The frame or the time that was typed is shown.
    GoToPlace(Place),
}
