//! What has the keyboard focus, and which keys it leaves to the program.
//!
//! A button handles the keys that press it or lead away from it. A text field reads all plain keys
//! and has its own undo, cursor and clipboard, whichever letters the user gave to commands.

use super::key_stroke::KeyStroke;
use egui::Key;
use touchline_application::app::{Command, MenuGroup};

/// What has the keyboard focus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Focus {
    /// Nothing.
    #[default]
    Free,
    /// A button or similar, reached by Tab: it handles Enter, Space, Tab and arrows itself.
    Widget,
    /// A text field.
    Text,
}

impl Focus {
    /// What has the focus in the window now.
    pub fn now(ctx: &egui::Context) -> Self {
        if ctx.text_edit_focused() {
            Self::Text
        } else if ctx.egui_wants_keyboard_input() {
            Self::Widget
        } else {
            Self::Free
        }
    }
}

/// Whether the focused control leaves this key to the program, given the command that has it.
pub(super) fn is_free(stroke: &KeyStroke, command: Option<Command>, focus: Focus) -> bool {
    let function_key = stroke.key.name().len() > 1 && stroke.key.name().starts_with('F');
    match focus {
        Focus::Free => true,
        Focus::Widget => !matches!(
            stroke.key,
            Key::Enter
                | Key::Space
                | Key::Tab
                | Key::Escape
                | Key::ArrowLeft
                | Key::ArrowRight
                | Key::ArrowUp
                | Key::ArrowDown
        ),
        // A text field has its own undo, cursor and clipboard keys. Only function keys and the
        // shortcuts of a few commands are left, whichever letters the user gave them.
        Focus::Text => {
            function_key
                || stroke.modifiers.command
                    && !is_key_of_text(stroke.key)
                    && command.is_some_and(works_beside_text)
        }
    }
}

/// Whether a shortcut of a command works while a text is typed: it is about the whole document or
/// the program, so that the text that has the focus does not matter to it.
fn works_beside_text(command: Command) -> bool {
    command.group() == MenuGroup::File || matches!(command, Command::Comment | Command::Palette)
}

/// Whether a text field has its own meaning for Ctrl with a key, so that no command gets it there.
const fn is_key_of_text(key: Key) -> bool {
    matches!(
        key,
        Key::A
            | Key::C
            | Key::V
            | Key::X
            | Key::Y
            | Key::Z
            | Key::ArrowLeft
            | Key::ArrowRight
            | Key::ArrowUp
            | Key::ArrowDown
            | Key::Home
            | Key::End
            | Key::Backspace
            | Key::Delete
    )
}
