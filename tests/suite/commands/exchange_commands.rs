//! `touchline export` and `touchline import`: there and back through the program, as a script
//! would.

use crate::program::touchline;
use std::fs;
use std::path::Path;
use touchline::camera::{BaseAngles, CameraBase, FocalCurve, Ptz};
use touchline::document::{
    Camera, Document, FieldSpec, Frame, FramePtz, FrameStatus, document_to_string,
};
use touchline::exchange::Format;
use touchline::field::builtin;
use touchline::geometry::{ImageSize, Vec3};
use touchline::store::read;

const SIZE: ImageSize = ImageSize::new(1280, 720);

/// Three solved frames and one that is not, as `doc.json`.
fn document(folder: &Path) -> Document {
    let base = CameraBase {
        distortion: FocalCurve::constant(-0.08),
        ..CameraBase::new(
            Vec3::new(1.0, -58.0, 16.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        )
    };
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut camera = Camera::new("main".into(), SIZE);
    camera.set_base(&base);
    document.cameras.push(camera.into());
    for index in 0..4 {
        let mut frame = Frame::from_image(&format!("images/{index}.jpg"), "main".into(), SIZE);
        frame.status = FrameStatus::Reference;
        let ptz = Ptz::from_degrees(
            f64::from(index) * 9.0 - 14.0,
            -11.0,
            1500.0 + 100.0 * f64::from(index),
        );
        frame.ptz = (index < 3).then(|| FramePtz::new(ptz, None));
        document.frames.push(frame.into());
    }
    fs::write(
        folder.join("doc.json"),
        document_to_string(&document).unwrap(),
    )
    .unwrap();
    document
}

/// How far apart two documents show the landmarks of their solved frames at most, px.
fn apart_px(a: &Document, b: &Document) -> f64 {
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let mut worst = 0.0_f64;
    let solved = |document: &Document| -> Vec<_> {
        document
            .frames
            .iter()
            .filter_map(|frame| document.ptz_camera(frame))
            .collect()
    };
    let (a, b) = (solved(a), solved(b));
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        for landmark in &field.landmarks {
            let point = field.landmark_in_world(landmark);
            if let Ok(image) = a.image_from_world(point)
                && SIZE.contains(image)
            {
                worst = worst.max(b.image_from_world(point).unwrap().distance_px(image));
            }
        }
    }
    worst
}

#[test]
fn cameras_go_out_and_come_back_through_every_format_that_holds_them() {
    let folder = tempfile::tempdir().unwrap();
    let document = document(folder.path());
    for (format, output, size) in [
        ("soccernet", "sn", ""),
        ("csv", "cameras.csv", ""),
        ("broadtrack", "bt.json", ""),
        ("colmap", "colmap", ""),
        ("opencv", "opencv", ""),
    ] {
        let ran = touchline(
            folder.path(),
            &format!("export doc.json --format {format} -o {output}"),
        );
        assert_eq!(ran.code, 1, "one frame is not solved: {}", ran.stderr);
        assert!(
            ran.stderr
                .contains("touchline: images/3.jpg: it is not solved"),
            "{}",
            ran.stderr
        );
        assert!(
            ran.stderr
                .contains(&format!("3 frames written as {format}; read again")),
            "{}",
            ran.stderr
        );
        let ran = touchline(
            folder.path(),
            &format!("import {output} --format {format} {size} -o back-{format}.json"),
        );
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let (_, back, _) = read(&folder.path().join(format!("back-{format}.json"))).unwrap();
        let worst = apart_px(&document, &back);
        assert!(worst < 1e-6, "{format}: {worst}");
        assert_eq!(back.cameras.len(), 1, "{format}: the frames share a base");
    }
}

