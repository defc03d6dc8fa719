//! What has been begun in the window and not ended.

use super::naming::{NameCandidate, filter_by_text};
use super::reclick::Reclick;
use touchline_documents::document::Target;

/// How many candidates are offered at the cursor.
pub const OFFERED: usize = 5;

/// What has been begun and not ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Mode {
    /// Nothing.
    #[default]
    Idle,
    /// A point is held by the pointer.
    Dragging {
        /// Which click.
        click: usize,
        /// It was placed by this very press and has no name yet.
        placed: bool,
    },
    /// A point waits for its name.
    Naming(Naming),
    /// Landmark first: the next click in the picture shows this.
    Placing(Target),
    /// The reason is asked for.
    Rejecting {
        /// For every frame of the shot.
        whole_shot: bool,
    },
    /// A number is being changed.
    Editing,
    /// Gold frames are clicked again, blind.
    ClickingAgain(Reclick),
}

/// A point that waits for its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Naming {
    /// Which click.
    pub click: usize,
    /// Every name it may get, best first.
    pub candidates: Vec<NameCandidate>,
    /// The point had named itself, and keeps that name unless another one is taken.
    pub refines: bool,
    /// What has been typed to filter them.
    pub typed: String,
    /// Lines are offered and not landmarks.
    pub lines: bool,
    /// The candidate under the pointer or chosen with the arrow keys, within those offered.
    pub highlighted: usize,
}

impl Naming {
    /// The candidates on offer: at most [`OFFERED`], after the filter.
    #[must_use]
    pub fn offered(&self) -> Vec<&NameCandidate> {
        let mut offered = filter_by_text(&self.candidates, &self.typed);
        offered.truncate(OFFERED);
        offered
    }

    /// The candidate that Enter takes.
    #[must_use]
    pub fn chosen(&self) -> Option<&NameCandidate> {
        self.offered().get(self.highlighted).copied()
    }
}
