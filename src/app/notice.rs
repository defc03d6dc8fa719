//! Messages to the user, with remedies.

use super::Command;

/// A message that does not take the focus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Tells messages apart.
    pub id: u64,
    /// How serious it is.
    pub level: Level,
    /// One or two sentences.
    pub text: String,
    /// Remedies, as buttons.
    pub offers: Vec<(&'static str, Command)>,
}

impl Notice {
    /// Whether a command is one of its remedies.
    #[must_use]
    pub fn offers(&self, command: Command) -> bool {
        self.offers.iter().any(|(_, offered)| *offered == command)
    }
}

/// How serious a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Information; without a button it disappears by itself.
    Info,
    /// Asks for a decision; stays until it is answered or closed.
    Question,
    /// Stays until it is closed.
    Warning,
    /// Something failed; stays until it is closed.
    Error,
}