#[test]
fn cameras_of_another_size_than_their_pictures_are_rescaled_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let document = document(folder.path());
    // Formats name a picture by its stem or by its path.
    let pictures = |name: &str, size: ImageSize| {
        fs::create_dir_all(folder.path().join(name).join("images")).unwrap();
        for file in (0..3).flat_map(|index| [format!("{index}.jpg"), format!("images/{index}.jpg")])
        {
            image::RgbImage::new(size.width, size.height)
                .save(folder.path().join(name).join(file))
                .unwrap();
        }
    };
    pictures("pictures", SIZE);
    pictures("square", ImageSize::new(720, 720));
    for (format, output) in [
        ("soccernet", "sn"),
        ("csv", "cameras.csv"),
        ("broadtrack", "bt.json"),
        ("colmap", "colmap"),
        ("opencv", "opencv"),
        ("opentrackio", "track.jsonl"),
    ] {
        let ran = touchline(
            folder.path(),
            &format!("export doc.json --format {format} --size 640x360 -o {output}"),
        );
        assert_eq!(ran.code, 1, "one frame is not solved: {}", ran.stderr);
        let import = |images: &str| {
            touchline(
                folder.path(),
                &format!(
                    "import {output} --format {format} --images {images} -o {format}-{images}.json"
                ),
            )
        };
        let ran = import("pictures");
        assert_eq!(ran.code, 0, "{format}: {}", ran.stderr);
        let said = "3 cameras rescaled to the size of the pictures, the first from 640 × 360 to 1280 × 720";
        assert!(ran.stderr.contains(said), "{format}: {}", ran.stderr);
        let (_, back, _) = read(&folder.path().join(format!("{format}-pictures.json"))).unwrap();
        let worst = apart_px(&document, &back);
        assert!(worst < 1e-6, "{format}: {worst}");
        let ran = import("square");
        assert_eq!(
            (ran.code, ran.stderr.lines().count()),
            (2, 1),
            "{format}: {}",
            ran.stderr
        );
        assert!(
            ran.stderr
                .contains("is of a picture of 640 × 360 px, and its picture has 720 × 720"),
            "{}",
            ran.stderr
        );
    }
}

#[test]
fn an_assumed_size_and_a_crown_that_is_lost_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = document(folder.path());
    document.field.set_crown_m(0.35);
    fs::write(
        folder.path().join("doc.json"),
        document_to_string(&document).unwrap(),
    )
    .unwrap();
    for (format, output) in [("wc14", "h"), ("soccernet", "sn"), ("csv", "cameras.csv")] {
        let ran = touchline(
            folder.path(),
            &format!("export doc.json --format {format} -o {output}"),
        );
        assert!(
            ran.stderr.contains(
                "not held: the crown of 0.35 m; on flat ground points of the field are up to "
            ),
            "{}",
            ran.stderr
        );
    }
    let ran = touchline(folder.path(), "import h --format wc14 -o back.json");
    assert!(
        ran.stderr
            .contains("the picture size of 3 frames is assumed, as that of the set (1280 × 720)"),
        "{}",
        ran.stderr
    );
}

#[test]
fn what_a_format_cannot_hold_is_said_and_nothing_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    document(folder.path());
    let ran = touchline(folder.path(), "export doc.json --format wc14 -o h");
    assert!(
        ran.stderr
            .contains("not held: lens distortion, points off the ground (3 frames)"),
        "{}",
        ran.stderr
    );
    assert!(ran.stderr.contains("px rms, at most "), "{}", ran.stderr);
    let text = fs::read_to_string(folder.path().join("h/0.homographyMatrix")).unwrap();
    assert_eq!(text.split_whitespace().count(), 9);
    let again = touchline(folder.path(), "export doc.json --format wc14 -o h");
    assert_eq!(again.code, 2);
    assert!(
        again
            .stderr
            .contains("h already exists; give --force to replace it"),
        "{}",
        again.stderr
    );
    let same = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let first = same("h/1.homographyMatrix");
    let ran = touchline(folder.path(), "export doc.json --format wc14 -o h --force");
    assert_eq!(
        (ran.code, same("h/1.homographyMatrix")),
        (1, first),
        "the same bytes for the same input"
    );
}

#[test]
fn frames_are_chosen_by_status_and_camera() {
    let folder = tempfile::tempdir().unwrap();
    document(folder.path());
    let ran = touchline(
        folder.path(),
        "export doc.json --format csv --status suggested",
    );
    assert_eq!(ran.code, 2);
    assert_eq!(
        ran.stderr,
        "touchline: no frame to export as csv: no frame has the requested status, camera and confidence\n"
    );
    let ran = touchline(folder.path(), "export doc.json --format csv --camera other");
    assert_eq!(
        ran.stderr,
        "touchline: there is no camera \"other\" in the document\n"
    );
    let ran = touchline(
        folder.path(),
        "export doc.json --format csv --status reference",
    );
    assert_eq!(ran.stdout.lines().count(), 4, "a header and three frames");
}

#[test]
fn damaged_input_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("camera_1.json"), "{\"pan_degrees\": ").unwrap();
    let ran = touchline(
        folder.path(),
        "import camera_1.json --format soccernet -o out.json",
    );
    assert_eq!(
        (ran.code, ran.stderr.lines().count()),
        (2, 1),
        "{}",
        ran.stderr
    );
    assert!(
        ran.stderr
            .starts_with("touchline: camera_1.json: not valid JSON: it ends within a value"),
        "{}",
        ran.stderr
    );
    assert!(!folder.path().join("out.json").exists());
    let ran = touchline(
        folder.path(),
        "import nothing --format soccernet -o out.json",
    );
    assert!(
        ran.stderr.starts_with("touchline: cannot read nothing: "),
        "{}",
        ran.stderr
    );
}

