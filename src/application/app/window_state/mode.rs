//! Modes: what the user has begun in the window and not ended.

use super::naming::{NameCandidate, filter_by_text};
use super::reclick::Reclick;
use touchline_documents::document::Target;

/// Maximum number of candidates listed at the cursor.
pub const OFFERED: usize = 5;

/// What the user has begun and not ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Mode {
    /// Nothing.
    #[default]
    Idle,
    /// The user drags a point.
    Dragging {
        /// The index of the click.
        click: usize,
        /// Whether the same press placed the point; then it has no name yet.
        placed: bool,
    },
    /// A point waits for its name.
    Naming(Naming),
    /// The landmark was chosen first; the next click in the picture places it.
    Placing(Target),
    /// The user chooses the reason of a rejection.
    Rejecting {
        /// Whether the rejection is for every frame of the shot.
        whole_shot: bool,
    },
    /// The user edits a number.
    Editing,
    /// The user clicks gold frames again, without seeing the first clicks.
    ClickingAgain(Reclick),
}

/// A point that waits for its name, and the list from which the user chooses.
#[derive(Clone, Debug, PartialEq)]
pub struct Naming {
    /// The index of the click.
    pub click: usize,
    /// All candidates, best first.
    pub candidates: Vec<NameCandidate>,
    /// Whether the point was named automatically and keeps that name unless the user chooses
    /// another one.
    pub refines: bool,
    /// The text that the user typed to filter them.
    pub typed: String,
    /// Whether lines are listed in place of landmarks.
    pub lines: bool,
    /// The index of the highlighted candidate among those listed, by pointer or arrow keys.
    pub highlighted: usize,
}

impl Naming {
    /// The candidates in the list: the first [`OFFERED`] that pass the filter.
    pub fn listed_candidates(&self) -> Vec<&NameCandidate> {
        let mut offered = filter_by_text(&self.candidates, &self.typed);
        offered.truncate(OFFERED);
        offered
    }

    /// The candidate that Enter chooses.
    pub fn chosen(&self) -> Option<&NameCandidate> {
        self.listed_candidates().get(self.highlighted).copied()
    }
}
