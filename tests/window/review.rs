//! Suggestions looked through in the window: the panel's list, one after the other, several
//! together.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use touchline::app::session::{Dialog, SidePanel};
use touchline::document::FrameStatus;
use touchline::ui::Shell;

pub const TESTS: &[Test] = tests![
    [Adapter] the_list_leads_from_suggestion_to_suggestion;
    [Adapter] a_row_has_a_menu_of_what_can_be_done_with_its_frame;
    [Adapter] under_the_pointer_no_row_moves;
    [Adapter] the_panel_and_the_filmstrip_look_like_this;
    [Adapter] several_are_accepted_by_keyboard_after_a_look_and_one_undo_takes_all_back;
    [Adapter] a_stretch_is_counted_and_accepted_by_keyboard_and_one_undo_takes_it_back;
    [Adapter] the_pictures_of_many_suggestions_lie_apart;
    [Adapter] in_the_gallery_pictures_are_selected_by_clicks_and_keys_and_accepted_once_seen;
    [Adapter] an_accepted_suggestion_can_be_used_for_training;
];

const SIZE: [f32; 2] = [1280.0, 720.0];

fn statuses(window: &Window) -> Vec<FrameStatus> {
    window
        .app()
        .open()
        .unwrap()
        .document
        .frames
        .iter()
        .map(|frame| frame.status)
        .collect()
}

fn the_list_leads_from_suggestion_to_suggestion() {
    use FrameStatus::{New, Reference, Suggested};
    let mut window = Window::open_suggested(&[Some(0.62), Some(0.99), Some(0.93), None], SIZE);
    window.key(Key::F4);
    assert_eq!(window.app().session.panel, SidePanel::Review);
    window
        .harness
        .get_by_label_contains("Suggestion, frame 1, 0001.png, 99 %")
        .click();
    window.harness.run_steps(2);
    assert_eq!(window.app().session.frame, 1);
    window.key(Key::Enter);
    assert_eq!(statuses(&window), [Suggested, Reference, Suggested, New]);
    assert_eq!(
        window.app().session.frame,
        0,
        "round and round: the most doubtful"
    );
    window.press_label("Time");
    window.harness.run_steps(2);
    window.key(Key::N);
    assert_eq!(window.app().session.frame, 2);
    window.press_label("1 frame has no answer, 1 uncertain: label frame 3, near pan\u{a0}−15°.");
    window.harness.run_steps(2);
    assert_eq!(window.app().session.frame, 3);
    window.press_label("Close the review panel");
    window.harness.run_steps(2);
    assert_eq!(window.app().session.panel, SidePanel::Frame);
    window
        .harness
        .get_by_label_contains("No proposal: 3 features look like the references, 12 are needed.");
}

fn a_row_has_a_menu_of_what_can_be_done_with_its_frame() {
    let mut window = Window::open_suggested(&[Some(0.62), Some(0.99), Some(0.93)], SIZE);
    window.key(Key::F4);
    window
        .harness
        .get_by_label_contains("Suggestion, frame 2, 0002.png")
        .click_secondary();
    window.harness.run_steps(5);
    assert_eq!(
        window.app().session.frame,
        2,
        "the menu is about the row's frame, which is shown"
    );
    window.wait_for(|shell| !shell.app().session.video.picture_awaited);
    window
        .harness
        .get_by_label_contains("Accept and stay")
        .click();
    window.harness.run_steps(4);
    assert_eq!(
        statuses(&window),
        [
            FrameStatus::Suggested,
            FrameStatus::Suggested,
            FrameStatus::Reference
        ]
    );
}

