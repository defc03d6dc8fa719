//! The timeline of a video: going to a frame by the pointer and by its number, moving a cut,
//! playing.
#![cfg(feature = "opencv")]

use super::harness::{SIZE, Window};
use crate::parts::{Test, tests};
use egui::{Event, Key, Modifiers, Pos2, pos2};
use egui_kittest::kittest::Queryable as _;
use std::path::Path;
use std::process::Command;
use touchline::document::{ShotKind, VideoShots};
use touchline_documents::testing::{WithFrames, a_match, new_video_frame, save};

pub const TESTS: &[Test] = tests![
    [Adapter, Ffmpeg] a_click_or_a_drag_on_the_timeline_shows_that_frame;
    [Adapter, Ffmpeg] a_drag_with_shift_selects_frames_and_a_click_lets_go_of_them;
    [Adapter, Ffmpeg] the_handle_of_a_cut_moves_it_in_one_step_of_undo;
    [Adapter, Ffmpeg] a_frame_is_gone_to_by_its_number_or_its_time;
    [Adapter, Ffmpeg] a_video_plays_and_stands_where_it_is_paused;
];

/// The video's name, its frames, and the first one of its second shot.
const VIDEO: &str = "match.mp4";
const FRAMES: u64 = 60;
const CUT: u64 = 40;
/// The height of the handles of cuts, points from the line's upper edge.
const HANDLE: f32 = 3.0;

/// A project of all frames of a video of two shots.
fn write_project(folder: &Path) {
    let size = format!("{}x{}", SIZE.width, SIZE.height);
    let input = format!("testsrc2=size={size}:rate=25:duration=2.4");
    let made = Command::new("ffmpeg")
        .args([
            "-v", "error", "-f", "lavfi", "-i", &input, "-c:v", "libx264", "-g", "25", VIDEO,
        ])
        .current_dir(folder)
        .status();
    assert!(made.unwrap().success());

    let frames = (0..FRAMES).map(|index| new_video_frame(VIDEO, index, SIZE));
    let mut document = a_match(SIZE).with_frames(frames);
    VideoShots::from_cuts(&document, VIDEO, FRAMES - 1, &[(CUT, ShotKind::Cut)])
        .write(&mut document);
    save(folder.join("project.json"), &document);
}

fn open() -> Window {
    let folder = tempfile::tempdir().unwrap();
    write_project(folder.path());
    Window::on(folder, [1280.0, 720.0], 1.0)
}

/// The middle of a frame's place on the line, so far below its upper edge.
fn on_line(window: &Window, frame: u64, below: f32) -> Pos2 {
    let line = window.harness.get_by_label("Timeline").rect();
    let share = (frame as f32 + 0.5) / FRAMES as f32;
    pos2(line.left() + share * line.width(), line.top() + below)
}

/// The edge between a frame and the one before it, at the height of the handles.
fn handle(window: &Window, frame: u64) -> Pos2 {
    let line = window.harness.get_by_label("Timeline").rect();
    pos2(
        line.left() + frame as f32 / FRAMES as f32 * line.width(),
        line.top() + HANDLE,
    )
}

fn shown_frame(window: &Window) -> usize {
    window.app().session.frame
}

/// The first frames of the shots.
fn starts(window: &Window) -> Vec<u64> {
    let document = &window.app().open().unwrap().document;
    VideoShots::from_document(document, VIDEO)
        .map(|shots| shots.starts().map(|(from, _)| from).collect())
        .unwrap_or_default()
}

fn a_click_or_a_drag_on_the_timeline_shows_that_frame() {
    let mut window = open();
    let at = on_line(&window, 30, 20.0);
    window.press(at);
    window.release(at);
    assert_eq!(shown_frame(&window), 30);
    window.press(on_line(&window, 10, 20.0));
    assert_eq!(shown_frame(&window), 10);
    let to = on_line(&window, 55, 20.0);
    window.drag(to);
    assert_eq!(
        shown_frame(&window),
        55,
        "the frame under the pointer is shown while it is dragged"
    );
    window.release(to);
    assert_eq!(shown_frame(&window), 55);
    assert_eq!(starts(&window), [0, CUT], "nothing was cut");
}

