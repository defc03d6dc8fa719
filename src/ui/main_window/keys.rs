//! From keys to actions, through the user's keymap.
//!
//! A plain key does nothing while a text field has the focus, or while a list of names or reasons
//! is open: those read letters and digits themselves, before this module. A dialog closes with
//! Escape, and one that [`opens`] lists also with the key that opens it. It takes all other keys,
//! unless it is about appearance.

use super::focus::{Focus, is_free};
use super::key_stroke::{KeyStroke, command_of, key_of, question_mark};
use crate::ui::{dialogs, takes_keys};
use egui::{Event, FocusDirection, Key};
use touchline_application::app::session::{Dialog, HeldCommands, Mode};
use touchline_application::app::{Action, App, Command, EditAction, ViewAction};

/// Distance by which an arrow key moves the selected point, px of the picture: alone, with Shift,
/// with Alt.
const NUDGE_PX: [f64; 3] = [0.1, 1.0, 10.0];

/// Commands that repeat while their key stays down.
const REPEATED: [Command; 8] = [
    Command::NextFrame,
    Command::PreviousFrame,
    Command::NextTenFrames,
    Command::PreviousTenFrames,
    Command::NextClick,
    Command::PreviousClick,
    Command::ZoomIn,
    Command::ZoomOut,
];

/// Reads the keys of this frame of the window.
pub fn read(app: &App, actions: &mut Vec<Action>, ctx: &egui::Context) {
    // A menu or the dialog of keys reads the key presses. A key that goes up still ends the command
    // that lasts while it is down, or the overlay would stay hidden after the menu has closed.
    let is_taken = dialogs::captures_keys(ctx) || egui::Popup::is_any_open(ctx);
    let focus = Focus::now(ctx);
    let (events, window_focused) = ctx.input(|input| (input.events.clone(), input.focused));
    let mut typed: Vec<Action> = Vec::new();
    for event in &events {
        let Event::Key {
            key,
            physical_key,
            pressed,
            repeat,
            modifiers,
        } = event
        else {
            continue;
        };
        if is_taken && *pressed {
            continue;
        }
        let stroke = KeyStroke {
            key: *key,
            physical: *physical_key,
            pressed: *pressed,
            repeat: *repeat,
            modifiers: *modifiers,
        };
        typed.extend(meaning(app, stroke, focus));
    }
    let steps_clicks = typed.iter().any(|action| {
        matches!(
            action,
            Action::Command(Command::NextClick | Command::PreviousClick)
        )
    });
    // egui moves the focus with Tab by itself.
    if steps_clicks {
        // Tab was a command here, so the focus must not move.
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    }
    // A key that goes up over another window sends no event. So the loss of the focus ends all
    // commands that last while a key is down.
    if !window_focused && app.session.picture.held != HeldCommands::default() {
        typed.push(Action::Hold(Command::HideOverlay, false));
        typed.push(Action::Hold(Command::Compare, false));
        typed.push(Action::Hold(Command::Snap, false));
    }
    actions.extend(typed);
}

/// The action of a key stroke in the present state, if any.
pub fn meaning(app: &App, stroke: KeyStroke, focus: Focus) -> Option<Action> {
    let stroke = question_mark(stroke);
    // A key goes up: it ends the command that lasts while it is down. Modifiers and focus do not
    // matter, they may have changed in the meantime.
    if !stroke.pressed {
        return Command::all()
            .filter(|command| command.is_held() && is_held_down(app, *command))
            .find(|command| {
                app.settings
                    .keys
                    .chords(*command)
                    .iter()
                    .any(|chord| key_of(chord) == Some(stroke.key))
            })
            .map(|command| Action::Hold(command, false));
    }
    let command = command_of(app, &stroke);
    // A dialog is open.
    if let Some(dialog) = &app.session.dialog {
        let opens_it = command.is_some_and(|command| opens(command, dialog));
        if stroke.key == Key::Escape
            || opens_it && (focus != Focus::Text || stroke.modifiers.command)
        {
            return Some(Action::View(ViewAction::CloseDialog));
        }
        if command == Some(Command::Guide) && is_free(&stroke, command, focus) {
            return Some(Action::Command(Command::Guide));
        }
        if takes_keys(dialog) {
            return None;
        }
    }
    if !is_free(&stroke, command, focus) {
        return None;
    }
    let plain = !stroke.modifiers.command && !stroke.modifiers.alt;
    match &app.session.mode {
        // The lists of names and reasons have read their keys already; only Escape is left.
        Mode::Naming(_) | Mode::Rejecting { .. } if plain => {
            return (command == Some(Command::Cancel)).then_some(Action::Command(Command::Cancel));
        }
        // While a point is dragged or a number is edited, only Escape and commands that last while
        // a key is down work.
        Mode::Dragging { .. } | Mode::Editing if command != Some(Command::Cancel) => {
            return command
                .filter(|command| command.is_held() && !stroke.repeat)
                .map(|held| Action::Hold(held, true));
        }
        _ => {}
    }
    // Any other mode: commands that last while their key is down, then the rest. An arrow key
    // without a command moves the selected point.
    match command {
        Some(command) if command.is_held() => {
            (!stroke.repeat).then_some(Action::Hold(command, true))
        }
        Some(command) if stroke.repeat && !REPEATED.contains(&command) => None,
        // Without points Tab moves the focus, as usual.
        Some(Command::NextClick | Command::PreviousClick)
            if app.session.quality.open
                || app.frame().is_none_or(|frame| frame.clicks.is_empty()) =>
        {
            None
        }
        Some(command) => Some(Action::Command(command)),
        None => nudge(app, &stroke),
    }
}

