//! The documents on which the commands are done: the demo match, with its pictures.

use std::ops::Range;
use std::path::{Path, PathBuf};
use touchline_application::testing::base;
use touchline_core::camera::{BaseAngles, FocalCurve, Ptz};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_documents::document::{
    Camera, Click, ClickOrigin, Document, FramePtz, FrameStatus, ShotKind, SolutionSource,
    VideoShots,
};
use touchline_documents::testing::{
    WithFrames, a_match, answered_by, load, new_video_frame, ptz_at,
};

fn demo_folder() -> PathBuf {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../projects/demo");
    std::fs::canonicalize(demo).unwrap()
}

/// A document of the demo match, with its pictures where they are.
fn read(name: &str) -> Document {
    let folder = demo_folder();
    let mut document = load(folder.join(name));
    for frame in &mut document.frames {
        let image = folder.join(frame.image.as_ref().unwrap());
        frame.image = Some(image.to_string_lossy().into_owned());
    }
    document
}

/// The frames of the demo match that commands are done on: four references, whose clicks give a
/// base, and six frames that nobody has looked at. Every window looks at every picture.
const FRAMES: Range<usize> = 9..19;

/// References with their clicks, and frames that nobody has looked at.
pub fn demo() -> Document {
    only(FRAMES, read("project.json"))
}

fn only(frames: Range<usize>, mut document: Document) -> Document {
    document.frames = document
        .frames
        .iter()
        .take(frames.end)
        .skip(frames.start)
        .cloned()
        .collect();
    document
}

/// The same before anything is accepted.
pub fn drafts() -> Document {
    let mut document = demo();
    for frame in &mut document.frames {
        if frame.status == FrameStatus::Reference {
            frame.status = FrameStatus::Draft;
        }
    }
    document
}

/// The same with the clicks as points of a model.
pub fn pointed() -> Document {
    let mut document = drafts();
    for frame in &mut document.frames {
        for click in &mut frame.clicks {
            click.origin = Some(Box::new(ClickOrigin::from_model("net")));
        }
    }
    document
}

/// Every frame has a camera, turned by some degrees, as a draft.
pub fn turned(turned_deg: f64) -> Document {
    with_cameras(
        FRAMES,
        turned_deg,
        FrameStatus::Draft,
        SolutionSource::Manual,
    )
}

/// The same with every frame of the demo match.
pub fn all_turned(turned_deg: f64) -> Document {
    with_cameras(
        0..usize::MAX,
        turned_deg,
        FrameStatus::Draft,
        SolutionSource::Manual,
    )
}

/// Every frame has a camera that is suggested.
pub fn suggested() -> Document {
    with_cameras(FRAMES, 0.0, FrameStatus::Suggested, SolutionSource::Forest)
}

/// Every frame has the camera of another program, a little off.
pub fn imported() -> Document {
    with_cameras(FRAMES, 0.2, FrameStatus::Suggested, SolutionSource::Import)
}

fn with_cameras(
    frames: Range<usize>,
    turned_deg: f64,
    status: FrameStatus,
    source: SolutionSource,
) -> Document {
    let mut document = only(frames.clone(), read("project.json"));
    let truth = only(frames, read("truth.json"));
    for (frame, truth) in document.frames.iter_mut().zip(&truth.frames) {
        let ptz = truth.ptz.as_ref().unwrap().ptz();
        let ptz = Ptz::from_degrees(
            ptz.pan.degrees() + turned_deg,
            ptz.tilt.degrees(),
            ptz.focal_px,
        );
        frame.clicks.clear();
        frame.status = status;
        frame.ptz = Some(FramePtz::new(ptz, None));
        frame.solution = answered_by(source, (source == SolutionSource::Forest).then_some(0.99));
    }
    document
}

/// Nothing is known of the camera, and nothing is clicked.
pub fn blank() -> Document {
    let mut document = demo();
    let camera = &mut document.cameras[0];
    (camera.position_m, camera.base_from_world) = (None, None);
    for frame in &mut document.frames {
        (frame.ptz, frame.solution, frame.status) = (None, None, FrameStatus::New);
        frame.clicks.clear();
    }
    document
}

/// The base stands a metre beside the truth.
pub fn displaced() -> Document {
    let mut document = demo();
    let mut base = document.cameras[0].base().unwrap();
    base.position_m += Vec3::new(1.0, 0.0, 0.5);
    document.cameras[0].set_base(&base);
    document
}

/// Two landmarks straight before the camera, in a picture cut from above its principal point: two
/// tilts and focal lengths fit.
pub fn two_roots() -> Document {
    let mut document = drafts();
    let mut base = document.cameras[0].base().unwrap();
    base.position_m.x = 0.0;
    base.base_from_world = BaseAngles::default().base_from_world();
    base.principal_point = ImagePoint::new(640.0, 1520.0);
    base.distortion = FocalCurve::NONE;
    document.cameras[0].set_base(&base);
    let frame = &mut document.frames[0];
    (frame.ptz, frame.solution) = (None, None);
    frame.clicks = [("centre_mark", 50.0), ("halfway_near", 680.0)]
        .map(|(id, y)| Click::landmark(id.into(), ImagePoint::new(640.0, y)))
        .into();
    document
}

/// The camera is known, and nothing is clicked.
pub fn unseen() -> Document {
    let mut document = demo();
    for frame in &mut document.frames {
        (frame.ptz, frame.solution, frame.status) = (None, None, FrameStatus::New);
        frame.clicks.clear();
    }
    document
}

/// Thirty frames of a video with three shots.
pub fn video() -> Document {
    let size = ImageSize::new(64, 36);
    let frames = (0..30).map(|index| new_video_frame("match.mp4", index, size));
    let mut document = a_match(size).with_frames(frames);
    let cuts = [(10, ShotKind::Cut), (20, ShotKind::Fade)];
    VideoShots::from_cuts(&document, "match.mp4", 29, &cuts).write(&mut document);
    document
}

/// The same before anything is known of it.
pub fn film() -> Document {
    let size = ImageSize::new(64, 36);
    let frames = (0..30).map(|index| new_video_frame("match.mp4", index, size));
    let mut document = a_match(size).with_frames(frames);
    (
        document.cameras[0].position_m,
        document.cameras[0].base_from_world,
    ) = (None, None);
    document
}

/// The same with a cut, and a camera on either side of it.
pub fn labelled_film() -> Document {
    let mut document = film();
    let cuts = [(15, ShotKind::Cut)];
    VideoShots::from_cuts(&document, "match.mp4", 29, &cuts).write(&mut document);
    document.cameras[0].set_base(&base());
    let mut other = Camera::clone(&document.cameras[0]);
    other.id = "main_2".into();
    document.cameras.push(other.into());
    for index in 0..30 {
        let frame = &mut document.frames[index];
        if index >= 15 {
            frame.camera = "main_2".into();
        }
        frame.ptz = ptz_at(0.5 * index as f64, -12.0, 80.0);
        frame.status = FrameStatus::Suggested;
        frame.solution = answered_by(SolutionSource::Tracking, Some(0.97));
    }
    document
}
