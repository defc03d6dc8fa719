//! The keys of commands; the user can change each.

use crate::app::Command;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A key with modifiers, written like "Ctrl+Shift+Z". Names of keys are those of the window toolkit
/// ("Period", "F2", "Z").
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Chord {
    /// Control (Command on macOS).
    pub ctrl: bool,
    pub shift: bool,
    /// Alt (Option on macOS).
    pub alt: bool,
    /// The key's name.
    pub key: String,
}

/// Why a text is not a key.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ChordError {
    /// There are only modifiers.
    #[error("{0:?} is not a key; write for example \"Ctrl+Shift+Z\"")]
    NoKey(String),
    #[error("{text:?}: {modifier:?} is not a modifier; there are Ctrl, Shift and Alt")]
    UnknownModifier {
        /// The whole text.
        text: String,
        /// The unknown part.
        modifier: String,
    },
}

impl FromStr for Chord {
    type Err = ChordError;

    fn from_str(text: &str) -> Result<Self, ChordError> {
        // The key is the last part. The key + itself is written "Plus".
        let mut parts: Vec<&str> = text.split('+').map(str::trim).collect();
        let key = parts
            .pop()
            .filter(|key| !key.is_empty())
            .ok_or_else(|| ChordError::NoKey(text.to_owned()))?;
        let mut chord = Self {
            ctrl: false,
            shift: false,
            alt: false,
            key: key.to_owned(),
        };
        for modifier in parts {
            match modifier {
                "Ctrl" | "Cmd" => chord.ctrl = true,
                "Shift" => chord.shift = true,
                "Alt" => chord.alt = true,
                _ => {
                    return Err(ChordError::UnknownModifier {
                        text: text.to_owned(),
                        modifier: modifier.to_owned(),
                    });
                }
            }
        }
        Ok(chord)
    }
}

impl TryFrom<String> for Chord {
    type Error = ChordError;

    fn try_from(text: String) -> Result<Self, ChordError> {
        text.parse()
    }
}

impl From<Chord> for String {
    fn from(chord: Chord) -> Self {
        let mut text = Self::new();
        for (held, name) in [
            (chord.ctrl, "Ctrl+"),
            (chord.shift, "Shift+"),
            (chord.alt, "Alt+"),
        ] {
            if held {
                text.push_str(name);
            }
        }
        text + &chord.key
    }
}

impl fmt::Display for Chord {
    /// The text for the user, such as "Ctrl+Z" or "Shift+.".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (held, name) in [
            (self.ctrl, "Ctrl+"),
            (self.shift, "Shift+"),
            (self.alt, "Alt+"),
        ] {
            if held {
                f.write_str(name)?;
            }
        }
        f.write_str(match self.key.as_str() {
            "Period" => ".",
            "Comma" => ",",
            "Plus" => "+",
            "Minus" => "−",
            "Equals" => "=",
            "Delete" => "Del",
            "Escape" => "Esc",
            other => other,
        })
    }
}

/// The keys of all commands: the defaults, and the user's changes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Keymap {
    /// Keys by command id, only for commands whose keys differ from the defaults.
    changed: BTreeMap<String, Vec<Chord>>,
}

impl Keymap {
    /// The keys of a command.
    pub fn chords(&self, command: Command) -> Vec<Chord> {
        match self.changed.get(command.id()) {
            Some(chords) => chords.clone(),
            None => command
                .default_keys()
                .iter()
                .filter_map(|text| text.parse().ok())
                .collect(),
        }
    }

    /// The first key of a command as text for the user; empty if it has none.
    pub fn key_label(&self, command: Command) -> String {
        self.chords(command)
            .first()
            .map(ToString::to_string)
            .unwrap_or_default()
    }

    /// The first key of a command for a sentence; the command's name if it has none.
    pub fn key_or_name(&self, command: Command) -> String {
        let key = self.key_label(command);
        if key.is_empty() {
            format!("“{}”", command.name())
        } else {
            key
        }
    }

    /// The tooltip of a control: the command's description, and its key.
    pub fn tooltip(&self, command: Command) -> String {
        let key = self.key_label(command);
        if key.is_empty() {
            command.about().to_owned()
        } else {
            format!("{} ({key})", command.about())
        }
    }

    /// A text that names the key of a command; empty if the command has none.
    pub fn with_key(&self, command: Command, say: impl FnOnce(&str) -> String) -> String {
        let key = self.key_label(command);
        if key.is_empty() {
            String::new()
        } else {
            say(&key)
        }
    }

    /// Gives a command one key. Returns the command that had the key and loses it, if any.
    pub fn assign(&mut self, command: Command, chord: Chord) -> Option<Command> {
        // A key starts one command only: whichever had it loses it, but keeps its other keys.
        let loser =
            Command::all().find(|other| *other != command && self.chords(*other).contains(&chord));
        if let Some(loser) = loser {
            let kept = self
                .chords(loser)
                .into_iter()
                .filter(|held| *held != chord)
                .collect();
            self.changed.insert(loser.id().to_owned(), kept);
        }
        self.changed.insert(command.id().to_owned(), vec![chord]);
        loser
    }

    /// Resets all keys to their defaults.
    pub fn reset(&mut self) {
        self.changed.clear();
    }

    /// Whether any keys differ from the defaults.
    pub fn is_changed(&self) -> bool {
        !self.changed.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn no_two_commands_share_a_default_key() {
        let keymap = Keymap::default();
        let mut owners = BTreeMap::new();
        for command in Command::all() {
            assert_eq!(
                keymap.chords(command).len(),
                command.default_keys().len(),
                "{command:?} has an unreadable key"
            );
            for chord in keymap.chords(command) {
                if let Some(other) = owners.insert(chord.clone(), command) {
                    panic!("{chord} belongs to {other:?} and {command:?}");
                }
            }
        }
    }

    #[test]
    fn a_chord_survives_the_round_trip_and_nonsense_is_named() {
        for text in ["Z", "Ctrl+Z", "Ctrl+Shift+Alt+F2", "?"] {
            assert_eq!(String::from(text.parse::<Chord>().unwrap()), text);
        }
        assert_eq!(
            "Ctrl+".parse::<Chord>().unwrap_err(),
            ChordError::NoKey("Ctrl+".into())
        );
        assert!(
            "Hyper+Z"
                .parse::<Chord>()
                .unwrap_err()
                .to_string()
                .contains("\"Hyper\" is not a modifier")
        );
    }

    #[test]
    fn assigning_a_taken_key_takes_it_away() {
        let mut keymap = Keymap::default();
        let loser = keymap.assign(Command::ZoomToFit, "N".parse().unwrap());
        assert_eq!(loser, Some(Command::NextNeedsMe));
        assert!(keymap.chords(Command::NextNeedsMe).is_empty());
        assert_eq!(keymap.key_label(Command::ZoomToFit), "N");
        let say = |key: &str| format!("Press {key}.");
        assert_eq!(keymap.with_key(Command::ZoomToFit, say), "Press N.");
        assert_eq!(keymap.with_key(Command::NextNeedsMe, say), "");
        assert_eq!(keymap.key_or_name(Command::ZoomToFit), "N");
        let name = "“Next frame to do”";
        assert_eq!(keymap.key_or_name(Command::NextNeedsMe), name);
        keymap.reset();
        assert_eq!(keymap.key_label(Command::ZoomToFit), "F");
    }
}
