//! The quality page: opened by key, read by its nodes, left for a frame by a click.

use super::harness::Window;
use crate::parts::{Test, tests};
use egui::Key;
use egui_kittest::kittest::Queryable as _;
use touchline::app::{Action, Command};

pub const TESTS: &[Test] = tests![
    [Adapter] the_page_takes_the_window_and_a_click_on_a_point_leads_to_its_frame;
    [Adapter] the_time_is_enlarged_with_ctrl_and_the_wheel_and_moved_by_dragging;
    [Adapter] errors_landmarks_and_coverage_lead_to_the_frame_that_is_worst;
    [Adapter] without_a_camera_the_page_says_what_will_appear;
    [Adapter] curves_below_the_picture_lead_to_a_frame;
    [Adapter] the_shown_frames_point_of_a_curve_is_dragged_in_one_step;
];

const SIZE: [f32; 2] = [1280.0, 720.0];

fn the_page_takes_the_window_and_a_click_on_a_point_leads_to_its_frame() {
    let mut window = Window::open_suggested(&[Some(0.9); 9], SIZE);
    window.key(Key::F5);
    assert!(window.harness.query_by_label("Picture").is_none());
    let plots = window
        .harness
        .get_by_label("Pan, tilt and focal length over time: 9 suggestions")
        .rect();
    assert!(plots.width() > 1180.0, "{plots:?}");
    // The pan rises from frame to frame: the last point is at the top of the first plot, on the
    // right.
    let last = plots.right_top() + egui::vec2(-6.0, 8.0);
    window.harness.hover_at(last);
    window.harness.run_steps(2);
    window
        .harness
        .get_by_label_contains("0008.png, frame 8: pan -6.00°");
    window.press(last);
    window.release(last);
    assert_eq!(window.app().session.frame, 8);
    window.harness.get_by_label("Picture");
    window.key(Key::F5);
    window.key(Key::Escape);
    assert!(!window.app().session.quality.open);
}

fn the_time_is_enlarged_with_ctrl_and_the_wheel_and_moved_by_dragging() {
    let mut window = Window::open_suggested(&[Some(0.9); 9], SIZE);
    window.key(Key::F5);
    let middle = window
        .harness
        .get_by_label_contains("Pan, tilt and focal length over time")
        .rect()
        .center();
    window.harness.hover_at(middle);
    window.harness.event(egui::Event::Zoom(2.0));
    window.harness.run_steps(2);
    let [from, upto] = window.app().session.quality.span.unwrap();
    assert!(
        (upto - from - 4.0).abs() < 1e-6,
        "half of 1 to 9: {from} {upto}"
    );
    window.press(middle);
    window.drag(middle + egui::vec2(200.0, 0.0));
    window.release(middle + egui::vec2(200.0, 0.0));
    let [earlier, _] = window.app().session.quality.span.unwrap();
    assert!(earlier < from - 0.3, "{earlier} {from}");
    assert!(window.app().session.quality.open, "dragging is no click");
    window.press_label("All");
    window.harness.run_steps(2);
    assert_eq!(window.app().session.quality.span, None);
    window.press_label("Close the quality page");
    window.harness.run_steps(2);
    assert!(!window.app().session.quality.open);
}

fn errors_landmarks_and_coverage_lead_to_the_frame_that_is_worst() {
    let mut window = Window::open_referenced(6, SIZE);
    // One point of the fourth frame is 9 px off, which is 27 px at 1920 px width.
    window.key(Key::F5);
    window
        .harness
        .get_by_label_contains("Pan, tilt and focal length over time: 6 references");
    let histogram = window
        .harness
        .get_by_label_contains("Histogram. Points: ")
        .rect();
    window
        .harness
        .get_by_label("No check points. Press K to make a point a check point.");
    window
        .harness
        .get_by_label_contains("Map of pan and tilt. No reference sees the field near pan");
    let more = histogram.right_bottom() - egui::vec2(10.0, 20.0);
    window.press(more);
    window.release(more);
    assert_eq!(
        (
            window.app().session.frame,
            window.app().session.quality.open
        ),
        (3, false)
    );
    let worst = window.app().session.points.selected;
    assert!(worst.is_some());
    window.key(Key::F5);
    let click = &window.app().frame().unwrap().clicks[worst.unwrap()];
    let target = click.target.clone().unwrap();
    let clicks = window
        .app()
        .quality()
        .targets
        .iter()
        .find(|errors| errors.target == target)
        .unwrap()
        .clicks;
    let row = format!("{clicks} × {}: ", window.app().label(&target));
    window.harness.get_by_label_contains(&row).click();
    window.harness.run_steps(2);
    assert_eq!(
        (
            window.app().session.frame,
            window.app().session.points.selected
        ),
        (3, worst)
    );
}

