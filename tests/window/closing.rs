//! The window closes when everything is on disk, and asks before edits are lost.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use touchline::app::session::{Dialog, Leaving, Saving};
use touchline::app::{Action, EditAction};

pub const TESTS: &[Test] = tests![
    [Adapter] ctrl_q_asks_in_the_window_before_edits_are_lost;
];

fn ctrl_q_asks_in_the_window_before_edits_are_lost() {
    let mut window = Window::open(1, [1280.0, 720.0], 1.0);
    assert!(
        window
            .harness
            .ctx
            .options(|options| options.quit_shortcuts.is_empty()),
        "only the application quits"
    );
    let folder = window.app().open().unwrap().folder.clone();
    let away = folder.with_extension("away");
    std::fs::rename(&folder, &away).unwrap();
    window.apply(Action::Edit(EditAction::SetComment("kept?".to_owned())));
    window.wait_for(|shell| matches!(shell.app().session.disk.saving, Saving::Failed { .. }));
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::Q);
    window.harness.run_steps(3);
    assert_eq!(
        window.app().session.dialog,
        Some(Dialog::NotSaved(Leaving::Close))
    );
    assert!(
        window
            .harness
            .query_by_label("Quit and lose edits")
            .is_some(),
        "the window warns"
    );
    std::fs::rename(&away, &folder).unwrap();
    // The disk takes it again: what was asked for is done.
    window.wait_for(|shell| shell.app().session.dialog.is_none());
}
