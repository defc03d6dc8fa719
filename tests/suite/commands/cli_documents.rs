//! `touchline new`, `solve`, `check`, `export`: what a script can rely on.

use crate::program::touchline;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::document::{
    Camera, Click, Document, Edit, Frame, FramePtz, FrameStatus, SolutionSource, document_to_string,
};
use touchline::exchange::Format;
use touchline::geometry::ImageSize;
use touchline::store::{Access, Location, open, read, write_document};
use touchline_core::testing::{TestBase, landmark_in, soccer, turned_base};
use touchline_documents::testing::{
    WithFrames, a_match, match_from, new_frame, save, soccer_document, solved_by,
};

const SIZE: ImageSize = ImageSize::new(1280, 720);

fn picture(path: &Path, size: ImageSize, grey: u8) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    image::GrayImage::from_pixel(size.width, size.height, image::Luma([grey]))
        .save(path)
        .unwrap();
}

/// A folder with three pictures, `frames/2.png`, `frames/10.png` and `frames/large.png`.
fn pictures() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    picture(&folder.path().join("frames/10.png"), SIZE, 1);
    picture(&folder.path().join("frames/2.png"), SIZE, 2);
    picture(
        &folder.path().join("frames/large.png"),
        ImageSize::new(1920, 1080),
        3,
    );
    folder
}

fn base() -> CameraBase {
    turned_base([1.0, -58.0, 16.0], [0.0, -1.0, 0.0], SIZE)
}

const LANDMARKS: [&str; 5] = [
    "centre_mark",
    "penalty_area_far_right_front",
    "penalty_arc_far_right",
    "centre_circle_right",
    "penalty_mark_right",
];

/// The camera of frame `index`.
fn truth(index: usize) -> PtzCamera {
    base().aim(
        18.0 + index as f64 * 0.5,
        -11.0,
        1500.0 + index as f64 * 10.0,
    )
}

/// A frame with its first `clicks` landmarks clicked exactly.
fn clicked_frame(index: usize, clicks: usize) -> Frame {
    let field = soccer();
    let mut frame = new_frame(&format!("images/{index}.png"), SIZE);
    frame.status = FrameStatus::Draft;
    for name in &LANDMARKS[..clicks] {
        let at = landmark_in(&truth(index), &field, name);
        assert!(SIZE.contains(at), "{name} {at:?}");
        frame.clicks.push(Click::landmark((*name).into(), at));
    }
    frame
}

/// A document of frames with this many clicks each, written to `doc.json`.
fn clicked_document(folder: &Path, clicks: &[usize]) -> Document {
    let mut document = match_from(&base(), SIZE);
    document.frames = clicks
        .iter()
        .enumerate()
        .map(|(index, clicks)| clicked_frame(index, *clicks).into())
        .collect();
    save(folder.join("doc.json"), &document);
    document
}

