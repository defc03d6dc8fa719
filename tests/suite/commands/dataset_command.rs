//! `touchline export --dataset`: a folder that others can use, and nothing half-written.

use crate::program::touchline;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use touchline::camera::Ptz;
use touchline::document::{
    Camera, Click, Clip, Document, Extra, FramePtz, FrameStatus, Shot, ShotEnd, ShotKind, Solution,
    SolutionSource, VideoFrame,
};
use touchline::geometry::ImageSize;
use touchline::store::read;
use touchline_core::testing::{TestBase, base_at, landmark_in, soccer};
use touchline_documents::testing::{match_from, new_frame, save};

const SIZE: ImageSize = ImageSize::new(160, 90);

/// Twelve references in four clips with pictures, a suggestion, a rejected frame and one without a
/// label, as `doc.json`.
fn document(folder: &Path) -> Document {
    document_of(folder, SIZE)
}

/// The same with pictures of another size.
fn document_of(folder: &Path, size: ImageSize) -> Document {
    let field = soccer();
    let mut document = match_from(&base_at([1.0, -58.0, 16.0], size).bent(-0.1), size);
    fs::create_dir_all(folder.join("images")).unwrap();
    for index in 0..15_u8 {
        let name = format!("images/{index:04}.jpg");
        let shade = |x: u32, y: u32| image::Rgb([(x + u32::from(index)) as u8, (2 * y) as u8, 40]);
        image::RgbImage::from_fn(size.width, size.height, shade)
            .save(folder.join(&name))
            .unwrap();
        let mut frame = new_frame(&name, size);
        frame.clip = Some(Clip::Number(i64::from(index / 3)));
        frame.status = match index {
            12 => FrameStatus::Suggested,
            13 => FrameStatus::Rejected,
            _ => FrameStatus::Reference,
        };
        let ptz = Ptz::from_degrees(f64::from(index) - 6.0, -14.0, 180.0);
        frame.ptz = (index < 13).then(|| FramePtz::new(ptz, None));
        let source = if index == 11 || index == 12 {
            SolutionSource::Forest
        } else {
            SolutionSource::Clicks
        };
        frame.solution = Some(Solution {
            source: Some(source),
            rms_px: Some(0.5),
            ..Solution::default()
        });
        if let Some(camera) = document.cameras[0].ptz_camera(&frame) {
            for name in ["centre_mark", "halfway_far"] {
                let at = landmark_in(&camera, &field, name);
                frame.clicks.push(Click {
                    check: name == "halfway_far",
                    ..Click::landmark(name.into(), at)
                });
            }
        }
        document.frames.push(frame.into());
    }
    save(folder.join("doc.json"), &document);
    document
}

/// Every file below a folder and its bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path
                    .strip_prefix(folder)
                    .unwrap()
                    .to_string_lossy()
                    .replace('\\', "/");
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

fn text(files: &BTreeMap<String, Vec<u8>>, name: &str) -> String {
    String::from_utf8(files[name].clone()).unwrap()
}

