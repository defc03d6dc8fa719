//! Actions that show another frame or click, or change the list of names.

use crate::app::window_state::choices::{Scope, Selecting};
use crate::app::window_state::place::FrameOrTime;

/// An action that shows another frame or click, or changes the list of names.
#[derive(Debug, PartialEq)]
pub enum Navigation {
    /// Select a click by its index, or none.
    Select(Option<usize>),
    /// Show the frame at an index.
    GoTo(usize),
    /// Change the selection on the filmstrip.
    SelectFrame {
        /// The index of the clicked frame.
        frame: usize,
        /// Whether a range is selected or the frame toggled.
        how: Selecting,
    },
    /// Ask to which camera the frames of a scope belong.
    AskCamera(Scope),
    /// Close the quality page, and show a frame and optionally one of its clicks.
    LookAt {
        /// The index of the frame.
        frame: usize,
        /// The index of the click.
        click: Option<usize>,
    },
    /// Filter the list of names by a text.
    TypeName(String),
    /// Show other names for a point that was just named automatically, filtered by a text.
    RefineName(String),
    /// Confirm the name that a point was given automatically.
    ConfirmName,
    /// Highlight the candidate at an index in the list.
    HighlightName(usize),
    /// List lines (true) or landmarks.
    ListLines(bool),
    /// Show the frame with a number or at a time.
    GoToPlace(FrameOrTime),
}