#[test]
fn new_makes_a_project_of_a_folder() {
    let folder = pictures();
    let ran = touchline(
        folder.path(),
        "new match --frames frames --field soccer --set length_m=101.5",
    );
    assert_eq!((ran.code, ran.stdout.as_str()), (0, ""), "{}", ran.stderr);
    assert!(
        ran.stderr.ends_with("project.json: 3 frames\n"),
        "{}",
        ran.stderr
    );
    let (_, document, _) = read(&folder.path().join("match")).unwrap();
    let images: Vec<_> = document
        .frames
        .iter()
        .map(|frame| frame.image.as_deref().unwrap())
        .collect();
    assert_eq!(
        images,
        ["../frames/2.png", "../frames/10.png", "../frames/large.png"],
        "natural order"
    );
    assert_eq!(document.frames[0].sha256.as_ref().unwrap().len(), 64);
    assert_eq!(document.field.params["length_m"], 101.5);
    let cameras: Vec<_> = document
        .cameras
        .iter()
        .map(|camera| camera.id.as_str())
        .collect();
    assert_eq!(
        cameras,
        ["main", "main_1920x1080"],
        "a camera for each size of picture"
    );
    let check = touchline(folder.path(), "check match");
    assert_eq!(
        (check.code, check.stdout.as_str()),
        (0, "No problems: 3 frames, 0 clicks.\n")
    );
    let first = fs::read(folder.path().join("match/project.json")).unwrap();
    for (again, code) in [
        ("new match --frames frames --field soccer", 0),
        ("new match --frames frames --field futsal", 2),
    ] {
        let ran = touchline(folder.path(), again);
        assert_eq!(ran.code, code, "{}", ran.stderr);
        assert_eq!(
            fs::read(folder.path().join("match/project.json")).unwrap(),
            first,
            "it exists, and no image came"
        );
    }
    assert_eq!(
        touchline(
            folder.path(),
            "new match --force --frames frames --field soccer --every 2"
        )
        .code,
        0
    );
    assert_eq!(
        read(&folder.path().join("match")).unwrap().1.frames.len(),
        2
    );
    assert_eq!(
        fs::read(folder.path().join("match/project.json.bak")).unwrap(),
        first
    );
    fs::create_dir(folder.path().join("empty")).unwrap();
    let again = "new empty --frames frames --field soccer --set length_m=101.5";
    assert_eq!(
        touchline(folder.path(), again).code,
        0,
        "an empty folder counts as absent"
    );
    assert_eq!(
        fs::read(folder.path().join("empty/project.json")).unwrap(),
        first,
        "same input, same bytes"
    );
}

/// Sets for training networks stretch pictures to a square. Both the pictures and their labels are
/// brought back, and only together.
#[test]
fn stretched_pictures_and_their_labels_get_their_own_proportion() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("square")).unwrap();
    let shown = image::RgbImage::from_fn(64, 64, |x, _| image::Rgb([4 * x as u8, 90, 90]));
    for name in ["a.jpg", "b.png"] {
        shown.save(folder.path().join("square").join(name)).unwrap();
    }
    let table = "frame,label,x,y\na.jpg,centre_mark,32,16\n";
    fs::write(folder.path().join("points.csv"), table).unwrap();
    let import = |images: &str, to: &str| {
        let options = "--size 64x64 --stretched-from 128x72";
        touchline(
            folder.path(),
            &format!("import points.csv --images {images} {options} -o {to}"),
        )
    };
    let refused = import("square", "refused.json");
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(
        refused.stderr.contains("touchline new"),
        "{}",
        refused.stderr
    );

    let new = "new match --frames square --field soccer --stretched-from 128x72";
    let made = touchline(folder.path(), new);
    assert_eq!(made.code, 0, "{}", made.stderr);
    let (_, document, _) = read(&folder.path().join("match")).unwrap();
    let frames = document.frames.iter();
    let frames: Vec<_> = frames
        .map(|frame| (frame.image.as_deref().unwrap(), frame.image_size))
        .collect();
    let size = ImageSize::new(128, 72);
    assert_eq!(frames, [("images/a.jpg", size), ("images/b.png", size)]);
    let written = image::open(folder.path().join("match/images/b.png")).unwrap();
    let written = written.into_rgb8();
    assert_eq!(written.dimensions(), (128, 72));
    assert!(written.get_pixel(64, 36)[0].abs_diff(126) < 4);

    let read_back = import("match/images", "labels.json");
    assert_eq!(read_back.code, 0, "{}", read_back.stderr);
    let (_, document, _) = read(&folder.path().join("labels.json")).unwrap();
    assert_eq!(document.frames[0].image_size, size);
    let click = document.frames[0].clicks[0].image;
    assert_eq!((click.x, click.y), (64.0, 18.0));

    let again = touchline(
        folder.path(),
        &new.replace("match ", "other ").replace("square", "none"),
    );
    assert_eq!(again.code, 2, "{}", again.stderr);
}

