//! `touchline split` and `touchline merge`: work handed out in packages and put together again.

use crate::drawn::draw;
use crate::program::touchline;
use std::fs;
use std::path::Path;
use touchline::camera::PtzCamera;
use touchline::document::{Click, Document, FrameStatus, SolutionSource};
use touchline::geometry::{ImagePoint, Vec3};
use touchline::store::read;
use touchline_documents::testing::{save, solved_by};

fn document(path: &Path) -> Document {
    read(path).unwrap().1
}

/// Clicks a landmark on a frame of the document in a file.
fn click(path: &Path, frame: usize, landmark: &str) {
    let mut document = document(path);
    document.frames[frame].clicks.push(Click::landmark(
        landmark.into(),
        ImagePoint::new(20.0 + frame as f64, 30.0),
    ));
    document.frames[frame].status = FrameStatus::Draft;
    let file = if path.is_dir() {
        path.join("project.json")
    } else {
        path.to_path_buf()
    };
    save(file, &document);
}

#[test]
fn packages_come_back_with_what_was_done_in_them() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    draw(place.path(), "--frames 5 --size 320x180");
    let ran = touchline(place.path(), "split match --frames 2 -o work");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    ran.assert_says("5 frames in 3 packages in work");
    for (package, frame, landmark) in [
        ("work/package001", 1, "centre_mark"),
        ("work/package002", 0, "halfway_far"),
        ("work/package003", 0, "halfway_near"),
    ] {
        let check = touchline(place.path(), &format!("check {package}"));
        assert_eq!(
            check.code, 0,
            "a package is whole by itself: {}",
            check.stdout
        );
        click(&at(package), frame, landmark);
    }
    let ran = touchline(
        place.path(),
        "merge match work/package001 work/package002 work/package003 -o merged",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let mut expected = document(&at("match"));
    for (frame, landmark, at) in [
        (1, "centre_mark", 21.0),
        (2, "halfway_far", 20.0),
        (4, "halfway_near", 20.0),
    ] {
        expected.frames[frame]
            .clicks
            .push(Click::landmark(landmark.into(), ImagePoint::new(at, 30.0)));
        expected.frames[frame].status = FrameStatus::Draft;
    }
    let merged = touchline(place.path(), "solve merged");
    assert_eq!(merged.code, 0);
    let (location, merged, _) = read(&at("merged")).unwrap();
    for (frame, expected) in merged.frames.iter().zip(&expected.frames) {
        assert_eq!(
            (&frame.id, &frame.clicks, frame.status),
            (&expected.id, &expected.clicks, expected.status)
        );
        assert!(
            frame.image_path(location.folder()).unwrap().is_file(),
            "{}",
            frame.name()
        );
        let picture = fs::canonicalize(frame.image_path(location.folder()).unwrap()).unwrap();
        assert!(
            picture.starts_with(fs::canonicalize(at("match")).unwrap()),
            "pictures lie where the base has them"
        );
    }
    let again = touchline(place.path(), "split match --frames 2 -o work");
    assert_eq!(again.code, 2);
    assert!(
        again
            .stderr
            .contains("work holds something already; give an empty or a new folder"),
        "{}",
        again.stderr
    );
}

#[test]
fn what_two_people_did_differently_is_listed_and_neither_is_lost() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    draw(place.path(), "--frames 3 --size 320x180");
    for (name, landmark) in [("a.json", "centre_mark"), ("b.json", "halfway_far")] {
        fs::copy(at("match/project.json"), at("match").join(name)).unwrap();
        click(&at("match").join(name), 1, landmark);
    }
    click(&at("match/b.json"), 2, "halfway_near");
    let ran = touchline(
        place.path(),
        "merge match match/a.json match/b.json -o match/merged.json",
    );
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    ran.assert_says("images/0002.jpg: match/b.json has it otherwise; what came before it stays");
    let merged = document(&at("match/merged.json"));
    let landmark = |document: &Document, frame: usize| {
        document.frames[frame].clicks[0].target.clone().unwrap()
    };
    assert_eq!(
        (landmark(&merged, 1).as_str(), landmark(&merged, 2).as_str()),
        ("centre_mark", "halfway_near")
    );
    let others = document(&at("match/merged.conflicts.json"));
    assert_eq!(
        (others.frames.len(), landmark(&others, 0).as_str()),
        (1, "halfway_far")
    );
}

