//! A key stroke, and the command that the user's keymap has for it on any keyboard layout.
//!
//! Layouts differ in the keys of their signs, and in which of them need Shift. So a stroke is
//! compared with a chord by its logical key first, and a sign by its physical key after that.

use egui::{Key, Modifiers};
use touchline_application::app::{App, Chord, Command};

/// A key that went down or up.
#[derive(Clone, Copy, Debug)]
pub struct KeyStroke {
    /// The logical key, which depends on the keyboard layout.
    pub key: Key,
    /// The physical key, if the platform reports it.
    pub physical: Option<Key>,
    /// Whether the key went down.
    pub pressed: bool,
    /// Whether this is an automatic repetition while the key stays down.
    pub repeat: bool,
    pub modifiers: Modifiers,
}

/// Replaces Shift with the slash key by the question mark, because some layouts report no logical
/// key for it.
pub(super) fn question_mark(stroke: KeyStroke) -> KeyStroke {
    let is_slash = stroke.key == Key::Slash
        && stroke
            .physical
            .is_none_or(|physical| physical == Key::Slash);
    if is_slash && stroke.modifiers.shift {
        KeyStroke {
            key: Key::Questionmark,
            ..stroke
        }
    } else {
        stroke
    }
}

/// The command of a key stroke: by the logical key, else by the physical one.
pub(super) fn command_of(app: &App, stroke: &KeyStroke) -> Option<Command> {
    command_with_chord(app, |chord| is_logically(chord, stroke))
        .or_else(|| command_with_chord(app, |chord| is_physically(chord, stroke)))
}

/// The first command with a chord for which `matches` is true.
fn command_with_chord(app: &App, matches: impl Fn(&Chord) -> bool) -> Option<Command> {
    Command::all().find(|command| app.settings.keys.chords(*command).iter().any(&matches))
}

/// Whether a chord names this stroke's logical key. For a punctuation key a surplus Shift is
/// allowed, because the layout may need it to produce the sign.
fn is_logically(chord: &Chord, stroke: &KeyStroke) -> bool {
    let modifiers = stroke.modifiers;
    key_of(chord) == Some(stroke.key)
        && chord.ctrl == modifiers.command
        && chord.alt == modifiers.alt
        && (chord.shift == modifiers.shift || is_sign(stroke.key) && !chord.shift)
}

/// Whether a chord names this stroke's physical key. Only for punctuation: on some layouts Shift
/// with the dot is a colon, and then the dot's key counts.
fn is_physically(chord: &Chord, stroke: &KeyStroke) -> bool {
    let modifiers = stroke.modifiers;
    is_sign(stroke.key)
        && stroke.physical.is_some()
        && key_of(chord) == stroke.physical
        && (chord.ctrl, chord.alt, chord.shift)
            == (modifiers.command, modifiers.alt, modifiers.shift)
}

/// Whether a key is a punctuation sign, so that the layout decides whether it needs Shift.
const fn is_sign(key: Key) -> bool {
    matches!(
        key,
        Key::Plus
            | Key::Minus
            | Key::Equals
            | Key::Questionmark
            | Key::Exclamationmark
            | Key::Slash
            | Key::Backslash
            | Key::Pipe
            | Key::Colon
            | Key::Semicolon
            | Key::Quote
            | Key::Backtick
            | Key::OpenBracket
            | Key::CloseBracket
            | Key::OpenCurlyBracket
            | Key::CloseCurlyBracket
    )
}

/// The key that a chord names.
pub(super) fn key_of(chord: &Chord) -> Option<Key> {
    Key::from_name(&chord.key)
}

/// A key that goes down, on a platform that reports no physical keys.
#[cfg(test)]
pub(super) const fn stroke(key: Key, modifiers: Modifiers) -> KeyStroke {
    KeyStroke {
        key,
        physical: None,
        pressed: true,
        repeat: false,
        modifiers,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::open_with_click;
    use touchline_core::geometry::ImagePoint;

    const NONE: Modifiers = Modifiers::NONE;

    fn app() -> App {
        open_with_click(ImagePoint::new(10.0, 20.0))
    }

    fn found(app: &App, stroke: KeyStroke) -> Option<Command> {
        command_of(app, &question_mark(stroke))
    }

    #[test]
    fn modifiers_are_read_exactly() {
        let app = app();
        let ctrl_shift = Modifiers::COMMAND | Modifiers::SHIFT;
        assert_eq!(
            found(&app, stroke(Key::Z, Modifiers::COMMAND)),
            Some(Command::Undo)
        );
        assert_eq!(found(&app, stroke(Key::Z, ctrl_shift)), Some(Command::Redo));
        assert_eq!(
            found(&app, stroke(Key::Z, NONE)),
            Some(Command::ZoomToClick)
        );
        assert_eq!(
            found(&app, stroke(Key::Period, Modifiers::SHIFT)),
            Some(Command::NextTenFrames)
        );
        assert_eq!(
            found(&app, stroke(Key::Period, NONE)),
            Some(Command::NextFrame)
        );
        assert_eq!(found(&app, stroke(Key::J, NONE)), None);
    }

    #[test]
    fn signs_are_found_on_any_layout() {
        let app = app();
        let question = Some(Command::Keys);
        assert_eq!(
            found(&app, stroke(Key::Questionmark, Modifiers::SHIFT)),
            question
        );
        assert_eq!(found(&app, stroke(Key::Questionmark, NONE)), question);
        assert_eq!(found(&app, stroke(Key::Slash, Modifiers::SHIFT)), question);
        assert_eq!(
            found(&app, stroke(Key::Plus, Modifiers::SHIFT)),
            Some(Command::ZoomIn)
        );
        // On a German keyboard Shift and 7 is a slash, Shift and the dot is a colon.
        let german_slash = KeyStroke {
            physical: Some(Key::Num7),
            ..stroke(Key::Slash, Modifiers::SHIFT)
        };
        assert_eq!(found(&app, german_slash), None);
        let german_colon = KeyStroke {
            physical: Some(Key::Period),
            ..stroke(Key::Colon, Modifiers::SHIFT)
        };
        assert_eq!(found(&app, german_colon), Some(Command::NextTenFrames));
    }
}