#[test]
fn new_again_adds_the_images_that_came_and_changes_nothing_else() {
    let folder = pictures();
    let new = "new match --frames frames --field soccer";
    assert_eq!(touchline(folder.path(), new).code, 0);
    let project = folder.path().join("match");
    let mut document = read(&project).unwrap().1;
    document.frames[1].comment = Some("rain".to_owned());
    save(project.join("project.json"), &document);
    let frames = folder.path().join("frames");
    fs::copy(frames.join("2.png"), frames.join("3.png")).unwrap();
    fs::copy(frames.join("2.png"), frames.join("x.png")).unwrap();
    fs::remove_file(frames.join("10.png")).unwrap();
    let ran = touchline(folder.path(), new).done();
    let says = "2 new images added, 5 frames in all; 1 image not in the folder any more\n";
    assert!(ran.stderr.ends_with(says), "{}", ran.stderr);
    let now = read(&project).unwrap().1;
    let names: Vec<_> = now.frames.iter().map(|frame| frame.name()).collect();
    let all = ["2.png", "3.png", "10.png", "large.png", "x.png"];
    assert_eq!(names, all.map(|name| format!("../frames/{name}")));
    for frame in &document.frames {
        assert_eq!(now.frames.by_id(&frame.id), Some(frame));
    }
    assert_eq!(now.cameras, document.cameras);
}

#[test]
fn frames_that_fail_for_one_reason_are_counted_beyond_ten_and_programs_read_each() {
    let folder = pictures();
    for number in 0..14 {
        fs::write(
            folder.path().join(format!("frames/bad{number}.png")),
            "no picture",
        )
        .unwrap();
    }
    let text = touchline(folder.path(), "new text --frames frames --field soccer");
    let named = text.stderr.lines().filter(|line| line.contains("bad"));
    assert_eq!(named.count(), 10, "{}", text.stderr);
    assert!(
        text.stderr.contains("and 4 frames more: "),
        "{}",
        text.stderr
    );
    let json = touchline(
        folder.path(),
        "--json new json --frames frames --field soccer",
    );
    let failed = json
        .stderr
        .lines()
        .filter(|line| line.contains("frame_failed"));
    assert_eq!(failed.count(), 14);
}

#[test]
fn new_names_what_it_leaves_out() {
    let folder = pictures();
    fs::write(folder.path().join("frames/3.png"), "no picture").unwrap();
    let ran = touchline(
        folder.path(),
        "--json new match --frames frames --field soccer",
    );
    assert_eq!(ran.code, 1);
    let first: serde_json::Value =
        serde_json::from_str(ran.stderr.lines().next().unwrap()).unwrap();
    assert_eq!(first["level"], "frame_failed");
    assert!(
        first["frame"].as_str().unwrap().ends_with("3.png"),
        "{first}"
    );
    assert_eq!(
        read(&folder.path().join("match")).unwrap().1.frames.len(),
        3
    );
}

#[test]
fn solve_gives_ptz_and_solution_and_keeps_statuses() {
    let folder = tempfile::tempdir().unwrap();
    let before = clicked_document(folder.path(), &[2, 5, 1, 0, 3]);
    let ran = touchline(folder.path(), "solve doc.json -o out/solved.json").done();
    assert_eq!(
        ran.stderr,
        "touchline: 3 frames solved, 0 failed, 2 with too few clicks\n"
    );
    let (_, solved, _) = read(&folder.path().join("out/solved.json")).unwrap();
    for index in [0, 1, 4] {
        let (frame, truth) = (&solved.frames[index], truth(index).ptz());
        let ptz = frame.ptz.as_ref().unwrap();
        assert!(
            (ptz.pan_deg - truth.pan.degrees()).abs() < 1e-7,
            "frame {index}: {ptz:?}"
        );
        assert!(
            (ptz.focal_px - truth.focal_px).abs() < 1e-4,
            "frame {index}: {ptz:?}"
        );
        assert!(frame.solution.as_ref().unwrap().covariance.is_some());
        assert_eq!(frame.status, FrameStatus::Draft);
        assert_eq!(
            frame.image.as_deref(),
            Some(format!("../images/{index}.png").as_str())
        );
    }
    assert_eq!(solved.frames[2].ptz, None);
    assert_eq!(solved.frames[3].clicks, before.frames[3].clicks);
    let first = fs::read_to_string(folder.path().join("out/solved.json")).unwrap();
    let printed = touchline(&folder.path().join("out"), "solve ../doc.json");
    assert_eq!(
        printed.stdout, first,
        "standard output is the same document, seen from the working folder"
    );
    assert_eq!(
        touchline(folder.path(), "solve doc.json -o out/solved.json").code,
        2,
        "it exists"
    );
    let in_place = "solve out/solved.json -o out/solved.json --force";
    let written = || fs::read_to_string(folder.path().join("out/solved.json")).unwrap();
    let kept = || fs::read_to_string(folder.path().join("out/solved.json.bak"));
    assert_eq!(touchline(folder.path(), in_place).code, 0);
    assert_eq!(written(), first, "nothing to solve");
    assert!(kept().is_err(), "nothing was replaced");
    let (_, mut fewer, _) = read(&folder.path().join("out/solved.json")).unwrap();
    fewer.frames[1].clicks.pop();
    let fewer = document_to_string(&fewer).unwrap();
    fs::write(folder.path().join("out/solved.json"), &fewer).unwrap();
    assert_eq!(touchline(folder.path(), in_place).code, 0);
    assert!(written() != fewer && kept().unwrap() == fewer);
}