/// Where the camera of a document stands along the field, m.
fn x_m(document: &Document) -> f64 {
    document.cameras[0].position_m.unwrap().x
}

/// Moves the camera of the document in a file along the field.
fn move_camera(path: &Path, by_m: f64) {
    let mut document = document(path);
    let position_m = document.cameras[0].position_m.unwrap();
    document.cameras[0].position_m = Some(position_m + Vec3::new(by_m, 0.0, 0.0));
    save(path, &document);
}

#[test]
fn of_three_versions_none_loses_its_camera_or_its_frames() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join("match").join(name);
    draw(place.path(), "--frames 3 --size 320x180 --preset easy");
    for (name, landmark, by_m) in [
        ("a.json", "centre_mark", 3.0),
        ("b.json", "halfway_far", 5.0),
        ("c.json", "halfway_near", 7.0),
    ] {
        fs::copy(at("project.json"), at(name)).unwrap();
        click(&at(name), 1, landmark);
        move_camera(&at(name), by_m);
    }
    // One more frame that the second version alone has a camera for, in the base that it gave.
    let mut second = document(&at("b.json"));
    let truth = document(&at("truth.json"));
    let frame = &mut second.frames[2];
    frame.ptz.clone_from(&truth.frames[2].ptz);
    frame.status = FrameStatus::Reference;
    frame.solution = solved_by(SolutionSource::Forest);
    save(at("b.json"), &second);

    let ran = touchline(
        place.path(),
        "merge match match/a.json match/b.json match/c.json -o match/merged.json",
    );
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    for said in [
        "images/0002.jpg: match/c.json has it otherwise; what came before it stays",
        "on the merged base or field: 0 frames solved again, 1 fitted to where their lines were",
        "are in match/merged.conflicts.json, match/merged.conflicts2.json",
    ] {
        ran.assert_says(said);
    }
    let merged = document(&at("merged.json"));
    assert_eq!(x_m(&merged), x_m(&document(&at("a.json"))));
    for (name, version, landmark) in [
        ("merged.conflicts.json", "b.json", "halfway_far"),
        ("merged.conflicts2.json", "c.json", "halfway_near"),
    ] {
        let (others, version) = (document(&at(name)), document(&at(version)));
        assert_eq!(x_m(&others), x_m(&version), "{name}");
        let target = others.frames[0].clicks[0].target.clone().unwrap();
        assert_eq!((others.frames.len(), target.as_str()), (1, landmark));
    }

    // The frame of the second version shows the same place where it was, from the first's base.
    let centre = ImagePoint::new(160.0, 90.0);
    let seen = second.ptz_camera(&second.frames[2]).unwrap();
    let ground = seen.plane_from_image(centre, 0.0).unwrap();
    let now = merged.ptz_camera(&merged.frames[2]).unwrap();
    let [kept, fitted] = [PtzCamera::new(*now.base(), seen.ptz()), now]
        .map(|camera| camera.image_from_world(ground).unwrap().distance_px(centre));
    assert!(fitted < 0.3 * kept, "{fitted} {kept}");
}

/// Writes a comment into a frame of the document in a folder, as the window counts it.
fn comment(folder: &Path, frame: usize, comment: &str) {
    let before = document(folder);
    let mut after = before.clone();
    after.frames[frame].comment = Some(comment.to_owned());
    after.count_edits_since(&before);
    save(folder.join("project.json"), &after);
}

