//! Keys and clicks that arrive within one frame of the window: each is applied before the next is
//! read.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::{Event, Key, Modifiers, PointerButton};
use egui_kittest::kittest::Queryable as _;
use touchline::app::session::Mode;
use touchline::app::{Action, EditAction};
use touchline::document::{FrameStatus, RejectReason, Target};
use touchline::geometry::ImagePoint;

pub const TESTS: &[Test] = tests![
    [Adapter] rejecting_keeps_its_reason;
    [Adapter] the_next_point_is_nudged;
    [Adapter] a_click_its_name_and_the_next_frame_are_read_in_order;
    [Adapter] what_is_typed_after_a_dialog_opens_is_typed_into_it;
    [Adapter] a_key_that_was_tapped_holds_nothing;
    [Adapter] a_code_typed_after_a_point_has_named_itself_is_its_name_and_no_command;
    [Adapter] what_a_number_field_refuses_stays_in_it_with_the_reason_and_enter_never_leaves_the_frame;
];

fn key(key: Key, pressed: bool, modifiers: Modifiers) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers,
    }
}

/// A key pressed and let go, with the text that it types.
fn stroke(pressed: Key, typed: &str) -> Vec<Event> {
    let mut events = vec![key(pressed, true, Modifiers::NONE)];
    events.extend((!typed.is_empty()).then(|| Event::Text(typed.to_owned())));
    events.push(key(pressed, false, Modifiers::NONE));
    events
}

fn click(window: &Window, at: ImagePoint) -> Vec<Event> {
    let pos = window.on_screen(at);
    let button = |pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    vec![Event::PointerMoved(pos), button(true), button(false)]
}

/// Everything arrives at once; then the window runs until all of it is read.
fn all_at_once(window: &mut Window, events: &[Vec<Event>]) {
    let events = events.concat();
    let steps = events.len() + 2;
    window.harness.input_mut().events.extend(events);
    window.harness.run_steps(steps);
}

fn rejecting_keeps_its_reason() {
    let mut window = Window::open(2, [960.0, 600.0], 1.0);
    all_at_once(&mut window, &[stroke(Key::X, "x"), stroke(Key::Num2, "2")]);
    let frame = window.app().open().unwrap().frame(0).unwrap();
    assert_eq!(
        (frame.status, frame.reason),
        (FrameStatus::Rejected, Some(RejectReason::Replay))
    );
    assert_eq!(window.app().session.frame, 1);
}

fn the_next_point_is_nudged() {
    let mut window = Window::open(1, [960.0, 600.0], 1.0);
    window.click(ImagePoint::new(200.0, 150.0));
    window.key(Key::Enter);
    window.key(Key::Escape);
    window.click(ImagePoint::new(400.0, 250.0));
    window.key(Key::Enter);
    window.key(Key::Escape);
    assert_eq!(window.app().session.points.selected, None);
    let before: Vec<_> = window
        .app()
        .frame()
        .unwrap()
        .clicks
        .iter()
        .map(|click| click.image.x)
        .collect();
    all_at_once(
        &mut window,
        &[stroke(Key::Tab, ""), stroke(Key::ArrowRight, "")],
    );
    let selected = window.app().session.points.selected.unwrap();
    let moved = window.app().frame().unwrap().clicks[selected].image.x - before[selected];
    assert!((moved - 0.1).abs() < 1e-9, "{moved}");
}

fn a_click_its_name_and_the_next_frame_are_read_in_order() {
    let mut window = Window::open(2, [960.0, 600.0], 1.0);
    let letters: Vec<Vec<Event>> = [(Key::P, "p"), (Key::M, "m"), (Key::L, "l")]
        .map(|(key, text)| stroke(key, text))
        .into();
    let mut events = vec![click(&window, window.image_of("penalty_mark_left"))];
    events.extend(letters);
    events.extend([stroke(Key::Enter, ""), stroke(Key::Period, ".")]);
    all_at_once(&mut window, &events);
    assert_eq!(
        (window.app().session.frame, &window.app().session.mode),
        (1, &Mode::Idle)
    );
    let clicks = &window.app().open().unwrap().frame(0).unwrap().clicks;
    assert_eq!(clicks.len(), 1);
    assert_eq!(
        clicks[0].target,
        Some(Target::Landmark("penalty_mark_left".into()))
    );
}