#[test]
fn solve_names_the_frames_that_could_not_be() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = clicked_document(folder.path(), &[2, 2, 2]);
    document
        .cameras
        .push(Camera::new("baseless".into(), SIZE).into());
    document.frames[1].camera = "baseless".into();
    document.frames[2].clicks[0] = Click::landmark("nowhere".into(), SIZE.centre());
    document.frames[2].ptz = Some(FramePtz::new(truth(2).ptz(), None));
    save(folder.path().join("doc.json"), &document);
    let ran = touchline(folder.path(), "--json solve doc.json -o solved.json");
    assert_eq!(ran.code, 1);
    let failed: Vec<serde_json::Value> = ran
        .stderr
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(failed[0]["frame"], "images/1.png");
    assert_eq!(failed[1]["frame"], "images/2.png");
    assert!(
        failed[1]["message"]
            .as_str()
            .unwrap()
            .contains("no landmark \"nowhere\""),
        "{}",
        failed[1]
    );
    let (_, solved, _) = read(&folder.path().join("solved.json")).unwrap();
    assert!(solved.frames[0].ptz.is_some(), "the others are done");
    assert_eq!(
        solved.frames[2].ptz, document.frames[2].ptz,
        "what cannot be solved again stays"
    );
}

#[test]
fn a_command_counts_an_edit_of_the_frames_that_it_changes() {
    let folder = tempfile::tempdir().unwrap();
    clicked_document(folder.path(), &[5, 0, 4]);
    let revisions = |name: &str| {
        let (_, document, _) = read(&folder.path().join(name)).unwrap();
        document
            .frames
            .iter()
            .map(|frame| frame.revision)
            .collect::<Vec<_>>()
    };
    assert_eq!(revisions("doc.json"), [0, 0, 0]);
    for (command, expected) in [
        ("solve doc.json -o solved.json", [1, 0, 1]),
        ("solve solved.json -o again.json", [1, 0, 1]),
        (
            "refine-base again.json -o refined.json --distortion none",
            [2, 0, 2],
        ),
    ] {
        let ran = touchline(folder.path(), command);
        assert_eq!(ran.code, 0, "{command}: {}", ran.stderr);
        assert_eq!(
            revisions(command.split_whitespace().nth(3).unwrap()),
            expected,
            "{command}"
        );
    }
}