fn without_a_camera_the_page_says_what_will_appear() {
    let mut window = Window::open(2, SIZE, 1.0);
    window.key(Key::F5);
    for text in [
        "Cameras are plotted here over time",
        "The errors of clicks appear here.",
        "Errors by landmark and line appear here",
        "No frame of this camera is accepted yet.",
    ] {
        window.harness.get_by_label_contains(text);
    }
}

fn curves_below_the_picture_lead_to_a_frame() {
    let mut window = Window::open_suggested(&[Some(0.9); 9], SIZE);
    let name = "Pan, tilt and focal length over time: 9 suggestions";
    assert!(window.harness.query_by_label(name).is_none());
    window.apply(Action::Command(Command::ShowCurves));
    window.harness.run_steps(3);
    let plots = window.harness.get_by_label(name).rect();
    let picture = window.harness.get_by_label("Picture").rect();
    assert!(plots.top() >= picture.bottom(), "{plots:?} {picture:?}");
    // The pan rises from frame to frame: the last point is at the top of the first plot, on the
    // right.
    let last = plots.right_top() + egui::vec2(-18.0, 10.0);
    window.press(last);
    window.release(last);
    assert_eq!(window.app().session.frame, 8);
    window.apply(Action::Command(Command::ShowCurves));
    window.harness.run_steps(3);
    assert!(window.harness.query_by_label(name).is_none());
}

fn the_shown_frames_point_of_a_curve_is_dragged_in_one_step() {
    let mut window = Window::open_suggested(&[Some(0.9); 9], SIZE);
    window.apply(Action::Command(Command::ShowCurves));
    window.harness.run_steps(3);
    let name = "Pan, tilt and focal length over time: 9 suggestions";
    let plots = window.harness.get_by_label(name).rect();
    // The scale leaves some room above the highest point.
    let last = plots.right_top() + egui::vec2(-18.0, 18.0);
    let looks = |window: &Window, frame: usize| {
        let document = &window.app().open().unwrap().document;
        document.frames[frame].ptz.as_ref().unwrap().ptz()
    };
    // Another frame is shown: dragging its point changes no camera.
    let before = looks(&window, 8);
    window.press(last);
    window.drag(last + egui::vec2(0.0, 12.0));
    window.release(last + egui::vec2(0.0, 12.0));
    assert_eq!(looks(&window, 8), before);

    window.press(last);
    window.release(last);
    assert_eq!(window.app().session.frame, 8);
    window.press(last);
    for by in [8.0, 12.0, 16.0] {
        window.drag(last + egui::vec2(0.0, by));
    }
    window.release(last + egui::vec2(0.0, 16.0));
    let after = looks(&window, 8);
    // Half of the plot's height, which has the pans of nine frames and some room.
    let turned = before.pan.degrees() - after.pan.degrees();
    let whole = before.pan.degrees() - looks(&window, 0).pan.degrees();
    assert!(
        (0.5..1.0).contains(&(turned / whole)),
        "{turned} of {whole}°"
    );
    assert_eq!((after.tilt, after.focal_px), (before.tilt, before.focal_px));
    let history = &window.app().open().unwrap().history;
    assert_eq!(history.num_done(), 1);
    window.apply(Action::Command(Command::Undo));
    assert_eq!(looks(&window, 8), before);

    // Escape gives the drag up while the button is down.
    window.press(last);
    window.drag(last + egui::vec2(0.0, 12.0));
    assert_ne!(looks(&window, 8), before);
    window.key(Key::Escape);
    window.drag(last + egui::vec2(0.0, 16.0));
    window.release(last + egui::vec2(0.0, 16.0));
    assert_eq!(looks(&window, 8), before);
}
