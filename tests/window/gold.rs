//! A blind round in the window: nothing of the label is to be seen, and a click is kept where it
//! was made.

use super::harness::{Window, seen_landmarks, truth};
use crate::parts::{Test, tests};
use egui_kittest::kittest::Queryable as _;
use touchline::app::{Action, Command};
use touchline::camera::Ptz;
use touchline::document::{Document, FramePtz, FrameStatus};
use touchline::geometry::ImagePoint;
use touchline_documents::testing::save;

pub const TESTS: &[Test] = tests![
    [Adapter] nothing_of_the_label_shows_in_a_blind_round;
    [Adapter] a_blind_click_is_kept_where_it_was_made;
];

/// Labels a project's frames; the label and its camera lie off by so much.
fn label(document: &mut Document, off_px: f64) {
    for (index, frame) in document.frames.iter_mut().enumerate() {
        frame.clicks = seen_landmarks(index);
        frame.clicks.truncate(3);
        for click in &mut frame.clicks {
            click.image = ImagePoint::new(click.image.x + off_px, click.image.y - off_px);
        }
        let ptz = truth(index).ptz();
        let shown = Ptz::from_degrees(
            ptz.pan.degrees() + 0.2 * off_px,
            ptz.tilt.degrees(),
            ptz.focal_px,
        );
        frame.ptz = Some(FramePtz::new(shown, None));
        frame.status = FrameStatus::Reference;
        frame.gold = true;
    }
}

/// A window in a blind round on frames whose labels lie off by so much.
fn round(off_px: f64) -> Window {
    let window = Window::open(2, [960.0, 600.0], 1.0);
    let (_, mut document, _) = touchline::store::read(window.folder.path()).unwrap();
    label(&mut document, off_px);
    let folder = tempfile::tempdir().unwrap();
    for index in 0..2 {
        let name = format!("{index:04}.png");
        std::fs::copy(window.folder.path().join(&name), folder.path().join(&name)).unwrap();
    }
    save(folder.path().join("project.json"), &document);
    drop(window);
    let mut window = Window::on(folder, [960.0, 600.0], 1.0);
    window.apply(Action::Command(Command::ClickAgain));
    window.wait_for(|shell| shell.has_picture() && shell.has_thumbnails());
    window.harness.run_steps(3);
    window
}

/// What the window shows below its menu and above its filmstrip, with the pointer at a point of the
/// picture.
fn pixels(window: &mut Window, at: ImagePoint) -> Vec<u8> {
    let at = window.on_screen(at);
    window.drag(at);
    window.harness.run_steps(2);
    let mut image = window.harness.render().unwrap();
    let height = window.harness.get_by_label("Picture").rect().height() as u32;
    image::imageops::crop(&mut image, 0, 24, 960, height)
        .to_image()
        .into_raw()
}

/// Whether two pictures of the window show the same. A glyph has another place in the texture of
/// glyphs when texts were first drawn in another order, which can round a pixel of its edge by a
/// level; what a label draws changes hundreds.
fn alike(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 2)
}

fn nothing_of_the_label_shows_in_a_blind_round() {
    let (mut near, mut far) = (round(0.0), round(20.0));
    let label = near.app().frame().unwrap().clicks[0].image;
    assert!(label.distance_px(far.app().frame().unwrap().clicks[0].image) > 25.0);
    for at in [label, ImagePoint::new(320.0, 180.0)] {
        assert!(
            alike(&pixels(&mut near, at), &pixels(&mut far, at)),
            "the label shows with the pointer at {at:?}"
        );
    }
    // Outside of a round the same windows differ.
    for window in [&mut near, &mut far] {
        window.apply(Action::Command(Command::Cancel));
        window.harness.run_steps(3);
    }
    assert!(!alike(&pixels(&mut near, label), &pixels(&mut far, label)));
}

fn a_blind_click_is_kept_where_it_was_made() {
    let mut window = round(20.0);
    let target = window.app().round().unwrap().target().cloned().unwrap();
    let at = window.image_of(target.landmark.as_str());
    let labels = window.app().frame().unwrap().clicks.clone();
    let place = window.on_screen(at);
    window.press(place);
    assert!(
        window.harness.query_by_label("Loupe").is_some(),
        "as exact as a label"
    );
    window.release(place);
    let frame = window.app().open().unwrap().frame(target.frame).unwrap();
    assert!(
        frame.repeats[0].image.distance_px(at) < 1.0
            && frame.repeats[0].landmark == target.landmark
    );
    assert_eq!(frame.clicks, labels);
    // One on the label's own click takes hold of nothing.
    let second = window.on_screen(labels[1].image);
    window.press(second);
    window.release(second);
    let frame = window.app().open().unwrap().frame(target.frame).unwrap();
    assert!(frame.repeats.len() == 2 && frame.clicks == labels);
}
