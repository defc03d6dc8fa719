//! The tour on the demo match: each step is over when the person has done it.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::{Key, Rect, pos2};
use egui_kittest::kittest::Queryable as _;
use touchline::app::tour::TourStep;
use touchline::app::{Action, Command, EditAction};
use touchline::document::Target;

pub const TESTS: &[Test] = tests![
    [Adapter] the_tour_goes_on_when_its_step_is_done_and_can_be_left;
    [Adapter] without_a_frame_to_try_the_tour_says_what_to_do;
];

fn step(window: &Window) -> Option<TourStep> {
    window
        .app()
        .session
        .tour
        .as_ref()
        .map(touchline::app::tour::Tour::step)
}

/// Places a landmark by its name.
fn place(window: &mut Window, landmark: &str) {
    window
        .harness
        .state_mut()
        .apply([Action::Edit(EditAction::Pick(Target::Landmark(
            landmark.into(),
        )))]);
    window.click(window.image_of(landmark));
    window.harness.run_steps(2);
}

fn the_tour_goes_on_when_its_step_is_done_and_can_be_left() {
    let mut window = Window::open_in("demo", 4, [1280.0, 720.0]);
    let picture = window.harness.get_by_label("Picture").rect();
    // The demo offers it.
    window.press_label("Take the tour");
    window.harness.run_steps(3);
    assert_eq!(step(&window), Some(TourStep::FirstPoint));
    window.harness.get_by_label("Step 1 of 5: Place a point");
    window.snapshot_of(
        "tour",
        Rect::from_min_max(pos2(0.0, 24.0), pos2(1280.0, 90.0)),
    );
    assert!(
        window.harness.get_by_label("Picture").rect().top() > picture.top() + 30.0,
        "it lies over nothing"
    );

    // A point without a name is not enough.
    window.click(window.image_of("penalty_area_far_left_front"));
    assert_eq!(step(&window), Some(TourStep::FirstPoint));
    window.key(Key::Escape);
    place(&mut window, "penalty_area_far_left_front");
    assert_eq!(step(&window), Some(TourStep::SecondPoint));
    place(&mut window, "centre_circle_halfway_near");
    assert_eq!(step(&window), Some(TourStep::Refine));
    // Looking at other frames is no step of it.
    window.key(Key::Period);
    window.key(Key::Comma);
    assert_eq!(step(&window), Some(TourStep::Refine));
    let at = window.on_screen(window.image_of("centre_circle_halfway_near"));
    window.press(at);
    window.drag(at + egui::vec2(6.0, 0.0));
    assert_eq!(
        step(&window),
        Some(TourStep::Refine),
        "the point is still held"
    );
    window.release(at + egui::vec2(6.0, 0.0));
    assert_eq!(step(&window), Some(TourStep::Accept));
    window.apply(Action::Command(Command::Accept));
    assert_eq!(step(&window), Some(TourStep::Decide));
    window.key(Key::X);
    window.type_text("2");
    window.harness.run_steps(2);
    assert_eq!(step(&window), Some(TourStep::Finished));
    window.harness.get_by_label("That is the whole method");
    window.press_label("Close");
    window.harness.run_steps(3);
    assert_eq!(step(&window), None);

    // It can be begun again, and left.
    window.apply(Action::Command(Command::StartTour));
    window.harness.run_steps(2);
    assert_eq!(
        (step(&window), window.app().session.frame),
        (Some(TourStep::FirstPoint), 2)
    );
    window.press_label("Leave the tour");
    window.harness.run_steps(3);
    assert_eq!(step(&window), None);
}

fn without_a_frame_to_try_the_tour_says_what_to_do() {
    let mut window = Window::open_in("demo", 1, [1280.0, 720.0]);
    window.key(Key::X);
    window.type_text("1");
    window.apply(Action::Command(Command::StartTour));
    assert_eq!(step(&window), None);
    let notice = &window.app().session.messages.notices.last().unwrap().text;
    assert!(
        notice.contains("no frame left to try") && notice.contains("Delete "),
        "{notice}"
    );
}