#[test]
fn commands_see_what_only_the_journal_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("match");
    let document = soccer_document().with_pictures(["a.png"], SIZE);
    write_document(
        &Location::for_new_document(&path.join("")).unwrap(),
        &document,
        false,
    )
    .unwrap();
    let Access::Writable(mut store) = open(&path).unwrap().access else {
        panic!("read-only")
    };
    let mut after = document.clone();
    after.frames[0]
        .clicks
        .push(Click::without_name(SIZE.centre()));
    after.frames[0]
        .clicks
        .push(Click::landmark("centre_mark".into(), SIZE.centre()));
    store
        .append(&[Edit::between(&document, &after, "Two clicks")])
        .unwrap();
    let ran = touchline(folder.path(), "export match --format json -o set.json");
    assert_eq!(
        (ran.code, ran.stderr.as_str()),
        (0, "touchline: Recovered 1 edit: Two clicks.\n")
    );
    let (_, dataset, _) = read(&folder.path().join("set.json")).unwrap();
    assert_eq!(
        dataset.frames[0].clicks.len(),
        1,
        "no unnamed click in a dataset"
    );
    assert_eq!(dataset.frames[0].image.as_deref(), Some("match/a.png"));
    let refused = touchline(folder.path(), "solve match -o match --force");
    assert_eq!(refused.code, 2, "another program has it open");
    assert!(
        refused
            .stderr
            .contains("open in another touchline (process"),
        "{}",
        refused.stderr
    );
}

#[test]
fn check_says_everything_and_exits_with_one() {
    let folder = tempfile::tempdir().unwrap();
    clicked_document(folder.path(), &[2]);
    let ran = touchline(folder.path(), "check doc.json");
    assert_eq!(ran.code, 1);
    let image = folder.path().canonicalize().unwrap().join("images/0.png");
    let expected = format!(
        "frames[0] (images/0.png): {}: there is no such file; check whether it was moved or renamed\n\
         1 problem in 1 frame, 2 clicks.\n",
        image.display()
    );
    assert_eq!(ran.stdout, expected);
    let json = touchline(folder.path(), "check --json doc.json");
    let report: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(
        (
            report["problems"][0]["code"].as_str(),
            report["frames"].as_u64()
        ),
        (Some("missing_picture"), Some(1))
    );
    assert_eq!(
        (report["problems"][0]["frame"].as_u64(), json.code),
        (Some(0), 1)
    );
}

#[test]
fn wrong_usage_is_one_line_and_exit_two() {
    let folder = pictures();
    let exports = Format::all()
        .filter(|format| format.exports())
        .map(Format::name);
    let unknown_format = format!(
        "invalid value 'bmp' for '--format <FORMAT>' [possible values: {}]; see touchline --help",
        exports.collect::<Vec<_>>().join(", ")
    );
    let table = [
        (
            "a.json solve b.json",
            "a.json comes before the command; put it after the command",
        ),
        (
            "solve",
            "the following required arguments were not provided: <DOC>; see touchline --help",
        ),
        (
            "solve nothing.json",
            "nothing.json does not exist; give a project folder, its project.json or a dataset file",
        ),
        (
            "solve frames",
            "the folder frames holds no project.json; `touchline new` makes a project",
        ),
        ("export frames --format bmp", &unknown_format),
        (
            "new m --frames frames",
            "the following required arguments were not provided: --field <TEMPLATE>; see touchline --help",
        ),
        (
            "new m --frames nowhere --field soccer",
            "nowhere: there is no such file; check whether it was moved or renamed",
        ),
        (
            "new frames --frames frames --field soccer",
            "frames already exists; give --force to replace it, or another -o",
        ),
        (
            "new m --frames frames --field soccer --set length_m",
            "invalid value 'length_m' for '--set <NAME=NUMBER>': write NAME=NUMBER, such as length_m=105; see touchline --help",
        ),
    ];
    for (arguments, message) in table {
        let ran = touchline(folder.path(), arguments);
        assert_eq!(ran.stderr, format!("touchline: {message}\n"), "{arguments}");
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{arguments}");
    }
    assert!(!folder.path().join("m").exists(), "nothing was made");
}