#[test]
fn a_format_that_is_not_given_is_recognized() {
    let folder = tempfile::tempdir().unwrap();
    document(folder.path());
    touchline(
        folder.path(),
        "export doc.json --format soccernet -o cameras",
    );
    let ran = touchline(folder.path(), "import cameras -o back.json");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(
        ran.stderr.starts_with(
            "touchline: the format is soccernet: SoccerNet camera files, one per frame\n"
        ),
        "{}",
        ran.stderr
    );
    fs::write(
        folder.path().join("cameras/0.yml"),
        "%YAML:1.0\n---\ncamera_matrix: 0\n",
    )
    .unwrap();
    let ran = touchline(folder.path(), "import cameras -o other.json");
    assert_eq!(
        (ran.code, ran.stderr.as_str()),
        (
            2,
            "touchline: cameras: the files may be soccernet or opencv; give --format\n"
        )
    );
}

#[test]
fn the_place_of_the_output_is_tried_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    document(folder.path());
    let ran = touchline(
        folder.path(),
        "export missing.json --format csv -o doc.json/x.csv",
    );
    assert_eq!(ran.code, 2);
    assert!(
        ran.stderr.contains("x.csv: nothing can be made in "),
        "before the document is read: {}",
        ran.stderr
    );
    let left: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(left, ["doc.json"]);
}

#[test]
#[cfg(target_os = "linux")]
fn pipes_and_names_that_no_document_can_write_are_refused() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    assert!(
        std::process::Command::new("mkfifo")
            .arg(folder.path().join("pipe.json"))
            .status()
            .unwrap()
            .success()
    );
    let frames = folder.path().join(OsStr::from_bytes(b"frames-\xff"));
    fs::create_dir(&frames).unwrap();
    image::RgbImage::new(64, 36)
        .save(frames.join("1.png"))
        .unwrap();
    let new = |field: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_touchline"));
        command
            .current_dir(folder.path())
            .args(["new", "project", "--field", field, "--frames"])
            .arg(&frames);
        let output = command.output().unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    let (code, said) = new("./pipe.json");
    assert_eq!(code, Some(2));
    assert!(
        said.contains("cannot be read: it is a pipe, not a file") && said.lines().count() == 1,
        "{said}"
    );
    let (code, said) = new("soccer");
    assert_eq!(code, Some(2));
    assert!(
        said.ends_with(
            "a document cannot name it, for a folder's name in it is not UTF-8; rename the folder\n"
        ),
        "{said}"
    );
    assert!(!folder.path().join("project/project.json").exists());
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_touchline"));
    let command = command.current_dir(folder.path()).arg("calibrate");
    let output = command.arg(&frames).args(["-o", "found"]).output().unwrap();
    let calibrated = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), calibrated), (Some(2), said));
    assert!(!folder.path().join("found").exists());
    let ran = touchline(folder.path(), "relocalize pipe.json a.png -o out.json");
    assert_eq!(
        (ran.code, ran.stderr.as_str()),
        (
            2,
            "touchline: cannot read pipe.json: it is a pipe, not a file\n"
        )
    );
}