fn in_the_gallery_pictures_are_selected_by_clicks_and_keys_and_accepted_once_seen() {
    use FrameStatus::{Reference, Rejected, Suggested};
    let mut window = Window::open_suggested(&[Some(0.62), Some(0.99), Some(0.93)], SIZE);
    window
        .harness
        .key_press_modifiers(Modifiers::SHIFT, Key::F4);
    window.harness.run_steps(2);
    assert_eq!(window.app().session.dialog, Some(Dialog::Gallery));
    window.harness.run_steps(2);
    // The most doubtful comes first; the arrows begin there.
    window.key(Key::Space);
    assert_eq!(window.app().session.frames_selected, [0].into());
    window
        .harness
        .key_press_modifiers(Modifiers::SHIFT, Key::ArrowRight);
    window.harness.run_steps(2);
    assert_eq!(window.app().session.frames_selected, [0, 2].into());
    window
        .harness
        .get_by_label_contains("Frame 1, 99 %")
        .click();
    window.harness.run_steps(2);
    assert_eq!(window.app().session.frames_selected, [1].into());
    window.wait_for(Shell::has_thumbnails);
    window.key(Key::Enter);
    assert_eq!(statuses(&window), [Suggested, Reference, Suggested]);
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.harness.run_steps(2);
    assert_eq!(window.app().session.frames_selected, [0, 2].into());
    window.press_label("Reject 2");
    window.harness.run_steps(3);
    window.press_label("Replay");
    window.harness.run_steps(3);
    assert_eq!(statuses(&window), [Rejected, Reference, Rejected]);
    window.key(Key::Escape);
    assert_eq!(window.app().session.dialog, None);
}

fn under_the_pointer_no_row_moves() {
    let mut window = Window::open_suggested(&[Some(0.62), Some(0.99), Some(0.93), None], SIZE);
    window.key(Key::F4);
    let top =
        |window: &Window, label: &str| window.harness.get_by_label_contains(label).rect().top();
    let labels = [
        "frame 0, 0000.png",
        "frame 2, 0002.png",
        "frame 1, 0001.png",
    ];
    let before = labels.map(|label| top(&window, label));
    assert!(before.is_sorted());
    let first = window.harness.get_by_label_contains(labels[0]).rect();
    window.harness.hover_at(first.center());
    window.harness.run_steps(2);
    window.harness.get_by_label_contains(labels[0]).click();
    window.harness.run_steps(2);
    window.key(Key::Enter);
    window.propose(3, 0.97);
    window.propose(1, 0.98);
    assert_eq!(
        labels.map(|label| top(&window, label)),
        before,
        "accepted, proposed, proposed anew"
    );
    window
        .harness
        .get_by_label_contains("No longer a suggestion, frame 0");
    window
        .harness
        .get_by_label("1 new, sorted in when the pointer leaves");
    assert!(top(&window, "frame 3, 0003.png") > before[2]);
    window.harness.hover_at(egui::pos2(400.0, 300.0));
    window.harness.run_steps(3);
    let after = [
        "frame 2, 0002.png",
        "frame 3, 0003.png",
        "frame 1, 0001.png",
    ]
    .map(|label| top(&window, label));
    assert!(
        after.is_sorted()
            && window
                .harness
                .query_by_label_contains("No longer a suggestion")
                .is_none()
    );
    assert_eq!(after[0], before[0]);
}

fn the_panel_and_the_filmstrip_look_like_this() {
    let mut confidences = vec![Some(0.99), Some(0.97), Some(0.71)];
    confidences.extend([None; 5]);
    let mut window = Window::open_suggested(&confidences, SIZE);
    window.key(Key::F4);
    window
        .harness
        .get_by_label("5 frames without an answer, 3 to 7");
    let panel = egui::Rect::from_min_max(egui::pos2(980.0, 24.0), egui::pos2(1280.0, 700.0));
    // The suggestions are checked against the painted lines in the background, which marks the
    // thumbnails.
    let is_checked = |shell: &Shell| (0..3).all(|frame| shell.app().paint_says(frame).is_some());
    window.wait_for(|shell| shell.has_thumbnails() && is_checked(shell));
    window.snapshot_of("review_panel", panel);
}

fn the_pictures_of_many_suggestions_lie_apart() {
    let mut window = Window::open_suggested(&[Some(0.99); 7], SIZE);
    window
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, Key::Enter);
    window.harness.run_steps(3);
    let pictures: Vec<_> = window
        .harness
        .get_all_by_label_contains("Look at frame")
        .map(|picture| picture.rect())
        .collect();
    assert!(pictures.len() > 3, "more than one row: {pictures:?}");
    for (index, one) in pictures.iter().enumerate() {
        assert!(
            pictures[..index]
                .iter()
                .all(|other| !other.intersects(*one)),
            "{one:?} lies over another"
        );
    }
}

