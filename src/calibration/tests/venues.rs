//! A stadium's cameras are kept in a venue file and known again in another match; those of another
//! stadium are not taken for them.
#![cfg(feature = "opencv")]

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Mutex, OnceLock};
use touchline_calibration::autocalibrate::Doubt;
use touchline_calibration::pipelines::{
    MatchEvent, MatchLabels, MatchOptions, RecognisedCamera, Venue, VenueError, VenueEvent,
    VenueRefusal, Whereabouts, label_match, make_venue,
};
use touchline_calibration::proposals::FeatureStore;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::rotation::from_rotation_vector;
use touchline_core::geometry::{ImageSize, Vec2, Vec3};
use touchline_core::markings::project_landmarks;
use touchline_core::progress::Progress;
use touchline_core::testing::{soccer, turned_base};
use touchline_documents::document::{Camera, Click, Document, FramePtz, FrameStatus};
use touchline_documents::testing::{new_video_frame, soccer_document};
use touchline_vision::media::{FrameRef, MediaError, Picture, ReadFrames};
use touchline_vision::synthetic::{FrameOptions, Moment, StadiumOptions, stadium};

const SIZE: ImageSize = ImageSize::new(960, 540);
const VIEWS: usize = 8;

fn base() -> CameraBase {
    let mut base = turned_base([-6.0, -62.0, 14.0], [3.0, 0.0, 0.0], SIZE);
    base.sigma.position_m = [0.05, 0.1, 0.05].into();
    base.sigma.rotation = [3e-4, 3e-4, 0.0].into();
    base
}

/// The views of a match, from left to right; those of another match lie between them.
fn views(shift_deg: f64) -> impl Iterator<Item = Ptz> {
    let view = move |view: usize| {
        let pan_deg = 8.0 * (view as f64 - 3.5) + shift_deg;
        Ptz::from_degrees(pan_deg, -10.5, 950.0 + 0.3 * shift_deg)
    };
    (0..VIEWS).map(view)
}

/// The pictures of a match.
struct Drawn(Vec<Picture>);

impl ReadFrames for Drawn {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        match frame {
            FrameRef::Video { index, .. } => Ok(self.0[*index].clone()),
            FrameRef::Image(path) => panic!("{} is no frame of a video", path.display()),
        }
    }
}

/// A match in the stadium with this seed: its first one, or one at another time, when other people
/// sit in half of the seats, all move, and half of the boards show something else.
fn draw(seed: u64, base: &CameraBase, shift_deg: f64) -> Drawn {
    let mut scene = stadium(&StadiumOptions::new(soccer(), seed));
    if shift_deg != 0.0 {
        scene = scene.at(&Moment {
            occasion: 7,
            people_changed: 0.5,
            boards_changed: 0.5,
            instant: 3,
            restlessness: 1.0,
        });
    }
    let picture = |(view, ptz): (usize, Ptz)| {
        let camera = PtzCamera::new(*base, ptz);
        let options = FrameOptions {
            time_s: 10.0 * view as f64 + shift_deg,
            ..FrameOptions::default()
        };
        let image = scene.render(&camera, SIZE, &options).image;
        let rgba = image::DynamicImage::from(image).into_rgba8().into_raw();
        Picture::new(SIZE, rgba).unwrap()
    };
    Drawn(views(shift_deg).enumerate().map(picture).collect())
}

/// The document of a match whose camera is not known.
fn new_match() -> Document {
    let mut document = soccer_document();
    document
        .cameras
        .push(Camera::new("main".into(), SIZE).into());
    for index in 0..VIEWS as u64 {
        let frame = new_video_frame("no-such-video.mp4", index, SIZE);
        document.frames.push(frame.into());
    }
    document
}

/// The venue file of the first stadium.
fn venue_file() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let mut document = new_match();
        let camera = document.camera_mut(&"main".into()).unwrap();
        camera.set_base(&base());
        for (index, ptz) in views(0.0).enumerate() {
            document.frames[index].ptz = Some(FramePtz::new(ptz, None));
            document.frames[index].status = FrameStatus::Reference;
        }
        let made = make_venue(
            document.at(Path::new("")),
            &mut draw(1, &base(), 0.0),
            &FeatureStore::in_memory(),
            &Progress::default(),
        );
        made.unwrap().unwrap().model.to_bytes()
    })
}

fn venue() -> Venue {
    Venue::from_bytes(Path::new("arena.venue"), venue_file()).unwrap()
}

/// The camera that is recognised in a match, or why it is not, and the match. A search is not
/// waited for.
fn recognise(pictures: Drawn) -> (Result<RecognisedCamera, VenueRefusal>, Document) {
    recognise_in(new_match(), pictures)
}

/// The same in the document of a match.
fn recognise_in(
    mut document: Document,
    mut pictures: Drawn,
) -> (Result<RecognisedCamera, VenueRefusal>, Document) {
    let options = MatchOptions {
        find_shots: false,
        label_the_rest: false,
        venues: vec![venue()],
        ..MatchOptions::default()
    };
    let verdict = Mutex::new(None);
    let progress = Progress::new(|event| {
        let said = match event {
            MatchEvent::Venue(VenueEvent::Recognised(recognised)) => Ok(recognised),
            MatchEvent::Venue(VenueEvent::Refused { why, .. }) => Err(why),
            MatchEvent::Searching(_) => return ControlFlow::Break(()),
            _ => return ControlFlow::Continue(()),
        };
        *verdict.lock().unwrap() = Some(said);
        ControlFlow::Continue(())
    });
    let labels = label_match(
        &mut document,
        Path::new(""),
        &"main".into(),
        &mut pictures,
        &options,
        &progress,
    );
    drop(progress);
    let verdict = verdict.into_inner().unwrap().unwrap();
    assert_eq!(
        matches!(labels, Ok(MatchLabels::Labelled(_))),
        verdict.is_ok()
    );
    (verdict, document)
}

