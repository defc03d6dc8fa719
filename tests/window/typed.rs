//! Keys and clicks that arrive within one frame of the window: each is applied before the next is read.

use crate::parts::{Test, tests};
use crate::window::Window;
use egui::{Event, Key, Modifiers, PointerButton};
use touchline::app::session::Mode;
use touchline::document::{FrameStatus, RejectReason, Target};
use touchline::geometry::ImagePoint;

pub const TESTS: &[Test] = tests![
    [Adapter] rejecting_keeps_its_reason;
    [Adapter] the_next_point_is_nudged;
    [Adapter] a_click_its_name_and_the_next_frame_are_read_in_order;
    [Adapter] what_is_typed_after_a_dialog_opens_is_typed_into_it;
    [Adapter] a_key_that_was_tapped_holds_nothing;
];

fn key(key: Key, pressed: bool, modifiers: Modifiers) -> Event {
    Event::Key { key, physical_key: None, pressed, repeat: false, modifiers }
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
    let button =
        |pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE };
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
    assert_eq!((frame.status, frame.reason), (FrameStatus::Rejected, Some(RejectReason::Replay)));
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
    assert_eq!(window.app().session.selected, None);
    let before: Vec<_> = window.app().frame().unwrap().clicks.iter().map(|click| click.image.x).collect();
    all_at_once(&mut window, &[stroke(Key::Tab, ""), stroke(Key::ArrowRight, "")]);
    let selected = window.app().session.selected.unwrap();
    let moved = window.app().frame().unwrap().clicks[selected].image.x - before[selected];
    assert!((moved - 0.1).abs() < 1e-9, "{moved}");
}

fn a_click_its_name_and_the_next_frame_are_read_in_order() {
    let mut window = Window::open(2, [960.0, 600.0], 1.0);
    let letters: Vec<Vec<Event>> =
        [(Key::P, "p"), (Key::M, "m"), (Key::L, "l")].map(|(key, text)| stroke(key, text)).into();
    let mut events = vec![click(&window, window.image_of("penalty_mark_left"))];
    events.extend(letters);
    events.extend([stroke(Key::Enter, ""), stroke(Key::Period, ".")]);
    all_at_once(&mut window, &events);
    assert_eq!((window.app().session.frame, &window.app().session.mode), (1, &Mode::Idle));
    let clicks = &window.app().open().unwrap().frame(0).unwrap().clicks;
    assert_eq!(clicks.len(), 1);
    assert_eq!(clicks[0].target, Some(Target::Landmark("penalty_mark_left".into())));
}

fn what_is_typed_after_a_dialog_opens_is_typed_into_it() {
    let mut window = Window::open(2, [960.0, 600.0], 1.0);
    let palette = vec![key(Key::K, true, Modifiers::COMMAND), key(Key::K, false, Modifiers::COMMAND)];
    // Text without keys, as an input method writes it.
    let text = vec![Event::Text("next frame".to_owned())];
    all_at_once(&mut window, &[palette.clone(), text, stroke(Key::Enter, "")]);
    assert_eq!((&window.app().session.dialog, window.app().session.frame), (&None, 1));
    // Closed again, the keys are the window's.
    all_at_once(&mut window, &[palette, stroke(Key::Escape, ""), stroke(Key::Comma, ",")]);
    assert_eq!((&window.app().session.dialog, window.app().session.frame), (&None, 0));
}

fn a_key_that_was_tapped_holds_nothing() {
    let mut window = Window::open(1, [960.0, 600.0], 1.0);
    all_at_once(&mut window, &[stroke(Key::H, "h")]);
    assert!(!window.app().session.held.hide_overlay);
}