fn a_drag_with_shift_selects_frames_and_a_click_lets_go_of_them() {
    let mut window = open();
    let at = on_line(&window, 10, 20.0);
    window.press(at);
    window.release(at);
    let selected = |window: &Window| -> Vec<usize> {
        let frames = &window.app().session.frames_selected;
        frames.iter().copied().collect()
    };
    window
        .harness
        .event(Event::ModifiersChanged(Modifiers::SHIFT));
    window.press(on_line(&window, 20, 20.0));
    assert_eq!(selected(&window), (10..=20).collect::<Vec<_>>());
    let to = on_line(&window, 15, 20.0);
    window.drag(to);
    window.release(to);
    window
        .harness
        .event(Event::ModifiersChanged(Modifiers::NONE));
    window.harness.run_steps(2);
    assert_eq!(selected(&window), (10..=15).collect::<Vec<_>>());
    assert_eq!(shown_frame(&window), 10, "the shown frame stays");
    window
        .harness
        .get_by_label_contains("6 frames selected, 10 to 15.");
    // No frame has a camera: the sheet says so, and Enter changes nothing.
    window.key(Key::Enter);
    window
        .harness
        .get_by_label("0 on the paint, 6 left: 6 without a camera (frames 10–15).");
    window.key(Key::Escape);
    assert_eq!(selected(&window).len(), 6);
    let elsewhere = on_line(&window, 40, 20.0);
    window.press(elsewhere);
    window.release(elsewhere);
    assert_eq!((selected(&window), shown_frame(&window)), (Vec::new(), 40));
}

fn the_handle_of_a_cut_moves_it_in_one_step_of_undo() {
    let mut window = open();
    let (from, to) = (handle(&window, CUT), on_line(&window, 20, HANDLE));
    window.press(from);
    for step in 1..=4 {
        window.drag(from + (to - from) * (step as f32 / 4.0));
    }
    assert_eq!(
        (starts(&window), shown_frame(&window)),
        (vec![0, CUT], 0),
        "it is moved when it is let go"
    );
    window.release(to);
    assert_eq!((starts(&window), shown_frame(&window)), (vec![0, 20], 0));
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.harness.run_steps(2);
    assert_eq!(starts(&window), [0, CUT]);
}

fn a_frame_is_gone_to_by_its_number_or_its_time() {
    let mut window = open();
    for (typed, frame) in [("20", 20), ("0:01.0", 25)] {
        window
            .harness
            .key_press_modifiers(Modifiers::COMMAND, Key::G);
        window.harness.run_steps(3);
        window.type_text(typed);
        window.key(Key::Enter);
        assert_eq!(shown_frame(&window), frame, "{typed}");
    }
    window.key(Key::Home);
    assert_eq!(shown_frame(&window), 0);
    window.key(Key::End);
    assert_eq!(shown_frame(&window) as u64, FRAMES - 1);
    // What is no place is said at the field, and nothing else happens.
    window
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::G);
    window.harness.run_steps(3);
    window.type_text("soon");
    window.key(Key::Enter);
    assert_eq!(shown_frame(&window) as u64, FRAMES - 1);
    window.harness.get_by_label("Frame or time");
}

fn a_video_plays_and_stands_where_it_is_paused() {
    let mut window = open();
    window.press_label("Play");
    window.wait_for(|shell| shell.app().session.frame >= 3);
    window.press_label("Pause");
    window.harness.run_steps(2);
    let stands = shown_frame(&window);
    window.harness.get_by_label("Play");
    std::thread::sleep(std::time::Duration::from_millis(150));
    window.harness.run_steps(4);
    assert_eq!(shown_frame(&window), stands);
}
