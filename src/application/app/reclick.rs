//! A blind round: the landmarks of the gold frames are clicked again, without a look at the label,
//! its lines or a proposal.

use touchline_core::field::LandmarkId;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Document, FrameStatus};

/// What a round asks for next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asked {
    /// The frame, by its place in the document.
    pub frame: usize,
    /// The landmark to be clicked in it.
    pub landmark: LandmarkId,
}

/// A blind round that is under way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reclick {
    /// Everything that is asked for, in order.
    asked: Vec<Asked>,
    /// What is asked for now.
    at: usize,
    /// What was clicked, by its place in `asked`, the latest last; the others were skipped.
    clicked: Vec<usize>,
    /// The number of the round in the document.
    pub round: u32,
    /// Where the pointer holds the click that is being made, px of the picture.
    pub held: Option<ImagePoint>,
}

impl Reclick {
    /// A round over the gold references of a document; it asks for nothing where there are none.
    #[must_use]
    pub fn of(document: &Document) -> Self {
        let frames = document.frames.iter().enumerate();
        let gold = frames.filter(|(_, frame)| frame.gold && frame.status == FrameStatus::Reference);
        let asked = gold.flat_map(|(index, frame)| {
            frame.asked_again().map(move |id| Asked {
                frame: index,
                landmark: id.clone(),
            })
        });
        Self {
            asked: asked.collect(),
            round: document.next_round(),
            ..Self::default()
        }
    }

    /// What is asked for now; none at the end.
    #[must_use]
    pub fn asked(&self) -> Option<&Asked> {
        self.asked.get(self.at)
    }

    /// How many are asked for in all.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.asked.len()
    }

    /// Nothing is asked for.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.asked.is_empty()
    }

    /// Which one is asked for now, from 1.
    #[must_use]
    pub const fn number(&self) -> usize {
        self.at + 1
    }

    /// How many were clicked.
    #[must_use]
    pub const fn clicked(&self) -> usize {
        self.clicked.len()
    }

    /// How many were skipped.
    #[must_use]
    pub const fn skipped(&self) -> usize {
        self.at - self.clicked.len()
    }

    /// What is asked for was clicked.
    pub(super) fn take_click(&mut self) {
        self.clicked.push(self.at);
        self.at += 1;
    }

    /// What is asked for cannot be seen.
    pub(super) const fn skip(&mut self) {
        self.at += 1;
    }

    /// Goes back to the last one that was clicked.
    pub(super) fn go_back(&mut self) {
        self.at = self.clicked.pop().unwrap_or(self.at);
    }
}