fn what_is_typed_after_a_dialog_opens_is_typed_into_it() {
    let mut window = Window::open(2, [960.0, 600.0], 1.0);
    let palette = vec![
        key(Key::K, true, Modifiers::COMMAND),
        key(Key::K, false, Modifiers::COMMAND),
    ];
    // Text without keys, as an input method writes it.
    let text = vec![Event::Text("next frame".to_owned())];
    all_at_once(
        &mut window,
        &[palette.clone(), text, stroke(Key::Enter, "")],
    );
    assert_eq!(
        (&window.app().session.dialog, window.app().session.frame),
        (&None, 1)
    );
    // Closed again, the keys are the window's.
    all_at_once(
        &mut window,
        &[palette, stroke(Key::Escape, ""), stroke(Key::Comma, ",")],
    );
    assert_eq!(
        (&window.app().session.dialog, window.app().session.frame),
        (&None, 0)
    );
}

fn a_key_that_was_tapped_holds_nothing() {
    let mut window = Window::open(1, [960.0, 600.0], 1.0);
    all_at_once(&mut window, &[stroke(Key::H, "h")]);
    assert!(!window.app().session.picture.held.hide_overlay);
}

/// A frame with two points, so that the third names itself.
fn two_points_named() -> Window {
    let mut window = Window::open(2, [1280.0, 720.0], 1.0);
    for landmark in ["penalty_area_far_left_front", "centre_circle_halfway_near"] {
        let pick = Action::Edit(EditAction::Pick(Target::Landmark(landmark.into())));
        window.apply(pick);
        window.click(window.image_of(landmark));
    }
    assert!(window.app().current().click_solution().is_some());
    window
}

fn clicked_names(window: &Window) -> Vec<String> {
    let clicks = &window.app().open().unwrap().frame(0).unwrap().clicks;
    clicks
        .iter()
        .map(|click| {
            click
                .target
                .as_ref()
                .map_or_else(String::new, |name| name.as_str().to_owned())
        })
        .collect()
}

fn a_code_typed_after_a_point_has_named_itself_is_its_name_and_no_command() {
    // Each of these letters is a command otherwise: check point, compare, next, reference; delete
    // is none.
    let codes = [
        ("pml", "penalty_mark_left"),
        ("gnlf", "goal_area_near_left_front"),
        ("chn", "penalty_mark_left"),
    ];
    for (code, expected) in codes {
        let mut window = two_points_named();
        let mut events = vec![click(&window, window.image_of("penalty_mark_left"))];
        for letter in code.chars() {
            let key = Key::from_name(&letter.to_uppercase().to_string()).unwrap();
            events.push(stroke(key, &letter.to_string()));
        }
        events.push(stroke(Key::Enter, ""));
        all_at_once(&mut window, &events);
        assert_eq!(
            (window.app().session.frame, &window.app().session.mode),
            (0, &Mode::Idle),
            "{code}"
        );
        assert_eq!(
            window.app().open().unwrap().frame(0).unwrap().status,
            FrameStatus::Draft,
            "{code}"
        );
        if code == "chn" {
            // The second point has that name: the two have swapped, and the list has said so
            // before.
            assert_eq!(
                clicked_names(&window)[1..],
                ["penalty_mark_left", "centre_circle_halfway_near"]
            );
        } else {
            assert_eq!(clicked_names(&window)[2], expected);
        }
    }
    // Where the pointer has left the point letters are commands again.
    let mut window = two_points_named();
    let placed = window.image_of("penalty_mark_left");
    window.click(placed);
    let elsewhere = window.on_screen(ImagePoint::new(placed.x + 120.0, placed.y));
    window.harness.event(Event::PointerMoved(elsewhere));
    window.harness.run_steps(2);
    window.key(Key::K);
    assert!(
        window.app().frame().unwrap().clicks[2].check,
        "K makes it a check point"
    );
}

fn what_a_number_field_refuses_stays_in_it_with_the_reason_and_enter_never_leaves_the_frame() {
    let mut window = two_points_named();
    window.harness.run_steps(4);
    let before = window.app().current().camera.unwrap().ptz();
    for (typed, told) in [
        ("-5", "-5° is out of range: 0.5 to 150°; lenses show"),
        ("abc", "“abc” is not a number."),
    ] {
        window
            .harness
            .get_by_role_and_label(egui::Role::SpinButton, "Field of view")
            .click();
        window.harness.run_steps(3);
        window.harness.event(Event::Text(typed.to_owned()));
        window.harness.run_steps(2);
        window.key(Key::Enter);
        assert!(
            window.harness.query_by_label_contains(told).is_some(),
            "{told}"
        );
        // Again and again: it is the field's.
        window.key(Key::Enter);
        window.key(Key::Enter);
        assert_eq!(
            (
                window.app().session.frame,
                window.app().current().camera.unwrap().ptz()
            ),
            (0, before),
            "{typed}"
        );
        window.key(Key::Escape);
        window.harness.run_steps(3);
    }
    assert_eq!(
        window.app().open().unwrap().frame(0).unwrap().status,
        FrameStatus::Draft
    );
}
