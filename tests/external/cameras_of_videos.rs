//! `touchline import --video`: cameras of other programs on the frames of a video.

use crate::parts::{Test, tests};
use crate::program::touchline;
use std::fs;
use std::path::Path;
use std::process::Command;
use touchline::document::{Document, Frame};
use touchline::geometry::ImageSize;
use touchline::store::read;
use touchline_core::testing::base_at;
use touchline_documents::testing::{WithFrames, match_from, new_video_frame, ptz_at, save};

pub const TESTS: &[Test] = tests![
    [Ffmpeg] cameras_of_every_format_come_to_their_frames_of_a_video;
    [Ffmpeg] cameras_of_another_video_are_refused_in_one_line;
];

const SIZE: ImageSize = ImageSize::new(1280, 720);
const FRAMES: u64 = 12;

/// A test card of twelve frames as `match.mp4`.
fn make_video(folder: &Path) {
    let status = Command::new("ffmpeg")
        .args(["-v", "error", "-y", "-f", "lavfi", "-i"])
        .arg("testsrc2=size=1280x720:rate=25:duration=0.48")
        .args(["-c:v", "libx264"])
        .arg(folder.join("match.mp4"))
        .status();
    assert!(status.unwrap().success());
}

/// All frames of the video with cameras, as `solved.json`.
fn write_solved(folder: &Path) -> Document {
    let frames = (0..FRAMES).map(|index| Frame {
        ptz: ptz_at(4.0 * index as f64 - 22.0, -11.0, 1300.0),
        ..new_video_frame("match.mp4", index, SIZE)
    });
    let base = base_at([1.0, -58.0, 16.0], SIZE);
    let document = match_from(&base, SIZE).with_frames(frames);
    save(folder.join("solved.json"), &document);
    document
}

/// The pan of each frame, degrees, with the number of its video frame.
fn pans_deg(document: &Document) -> Vec<(u64, Option<f64>)> {
    let pan = |frame: &Frame| {
        let ray = document
            .ptz_camera(frame)?
            .ray_from_image(SIZE.centre())
            .ok()?;
        Some(ray.pan.degrees())
    };
    document
        .frames
        .iter()
        .map(|frame| (frame.video.as_ref().unwrap().frame_index, pan(frame)))
        .collect()
}

fn cameras_of_every_format_come_to_their_frames_of_a_video() {
    let folder = tempfile::tempdir().unwrap();
    make_video(folder.path());
    let solved = write_solved(folder.path());
    let run = |arguments: &str| {
        let ran = touchline(folder.path(), arguments);
        assert_eq!(ran.code, 0, "{arguments}: {}", ran.stderr);
        ran.stderr
    };
    for (format, output) in [
        ("soccernet", "sn"),
        ("broadtrack", "bt.json"),
        ("csv", "cameras.csv"),
        ("opencv", "opencv"),
        ("fifa", "match-cameras.npz"),
        ("wc14", "h"),
        ("homography", "h.jsonl"),
    ] {
        run(&format!("export solved.json --format {format} -o {output}"));
        let back = format!("{format}.json");
        let said = run(&format!("import {output} --video match.mp4 -o {back}"));
        assert!(
            said.contains(&format!("the format is {format}: ")),
            "{said}"
        );
        assert!(
            said.contains("12 cameras are attached to match.mp4 "),
            "{said}"
        );
        let (_, document, _) = read(&folder.path().join(back)).unwrap();
        assert_eq!(document.cameras.len(), 1, "{format}");
        let wanted = pans_deg(&solved);
        for ((index, pan), (_, wanted)) in pans_deg(&document).into_iter().zip(wanted) {
            let off = pan.unwrap() - wanted.unwrap();
            assert!(off.abs() < 0.01, "{format}: frame {index} is off by {off}°");
        }
    }
    fs::write(folder.path().join("sn/camera_match_000007.json"), "{}").unwrap();
    fs::write(folder.path().join("sn/camera_match_000008.json"), "null").unwrap();
    let ran = touchline(folder.path(), "import sn --video match.mp4 -o damaged.json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let said = ran.stderr;
    assert!(
        said.contains("2 of 12 files have no camera that can be read: camera_match_000007.json ("),
        "{said}"
    );
    let (_, document, _) = read(&folder.path().join("damaged.json")).unwrap();
    let unsolved: Vec<u64> = pans_deg(&document)
        .into_iter()
        .filter(|(_, pan)| pan.is_none())
        .map(|(index, _)| index)
        .collect();
    assert_eq!(unsolved, [7, 8]);
}

fn cameras_of_another_video_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    make_video(folder.path());
    write_solved(folder.path());
    touchline(folder.path(), "export solved.json --format opencv -o few").done();
    let good = fs::read(folder.path().join("few/match_000000.yml")).unwrap();
    fs::create_dir(folder.path().join("many")).unwrap();
    for number in 0..40 {
        fs::write(folder.path().join(format!("many/{number}.yml")), &good).unwrap();
    }
    let ran = touchline(
        folder.path(),
        "import many --format opencv --video match.mp4 -o out.json",
    );
    ran.assert_refused(2);
    ran.assert_says("the numbers 0 to 39 of 40 cameras do not fit its 12 frames");
    assert!(!folder.path().join("out.json").exists());
    let ran = touchline(
        folder.path(),
        "import few --video few/match_000000.yml -o out.json",
    );
    assert_eq!(ran.code, 2, "{}", ran.stderr);
}
