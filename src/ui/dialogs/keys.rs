//! The list of all commands with their keys. A click on a key changes it.

use super::sheet;
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{
    Button, Context, Event, Grid, Id, Key, Label, Modifiers, RichText, ScrollArea, Ui, vec2,
};
use touchline_application::app::{Chord, Command, Keymap, MenuGroup, SettingsAction};

/// Keys and pointer actions that are no commands and cannot be changed.
const FIXED: [(&str, &str); 11] = [
    ("Click", "place a point, or grab one"),
    (
        "Drag a drawn line or ring",
        "move it to where the picture shows it; the frame's camera follows",
    ),
    ("1–5, letters", "choose a name, filter the names"),
    (
        "Arrows",
        "move the selected point 0.1 px; Shift 1 px, Alt 10 px",
    ),
    (
        "Tab",
        "while naming a point: switch between landmarks and lines",
    ),
    ("Wheel", "zoom to the pointer"),
    ("Space-drag, middle drag", "move the picture"),
    (
        "Alt while releasing",
        "the point stays there instead of snapping to paint nearby",
    ),
    (
        "Shift-click, Shift-drag",
        "on filmstrip or timeline: select the frames from the shown one to there",
    ),
    ("Shift while dragging", "a tenth of the pointer's speed"),
    ("1–6", "the reason, after Not calibratable"),
];

/// Width of the column of keys, points.
const KEY: f32 = 168.0;

/// Where the command that waits for a new key is stored.
fn waiting() -> Id {
    Id::unique("command that waits for a key")
}

/// Whether the next key press is recorded for a command, so that nothing else may read it.
pub fn captures_keys(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp::<Option<Command>>(waiting()))
        .flatten()
        .is_some()
}

/// Sets the command that waits for a new key.
fn set_waiting(ctx: &Context, command: Option<Command>) {
    ctx.data_mut(|data| data.insert_temp(waiting(), command));
}

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    // Closing the dialog ends the wait for a key.
    if super::has_just_opened(ctx, "keys") {
        set_waiting(ctx, None);
    }
    let chosen = ctx
        .data(|data| data.get_temp::<Option<Command>>(waiting()))
        .flatten();
    if let Some(command) = chosen {
        capture(panel, ctx, command);
    }
    sheet(panel, ctx, "Keys", vec2(860.0, 560.0), |panel, ui| {
        ui.horizontal(|ui| {
            let hint = match chosen {
                Some(command) => format!(
                    "Press the new key for “{}”. Esc keeps the old one.",
                    command.name()
                ),
                None => "Click a key to change it.".to_owned(),
            };
            let colour = if chosen.is_some() {
                ui.palette().accent
            } else {
                ui.palette().weak
            };
            ui.label(RichText::new(hint).color(colour));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let changed = panel.app.settings.keys.is_changed();
                let reset = ui.add_enabled(changed, Button::new("Reset to defaults"));
                let reset = reset
                    .on_hover_text("Give every command its default key.")
                    .on_disabled_hover_text("Every command has its default key.");
                if reset.clicked() {
                    panel.set(SettingsAction::ResetKeys);
                }
            });
        });
        ui.add_space(theme::SPACE);
        ScrollArea::vertical()
            .auto_shrink([false, true])
            .show(ui, |ui| {
                ui.columns(2, |columns| {
                    for group in [MenuGroup::File, MenuGroup::Edit, MenuGroup::View] {
                        table(panel, &mut columns[0], group, chosen);
                    }
                    for group in [MenuGroup::Frame, MenuGroup::Camera, MenuGroup::Help] {
                        table(panel, &mut columns[1], group, chosen);
                    }
                    show_fixed_keys(&mut columns[1]);
                });
            });
    });
}

/// Lists the commands of a menu.
fn table(panel: &mut Panel<'_>, ui: &mut Ui, group: MenuGroup, chosen: Option<Command>) {
    theme::title(ui, &group.title().to_uppercase());
    Grid::new(("keys", group.title()))
        .num_columns(2)
        .min_col_width(KEY)
        .spacing([12.0, 2.0])
        .show(ui, |ui| {
            for command in Command::all().filter(|command| command.group() == group) {
                key(panel, ui, command, chosen == Some(command));
                ui.add(Label::new(command.name()).truncate())
                    .on_hover_text(command.about());
                ui.end_row();
            }
        });
    ui.add_space(3.0 * theme::SPACE);
}