/// Moves the selected point by an arrow key.
fn nudge(app: &App, stroke: &KeyStroke) -> Option<Action> {
    // Directions are those of the picture: x to the right, y down.
    let (dx, dy) = match stroke.key {
        Key::ArrowLeft => (-1.0, 0.0),
        Key::ArrowRight => (1.0, 0.0),
        Key::ArrowUp => (0.0, -1.0),
        Key::ArrowDown => (0.0, 1.0),
        _ => return None,
    };
    // The quality page hides the picture, so its points must not move unseen.
    app.session
        .points
        .selected
        .filter(|_| !app.session.quality.open)?;
    let step = match (
        stroke.modifiers.shift,
        stroke.modifiers.alt,
        stroke.modifiers.command,
    ) {
        (false, false, false) => NUDGE_PX[0],
        (true, false, false) => NUDGE_PX[1],
        (false, true, false) => NUDGE_PX[2],
        _ => return None,
    };
    Some(Action::Edit(EditAction::Nudge {
        dx_px: dx * step,
        dy_px: dy * step,
        held: stroke.repeat,
    }))
}

/// Whether a command opens this dialog. The same key closes it again.
fn opens(command: Command, dialog: &Dialog) -> bool {
    matches!(
        (command, dialog),
        (Command::Palette, Dialog::Palette)
            | (Command::Keys, Dialog::Keys)
            | (Command::About, Dialog::About)
            | (Command::Messages, Dialog::Messages)
            | (Command::Preferences, Dialog::Preferences)
            | (Command::GoToPlace, Dialog::GoToPlace)
            | (Command::OverlayStyle, Dialog::OverlayStyle)
            | (Command::PictureLook, Dialog::PictureLook)
            | (Command::Guide, Dialog::Guide { .. })
    )
}

