//! Messages to the user, with commands as remedies.

use crate::app::Command;

/// A message that does not take the focus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// The unique number of the message.
    pub id: u64,
    /// The severity.
    pub level: Level,
    /// One or two sentences.
    pub text: String,
    /// Labels and commands of the buttons.
    pub offers: Vec<(&'static str, Command)>,
}

impl Notice {
    /// Whether the message has a button for a command.
    pub fn offers(&self, command: Command) -> bool {
        self.offers.iter().any(|(_, offered)| *offered == command)
    }
}

/// The severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Information; disappears after a while if it has no button.
    Info,
    /// A question; stays until the user answers or closes it.
    Question,
    /// A warning; stays until the user closes it.
    Warning,
    /// An error; stays until the user closes it.
    Error,
}

/// The messages of the session.
#[derive(Debug, Default)]
pub struct Messages {
    /// Messages that the user has neither answered nor dismissed, latest last.
    pub notices: Vec<Notice>,
    /// All messages of the session, latest last; the oldest are dropped.
    pub log: Vec<(Level, String)>,
    last_id: u64,
}

impl Messages {
    /// Shows a message. It replaces an earlier one with the same text.
    pub(in crate::app) fn show(
        &mut self,
        level: Level,
        text: String,
        offers: Vec<(&'static str, Command)>,
    ) {
        /// Maximum number of open messages. Beyond it the oldest information is dropped, or the
        /// oldest message if there is no information.
        const WAITING: usize = 20;
        /// Maximum number of messages in the log.
        const REMEMBERED: usize = 200;
        // The log has every message, also repeated ones: it shows what happened in which order.
        if self.log.len() >= REMEMBERED {
            self.log.remove(0);
        }
        self.log.push((level, text.clone()));
        // A repeated message moves to the end under a new number, so that the window shows it anew.
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

/// The message in the status row: usually the latest. A question precedes later warnings, because
/// nothing else would bring it back. Later information precedes it, because it disappears by
/// itself, and so do errors, which must be seen at once.
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