fn base_of(document: &Document) -> CameraBase {
    document.cameras[0].base().unwrap()
}

#[test]
fn a_venue_comes_back_from_its_file_with_all_that_is_known_of_its_camera() {
    let venue = venue();
    assert_eq!(venue.name, "arena");
    let [camera] = &venue.document().cameras[..] else {
        panic!("{:?}", venue.document().cameras)
    };
    let (kept, exact) = (camera.base().unwrap(), base());
    assert!((kept.position_m - exact.position_m).norm() < 1e-12);
    assert!((kept.sigma.position_m - exact.sigma.position_m).norm() < 1e-12);
    assert!(venue.document().frames.is_empty());
    assert!(venue_file().len() < 5_000_000, "{}", venue_file().len());
}

#[test]
fn a_damaged_file_is_no_venue() {
    let path = Path::new("arena.venue");
    let file = venue_file();
    let mut altered = file.to_vec();
    altered[file.len() / 2] ^= 1;
    for bytes in [
        &[][..],
        b"{}",
        &file[..100],
        &file[..file.len() - 1],
        &altered,
    ] {
        let refused = Venue::from_bytes(path, bytes).unwrap_err();
        assert!(matches!(refused, VenueError::Forest { .. }), "{refused:?}");
        assert!(!refused.to_string().contains('\n'));
    }
    let missing = Venue::read(Path::new("no/such.venue")).unwrap_err();
    assert!(matches!(missing, VenueError::Io { .. }), "{missing:?}");
}

#[test]
fn a_project_without_certain_frames_gives_no_venue() {
    let made = make_venue(
        new_match().at(Path::new("")),
        &mut Drawn(Vec::new()),
        &FeatureStore::in_memory(),
        &Progress::default(),
    );
    assert!(matches!(made, Err(VenueError::NothingCertain)), "{made:?}");
}

#[test]
fn a_camera_that_stands_where_it_stood_keeps_its_base() {
    let (recognised, document) = recognise(draw(1, &base(), 3.0));
    let recognised = recognised.unwrap();
    assert_eq!(recognised.change.whereabouts, Whereabouts::Same);
    assert!(recognised.aligned >= 6, "{recognised:?}");
    assert!((base_of(&document).position_m - base().position_m).norm() < 1e-9);
    for (index, exact) in views(3.0).enumerate() {
        if let Some(ptz) = &document.frames[index].ptz {
            let off_deg = (ptz.ptz().pan.degrees() - exact.pan.degrees()).abs();
            assert!(off_deg < 0.05, "frame {index}: {off_deg}°");
        }
    }
}

#[test]
fn a_click_elsewhere_refuses_a_camera_that_fits() {
    let (field, shown) = (soccer(), views(3.0).nth(4).unwrap());
    let camera = PtzCamera::new(base(), shown);
    let landmarks = project_landmarks(&field, &camera, SIZE, 0.0);
    let landmark = landmarks
        .iter()
        .find(|seen| field.landmarks[seen.landmark].is_on_ground())
        .unwrap();
    let mut document = new_match();
    let at = landmark.image.translate(Vec2::new(0.0, 40.0));
    let id = field.landmarks[landmark.landmark].id.clone();
    document.frames[4].clicks = vec![Click::landmark(id, at)];
    let (refused, _) = recognise_in(document, draw(1, &base(), 3.0));
    assert!(
        matches!(
            refused,
            Err(VenueRefusal::Contradicted(Doubt::ClickContradicts { .. }))
        ),
        "{refused:?}"
    );
}

#[test]
fn a_camera_that_leans_or_was_moved_gets_the_base_that_its_frames_show() {
    let lean = from_rotation_vector(Vec3::new(0.0, 0.0, 0.3_f64.to_radians()));
    let turned = CameraBase {
        base_from_world: lean * base().base_from_world,
        ..base()
    };
    let moved = CameraBase {
        position_m: base().position_m + Vec3::new(1.0, -0.4, 0.5),
        ..base()
    };
    for (exact, whereabouts) in [(turned, Whereabouts::Turned), (moved, Whereabouts::Moved)] {
        let (recognised, document) = recognise(draw(1, &exact, 3.0));
        let change = recognised.unwrap().change;
        assert_eq!(change.whereabouts, whereabouts, "{change}");
        let now = base_of(&document);
        let off_m = (now.position_m - exact.position_m).norm();
        assert!(off_m < 0.5, "{off_m} m: {change}");
    }
}

#[test]
fn the_camera_of_another_stadium_is_another_one_though_it_stands_at_the_same_place() {
    let (refused, document) = recognise(draw(2, &base(), 3.0));
    assert!(
        matches!(refused, Err(VenueRefusal::NotRecognised { .. })),
        "{refused:?}"
    );
    assert!(document.cameras[0].base().is_none());
}
