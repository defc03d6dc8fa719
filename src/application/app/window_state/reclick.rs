//! A blind round: the user clicks the landmarks of gold frames again, without seeing labels, lines
//! or proposals.

use touchline_core::field::LandmarkId;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Document, FrameStatus};

/// A landmark to be clicked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReclickTarget {
    /// The index of the frame.
    pub frame: usize,
    pub landmark: LandmarkId,
}

/// A blind round.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reclick {
    /// All landmarks of the round, in order.
    targets: Vec<ReclickTarget>,
    /// The index of the present one.
    at: usize,
    /// The indices in `targets` of the landmarks that were clicked, latest last. The others before
    /// `at` were skipped.
    clicked: Vec<usize>,
    /// The number of the round in the document.
    pub round: u32,
    /// The point at which the button is held down, px of the picture.
    pub held: Option<ImagePoint>,
}

impl Reclick {
    /// A round over the gold references of a document; empty if there are none.
    pub fn from_document(document: &Document) -> Self {
        let frames = document.frames.iter().enumerate();
        let gold = frames.filter(|(_, frame)| frame.gold && frame.status == FrameStatus::Reference);
        let targets = gold.flat_map(|(index, frame)| {
            frame.landmarks_to_repeat().map(move |id| ReclickTarget {
                frame: index,
                landmark: id.clone(),
            })
        });
        Self {
            targets: targets.collect(),
            round: document.next_round(),
            ..Self::default()
        }
    }

    /// The present landmark; none at the end.
    pub fn target(&self) -> Option<&ReclickTarget> {
        self.targets.get(self.at)
    }

    /// Number of landmarks in the round.
    pub const fn len(&self) -> usize {
        self.targets.len()
    }

    /// Whether the round has no landmarks.
    pub const fn is_empty(&self) -> bool {
        self.targets.is_empty()
    }

    /// The number of the present landmark, from 1.
    pub const fn number(&self) -> usize {
        self.at + 1
    }

    /// Number of landmarks that were clicked.
    pub const fn clicked_count(&self) -> usize {
        self.clicked.len()
    }

    /// Number of landmarks that were skipped.
    pub const fn skipped_count(&self) -> usize {
        self.at - self.clicked.len()
    }

    /// Registers that the present landmark was clicked.
    pub(in crate::app) fn take_click(&mut self) {
        self.clicked.push(self.at);
        self.at += 1;
    }

    /// Skips the present landmark.
    pub(in crate::app) const fn skip(&mut self) {
        self.at += 1;
    }

    /// Returns to the landmark that was clicked last.
    pub(in crate::app) fn go_back(&mut self) {
        self.at = self.clicked.pop().unwrap_or(self.at);
    }
}
