//! One frame labelled from beginning to end, as a person does it.

use super::harness::{Window, truth};
use crate::parts::{Test, tests};
use egui::Key;
use egui_kittest::kittest::Queryable as _;
use touchline::app::session::{Mode, Saving};
use touchline::document::{FrameStatus, Target};
use touchline::geometry::ImagePoint;

pub const TESTS: &[Test] = tests![
    [Adapter] two_clicks_a_third_that_names_itself_and_the_frame_is_a_reference;
    [Adapter] escape_takes_a_point_without_a_name_away;
    [Adapter] the_list_of_names_changes_to_lines_and_back;
    [Adapter] a_landmark_picked_on_the_field_map_is_placed_by_the_next_click;
    [Adapter] a_point_takes_its_name_from_the_field_map_too;
];

fn two_clicks_a_third_that_names_itself_and_the_frame_is_a_reference() {
    let mut window = Window::open(2, [1280.0, 720.0], 1.0);

    // The first point: nothing is known, so the list asks; its code is typed.
    window.click(window.image_of("penalty_area_far_left_front"));
    assert!(matches!(window.app().session.mode, Mode::Naming(_)));
    window.type_text("pflf");
    window
        .harness
        .get_by_label("1 Penalty area, far left, front corner");
    window.key(Key::Enter);
    assert_eq!(window.app().session.mode, Mode::Idle);
    assert!(window.app().current().camera.is_none());

    // The second: the highlighted name is tried out before it is taken.
    window.click(window.image_of("centre_circle_halfway_near"));
    window.type_text("chn");
    assert!(
        window.app().current().preview.is_some(),
        "the camera with this name is shown"
    );
    window.press_label("1 Centre circle meets halfway line, near");
    window.harness.run_steps(2);
    let camera = window.app().current().camera.unwrap();
    assert!(
        (camera.ptz().pan - truth(0).ptz().pan).degrees().abs() < 1e-3,
        "{:?}",
        camera.ptz()
    );

    // The third names itself, and says so.
    window.click(window.image_of("penalty_mark_left"));
    assert_eq!(window.app().session.mode, Mode::Idle);
    assert_eq!(window.app().session.points.named_automatically, Some(2));
    let clicks = &window.app().frame().unwrap().clicks;
    assert_eq!(
        clicks[2].target,
        Some(Target::Landmark("penalty_mark_left".into()))
    );
    assert!(
        clicks[2]
            .image
            .distance_px(window.image_of("penalty_mark_left"))
            < 1.0,
        "{:?}",
        clicks[2].image
    );

    // Enter, while letters would change the name, confirms it and nothing else.
    window.key(Key::Enter);
    assert_eq!(
        (
            window.app().session.frame,
            window.app().session.points.named_automatically
        ),
        (0, None)
    );

    // Accepted by a stroke for itself: the frame is a reference, the next one is shown, everything
    // is on disk.
    window.harness.run_steps(5);
    window.key(Key::Enter);
    assert_eq!(window.app().session.frame, 1);
    assert_eq!(
        window.app().open().unwrap().frame(0).unwrap().status,
        FrameStatus::Reference
    );
    window.wait_for(|shell| matches!(shell.app().session.disk.saving, Saving::Saved { .. }));
    let (_, document, _) = touchline::store::read(window.folder.path()).unwrap();
    assert_eq!(document.frames[0].clicks.len(), 3);
    assert_eq!(document.frames[0].status, FrameStatus::Reference);
}

fn escape_takes_a_point_without_a_name_away() {
    let mut window = Window::open(1, [960.0, 600.0], 1.0);
    window.click(window.image_of("penalty_mark_left"));
    assert_eq!(window.app().frame().unwrap().clicks.len(), 1);
    window.key(Key::Escape);
    assert_eq!(window.app().session.mode, Mode::Idle);
    assert!(window.app().frame().unwrap().clicks.is_empty());
}

fn the_list_of_names_changes_to_lines_and_back() {
    let mut window = Window::open(1, [960.0, 600.0], 1.0);
    window.click(window.image_of("penalty_mark_left"));
    window.key(Key::Tab);
    assert!(matches!(&window.app().session.mode, Mode::Naming(naming) if naming.lines));
    window.type_text("halfway");
    window.harness.get_by_label("1 Halfway line");
    window.snapshot(
        "list_of_names",
        window.image_of("penalty_mark_left"),
        [840.0, 240.0],
    );
    window.key(Key::Tab);
    window.type_text("qq");
    assert!(
        matches!(&window.app().session.mode, Mode::Naming(naming) if !naming.lines && naming.listed_candidates().is_empty())
    );
    for _ in 0..9 {
        window.key(Key::Backspace);
    }
    assert!(
        matches!(&window.app().session.mode, Mode::Naming(naming) if naming.listed_candidates().len() == 5)
    );
    window.key(Key::ArrowDown);
    window.type_text("3");
    assert_eq!(window.app().session.mode, Mode::Idle);
    assert!(window.app().frame().unwrap().clicks[0].target.is_some());
}

fn a_landmark_picked_on_the_field_map_is_placed_by_the_next_click() {
    let mut window = Window::open(1, [1280.0, 720.0], 1.0);
    let map = window.harness.get_by_label("Field map").rect();
    window.press(map.center());
    window.release(map.center());
    let centre_mark = Target::Landmark("centre_mark".into());
    assert_eq!(
        window.app().session.mode,
        Mode::Placing(centre_mark.clone())
    );
    window.click(window.image_of("centre_mark"));
    assert_eq!(window.app().session.mode, Mode::Idle);
    assert_eq!(
        window.app().frame().unwrap().clicks[0].target,
        Some(centre_mark)
    );

    // With the name in hand the lines follow the pointer before it is clicked.
    window.press(map.center() + egui::vec2(0.0, -0.4 * map.height()));
    window.release(map.center() + egui::vec2(0.0, -0.4 * map.height()));
    assert!(
        matches!(window.app().session.mode, Mode::Placing(_)),
        "{:?}",
        window.app().session.mode
    );
    let tried = |window: &mut Window, x: f64| {
        let at = window.on_screen(ImagePoint::new(x, 60.0));
        window.drag(at);
        window.app().current().preview.map(|camera| camera.ptz())
    };
    let cameras = [tried(&mut window, 400.0), tried(&mut window, 420.0)];
    assert!(
        cameras[0].is_some() && cameras[0] != cameras[1],
        "{cameras:?}"
    );
    window.key(Key::Escape);
    assert_eq!(window.app().session.mode, Mode::Idle);
}

fn a_point_takes_its_name_from_the_field_map_too() {
    let mut window = Window::open(1, [1280.0, 720.0], 1.0);
    window.click(window.image_of("centre_mark"));
    assert!(matches!(window.app().session.mode, Mode::Naming(_)));
    let map = window.harness.get_by_label("Field map").rect();
    window.press(map.center());
    window.snapshot_of("field_map", map);
    window.release(map.center());
    assert_eq!(window.app().session.mode, Mode::Idle);
    let clicks = &window.app().frame().unwrap().clicks;
    assert_eq!(
        clicks[0].target,
        Some(Target::Landmark("centre_mark".into()))
    );
}