fn comments(document: &Document) -> Vec<&str> {
    let frames = document.frames.iter();
    frames
        .map(|frame| frame.comment.as_deref().unwrap_or(""))
        .collect()
}

/// Copies a project without its pictures.
fn copy_project(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    fs::copy(from.join("project.json"), to.join("project.json")).unwrap();
}

#[test]
fn what_the_owner_did_since_the_split_stays() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    for command in [
        "synth --frames 6 --size 320x180 -o match",
        "split match --frames 3 -o work",
    ] {
        assert_eq!(touchline(place.path(), command).code, 0, "{command}");
    }
    // The owner goes on, in frames of both packages, and the packages are worked on.
    comment(&at("match"), 0, "owner");
    comment(&at("match"), 4, "owner");
    let mut owned = document(&at("match"));
    owned.field.params.insert("length_m".to_owned(), 102.0);
    let project = at("match/project.json");
    save(&project, &owned);
    move_camera(&project, 2.0);
    let moved = x_m(&document(&at("match")));
    comment(&at("work/package001"), 1, "first");
    comment(&at("work/package002"), 1, "second");
    comment(&at("work/package002"), 2, "second");

    let all = "merge match work/package001 work/package002 -o merged.json";
    for command in [
        all,
        "merge match work/package002 work/package001 match -o match --force",
    ] {
        let ran = touchline(place.path(), command);
        assert_eq!(ran.code, 1, "{}", ran.stderr);
        ran.assert_says("1 conflict\n");
        let merged = if command == all {
            "merged.json"
        } else {
            "match"
        };
        let merged = document(&at(merged));
        let wanted = ["owner", "first", "", "", "owner", "second"];
        assert_eq!(comments(&merged), wanted, "{command}");
        assert_eq!(merged.field.params["length_m"], 102.0);
        assert_eq!(x_m(&merged), moved);
    }
    let others = document(&at("merged.conflicts.json"));
    assert_eq!(comments(&others), ["second"]);
    // The packages come a second time, after more was done in one.
    comment(&at("work/package001"), 2, "first again");
    let ran = touchline(place.path(), "merge match work/package001 -o again.json");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let wanted = ["owner", "first", "first again", "", "owner", "second"];
    assert_eq!(comments(&document(&at("again.json"))), wanted);
}

#[test]
fn a_copy_of_an_earlier_state_takes_nothing_back() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    draw(place.path(), "--frames 3 --size 320x180");
    comment(&at("match"), 0, "first");
    copy_project(&at("match"), &at("copy"));
    comment(&at("match"), 1, "today");
    let ran = touchline(place.path(), "merge match match copy -o merged.json");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let merged = document(&at("merged.json"));
    assert_eq!(comments(&merged), ["first", "today", ""]);
    // What was done in the copy is named, where the project has as much or more.
    comment(&at("copy"), 1, "in the copy");
    comment(&at("copy"), 2, "in the copy");
    let ran = touchline(place.path(), "merge match copy -o merged.json --force");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let merged = document(&at("merged.json"));
    assert_eq!(comments(&merged), ["first", "today", "in the copy"]);
    let others = document(&at("merged.conflicts.json"));
    assert_eq!(comments(&others), ["in the copy"]);
}

#[test]
fn a_package_of_another_match_is_refused() {
    let place = tempfile::tempdir().unwrap();
    for (name, seed) in [("north", 1), ("south", 2)] {
        for command in [
            format!("synth --frames 2 --size 320x180 --seed {seed} -o {name}"),
            format!("split {name} --frames 1 -o work-{name}"),
        ] {
            assert_eq!(touchline(place.path(), &command).code, 0, "{command}");
        }
    }
    let ran = touchline(
        place.path(),
        "merge north work-north/package001 work-south/package002 -o merged.json",
    );
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(
        ran.stderr
            .contains("package002: 1 of 1 pictures are others")
            && ran.stderr.contains("images/0002.jpg"),
        "{}",
        ran.stderr
    );
    assert!(!place.path().join("merged.json").exists());
}