#[test]
fn a_command_in_place_ends_the_journal_that_it_read() {
    let folder = tempfile::tempdir().unwrap();
    let document = clicked_document(folder.path(), &[5, 4]);
    let path = folder.path().join("doc.json");
    let Access::Writable(mut store) = open(&path).unwrap().access else {
        panic!("read-only")
    };
    let mut after = document.clone();
    after.frames[1].comment = Some("before the crash".to_owned());
    after.count_edits_since(&document);
    store
        .append(&[Edit::between(&document, &after, "Comment")])
        .unwrap();
    // A session that did not write the document leaves its journal.
    drop(store);

    let ran = touchline(folder.path(), "solve doc.json -o doc.json --force").done();
    ran.assert_says("Recovered 1 edit: Comment.");
    let (location, solved, recovery) = read(&path).unwrap();
    assert!(recovery.is_empty(), "{recovery:?}");
    assert_eq!(solved.frames[1].comment, after.frames[1].comment);
    assert!(solved.frames[1].ptz.is_some());
    assert_eq!(touchline::store::orphans(&location), []);
    let names = fs::read_dir(folder.path()).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    assert_eq!(names, ["doc.json", "doc.json.bak"]);
}

#[test]
fn cameras_that_were_decided_are_solved_again_only_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = clicked_document(folder.path(), &[5, 5, 5]);
    let set = FramePtz::new(Ptz::from_degrees(10.0, -10.0, 1400.0), None);
    for (index, source) in [(0, SolutionSource::Manual), (1, SolutionSource::Markings)] {
        let frame = &mut document.frames[index];
        frame.status = FrameStatus::Reference;
        frame.ptz = Some(set.clone());
        frame.solution = solved_by(source);
    }
    let text = document_to_string(&document).unwrap();
    fs::write(folder.path().join("doc.json"), text).unwrap();
    for (command, kept) in [
        ("solve doc.json -o solved.json", 2),
        ("solve doc.json -o again.json --replace-decided", 0),
        ("refine-base doc.json -o refined.json --distortion none", 2),
    ] {
        let ran = touchline(folder.path(), command);
        assert_eq!(ran.code, 0, "{command}: {}", ran.stderr);
        let says = ran
            .stderr
            .contains("2 frames with enough clicks kept as decided");
        assert_eq!(says, kept == 2, "{command}: {}", ran.stderr);
        let output = command.split_whitespace().nth(3).unwrap();
        let (_, solved, _) = read(&folder.path().join(output)).unwrap();
        let sources = solved
            .frames
            .iter()
            .map(|frame| frame.solution.as_ref()?.source);
        let clicks = sources.filter(|source| *source == Some(SolutionSource::Clicks));
        assert_eq!(clicks.count(), 3 - kept, "{command}");
    }
    let (_, solved, _) = read(&folder.path().join("solved.json")).unwrap();
    assert_eq!(solved.frames[0].ptz, Some(set.clone()));
    assert_eq!(solved.frames[1].ptz, Some(set));
}

#[test]
fn what_is_no_document_is_not_replaced_by_one_nor_a_document_by_another_kind() {
    let folder = tempfile::tempdir().unwrap();
    clicked_document(folder.path(), &[5]);
    let at = |name: &str| folder.path().join(name);
    let before = fs::read(at("doc.json")).unwrap();
    fs::write(at("match.mp4"), "a video").unwrap();
    fs::copy(at("doc.json"), at("other.json")).unwrap();
    for (command, says) in [
        (
            "solve doc.json -o match.mp4 --force",
            "is no document of touchline",
        ),
        (
            "export doc.json --format csv -o doc.json --force",
            "is the document that is exported",
        ),
        (
            "export doc.json --format json -o doc.json --force",
            "is the document that is exported",
        ),
        (
            "export doc.json --format coco -o other.json --force",
            "is a document of touchline",
        ),
    ] {
        let ran = touchline(folder.path(), command);
        assert_eq!(ran.code, 2, "{command}: {}", ran.stderr);
        assert!(ran.stderr.contains(says), "{command}: {}", ran.stderr);
    }
    assert_eq!(fs::read_to_string(at("match.mp4")).unwrap(), "a video");
    for name in ["doc.json", "other.json"] {
        assert!(fs::read(at(name)).unwrap() == before, "{name}");
    }
}

