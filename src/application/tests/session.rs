//! A whole session without a window: open a folder of frames, take a camera over, label, save,
//! export, reopen.

use crate::headless::Headless;
use touchline_application::app::{Action, Command, EditAction, PointerAction, Question};
use touchline_application::jobs::PictureState;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::testing::{TestBase, base_at, soccer};
use touchline_documents::document::{Camera, FrameStatus, Target};
use touchline_documents::exchange::Format;
use touchline_documents::testing::{load, save, soccer_document};

const SIZE: ImageSize = ImageSize::new(640, 360);

fn truth() -> PtzCamera {
    base_at([1.0, -62.0, 17.0], SIZE).aim(2.0, -13.0, 760.0)
}

/// Clicks a landmark where the truth has it.
fn click(headless: &mut Headless, landmark: &str) {
    let field = soccer();
    let landmark = field.landmark(landmark).unwrap();
    let at = truth()
        .image_from_world(field.landmark_in_world(landmark))
        .unwrap();
    headless.act(Action::Pointer(PointerAction::Press { at, on: None }));
    headless.act(Action::Pointer(PointerAction::Release));
    let click = headless.app.frame().unwrap().clicks.len() - 1;
    headless.act(Action::Edit(EditAction::Name {
        click,
        target: Target::Landmark(landmark.id.clone()),
    }));
}

#[test]
fn a_folder_is_opened_labelled_saved_exported_and_reopened() {
    let root = tempfile::tempdir().unwrap();
    let frames = root.path().join("frames");
    std::fs::create_dir(&frames).unwrap();
    for name in ["1.png", "2.png", "10.png"] {
        image::RgbImage::new(SIZE.width, SIZE.height)
            .save(frames.join(name))
            .unwrap();
    }
    let mut other = soccer_document();
    let mut camera = Camera::new("gantry".into(), SIZE);
    camera.set_base(truth().base());
    other.cameras.push(camera.into());
    let camera_file = root.path().join("camera.json");
    save(&camera_file, &other);

    let mut headless = Headless::open(&frames);
    let PictureState::Ready(_, picture) = headless.wait_for_picture() else {
        panic!("no picture")
    };
    assert_eq!(
        picture.size(),
        SIZE,
        "an application without a window has pictures"
    );
    headless.answer(Question::CameraFrom, &camera_file);
    headless.wait_until("taking the camera over", |app| app.current().base.is_some());

    click(&mut headless, "centre_mark");
    click(&mut headless, "halfway_far");
    let at = headless.app.frame().unwrap().clicks[1].image;
    headless.act(Action::Pointer(PointerAction::Press { at, on: Some(1) }));
    headless.act(Action::Pointer(PointerAction::Drag(ImagePoint::new(
        at.x + 9.0,
        at.y,
    ))));
    headless.act(Action::Pointer(PointerAction::Release));
    headless.act(Action::Command(Command::Undo));
    let ptz = headless.app.frame().unwrap().ptz.as_ref().unwrap().ptz();
    assert!((ptz.focal_px - 760.0).abs() < 1e-6, "{ptz:?}");
    headless.act(Action::Command(Command::Accept));
    headless.wait_until_saved();
    let labelled = headless.app.open().unwrap().document.clone();

    let dataset = root.path().join("out").join("dataset.json");
    std::fs::create_dir(root.path().join("out")).unwrap();
    headless.answer(Question::ExportAs(Format::Json), &dataset);
    headless.wait_until("exporting", |app| {
        app.session
            .messages
            .notices
            .iter()
            .any(|n| n.text.starts_with("1 frame written as json"))
    });
    let exported = load(&dataset);
    assert_eq!(exported.frames[0].name(), "../frames/1.png");
    assert_eq!(exported.frames[0].ptz, labelled.frames[0].ptz);

    assert!(headless.runner.close().is_empty());
    let mut again = Headless::new();
    again.act(Action::Open(frames));
    again.wait_until("reopening", |app| app.open().is_some());
    let reopened = again.app.open().unwrap();
    assert!(reopened.read_only.is_none());
    assert_eq!(reopened.document.frames, labelled.frames);
    assert_eq!(reopened.document.cameras, labelled.cameras);
    assert_eq!(reopened.frame(0).unwrap().status, FrameStatus::Reference);
    assert_eq!(again.app.session.frame, 1, "work goes on where it is left");
}

#[test]
fn what_cannot_be_opened_leaves_everything_as_it_is() {
    let root = tempfile::tempdir().unwrap();
    let mut headless = Headless::new();
    headless.act(Action::Open(root.path().join("nothing")));
    headless.wait_until("the message", |app| {
        !app.session.messages.notices.is_empty()
    });
    assert!(headless.app.open().is_none() && headless.app.session.disk.opening.is_none());
    assert!(
        headless.app.session.messages.notices[0]
            .text
            .contains("there is no such file or folder")
    );
}