/// Shows the keys of a command as a button; a click waits for a new key.
fn key(panel: &Panel<'_>, ui: &mut Ui, command: Command, waits: bool) {
    let shown = key_list(&panel.app.settings.keys, command);
    let text = match (waits, shown.is_empty()) {
        (true, _) => RichText::new("press a key").color(ui.palette().strong),
        (false, true) => RichText::new("none").color(ui.palette().weak),
        (false, false) => RichText::new(&shown).monospace().color(ui.palette().strong),
    };
    let button = ui.add(Button::new(text).min_size(vec2(KEY, 20.0)).selected(waits));
    let name = format!(
        "Key of {}: {}",
        command.name(),
        if shown.is_empty() { "none" } else { &shown }
    );
    if button
        .accessible_name(name)
        .on_hover_text(format!("{} Click to change the key.", command.about()))
        .clicked()
    {
        set_waiting(ui.ctx(), (!waits).then_some(command));
    }
}

/// All keys of a command.
fn key_list(keys: &Keymap, command: Command) -> String {
    let chords: Vec<String> = keys
        .chords(command)
        .iter()
        .map(ToString::to_string)
        .collect();
    chords.join(", ")
}

/// Lists what cannot be changed.
fn show_fixed_keys(ui: &mut Ui) {
    theme::title(ui, "POINTER AND FIXED KEYS");
    Grid::new("fixed keys")
        .num_columns(2)
        .min_col_width(KEY)
        .spacing([12.0, 4.0])
        .show(ui, |ui| {
            for (key, about) in FIXED {
                theme::strong(ui, key);
                ui.add(Label::new(about).wrap());
                ui.end_row();
            }
        });
}

/// Assigns the next key press to the command, and removes it from the input. Escape keeps the old
/// key.
fn capture(panel: &mut Panel<'_>, ctx: &Context, command: Command) {
    // A modifier alone is not a key, and a repetition belongs to an earlier press.
    let pressed = ctx.input_mut(|input| {
        let found = input.events.iter().find_map(|event| match event {
            Event::Key {
                key,
                pressed: true,
                repeat: false,
                modifiers,
                ..
            } if !is_modifier(*key) => Some((*key, *modifiers)),
            _ => None,
        });
        // The text that the key types must not reach a field either.
        if found.is_some() {
            input
                .events
                .retain(|event| !matches!(event, Event::Key { .. } | Event::Text(_)));
        }
        found
    });
    let Some((key, modifiers)) = pressed else {
        return;
    };
    set_waiting(ctx, None);
    if key != Key::Escape {
        panel.set(SettingsAction::AssignKey(command, chord(key, modifiers)));
    }
}

/// Whether a key is a modifier by itself.
const fn is_modifier(key: Key) -> bool {
    matches!(
        key,
        Key::ShiftLeft
            | Key::ShiftRight
            | Key::ControlLeft
            | Key::ControlRight
            | Key::AltLeft
            | Key::AltRight
            | Key::SuperLeft
            | Key::SuperRight
    )
}

/// A key stroke as the settings store it. For punctuation, Shift is not stored, because the
/// keyboard layout decides whether the sign needs it.
fn chord(key: Key, modifiers: Modifiers) -> Chord {
    // Some layouts report the question mark as Shift and slash (`key_stroke::question_mark`).
    let question = key == Key::Questionmark || key == Key::Slash && modifiers.shift;
    let sign = question
        || matches!(
            key,
            Key::Plus | Key::Colon | Key::Exclamationmark | Key::Pipe
        );
    Chord {
        ctrl: modifiers.command,
        shift: modifiers.shift && !sign,
        alt: modifiers.alt,
        key: if question {
            "?".to_owned()
        } else {
            key.name().to_owned()
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pressed_key_is_written_as_the_settings_read_it() {
        for (key, modifiers, written) in [
            (Key::N, Modifiers::NONE, "N"),
            (
                Key::Z,
                Modifiers::COMMAND | Modifiers::SHIFT,
                "Ctrl+Shift+Z",
            ),
            (Key::Period, Modifiers::SHIFT, "Shift+Period"),
            (Key::Plus, Modifiers::SHIFT, "Plus"),
            (Key::Slash, Modifiers::SHIFT, "?"),
        ] {
            assert_eq!(chord(key, modifiers), written.parse().unwrap());
        }
    }
}
