//! The picture: zooming, dragging, masks, what is drawn when.

use super::harness::{SIZE, Window};
use crate::parts::{Test, tests};
use egui::{CursorIcon, Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, TouchPhase, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use touchline::app::session::{Mode, PictureView};
use touchline::document::{FrameStatus, Target};
use touchline::geometry::ImagePoint;
use touchline::ui::Shell;

pub const TESTS: &[Test] = tests![
    [Adapter] a_click_lands_on_the_same_pixel_at_any_density;
    [Adapter] the_wheel_zooms_to_the_pointer_and_the_view_stays_on_the_next_frame;
    [Adapter] the_overlay_follows_a_dragged_point_in_the_same_frame_of_the_window;
    [Adapter] a_drawn_ring_is_dragged_to_where_the_picture_shows_it;
    [Adapter] masks_are_drawn_and_deleted_on_the_picture;
    [Adapter] a_frame_is_rejected_with_its_reason;
    [Adapter] nothing_can_be_clicked_where_the_picture_is_missing;
    [] without_a_graphics_adapter_the_window_still_runs;
];

fn wheel(window: &mut Window, lines: f32) {
    window.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, lines),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    window.harness.run_steps(2);
}

fn a_click_lands_on_the_same_pixel_at_any_density() {
    for pixels_per_point in [1.0, 1.25, 2.0] {
        let mut window = Window::open(1, [960.0, 600.0], pixels_per_point);
        let at = ImagePoint::new(212.25, 141.5);
        window.click(at);
        let placed = window.app().frame().unwrap().clicks[0].image;
        assert!(
            placed.distance_px(at) < 1.0,
            "{placed:?} at {pixels_per_point}"
        );
    }
}

fn the_wheel_zooms_to_the_pointer_and_the_view_stays_on_the_next_frame() {
    let mut window = Window::open(2, [960.0, 600.0], 1.0);
    let held = ImagePoint::new(400.0, 120.0);
    let at = window.on_screen(held);
    window.drag(at);
    for _ in 0..8 {
        wheel(&mut window, 1.0);
    }
    assert!(
        window.on_screen(held).distance(at) < 4.0,
        "{:?}",
        window.on_screen(held)
    );
    let PictureView::Zoomed { scale, .. } = window.app().session.picture.view else {
        panic!("enlarged")
    };
    assert!(scale > 3.0, "{scale}");
    let view = window.app().session.picture.view;
    window.key(Key::Period);
    assert_eq!(
        (
            window.app().session.frame,
            window.app().session.picture.view
        ),
        (1, view)
    );
    window.key(Key::F);
    assert_eq!(window.app().session.picture.view, PictureView::Fit);
}

fn the_overlay_follows_a_dragged_point_in_the_same_frame_of_the_window() {
    let mut window = Window::open(1, [960.0, 600.0], 1.0);
    window.click(window.image_of("penalty_mark_left"));
    window.type_text("pml");
    window.key(Key::Enter);
    let at = window.on_screen(window.app().frame().unwrap().clicks[0].image);
    assert!(window.harness.query_by_label("Loupe").is_none());

    // Pressing selects and moves nothing; the point keeps its distance from the pointer.
    window.press(at + vec2(3.0, 2.0));
    assert!(matches!(
        window.app().session.mode,
        Mode::Dragging {
            click: 0,
            placed: false
        }
    ));
    let before = window.app().frame().unwrap().clicks[0].image;
    window.drag(at + vec2(63.0, 42.0));
    let moved = window.app().frame().unwrap().clicks[0].image;
    assert!(
        window.on_screen(moved).distance(at + vec2(60.0, 40.0)) < 0.1,
        "{before:?} {moved:?}"
    );
    let picture = window.harness.render().unwrap();
    let arm = at + vec2(60.0 + 7.0, 40.0);
    let brightest = (-1..=1)
        .map(|dy| {
            picture
                .get_pixel(arm.x as u32, (arm.y as i32 + dy) as u32)
                .0[0]
        })
        .max();
    assert!(
        brightest > Some(240),
        "the marker is where the point is: {brightest:?}"
    );
    window.harness.get_by_label("Loupe");
    window.snapshot("loupe", moved, [420.0, 420.0]);

    // Escape while the button is down: as if nothing had been.
    window.key(Key::Escape);
    window.release(at);
    assert_eq!(window.app().frame().unwrap().clicks[0].image, before);
    assert!(window.harness.query_by_label("Loupe").is_none());
}