#[test]
fn a_document_that_is_open_elsewhere_is_refused_before_the_work_begins() {
    let folder = tempfile::tempdir().unwrap();

    let document = a_match(SIZE);
    let project = folder.path().join("match");
    write_document(
        &Location::for_new_document(&project.join("")).unwrap(),
        &document,
        false,
    )
    .unwrap();
    let Access::Writable(store) = open(&project).unwrap().access else {
        panic!("read-only")
    };
    // What they would work on is not there: they do not come to look at it.
    for command in [
        "solve missing -o match --force",
        "track missing -o match --force",
        "snap missing -o match --force",
        "refine-base missing -o match --force",
        "relocalize missing.tlf missing -o match --force",
        "calibrate missing -o match --force",
    ] {
        let ran = touchline(folder.path(), command);
        assert_eq!(ran.code, 2, "{command}: {}", ran.stderr);
        assert!(
            ran.stderr.contains("open in another touchline"),
            "{command}: {}",
            ran.stderr
        );
    }
    drop(store);
    let ran = touchline(folder.path(), "solve match -o match --force");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
}

#[test]
fn an_import_of_a_document_sees_its_journal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("match");

    let document = a_match(SIZE).with_pictures(["a.png"], SIZE);
    write_document(
        &Location::for_new_document(&path.join("")).unwrap(),
        &document,
        false,
    )
    .unwrap();
    let Access::Writable(mut store) = open(&path).unwrap().access else {
        panic!("read-only")
    };
    let mut after = document.clone();
    after.frames[0]
        .clicks
        .push(Click::landmark("centre_mark".into(), SIZE.centre()));
    store
        .append(&[Edit::between(&document, &after, "Click")])
        .unwrap();
    touchline(
        folder.path(),
        "import match/project.json --format json -o imported.json",
    )
    .done();
    assert_eq!(
        read(&folder.path().join("imported.json")).unwrap().1.frames[0]
            .clicks
            .len(),
        1
    );
}

#[test]
fn a_field_of_the_users_own_is_found_from_where_the_document_lies() {
    let folder = tempfile::tempdir().unwrap();
    let template = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/fields/soccer.json");
    fs::copy(template, folder.path().join("mine.json")).unwrap();
    fs::create_dir(folder.path().join("labels")).unwrap();
    clicked_document(folder.path(), &[2]);
    assert_eq!(
        touchline(
            folder.path(),
            "export doc.json --format labelme -o labels/out"
        )
        .code,
        0
    );
    touchline(
        folder.path(),
        "import labels/out --format labelme --field mine.json --size 1280x720 -o deep/doc.json",
    )
    .done();
    let (location, imported, _) = read(&folder.path().join("deep/doc.json")).unwrap();
    imported.field.model(location.folder()).unwrap();
}

#[test]
#[cfg(target_os = "linux")]
fn a_result_goes_through_a_pipe_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    clicked_document(folder.path(), &[2]);
    let direct = touchline(folder.path(), "solve doc.json");
    let by_name = touchline(folder.path(), "solve doc.json -o /dev/stdout");
    assert_eq!(
        (by_name.code, &by_name.stdout),
        (0, &direct.stdout),
        "{}",
        by_name.stderr
    );
    let filtered = touchline(
        folder.path(),
        "export doc.json --format json --status draft",
    );
    filtered.assert_prints("\"images/0.png\"");
    fs::create_dir(folder.path().join("elsewhere")).unwrap();
    let elsewhere = touchline(
        &folder.path().join("elsewhere"),
        "export ../doc.json --format json --status draft",
    );
    elsewhere.assert_prints("\"../images/0.png\"");
}

#[test]
fn a_check_prints_no_character_that_a_terminal_obeys() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = clicked_document(folder.path(), &[1]);
    document.frames[0].image = Some("a\u{1b}[2J\u{202e}.png".to_owned());
    save(folder.path().join("doc.json"), &document);
    let ran = touchline(folder.path(), "check doc.json");
    assert!(
        ran.stdout.contains(r"a\u{1b}[2J\u{202e}.png"),
        "{}",
        ran.stdout
    );
    assert!(
        !ran.stdout.contains(['\u{1b}', '\u{202e}']),
        "{}",
        ran.stdout
    );
}