#[test]
fn a_dataset_is_whole_and_says_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let document = document(folder.path());
    let command = "export doc.json --dataset out/set --split 2/1/1 --seed 3 --undistorted --licence CC-BY-4.0";
    fs::create_dir(folder.path().join("out")).unwrap();
    let ran = touchline(folder.path(), command);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    ran.assert_says("images/0014.jpg: it has neither clicks nor a camera");
    ran.assert_says("12 frames (train 6, validation 3, test 3) and 24 pictures in out/set");
    let written = files(&folder.path().join("out/set"));
    let listed: BTreeMap<String, String> = text(&written, "manifest.sha256")
        .lines()
        .map(|line| {
            line.split_once("  ")
                .map(|(hash, name)| (name.to_owned(), hash.to_owned()))
                .unwrap()
        })
        .collect();
    assert_eq!(
        listed.len() + 1,
        written.len(),
        "every file but the manifest is listed"
    );
    for (name, hash) in &listed {
        let digits: Vec<String> = Sha256::digest(&written[name])
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        assert_eq!(digits.concat(), *hash, "{name}");
    }
    let (_, dataset, _) = read(&folder.path().join("out/set/dataset.json")).unwrap();
    for frame in &dataset.frames {
        let original = document.frames.by_id(&frame.id).unwrap();
        assert_eq!(
            (&frame.clicks, &frame.ptz),
            (&original.clicks, &original.ptz),
            "raw clicks and cameras stay"
        );
        let image = frame.image.as_deref().unwrap();
        assert_eq!(
            written[image],
            fs::read(folder.path().join(original.image.as_deref().unwrap())).unwrap()
        );
        assert_eq!(
            Path::new(image).file_name(),
            Path::new(original.image.as_deref().unwrap()).file_name()
        );
        assert_eq!(frame.sha256.as_ref(), listed.get(image));
    }
    let table = text(&written, "frames.csv");
    let of = |label: &str| {
        table
            .lines()
            .filter(|line| line.split(',').nth(2) == Some(label))
            .count()
    };
    assert_eq!((of("clicked"), of("suggested_and_accepted")), (11, 1));
    let clips: BTreeMap<&str, Vec<&str>> =
        table
            .lines()
            .skip(1)
            .fold(BTreeMap::new(), |mut clips, line| {
                let fields: Vec<&str> = line.split(',').collect();
                clips.entry(fields[6]).or_default().push(fields[1]);
                clips
            });
    assert!(
        clips
            .values()
            .all(|splits| splits.iter().all(|split| *split == splits[0])),
        "{clips:?}"
    );
    assert_eq!(text(&written, "splits/test.txt").lines().count(), 3);
    let card = text(&written, "README.md");
    for wanted in [
        "| frames | 12 |",
        "105 × 68 m, crown 0 m; its size is **assumed**",
        "| suggested_and_accepted | 1 |",
        "| clicks on landmarks from the camera's overlay | median 0.00 px, 95 % below 0.00 px, largest 0.00 px; known in 12 of 12 |",
        "| confidence (overlay within 10 px at 1920 px width) | not known in any of 12 |",
        "| images | 12 |",
        "Split 2 : 1 : 1 by clip, which is never split; seed 3.",
        "## Licence\n\nCC-BY-4.0",
    ] {
        assert!(card.contains(wanted), "{wanted}\n{card}");
    }
    let (_, plain, _) = read(&folder.path().join("out/set/undistorted/dataset.json")).unwrap();
    assert_eq!(plain.frames.len(), 12);
    for frame in &plain.frames {
        let camera = plain.ptz_camera(frame).unwrap();
        assert!(camera.lens().is_none());
        let field = soccer();
        let landmark = field
            .landmarks
            .iter()
            .find(|landmark| landmark.id.as_str() == "centre_mark")
            .unwrap();
        let shown = camera
            .image_from_world(field.landmark_in_world(landmark))
            .unwrap();
        assert!(
            shown.distance_px(frame.clicks[0].image) < 1e-9,
            "clicks lie where the plain camera shows them"
        );
        assert!(written.contains_key(&format!("undistorted/{}", frame.image.as_deref().unwrap())));
    }
}

#[test]
fn the_same_input_gives_the_same_bytes_and_nothing_is_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    document(folder.path());
    let export = |rest: &str| {
        touchline(
            folder.path(),
            &format!("export doc.json --split 80/10/10 {rest}"),
        )
    };
    assert_eq!(export("--dataset a").code, 1);
    assert_eq!(export("--dataset b").code, 1);
    assert_eq!(
        files(&folder.path().join("a")),
        files(&folder.path().join("b"))
    );
    let again = export("--dataset a");
    assert_eq!(again.code, 2);
    assert_eq!(
        again.stderr.lines().last().unwrap(),
        "touchline: a already exists; give --force to replace it, or another -o"
    );
    fs::write(folder.path().join("a/own.txt"), "mine").unwrap();
    let refused = export("--dataset a --force");
    assert_eq!(refused.code, 2);
    assert!(
        refused
            .stderr
            .contains("a holds own.txt, which would be lost; move it away"),
        "{}",
        refused.stderr
    );
    fs::remove_file(folder.path().join("a/own.txt")).unwrap();
    // A picture that the next dataset leaves out goes, unless somebody changed it.
    fs::write(folder.path().join("a/images/test/note.txt"), "mine").unwrap();
    assert_eq!(export("--dataset a --force").code, 2);
    fs::remove_file(folder.path().join("a/images/test/note.txt")).unwrap();
    assert_eq!(export("--dataset a --force --seed 7").code, 1);
    fs::create_dir(folder.path().join("home")).unwrap();
    fs::write(folder.path().join("home/own.txt"), "mine").unwrap();
    let refused = export("--dataset home --force");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains(
        "home contains something other than a dataset of this program; give another folder"
    ));
    assert_eq!(
        fs::read_to_string(folder.path().join("home/own.txt")).unwrap(),
        "mine"
    );
    let left = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut left: Vec<String> = left.collect();
    left.sort();
    assert_eq!(
        left,
        ["a", "b", "doc.json", "home", "images"],
        "nothing temporary is left"
    );
}

