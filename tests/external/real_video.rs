//! A real match as a video: its frames in a project, and what is said of numbers and times that are
//! not right.
#![cfg(feature = "opencv")]

use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;
use touchline::app::{TrainerActivity, TrainerOrder, TrainerReport, TrainerStatus};
use touchline::calibrate::{Problem, check_pictures};
use touchline::camera::{CameraBase, FocalCurve};
use touchline::document::{Camera, Document, Frame, FrameStatus, SolutionSource};
use touchline::geometry::rotation::nearest_rotation;
use touchline::geometry::{ImagePoint, ImageSize, Mat3, Vec3};
use touchline::jobs::{SharedPictures, Trainer, TrainerOptions};
use touchline::progress::Progress;
use touchline::store::read;
use touchline_documents::testing::{ptz_at, save, soccer_document};

pub const TESTS: &[Test] = tests![
    [Frames] new_takes_the_frames_of_a_video_that_decode;
    [Frames] check_compares_frame_numbers_and_times_of_a_video;
    [Frames] the_trainer_carries_cameras_between_key_frames;
    [Frames] key_frames_are_answered_and_the_frames_between_carried_from_the_command_line;
];

fn new_takes_the_frames_of_a_video_that_decode() {
    let data = frames_folder();
    let folder = tempfile::tempdir().unwrap();
    let video = data.join("video-soccer/match.mp4").canonicalize().unwrap();
    let ran = touchline(
        folder.path(),
        &format!("new match --frames {} --field soccer", video.display()),
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    ran.assert_says("match.mp4 announces 825 frames; only 817 can be decoded.");
    let (location, document, _) = read(&folder.path().join("match")).unwrap();
    assert_eq!(document.frames.len(), 817);
    let last = document.frames[816].video.as_ref().unwrap();
    assert_eq!((last.frame_index, last.pts_s), (816, Some(32.64)));
    assert_eq!(
        last.file_path(location.folder()).canonicalize().unwrap(),
        video
    );
    assert_eq!(touchline(folder.path(), "check match").code, 0);
}

fn check_compares_frame_numbers_and_times_of_a_video() {
    let data = frames_folder();
    let mut document = soccer_document();
    let frame = |index, pts_s| {
        let video = touchline::document::VideoFrame::new("match.mp4", index, pts_s);
        Frame::from_video(video, "main".into(), ImageSize::new(1280, 720)).into()
    };
    let frames = [
        frame(10, Some(0.4)),
        frame(10, None),
        frame(816, None),
        frame(817, None),
        frame(10, Some(0.48)),
    ];
    document.frames = frames.into_iter().collect();
    let problems = check_pictures(
        document.at(&data.join("video-soccer")),
        &Progress::default(),
    );
    let said: Vec<_> = problems.iter().map(Problem::to_string).collect();
    let expected = [
        "frames[3] (match.mp4#817): the video has 817 frames, numbered from 0; there is no frame 817",
        "frames[4] (match.mp4#10): pts_s 0.48 is not the time of frame 10 of the video (0.4000); inspect the label",
    ];
    assert_eq!(said, expected);
}

/// The first frames of the match; their camera and two of its views as `touchline calibrate` finds
/// them.
fn two_references(frames: u64) -> Document {
    let size = ImageSize::new(1280, 720);
    let mut document = soccer_document();
    let mut main = Camera::new("main".into(), size);
    let rows = [
        [1.0, 0.0, 0.00142],
        [0.00142, -0.00281, -1.0],
        [0.0, 1.0, -0.00281],
    ];
    let base_from_world = nearest_rotation(&Mat3::from_fn(|row, column| rows[row][column]));
    let distortion = FocalCurve {
        at_focal_px: 1333.3,
        value: 0.0633,
        per_1000_px: 0.3986,
        k2_per_k1_squared: 2.0,
        ..FocalCurve::NONE
    };
    let centre = ImagePoint::new(644.65, 329.17);
    main.set_base(&CameraBase {
        distortion,
        ..CameraBase::new(Vec3::new(-0.043, -70.724, 15.334), base_from_world, centre)
    });
    document.cameras.push(main.into());
    for index in 0..frames {
        let video = touchline::document::VideoFrame::new("match.mp4", index, None);
        document
            .frames
            .push(Frame::from_video(video, "main".into(), size).into());
    }
    for (index, pan_deg, tilt_deg, focal_px) in [
        (0, 8.53823, -11.79129, 2539.516),
        (60, 7.79803, -11.35380, 2627.479),
    ] {
        document.frames[index].status = FrameStatus::Reference;
        document.frames[index].ptz = ptz_at(pan_deg, tilt_deg, focal_px);
    }
    document
}

fn the_trainer_carries_cameras_between_key_frames() {
    let folder = tempfile::tempdir().unwrap();
    let video = frames_folder()
        .join("video-soccer/match.mp4")
        .canonicalize()
        .unwrap();
    std::os::unix::fs::symlink(video, folder.path().join("match.mp4")).unwrap();
    let mut document = two_references(61);
    let (wake, woken) = channel();
    let wake = Arc::new(move || wake.send(()).unwrap_or_default());
    let options = TrainerOptions {
        settle: Duration::ZERO,
        ..TrainerOptions::default()
    };
    let file = folder.path().join("project.json");
    let trainer = Trainer::start(file, options, SharedPictures::none(), wake).unwrap();
    trainer.notify(TrainerOrder::Document(Box::new(document.clone())));
    let (mut status, mut asked, mut tracked) = (TrainerStatus::default(), 0, 0);
    while !(status.doing == TrainerActivity::Nothing && status.forest.is_some()) {
        woken.recv().unwrap();
        for report in trainer.poll() {
            match report {
                TrainerReport::Status(now) => status = *now,
                TrainerReport::Proposals(proposals) => {
                    asked += proposals.len();
                    for camera in proposals {
                        camera.record(document.frames.by_id_mut(&camera.frame).unwrap());
                    }
                }
                TrainerReport::Tracked(cameras) => {
                    tracked += cameras.len();
                    for camera in cameras {
                        camera.record(document.frames.by_id_mut(&camera.frame).unwrap());
                    }
                }
                TrainerReport::Features(_) => panic!("nobody asked for features"),
                TrainerReport::Broken { message } => panic!("{message}"),
            }
        }
    }
    assert_eq!(status.trouble, None);
    // Eight beside the first frame, and two key frames.
    assert!(
        asked <= 10 && tracked == 59,
        "{asked} asked, {tracked} carried"
    );
    let pans: Vec<f64> = document
        .frames
        .iter()
        .map(|frame| frame.ptz.as_ref().unwrap().pan_deg)
        .collect();
    let of_carried = |at: &usize| {
        let source = document.frames[*at]
            .solution
            .as_ref()
            .and_then(|solution| solution.source);
        source == Some(SolutionSource::Tracking)
    };
    let rests: Vec<usize> = (12..58).filter(of_carried).collect();
    assert!(rests.len() > 40, "{rests:?}");
    for at in rests {
        let jerk_deg = pans[at - 1] - 2.0 * pans[at] + pans[at + 1];
        assert!(jerk_deg.abs() < 0.05, "frame {at}: {jerk_deg}°");
    }
}

fn key_frames_are_answered_and_the_frames_between_carried_from_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let video = frames_folder()
        .join("video-soccer/match.mp4")
        .canonicalize()
        .unwrap();
    std::os::unix::fs::symlink(video, folder.path().join("match.mp4")).unwrap();
    save(folder.path().join("match.json"), &two_references(61));
    for command in [
        "train match.json -o match.tlf",
        "relocalize match.tlf match.json -o keys.json --key-frames",
        "track keys.json -o tracked.json",
    ] {
        let ran = touchline(folder.path(), command);
        assert_eq!(ran.code, 0, "{command}: {}", ran.stderr);
        let left =
            "2 frames answered, 0 not, 59 left unchanged (no key frames, with clicks, or accepted)";
        assert!(
            !command.starts_with("relocalize") || ran.stderr.contains(left),
            "{}",
            ran.stderr
        );
    }
    let (_, tracked, _) = read(&folder.path().join("tracked.json")).unwrap();
    assert!(tracked.frames.iter().all(|frame| frame.ptz.is_some()));
}
