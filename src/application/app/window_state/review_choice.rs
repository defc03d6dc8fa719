//! The user's choices in the review panel, and whether the pointer is over its list.

/// The order of the list of suggestions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReviewOrder {
    /// Lowest confidence first.
    #[default]
    Confidence,
    /// Largest disagreement with the neighbours first.
    Disagreement,
    /// Those first that the painted lines contradict.
    Paint,
    /// Those first that mending moved farthest.
    Moved,
    /// In the document's order.
    Time,
}

impl ReviewOrder {
    /// All orders, as the panel lists them.
    pub const ALL: [Self; 5] = [
        Self::Confidence,
        Self::Disagreement,
        Self::Paint,
        Self::Moved,
        Self::Time,
    ];

    /// The label in the panel.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Confidence => "Confidence",
            Self::Disagreement => "Disagreement",
            Self::Paint => "Paint",
            Self::Moved => "Moved",
            Self::Time => "Time",
        }
    }

    /// The explanation in the panel.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Confidence => {
                "Lowest confidence first: look at these. Those above a threshold can be accepted at once."
            }
            Self::Disagreement => {
                "Those most out of line with the frames before and after come first."
            }
            Self::Paint => {
                "Those first that the painted lines contradict, then those on which they do not \
                 decide; among equals those that mending moved farthest."
            }
            Self::Moved => {
                "Those first whose imported camera mending moved farthest, in px of the picture."
            }
            Self::Time => "In the order of the frames.",
        }
    }
}

/// The user's choices in the review panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReviewChoice {
    /// The order of the list.
    pub order: ReviewOrder,
    /// Minimum confidence of suggestions that are accepted together.
    pub threshold: f64,
    /// Whether suggestions that disagree with their neighbours are accepted, too.
    pub with_disagreeing: bool,
    /// Whether the list shows one suggestion per shot.
    pub one_per_shot: bool,
    /// Whether the pointer is over the list; then its rows do not move.
    pub held: bool,
}

impl Default for ReviewChoice {
    fn default() -> Self {
        Self {
            order: ReviewOrder::default(),
            threshold: 0.95,
            with_disagreeing: false,
            one_per_shot: false,
            held: false,
        }
    }
}