#[test]
#[cfg(unix)]
fn ctrl_c_stops_the_export_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    document_of(folder.path(), ImageSize::new(1920, 1080));
    let entries = || fs::read_dir(folder.path()).unwrap().count();
    let before = entries();
    let child = std::process::Command::new(env!("CARGO_BIN_EXE_touchline"))
        .args(["export", "doc.json", "--dataset", "set", "--undistorted"])
        .current_dir(folder.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    while entries() == before {
        std::thread::yield_now();
    }
    assert!(
        std::process::Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .status()
            .unwrap()
            .success()
    );
    let ended = child.wait_with_output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(130), "{said}");
    assert_eq!(
        said.lines().last(),
        Some("touchline: stopped; nothing was written")
    );
    assert_eq!(entries(), before, "nothing is left, also nothing temporary");
}

#[test]
fn frames_and_pictures_are_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = document(folder.path());
    let ran = touchline(
        folder.path(),
        "export doc.json --dataset linked --status suggested,reference --images link",
    );
    ran.assert_says("1 frame with a camera that has not been reviewed");
    ran.assert_says("13 frames and 13 pictures in linked");
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let inode = |path: &str| fs::metadata(folder.path().join(path)).unwrap().ino();
        assert_eq!(inode("linked/images/0003.jpg"), inode("images/0003.jpg"));
    }
    let ran = touchline(
        folder.path(),
        "export doc.json --dataset left --images none",
    );
    ran.assert_says("12 frames and 0 pictures in left");
    let (_, left, _) = read(&folder.path().join("left/dataset.json")).unwrap();
    assert_eq!(left.frames[0].image.as_deref(), Some("../images/0000.jpg"));
    let ran = touchline(
        folder.path(),
        "export doc.json --dataset anew --images extract --image-format png",
    );
    ran.assert_says("12 frames and 12 pictures in anew");
    let pixels = |path: &str| image::open(folder.path().join(path)).unwrap().into_rgb8();
    assert_eq!(pixels("anew/images/0003.png"), pixels("images/0003.jpg"));
    let ran = touchline(
        folder.path(),
        "export doc.json --dataset smaller --images extract --image-format jpg",
    );
    ran.assert_says("12 frames and 12 pictures in smaller");
    assert!(folder.path().join("smaller/images/0003.jpg").is_file());
    // A picture that is not the one that was labelled, one that is gone, and two of one name.
    document.frames[0].sha256 = Some("00".repeat(32));
    fs::remove_file(folder.path().join("images/0001.jpg")).unwrap();
    save(folder.path().join("doc.json"), &document);
    let ran = touchline(folder.path(), "export doc.json --dataset some");
    ran.assert_says("images/0000.jpg: its picture changed since it was labelled");
    ran.assert_says("images/0001.jpg: ");
    ran.assert_says("10 frames and 10 pictures in some");
    assert!(!folder.path().join("some/images/0000.jpg").exists());
    for (number, options) in [
        "--images extract",
        "--images none",
        "--images none --undistorted",
    ]
    .iter()
    .enumerate()
    {
        let ran = touchline(
            folder.path(),
            &format!("export doc.json --dataset changed{number} {options}"),
        );
        let says = "images/0000.jpg: its picture changed since it was labelled";
        assert!(ran.stderr.contains(says), "{options}: {}", ran.stderr);
        let (_, written, _) =
            read(&folder.path().join(format!("changed{number}/dataset.json"))).unwrap();
        assert!(
            written.frames.by_id(&document.frames[0].id).is_none(),
            "{options}"
        );
    }
    let other = folder.path().join("other");
    fs::create_dir(&other).unwrap();
    fs::copy(
        folder.path().join("images/0002.jpg"),
        other.join("0002.jpg"),
    )
    .unwrap();
    document.frames[3].image = Some(other.join("0002.jpg").to_string_lossy().into_owned());
    save(folder.path().join("doc.json"), &document);
    let ran = touchline(folder.path(), "export doc.json --dataset twice");
    assert_eq!(ran.code, 2);
    ran.assert_says("would both be written as images/0002.jpg");
    assert!(!folder.path().join("twice").exists());
}