/// Whether a command that lasts while its key is down is active.
fn is_held_down(app: &App, command: Command) -> bool {
    match command {
        Command::HideOverlay => app.session.picture.held.hide_overlay,
        Command::Compare => app.session.picture.held.compare,
        Command::Snap => app.session.picture.held.before_snap,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::super::key_stroke::{command_of, stroke};
    use super::*;
    use crate::ui::open_with_click;
    use egui::Modifiers;
    use touchline_application::app::Navigation;
    use touchline_core::geometry::ImagePoint;

    const NONE: Modifiers = Modifiers::NONE;

    fn app() -> App {
        open_with_click(ImagePoint::new(10.0, 20.0))
    }

    fn press(app: &App, key: Key, modifiers: Modifiers) -> Option<Action> {
        meaning(app, stroke(key, modifiers), Focus::Free)
    }

    #[test]
    fn arrows_nudge_the_selected_point_and_nothing_else() {
        let mut app = app();
        assert_eq!(press(&app, Key::ArrowLeft, NONE), None);
        app.update(Action::Navigate(Navigation::Select(Some(0))));
        assert_eq!(
            press(&app, Key::ArrowLeft, NONE),
            Some(Action::Edit(EditAction::Nudge {
                dx_px: -0.1,
                dy_px: 0.0,
                held: false
            }))
        );
        assert_eq!(
            press(&app, Key::ArrowDown, Modifiers::SHIFT),
            Some(Action::Edit(EditAction::Nudge {
                dx_px: 0.0,
                dy_px: 1.0,
                held: false
            }))
        );
        assert_eq!(
            press(&app, Key::ArrowUp, Modifiers::ALT),
            Some(Action::Edit(EditAction::Nudge {
                dx_px: 0.0,
                dy_px: -10.0,
                held: false
            }))
        );
        assert_eq!(press(&app, Key::ArrowUp, Modifiers::COMMAND), None);
    }

    #[test]
    fn letters_sleep_while_a_point_is_named_or_text_is_typed() {
        let mut app = app();
        assert_eq!(meaning(&app, stroke(Key::N, NONE), Focus::Text), None);
        assert_eq!(
            meaning(&app, stroke(Key::S, Modifiers::COMMAND), Focus::Text),
            Some(Action::Command(Command::Save))
        );
        assert_eq!(
            meaning(&app, stroke(Key::Z, Modifiers::COMMAND), Focus::Text),
            None
        );
        assert_eq!(meaning(&app, stroke(Key::Enter, NONE), Focus::Widget), None);
        app.update(Action::Navigate(Navigation::Select(Some(0))));
        app.update(Action::Command(Command::RenameClick));
        for key in [Key::N, Key::Num3, Key::Enter, Key::X] {
            assert_eq!(press(&app, key, NONE), None);
        }
        assert_eq!(
            press(&app, Key::Escape, NONE),
            Some(Action::Command(Command::Cancel))
        );
        assert_eq!(
            press(&app, Key::Z, Modifiers::COMMAND),
            Some(Action::Command(Command::Undo))
        );
    }

    #[test]
    fn keys_sleep_while_a_reason_is_chosen() {
        let mut app = app();
        app.update(Action::Command(Command::Reject));
        assert_eq!(press(&app, Key::N, NONE), None);
        assert_eq!(
            press(&app, Key::Escape, NONE),
            Some(Action::Command(Command::Cancel))
        );
    }

    #[test]
    fn held_commands_end_with_their_key_and_only_stepping_repeats() {
        let mut app = app();
        assert_eq!(
            press(&app, Key::H, NONE),
            Some(Action::Hold(Command::HideOverlay, true))
        );
        app.update(Action::Hold(Command::HideOverlay, true));
        let up = KeyStroke {
            pressed: false,
            ..stroke(Key::H, Modifiers::SHIFT)
        };
        assert_eq!(
            meaning(&app, up, Focus::Text),
            Some(Action::Hold(Command::HideOverlay, false))
        );
        let again = |key| {
            meaning(
                &app,
                KeyStroke {
                    repeat: true,
                    ..stroke(key, NONE)
                },
                Focus::Free,
            )
        };
        assert_eq!(again(Key::H), None);
        assert_eq!(
            again(Key::Period),
            Some(Action::Command(Command::NextFrame))
        );
        assert_eq!(again(Key::Enter), None);
        assert_eq!(again(Key::Delete), None);
    }

    #[test]
    fn a_key_that_goes_up_ends_its_command_while_a_menu_has_the_keys() {
        let mut app = app();
        app.update(Action::Hold(Command::HideOverlay, true));
        let ctx = egui::Context::default();
        let event = |key, pressed| Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: NONE,
        };
        ctx.begin_pass(egui::RawInput {
            events: vec![event(Key::N, true), event(Key::H, false)],
            focused: true,
            ..egui::RawInput::default()
        });
        egui::Popup::open_id(&ctx, egui::Id::unique("a menu"));
        let mut actions = Vec::new();
        read(&app, &mut actions, &ctx);
        ctx.end_pass().textures_delta.clear();
        assert_eq!(actions, [Action::Hold(Command::HideOverlay, false)]);
    }

    #[test]
    fn a_dialog_keeps_the_keys_and_closes_with_escape_or_its_own_key() {
        let mut app = app();
        app.update(Action::Command(Command::Palette));
        assert_eq!(press(&app, Key::N, NONE), None);
        assert_eq!(
            meaning(&app, stroke(Key::Escape, NONE), Focus::Text),
            Some(Action::View(ViewAction::CloseDialog))
        );
        assert_eq!(
            meaning(&app, stroke(Key::K, Modifiers::COMMAND), Focus::Text),
            Some(Action::View(ViewAction::CloseDialog))
        );
        app.update(Action::View(ViewAction::CloseDialog));
        app.update(Action::Command(Command::Preferences));
        assert_eq!(
            press(&app, Key::Comma, Modifiers::COMMAND),
            Some(Action::View(ViewAction::CloseDialog))
        );
        app.update(Action::View(ViewAction::CloseDialog));
        app.update(Action::Command(Command::OverlayStyle));
        assert_eq!(
            press(&app, Key::Period, NONE),
            Some(Action::Command(Command::NextFrame))
        );
        assert_eq!(
            press(&app, Key::O, NONE),
            Some(Action::View(ViewAction::CloseDialog))
        );
    }

    #[test]
    fn beside_a_text_the_keys_are_those_of_the_users_keymap() {
        let mut app = open_with_click(ImagePoint::new(10.0, 20.0));
        let keys = &mut app.settings.keys;
        keys.assign(Command::Save, "Ctrl+J".parse().unwrap());
        keys.assign(Command::Undo, "Ctrl+E".parse().unwrap());
        keys.assign(Command::Quit, "Ctrl+A".parse().unwrap());
        for (key, expected) in [
            (Key::J, Some(Command::Save)),
            (Key::S, None),
            // Undo is the text field's own, and so is the key that selects all of a text.
            (Key::E, None),
            (Key::A, None),
        ] {
            let stroke = stroke(key, Modifiers::COMMAND);
            let command = command_of(&app, &stroke);
            let free = command.filter(|_| is_free(&stroke, command, Focus::Text));
            assert_eq!(free, expected, "{key:?}");
        }
    }
}
