//! The user guide: every dialog leads to its page, and back.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::{Key, Modifiers, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use touchline::app::guide::GuidePage;
use touchline::app::session::Dialog;
use touchline::app::{Action, Command, ViewAction};

pub const TESTS: &[Test] = tests![
    [Adapter] every_dialog_leads_to_its_page_and_back;
    [Adapter] the_guide_is_read_from_top_to_bottom_in_the_smallest_window;
    [Adapter] f1_opens_the_page_of_what_is_shown;
];

fn page(window: &Window) -> Option<GuidePage> {
    match window.app().session.dialog {
        Some(Dialog::Guide { page, .. }) => Some(page),
        _ => None,
    }
}

fn every_dialog_leads_to_its_page_and_back() {
    let mut window = Window::open(2, [900.0, 600.0], 1.0);
    for (command, expected) in [
        (Command::Keys, GuidePage::Window),
        (Command::Messages, GuidePage::Window),
        (Command::Preferences, GuidePage::Window),
        (Command::OverlayStyle, GuidePage::Window),
        (Command::PictureLook, GuidePage::Window),
        (Command::About, GuidePage::Window),
        (Command::ChooseSport, GuidePage::FirstProject),
        (Command::GoToPlace, GuidePage::Video),
        (Command::AssignToCamera, GuidePage::Base),
        (Command::Export, GuidePage::Export),
        (Command::Import, GuidePage::Export),
    ] {
        window.apply(Action::Command(command));
        window.harness.run_steps(3);
        let before = window.app().session.dialog.clone();
        window.press_label(&format!("Guide: {}", expected.title()));
        // A sheet takes its place in the second picture.
        window.harness.run_steps(6);
        assert_eq!(page(&window), Some(expected), "{}", command.name());
        window.press_label("Glossary");
        window.harness.run_steps(4);
        assert_eq!(
            page(&window),
            Some(GuidePage::Glossary),
            "{}",
            command.name()
        );
        window.press_label("Back");
        window.harness.run_steps(3);
        assert_eq!(window.app().session.dialog, before, "{}", command.name());
        window.apply(Action::View(ViewAction::CloseDialog));
        window.harness.run_steps(2);
    }
}

fn the_guide_is_read_from_top_to_bottom_in_the_smallest_window() {
    let mut window = Window::open(2, [900.0, 600.0], 1.0);
    window.key(Key::F1);
    window.harness.run_steps(6);
    window.snapshot_of(
        "guide",
        Rect::from_min_max(pos2(70.0, 30.0), pos2(830.0, 330.0)),
    );
    let rect = |text: &str| window.harness.get_by_label_contains(text).rect();
    for name in ["Close: User guide", "Glossary"] {
        let place = rect(name);
        assert!(
            Rect::from_min_size(pos2(0.0, 0.0), vec2(900.0, 600.0)).contains_rect(place),
            "{name}: {place:?}"
        );
    }
    let (first, second) = (rect("Drop a folder of frames"), rect("Choose the sport."));
    assert!(
        second.top() >= first.bottom() && (second.left() - first.left()).abs() < 2.0,
        "{first:?} {second:?}"
    );
}

fn f1_opens_the_page_of_what_is_shown() {
    let mut window = Window::open(2, [900.0, 600.0], 1.0);
    for (key, expected) in [
        (Key::F2, GuidePage::Base),
        (Key::F4, GuidePage::Review),
        (Key::F5, GuidePage::Quality),
    ] {
        window.key(key);
        window.key(Key::F1);
        assert_eq!(page(&window), Some(expected), "{key:?}");
        window.key(Key::Escape);
        window.key(key);
    }
    // From a dialog as well; F1 closes it again.
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::E);
    window.harness.run_steps(3);
    window.key(Key::F1);
    assert_eq!(page(&window), Some(GuidePage::Export));
    window.key(Key::F1);
    assert_eq!(window.app().session.dialog, Some(Dialog::Transfer));
}
