//! What changes in a stadium while a match goes on: spectators move, people come and go, boards
//! show something else.

/// A moment of a stadium. The default changes nothing: spectators sit still, and all frames show
/// the same people and boards.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Chooses who came and went and which boards changed; frames of one stretch of play share it.
    pub occasion: u64,
    /// The share of seats with another person than at first, 0 to 1.
    pub people_changed: f64,
    /// The share of boards that are drawn again, 0 to 1; a few of them show what they showed.
    pub boards_changed: f64,
    /// Chooses how spectators hold themselves; every frame has its own.
    pub instant: u64,
    /// How much spectators move, 0 to 1. At 1 they lean up to 0.11 m to either side, and one in
    /// eight stands.
    pub restlessness: f64,
}
