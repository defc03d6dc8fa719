//! `touchline render` from outside: pictures, exit codes and what is said.

use crate::parts::{Test, tests};
use image::{Rgba, RgbaImage};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

pub const TESTS: &[Test] = tests![
    [Adapter] a_solved_frame_gets_its_overlay_and_its_view_from_above;
    [Adapter] a_frame_without_a_camera_is_rendered_and_named;
    [Adapter] what_cannot_be_done_is_said_in_one_line;
];

fn render(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_touchline"))
        .current_dir(folder)
        .args(["render", "match.json"])
        .args(arguments)
        .output()
        .unwrap()
}

fn stderr_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A dataset of two grey frames, the first one solved.
fn dataset(folder: &Path) {
    for name in ["1.png", "2.png"] {
        RgbaImage::from_pixel(320, 180, Rgba([90, 90, 90, 255]))
            .save(folder.join(name))
            .unwrap();
    }
    let frame = |image: &str| {
        serde_json::json!({
            "image": image, "camera": "main", "image_size_px": [320, 180], "status": "draft",
            "clicks": [{ "landmark": "centre_mark", "image_px": [160.0, 88.0] }],
        })
    };
    let mut solved = frame("1.png");
    solved["ptz"] = serde_json::json!({ "pan_deg": 0.0, "tilt_deg": -16.7, "focal_px": 420.0 });
    let document = serde_json::json!({
        "format": "touchline", "version": 1,
        "field": { "template": "soccer", "params": {} },
        "cameras": [{
            "id": "main", "image_size_px": [320, 180], "principal_point_px": [160.0, 90.0],
            "position_m": [0.0, -60.0, 18.0], "base_from_world": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
        }],
        "frames": [solved, frame("2.png")],
    });
    fs::write(folder.join("match.json"), document.to_string()).unwrap();
}

fn a_solved_frame_gets_its_overlay_and_its_view_from_above() {
    let folder = tempfile::tempdir().unwrap();
    dataset(folder.path());
    let output = render(folder.path(), &["--frame", "1.png", "-o", "overlay.png"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr_of(&output));
    assert!(
        stderr_of(&output).contains("touchline: overlay.png: rendered with "),
        "{}",
        stderr_of(&output)
    );
    let overlay = image::open(folder.path().join("overlay.png"))
        .unwrap()
        .into_rgba8();
    assert_eq!(overlay.dimensions(), (320, 180));
    // The halfway line runs up the middle of the picture, in yellow.
    let Rgba([r, _, b, _]) = *overlay.get_pixel(160, 150);
    assert!(r > 180 && b < 120, "{:?}", overlay.get_pixel(160, 150));
    assert_eq!(overlay.get_pixel(20, 20).0, [90, 90, 90, 255]);

    let output = render(
        folder.path(),
        &["--frame", "0", "-o", "above.png", "--top-view"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr_of(&output));
    let above = image::open(folder.path().join("above.png"))
        .unwrap()
        .into_rgba8();
    assert_eq!(above.dimensions(), (1380, 936));
}

fn a_frame_without_a_camera_is_rendered_and_named() {
    let folder = tempfile::tempdir().unwrap();
    dataset(folder.path());
    let output = render(folder.path(), &["--frame", "2.png", "-o", "2-overlay.png"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr_of(&output));
    assert!(
        stderr_of(&output).contains("2.png: it has no camera yet"),
        "{}",
        stderr_of(&output)
    );
    assert!(folder.path().join("2-overlay.png").exists());
}

fn what_cannot_be_done_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    dataset(folder.path());
    fs::remove_file(folder.path().join("2.png")).unwrap();
    RgbaImage::new(10, 10)
        .save(folder.path().join("2.png"))
        .unwrap();
    for (arguments, message) in [
        (
            ["--frame", "0", "-o", "1.png"],
            "1.png already exists; give --force to replace it, or another -o",
        ),
        (
            ["--frame", "7", "-o", "x.png"],
            "--frame 7: there are 2 frames, counted from 0",
        ),
        (
            ["--frame", "x", "-o", "x.png"],
            "no frame has this image; the document has 2 frames, by index 0 to 1",
        ),
        (
            ["--frame", "0", "-o", "x.jpg"],
            "-o x.jpg: a PNG is written, so its name must end with .png",
        ),
        (
            ["--frame", "1", "-o", "x.png"],
            "2.png is 10 × 10 px, but the document says 320 × 180 px",
        ),
    ] {
        let output = render(folder.path(), &arguments);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{arguments:?}: {}",
            stderr_of(&output)
        );
        let lines: Vec<String> = stderr_of(&output).lines().map(str::to_owned).collect();
        assert!(
            lines.len() == 1 && lines[0].contains(message),
            "{arguments:?}: {lines:?}"
        );
    }
    assert!(!folder.path().join("x.png").exists());
}