fn a_drawn_ring_is_dragged_to_where_the_picture_shows_it() {
    let mut window = Window::open_suggested(&[Some(0.9)], [960.0, 600.0]);
    let before = window.app().frame().unwrap().ptz.clone();
    let ring = window.image_of("penalty_mark_left");
    let at = window.on_screen(ring) + vec2(3.0, -2.0);
    window.drag(at);
    window.harness.step();
    assert_eq!(
        window.harness.output().platform_output.cursor_icon,
        CursorIcon::Grab
    );
    window.press(at);
    window.drag(at + vec2(30.0, 0.0));
    let frame = window.app().frame().unwrap();
    let target = Target::Landmark("penalty_mark_left".into());
    assert_eq!(frame.clicks[0].target, Some(target));
    assert_ne!(frame.ptz, before, "the camera follows");
    let now = window.app().current().camera.unwrap();
    let field = touchline_core::testing::soccer();
    let mark = field.landmark_in_world(field.landmark("penalty_mark_left").unwrap());
    let drawn = now.image_from_world(mark).unwrap();
    assert!(
        window.on_screen(drawn).distance(at + vec2(27.0, 2.0)) < 1.5,
        "it keeps its distance from the pointer"
    );

    // Escape while the button is down.
    window.key(Key::Escape);
    window.release(at);
    let frame = window.app().frame().unwrap();
    assert_eq!((frame.clicks.len(), &frame.ptz), (0, &before));

    // A drag that ends is one step of undo.
    window.press(at);
    window.drag(at + vec2(-20.0, 8.0));
    window.release(at + vec2(-20.0, 8.0));
    assert_eq!(window.app().frame().unwrap().clicks.len(), 1);
    assert_eq!(window.app().session.mode, Mode::Idle);
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.harness.run_steps(2);
    let frame = window.app().frame().unwrap();
    assert_eq!((frame.clicks.len(), &frame.ptz), (0, &before));
}

fn masks_are_drawn_and_deleted_on_the_picture() {
    let mut window = Window::open(1, [960.0, 600.0], 1.0);
    window.key(Key::M);
    let corners = [ImagePoint::new(100.0, 80.0), ImagePoint::new(260.0, 150.0)]
        .map(|corner| window.on_screen(corner));
    window.press(corners[0]);
    window.drag(corners[1]);
    window.release(corners[1]);
    let frame = window.app().frame().unwrap();
    assert!(frame.clicks.is_empty() && frame.masks.len() == 1);
    assert!(
        (frame.masks[0].width - 160.0).abs() < 1.5 && (frame.masks[0].height - 70.0).abs() < 1.5
    );
    window.press_label("Delete frame mask 1");
    window.harness.run_steps(2);
    assert!(window.app().frame().unwrap().masks.is_empty());
}

fn a_frame_is_rejected_with_its_reason() {
    let mut window = Window::open(2, [960.0, 600.0], 1.0);
    window.key(Key::X);
    window.harness.get_by_label_contains("Replay");
    window.type_text("2");
    window.harness.run_steps(1);
    assert_eq!(
        window.app().open().unwrap().frame(0).unwrap().status,
        FrameStatus::Rejected
    );
    assert_eq!(window.app().session.frame, 1);
}

fn nothing_can_be_clicked_where_the_picture_is_missing() {
    let window = Window::open(2, [960.0, 600.0], 1.0);
    std::fs::remove_file(window.folder.path().join("0001.png")).unwrap();
    let Window {
        harness, folder, ..
    } = window;
    drop(harness);
    let mut window = Window::on(folder, [960.0, 600.0], 1.0);
    window.key(Key::Period);
    window.harness.run_steps(4);
    assert_eq!(window.app().session.frame, 1);
    assert!(!window.harness.state().has_picture());
    window.click(SIZE.centre());
    assert!(window.app().frame().unwrap().clicks.is_empty());
}

fn without_a_graphics_adapter_the_window_still_runs() {
    let mut harness = Harness::builder()
        .with_size([960.0, 600.0])
        .build_eframe(|creation| Shell::new(creation, None, Vec::new()).unwrap());
    harness.run_steps(3);
    assert!(harness.state().app().open().is_none());
}
