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

/// The messages.
#[derive(Debug, Default)]
pub struct Messages {
    /// Messages that nobody has answered or dismissed, the latest last.
    pub notices: Vec<Notice>,
    /// Every message that was shown, the latest last; the oldest go.
    pub log: Vec<(Level, String)>,
    last_id: u64,
}

impl Messages {
    /// Shows a message; one that says the same is replaced.
    pub(super) fn show(
        &mut self,
        level: Level,
        text: String,
        offers: Vec<(&'static str, Command)>,
    ) {
        /// At most this many wait: then the oldest that only informs goes.
        const WAITING: usize = 20;
        /// At most this many are remembered.
        const REMEMBERED: usize = 200;
        if self.log.len() >= REMEMBERED {
            self.log.remove(0);
        }
        self.log.push((level, text.clone()));
        self.notices.retain(|notice| notice.text != text);
        self.last_id += 1;
        self.notices.push(Notice {
            id: self.last_id,
            level,
            text,
            offers,
        });
        if self.notices.len() > WAITING {
            let gone = self
                .notices
                .iter()
                .position(|notice| notice.level == Level::Info)
                .unwrap_or(0);
            self.notices.remove(gone);
        }
    }
}

/// The message that stands in the row: the latest. A question stands before warnings that came
/// after it, as nothing else would bring it back; information leaves by itself, and what failed is
/// said at once.
#[must_use]
pub fn in_row(notices: &[Notice]) -> Option<&Notice> {
    let latest = notices.last()?;
    let question = notices
        .iter()
        .rfind(|notice| notice.level == Level::Question);
    if latest.level == Level::Warning {
        question.or(Some(latest))
    } else {
        Some(latest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_is_not_hidden_by_warnings() {
        let notice = |id: u64, level: Level| Notice {
            id,
            level,
            text: String::new(),
            offers: Vec::new(),
        };
        let shown = |levels: &[Level]| {
            let notices: Vec<Notice> = (0..)
                .zip(levels)
                .map(|(id, level)| notice(id, *level))
                .collect();
            in_row(&notices).map(|notice| notice.id)
        };
        assert_eq!(shown(&[]), None);
        assert_eq!(
            shown(&[Level::Question, Level::Warning, Level::Warning]),
            Some(0)
        );
        assert_eq!(
            shown(&[Level::Question, Level::Warning, Level::Info]),
            Some(2)
        );
        assert_eq!(
            shown(&[Level::Question, Level::Question, Level::Warning]),
            Some(1)
        );
        assert_eq!(shown(&[Level::Question, Level::Error]), Some(1));
        assert_eq!(shown(&[Level::Warning, Level::Warning]), Some(1));
    }
}