#[test]
fn the_lens_of_every_frame_travels_without_its_rotation() {
    let folder = tempfile::tempdir().unwrap();
    let before = document(folder.path());
    let ran = touchline(
        folder.path(),
        "export doc.json --format fifa --rotations first -o shot.npz",
    );
    assert_eq!(ran.code, 1, "one frame is not solved: {}", ran.stderr);
    let ran = touchline(
        folder.path(),
        "import shot.npz --format fifa --size 1280x720 -o back.json",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let (_, after, _) = read(&folder.path().join("back.json")).unwrap();
    let solved: Vec<bool> = after
        .frames
        .iter()
        .map(|frame| frame.ptz.is_some())
        .collect();
    assert_eq!(solved, [true, false, false]);
    for (frame, known) in after.frames.iter().zip(&before.frames) {
        let (lens, camera) = (
            frame.lens.as_ref().unwrap(),
            before.ptz_camera(known).unwrap(),
        );
        assert_eq!(
            (lens.focal_px, lens.radial()),
            (camera.ptz().focal_px, camera.lens())
        );
        let video = frame.video.as_ref().unwrap();
        assert!(video.path.ends_with("shot.mp4"), "{}", video.path);
    }
    fs::write(folder.path().join("bad.npz"), "PK\u{3}\u{4}").unwrap();
    let ran = touchline(folder.path(), "import bad.npz --format fifa -o bad.json");
    assert_eq!(
        (ran.code, ran.stderr.lines().count()),
        (2, 1),
        "{}",
        ran.stderr
    );
    assert!(
        ran.stderr
            .contains("bad.npz: not an archive as numpy.savez writes it (.npz)"),
        "{}",
        ran.stderr
    );
}

#[test]
fn pictures_of_unknown_cameras_get_one_each_from_their_lines() {
    let folder = tempfile::tempdir().unwrap();
    let truth = document(folder.path());
    touchline(
        folder.path(),
        "export doc.json --format soccernet-lines --projected -o lines",
    );
    // A picture with a single line: no camera.
    fs::write(
        folder.path().join("lines/little.json"),
        r#"{"Middle line": [{"x": 0.4, "y": 0.2}, {"x": 0.5, "y": 0.9}]}"#,
    )
    .unwrap();
    let ran = touchline(
        folder.path(),
        "import lines --format soccernet-lines --size 1280x720 --each-own-camera -o own.json",
    );
    assert_eq!(ran.code, 1, "one picture has no camera: {}", ran.stderr);
    for wanted in [
        "little.jpg: 2 equations from 1 line, 7 are needed: draw more lines",
        "3 frames with a camera of their own, 1 without one",
    ] {
        assert!(ran.stderr.contains(wanted), "{}", ran.stderr);
    }
    let (_, found, _) = read(&folder.path().join("own.json")).unwrap();
    let worst = apart_px(&truth, &found);
    assert!(worst < 6.0, "{worst} px");
}

#[test]
fn the_number_of_formats_is_stated_as_it_is() {
    let exports = Format::all().filter(|format| format.exports());
    let count = exports.count();
    for file in [
        "CHANGELOG.md",
        "Cargo.toml",
        "README.md",
        "assets/desktop/touchline.metainfo.xml",
        "assets/guide/export.md",
    ] {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
        let words: Vec<&str> = text.split_whitespace().collect();
        for pair in words.windows(2) {
            if let (Ok(stated), true) = (pair[0].parse::<usize>(), pair[1].starts_with("formats")) {
                assert_eq!(stated, count, "{file}");
            }
        }
    }
    // The help is wrapped, so words are compared.
    let help = touchline(Path::new("."), "export --help").stdout;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(help.matches("(an export loses: ").count(), count, "{help}");
}

#[test]
fn an_option_without_effect_is_refused_with_the_formats_that_take_it() {
    let folder = tempfile::tempdir().unwrap();
    document(folder.path());
    let refused = |arguments: &str, wanted: &str| {
        let ran = touchline(folder.path(), arguments);
        assert_eq!(
            (ran.code, ran.stderr.lines().count()),
            (2, 1),
            "{}",
            ran.stderr
        );
        assert!(ran.stderr.contains(wanted), "{}", ran.stderr);
    };
    refused(
        "export doc.json --format json --size 960x540 -o a.json",
        "--size has no effect on json; it is for soccernet, ",
    );
    refused(
        "export doc.json --format colmap --outside drop -o a",
        "--outside has no effect on colmap; it is for coco, label-studio or labelme",
    );
    refused(
        "export doc.json --dataset out --fps 25",
        "--fps has no effect on a dataset; it is for csv, ",
    );
    touchline(folder.path(), "export doc.json --format csv -o cameras.csv");
    refused(
        "import cameras.csv --format csv --annotator anna -o a.json",
        "--annotator has no effect on csv; it is for label-studio",
    );
    let help = touchline(folder.path(), "import --help").stdout;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        help.contains("takes --field --set --images --size --zoom --sensor-mm"),
        "{help}"
    );
}

#[test]
fn what_cannot_be_read_is_counted_and_the_rest_is_imported() {
    let folder = tempfile::tempdir().unwrap();
    document(folder.path());
    touchline(
        folder.path(),
        "export doc.json --format soccernet -o cameras",
    );
    let names: Vec<_> = fs::read_dir(folder.path().join("cameras"))
        .unwrap()
        .collect();
    fs::write(folder.path().join("cameras/camera_9999.json"), "null").unwrap();
    let ran = touchline(folder.path(), "import cameras --json -o back.json");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let wanted = format!(
        "1 of {} files has no camera that can be read: camera_9999.json (",
        names.len() + 1
    );
    let mut lines = ran.stderr.lines();
    let line = lines.find(|line| line.contains(&wanted)).unwrap();
    assert!(line.contains("\"level\":\"failed\""), "{line}");
    assert!(folder.path().join("back.json").exists());
}