#[test]
fn pictures_from_outside_of_the_project_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("project");
    fs::create_dir(&project).unwrap();
    let mut document = document(&project);
    fs::rename(
        project.join("images/0001.jpg"),
        folder.path().join("private.jpg"),
    )
    .unwrap();
    document.frames[1].image = Some("../private.jpg".to_owned());
    save(project.join("doc.json"), &document);
    let ran = touchline(&project, "export doc.json --dataset set");
    let says = "private.jpg lies outside of the project; --outside-pictures takes it too";
    assert!(ran.code == 1 && ran.stderr.contains(says), "{}", ran.stderr);
    ran.assert_says("11 frames and 11 pictures in set");
    assert!(!project.join("set/images/private.jpg").exists());
    let ran = touchline(&project, "export doc.json --dataset all --outside-pictures");
    ran.assert_says("1 picture from outside of the project, the first is ");
    assert!(project.join("all/images/private.jpg").is_file());
    // What is only named is not taken along.
    let ran = touchline(&project, "export doc.json --dataset named --images none");
    ran.assert_says("12 frames and 0 pictures in named");
}

#[test]
fn shots_of_another_video_stay_behind() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = document(folder.path());
    document.cameras.push(
        Camera {
            id: "second".into(),
            ..(*document.cameras[0]).clone()
        }
        .into(),
    );
    for (index, frame) in document.frames.iter_mut().enumerate() {
        let (video, camera) = if index < 6 {
            ("a.mp4", "main")
        } else {
            ("b.mp4", "second")
        };
        frame.video = Some(VideoFrame::new(video, index as u64, None));
        (frame.image, frame.camera) = (None, camera.into());
    }
    // Bare numbers count in the first video.
    let ends = |from, to| (ShotEnd::VideoFrame(from), ShotEnd::VideoFrame(to));
    for (from, to) in [ends(0, 2), ends(3, 5)] {
        document.shots.push(Shot {
            from,
            to,
            camera: None,
            kind: ShotKind::Cut,
            content: None,
            extra: Extra::new(),
        });
    }
    save(folder.path().join("doc.json"), &document);
    for (camera, shots) in [("main", 2), ("second", 0)] {
        let ran = touchline(
            folder.path(),
            &format!("export doc.json --dataset {camera} --camera {camera} --images none"),
        );
        assert!(ran.code < 2, "{}", ran.stderr);
        let (_, dataset, _) = read(&folder.path().join(camera).join("dataset.json")).unwrap();
        assert_eq!(dataset.shots.len(), shots, "{camera}");
    }
}

#[test]
fn wrong_usage_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    document(folder.path());
    for (arguments, wanted) in [
        (
            "export doc.json --dataset a --format csv",
            "the argument '--dataset <DIR>' cannot be used with '--format <FORMAT>'",
        ),
        (
            "export doc.json --dataset a --split half",
            "half is no shares of training, validation and test such as 80/10/10",
        ),
        (
            "export doc.json --dataset a --images move",
            "[possible values: copy, link, extract, none]",
        ),
        (
            "export doc.json --format csv --start 25:00",
            "25:00 is no timecode such as 10:00:00:00 or 10:00:00;00",
        ),
        (
            "export doc.json --dataset a --status draft",
            "no frame for the dataset: none has the requested status",
        ),
    ] {
        let ran = touchline(folder.path(), arguments);
        ran.assert_refused(2);
        ran.assert_says(wanted);
    }
    assert!(!folder.path().join("a").exists());
}