fn several_are_accepted_by_keyboard_after_a_look_and_one_undo_takes_all_back() {
    use FrameStatus::{Reference, Suggested};
    let mut window = Window::open_suggested(&[Some(0.99), Some(0.5), Some(0.97)], SIZE);
    window
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, Key::Enter);
    window.harness.run_steps(3);
    assert_eq!(window.app().session.dialog, Some(Dialog::AcceptAll));
    window
        .harness
        .get_by_label("2 suggestions, probably at most 1 of them wrong. The least certain come first, from 97 % on.");
    window.harness.get_by_label("Look at frame 2, 97 %");
    let tick = window
        .harness
        .get_by_role_and_label(Role::CheckBox, "Accept frame 2");
    tick.click();
    window.harness.run_steps(2);
    window
        .harness
        .get_by_label_contains("1 suggestion, all probably right.");
    window
        .harness
        .get_by_role_and_label(Role::CheckBox, "Accept frame 2")
        .click();
    window.harness.run_steps(2);
    window.key(Key::Escape);
    assert_eq!(window.app().session.dialog, None);
    window
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, Key::Enter);
    window.harness.run_steps(3);
    window.key(Key::Enter);
    assert_eq!(statuses(&window), [Reference, Suggested, Reference]);
    window
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, Key::Z);
    window.harness.run_steps(2);
    assert_eq!(statuses(&window), [Suggested; 3]);
}

fn a_stretch_is_counted_and_accepted_by_keyboard_and_one_undo_takes_it_back() {
    use FrameStatus::{New, Reference, Suggested};
    let mut window = Window::open_suggested(&[Some(0.99), Some(0.97), None, Some(0.98)], SIZE);
    window
        .harness
        .get_by_label_contains("Frame 3, 0003.png")
        .click_modifiers(egui::Modifiers::SHIFT);
    window.harness.run_steps(2);
    window
        .harness
        .get_by_label_contains("4 frames selected, 0 to 3.");
    window.harness.get_by_label("Accept 4 selected frames…");
    // The painted lines of their pictures are looked at in the background.
    let is_checked = |frame| move |shell: &Shell| shell.app().own_paint_says(frame).is_some();
    for frame in [0, 1, 3] {
        window.wait_for(is_checked(frame));
    }
    window.key(Key::Enter);
    assert_eq!(window.app().session.dialog, Some(Dialog::AcceptAll));
    window
        .harness
        .get_by_label("3 on the paint, 1 left: 1 without a camera (frame 2).");
    window.key(Key::Escape);
    assert_eq!(
        statuses(&window),
        [Suggested, Suggested, New, Suggested],
        "left as they were"
    );
    window.key(Key::Enter);
    window.harness.run_steps(3);
    window.key(Key::Enter);
    assert_eq!(statuses(&window), [Reference, Reference, New, Reference]);
    window
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, Key::Z);
    window.harness.run_steps(2);
    assert_eq!(statuses(&window), [Suggested, Suggested, New, Suggested]);
}

fn an_accepted_suggestion_can_be_used_for_training() {
    let mut window = Window::open_suggested(&[Some(0.97)], SIZE);
    window
        .harness
        .get_by_label("Proposed, confidence 97 %. Not reviewed yet.");
    assert!(
        window
            .harness
            .query_by_role_and_label(Role::CheckBox, "Use for training")
            .is_none()
    );
    window.key(Key::Enter);
    let switch = window
        .harness
        .get_by_role_and_label(Role::CheckBox, "Use for training");
    assert_eq!(
        switch.accesskit_node().toggled(),
        Some(egui::accesskit::Toggled::False)
    );
    // Not by its place: what arrives about the frame in the background moves it.
    switch.click_accesskit();
    window.harness.run_steps(2);
    assert!(window.app().frame().unwrap().is_used_for_training());
}
