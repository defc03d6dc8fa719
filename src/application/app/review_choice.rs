//! The user's choices in the review panel, and whether the pointer is over its list.

/// What the list of suggestions begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReviewOrder {
    /// The most doubtful.
    #[default]
    Confidence,
    /// The one farthest from its neighbours' way.
    Disagreement,
    /// The first in the document.
    Time,
}

impl ReviewOrder {
    /// Every order, as the panel lists them.
    pub const ALL: [Self; 3] = [Self::Confidence, Self::Disagreement, Self::Time];

    /// What the panel calls it.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Confidence => "Confidence",
            Self::Disagreement => "Disagreement",
            Self::Time => "Time",
        }
    }

    /// What it is good for.
    #[must_use]
    pub const fn about(self) -> &'static str {
        match self {
            Self::Confidence => {
                "Lowest confidence first: look at these. Those above a threshold can be accepted at once."
            }
            Self::Disagreement => {
                "Those most out of line with the frames before and after come first."
            }
            Self::Time => "In the order of the frames.",
        }
    }
}

/// What a person chose in the review panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReviewChoice {
    /// The order of the list.
    pub order: ReviewOrder,
    /// Suggestions of at least this probability are accepted together.
    pub threshold: f64,
    /// Also those that disagree with their neighbours.
    pub with_disagreeing: bool,
    /// The list has one suggestion a shot.
    pub one_per_shot: bool,
    /// The pointer is over the list: its rows stay where they are.
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
