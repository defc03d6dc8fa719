//! The dialog of exports, datasets and imports.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::{Key, Modifiers, pos2, vec2};
use touchline::app::session::Dialog;
use touchline::app::transfer::{PreviewResult, TransferAction};
use touchline::app::{Action, App, Question};
use touchline::exchange::Format;

pub const TESTS: &[Test] = tests![
    [Adapter] formats_say_what_they_are_and_what_they_lose_before_anything_is_written;
    [Adapter] a_dataset_is_shown_before_it_is_written;
];

const SIZE: [f32; 2] = [1280.0, 720.0];

fn wait_for_look(window: &mut Window) {
    window.wait_for(|shell| shell.app().operations.transfer.found.is_some() && shell.is_idle());
    window.harness.run_steps(3);
}

/// The format of the export that was looked at.
fn exported_format(app: &App) -> Option<Format> {
    match &app.operations.transfer.found.as_ref()?.look {
        PreviewResult::Export(Ok(exported)) => Some(exported.format),
        _ => None,
    }
}

fn formats_say_what_they_are_and_what_they_lose_before_anything_is_written() {
    let mut window = Window::open_referenced(4, SIZE);
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::E);
    window.harness.run_steps(2);
    assert_eq!(window.app().session.dialog, Some(Dialog::Transfer));
    wait_for_look(&mut window);
    // Further down in the list than a click reaches.
    window.apply(Action::Transfer(TransferAction::Format(Format::Chan)));
    window.wait_for(|shell| shell.is_idle() && exported_format(shell.app()) == Some(Format::Chan));
    window.harness.run_steps(3);
    assert_eq!(window.harness.unnamed_widgets(), Vec::<String>::new());
    window.snapshot_of(
        "export_formats",
        egui::Rect::from_min_size(pos2(220.0, 60.0), vec2(840.0, 600.0)),
    );
    let file = window.folder.path().join("camera.chan");
    window.apply(Action::Answer(
        Question::ExportAs(Format::Chan),
        file.clone(),
    ));
    window.wait_for(|shell| file.exists() && shell.app().session.dialog.is_none());
}

fn a_dataset_is_shown_before_it_is_written() {
    let mut window = Window::open_referenced(4, SIZE);
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    window.harness.run_steps(2);
    window.press_label("split into training, validation and test, %:");
    window.harness.run_steps(2);
    wait_for_look(&mut window);
    assert_eq!(window.harness.unnamed_widgets(), Vec::<String>::new());
    window.snapshot_of(
        "export_dataset",
        egui::Rect::from_min_size(pos2(220.0, 60.0), vec2(840.0, 600.0)),
    );
    let folder = window.folder.path().join("set");
    window.apply(Action::Answer(Question::DatasetTo, folder.clone()));
    window.wait_for(|shell| {
        folder.join("manifest.sha256").exists() && shell.app().session.dialog.is_none()
    });
    window.apply(Action::Transfer(TransferAction::Stop));
    assert!(
        (!window.app().operations.transfer.is_looking()
            && window.app().operations.transfer.writing().is_none())
    );
}
