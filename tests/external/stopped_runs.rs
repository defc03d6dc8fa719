//! `touchline calibrate` killed at random moments: run again until it ends by itself, it gives the
//! same bytes as in one run.
#![cfg(feature = "opencv")]

use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

pub const TESTS: &[Test] = tests![
    [Ffmpeg, Frames] a_run_that_is_killed_goes_on_and_ends_with_the_same_bytes;
];

/// Two shots of one match, ten seconds in all, at half the size.
fn two_shots(folder: &Path) {
    let video = frames_folder().join("video-soccer/match.mp4");
    let shot = |frames: &str, name: &str| {
        format!("[0:v]trim={frames},setpts=PTS-STARTPTS,scale=640:360[{name}]")
    };
    let filter = format!(
        "{};{};[a][b]concat",
        shot("start_frame=0:end_frame=150", "a"),
        shot("start_frame=640:end_frame=740", "b")
    );
    let status = Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(video)
        .args(["-filter_complex", &filter, "-c:v", "libx264", "two.mp4"])
        .current_dir(folder)
        .status();
    assert!(status.unwrap().success());
}

fn start(folder: &Path, output: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_touchline"))
        .args(["calibrate", "two.mp4", "--force", "-o", output])
        .current_dir(folder)
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn a_run_that_is_killed_goes_on_and_ends_with_the_same_bytes() {
    let place = tempfile::tempdir().unwrap();
    two_shots(place.path());
    let begun = Instant::now();
    touchline(place.path(), "calibrate two.mp4 -o whole").done();
    let whole_s = begun.elapsed().as_secs_f64();
    let project = |name: &str| fs::read(place.path().join(name).join("project.json")).unwrap();
    let expected = project("whole");
    // Each run gets far enough to finish the longest part, which is the search, or is killed in it.
    let mut random = Pcg64::seed_from_u64(76);
    let mut kills = 0;
    loop {
        let mut run = start(place.path(), "killed");
        let lives = Duration::from_secs_f64(random.random_range(0.05..0.9) * whole_s);
        let begun = Instant::now();
        let ended = loop {
            if let Some(status) = run.try_wait().unwrap() {
                break Some(status);
            }
            if begun.elapsed() > lives {
                run.kill().unwrap();
                run.wait().unwrap();
                break None;
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        if let Some(status) = ended {
            assert!(status.success());
            break;
        }
        kills += 1;
        assert!(kills < 60, "no run gets to the end");
    }
    assert_eq!(project("killed"), expected, "after {kills} kills");
    // Everything is there: once more takes a small part of the time, and a damaged file is made
    // again.
    let work = place.path().join("killed/.touchline/work");
    for file in fs::read_dir(&work).unwrap().step_by(3) {
        let path = file.unwrap().path();
        let mut bytes = fs::read(&path).unwrap();
        if let Some(last) = bytes.last_mut() {
            *last ^= 1;
        }
        fs::write(path, bytes).unwrap();
    }
    touchline(place.path(), "calibrate two.mp4 --force -o killed").done();
    assert_eq!(project("killed"), expected, "after damage");
    let begun = Instant::now();
    touchline(place.path(), "calibrate two.mp4 --force -o killed").done();
    let again_s = begun.elapsed().as_secs_f64();
    assert!(again_s < 0.25 * whole_s, "{again_s} s of {whole_s} s");
    assert_eq!(project("killed"), expected);
    // Another file of the same name is another video.
    fs::copy(
        frames_folder().join("wild/villa-dissolve.mp4"),
        place.path().join("two.mp4"),
    )
    .unwrap();
    touchline(place.path(), "calibrate two.mp4 --force -o killed");
    let other = fs::read_to_string(place.path().join("killed/project.json")).unwrap_or_default();
    assert!(!other.contains("\"tracking\"") || other.as_bytes() != expected.as_slice());
}
