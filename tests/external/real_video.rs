//! A real match as a video: its frames in a project, and what is said of numbers and times that are not right.
#![cfg(feature = "opencv")]

use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use touchline::calibrate::{Problem, check_pictures};
use touchline::document::{Document, FieldSpec, Frame};
use touchline::geometry::ImageSize;
use touchline::store::read;

pub const TESTS: &[Test] = tests![
    [Frames] new_takes_the_frames_of_a_video_that_decode;
    [Frames] check_compares_frame_numbers_and_times_of_a_video;
];

fn new_takes_the_frames_of_a_video_that_decode() {
    let data = frames_folder();
    let folder = tempfile::tempdir().unwrap();
    let video = data.join("video-soccer/match.mp4").canonicalize().unwrap();
    let ran = touchline(folder.path(), &format!("new match --frames {} --field soccer", video.display()));
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("match.mp4 states 825 frames, 817 decode."), "{}", ran.stderr);
    let (location, document, _) = read(&folder.path().join("match")).unwrap();
    assert_eq!(document.frames.len(), 817);
    let last = document.frames[816].video.as_ref().unwrap();
    assert_eq!((last.frame_index, last.pts_s), (816, Some(32.64)));
    assert_eq!(last.file_path(location.folder()).canonicalize().unwrap(), video);
    assert_eq!(touchline(folder.path(), "check match").code, 0);
}

fn check_compares_frame_numbers_and_times_of_a_video() {
    let data = frames_folder();
    let mut document = Document::new(FieldSpec::new("soccer"));
    let frame = |index, pts_s| {
        let video = touchline::document::VideoFrame::new("match.mp4", index, pts_s);
        Frame::from_video(video, "main".into(), ImageSize::new(1280, 720)).into()
    };
    let frames = [frame(10, Some(0.4)), frame(10, None), frame(816, None), frame(817, None), frame(10, Some(0.48))];
    document.frames = frames.into_iter().collect();
    let problems = check_pictures(document.at(&data.join("video-soccer")), &|| {});
    let said: Vec<_> = problems.iter().map(Problem::to_string).collect();
    let expected = [
        "frames[3] (match.mp4#817): the video has 817 frames, numbered from 0; there is no frame 817",
        "frames[4] (match.mp4#10): pts_s 0.48 is not the time of frame 10 of the video (0.4000); inspect the label",
    ];
    assert_eq!(said, expected);
}
