//! `touchline synth` and the demo that it drew.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use touchline::document::FrameStatus;
use touchline::geometry::ImagePoint;
use touchline::media::sha256_of_file;
use touchline_documents::testing::load;

fn synth(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_touchline"))
        .arg("synth")
        .args(arguments)
        .arg("-o")
        .arg(folder)
        .output()
        .unwrap()
}

fn bytes_below(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    for name in [
        "project.json",
        "truth.json",
        "images/0001.jpg",
        "images/0002.jpg",
        "masks/0002.png",
    ] {
        files.push((
            PathBuf::from(name),
            std::fs::read(folder.join(name)).unwrap(),
        ));
    }
    files
}

#[test]
fn a_match_is_drawn_with_its_truth_and_never_over_something() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "--frames", "2", "--seed", "6", "--size", "320x180", "--preset", "hard", "--masks",
    ];
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    for place in [&one, &two] {
        let output = synth(&arguments, place);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    assert_eq!(bytes_below(&one), bytes_below(&two));

    let (project, truth) = (load(one.join("project.json")), load(one.join("truth.json")));
    assert_eq!((project.frames.len(), truth.frames.len()), (2, 2));
    for (frame, exact) in project.frames.iter().zip(&truth.frames) {
        assert_eq!((frame.status, &frame.ptz), (FrameStatus::New, &None));
        assert_eq!(exact.status, FrameStatus::Reference);
        assert_eq!(frame.image, exact.image);
        let camera = truth.ptz_camera(exact).unwrap();
        // The curve of the lens and the k₁ in use agree.
        assert_eq!(exact.ptz.as_ref().unwrap().k1, Some(camera.k1()));
        assert!(!exact.masks.is_empty() && exact.extra.contains_key("truth"));
    }
    assert!(project.cameras[0].base().is_some() && project.cameras[0].masks.len() == 1);

    let refused = synth(&arguments, &one);
    assert_eq!(refused.status.code(), Some(2));
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        told.trim_end()
            .ends_with("one already exists; give --force to replace it, or another -o"),
        "{told}"
    );
    assert_eq!(bytes_below(&one), bytes_below(&two));
}

#[test]
fn a_court_is_drawn_with_its_own_field_by_a_camera_that_keeps_still() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("court");
    let arguments = "--scene tennis --camera corner --still --frames 2 --size 320x180";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let output = synth(&arguments, &place);
    assert!(output.status.success());
    let truth = load(place.join("truth.json"));
    assert_eq!(truth.field.template, "tennis");
    let [one, two] = [0, 1].map(|frame| truth.ptz_camera(&truth.frames[frame]).unwrap());
    assert_eq!(one, two);
    assert!(one.base().position_m.x < -12.0 && one.base().position_m.y < -6.0);
}

#[test]
fn wrong_orders_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("match");
    for (arguments, named) in [
        (&["--frames", "0"][..], "0 is not in 1..=100000"),
        (&["--size", "big"], "write it like 1280x720"),
        (&["--preset", "harder"], "there are easy, paper and hard"),
        (&["--quality", "0"], "0 is not in 1..=100"),
        (&["--step=-1"], "is not a time; give seconds"),
        (&["--seed", "x"], "--seed"),
        (&["--scene", "desert"], "stadium, basketball"),
        (&["--camera", "end"], "stadium has no camera at the end"),
        (&["--camera", "roof"], "side, end, corner"),
        (&["--demo", "--still"], "--demo"),
        (&["--demo", "--frames", "3"], "--demo"),
        (&["--broadcast", "3"], "3 is not in 4..=36000"),
        (&["--broadcast", "9", "--frames", "3"], "--broadcast"),
        (&["--broadcast", "9", "--cameras", "2"], "2 is not in 3..=7"),
        (&["--cameras", "4"], "--broadcast"),
    ] {
        let output = synth(arguments, &place);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(
            told.contains(named) && told.trim_end().lines().count() == 1,
            "{arguments:?}: {told}"
        );
    }
    assert!(!place.exists());
    let file = folder.path().join("file");
    std::fs::write(&file, "mine").unwrap();
    let output = synth(&["--frames", "1", "--force"], &file);
    assert!(String::from_utf8_lossy(&output.stderr).contains("is a file; give a folder"));
    assert_eq!(std::fs::read(&file).unwrap(), b"mine");
}

#[test]
fn the_demo_is_whole_and_its_references_are_right() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("projects/demo");
    let (project, truth) = (
        load(folder.join("project.json")),
        load(folder.join("truth.json")),
    );
    assert!(project.frames.len() >= 24 && project.frames.len() == truth.frames.len());
    let mut references = 0;
    for (frame, exact) in project.frames.iter().zip(&truth.frames) {
        assert_eq!(
            sha256_of_file(&frame.image_path(&folder).unwrap()).ok(),
            frame.sha256,
            "{}",
            frame.name()
        );
        let exact = truth.ptz_camera(exact).unwrap();
        let Some(solved) = project.ptz_camera(frame) else {
            assert_eq!((frame.status, frame.clicks.len()), (FrameStatus::New, 0));
            continue;
        };
        references += 1;
        assert_eq!(frame.status, FrameStatus::Reference);
        assert!((2..=7).contains(&frame.clicks.len()));
        // What the middle of the picture shows is drawn within a few pixels of it.
        let centre = ImagePoint::new(640.0, 360.0);
        let shown = solved
            .image_from_ray(exact.ray_from_image(centre).unwrap())
            .unwrap();
        assert!(
            shown.distance_px(centre) < 8.0,
            "{}: {:.1} px",
            frame.name(),
            shown.distance_px(centre)
        );
    }
    assert!(
        references * 3 >= project.frames.len(),
        "{references} references"
    );
}
