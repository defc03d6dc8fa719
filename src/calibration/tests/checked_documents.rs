//! Documents that can be read, and what `check` says of their values and pictures.

use crate::bad_documents::SAMPLE;
use std::fs;
use std::path::Path;
use touchline_calibration::calibrate::{Problem, check_pictures, check_values};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::progress::Progress;
use touchline_documents::document::{Click, Document, FrameStatus, document_from_bytes};
use touchline_documents::testing::{new_frame, soccer_document};

/// A sound document, broken by `change`, and what `check` says of it.
fn problems(change: impl FnOnce(&mut Document)) -> Vec<String> {
    let mut document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    change(&mut document);
    check_values(document.at(Path::new("")))
        .iter()
        .map(Problem::to_string)
        .collect()
}

#[test]
fn a_sound_document_has_no_problems() {
    assert_eq!(problems(|_| {}), Vec::<String>::new());
}

#[test]
fn check_names_everything_that_is_wrong() {
    type Change = fn(&mut Document);
    let table: &[(Change, &str)] = &[
        (
            |d| d.frames[1].image = Some("images/0001.jpg".into()),
            "frames[1] (images/0001.jpg): the same picture as frames[0]; remove one",
        ),
        (
            |d| d.frames[1] = d.frames[0].clone(),
            "frames[1] (images/0001.jpg): the same picture as frames[0]; remove one",
        ),
        (
            |d| d.frames[1].image = None,
            "frames[1] (a frame without a picture): has neither an image nor a video",
        ),
        (
            |d| d.frames[2].camera = "third".into(),
            "frames[2] (/elsewhere/0003.jpg): its camera \"third\" is not in the document",
        ),
        (
            |d| d.frames[2].camera = "main".into(),
            "frames[2] (/elsewhere/0003.jpg): 1280 × 720 px where its camera has 1920 × 1080 px; assign it to a camera of its own size",
        ),
        (
            |d| d.cameras[1].id = "main".into(),
            "camera main: another camera has this name too; rename one | frames[2] (/elsewhere/0003.jpg): its camera \"second\" is not in the document",
        ),
        (
            |d| d.cameras[0].position_m = None,
            "camera main: position_m is missing, so the base is not known",
        ),
        (
            |d| d.cameras[0].base_from_world = None,
            "camera main: base_from_world is missing, so the base is not known",
        ),
        (
            |d| d.cameras[0].position_m.as_mut().unwrap().x = f64::NAN,
            "camera main: the base is not a finite number; enter it again",
        ),
        (
            |d| d.cameras[0].principal_point.y = f64::INFINITY,
            "camera main: the base is not a finite number; enter it again | camera main: principal_point_px is not a finite number; enter it again",
        ),
        (
            |d| d.cameras[0].masks[0].width = 0.0,
            "camera main: mask 1 covers no pixel of the picture",
        ),
        (
            |d| d.frames[0].masks[0].x = 1920.0,
            "frames[0] (images/0001.jpg): mask 1 covers no pixel of the picture",
        ),
        (
            |d| {
                _ = d.cameras[0]
                    .distortion
                    .as_mut()
                    .unwrap()
                    .extra
                    .insert("k2".into(), 0.1.into());
            },
            "camera main: distortion.k2 is not used by this program; overlays are computed without it",
        ),
        (
            |d| {
                d.cameras[0]
                    .distortion
                    .as_mut()
                    .unwrap()
                    .k1
                    .as_mut()
                    .unwrap()
                    .value = -3.0;
            },
            "frames[0] (images/0001.jpg): with k1 = -2.9139 the lens model folds inside the picture; check the distortion",
        ),
        (
            |d| d.field.template = "quidditch".into(),
            "field: no field template is named \"quidditch\"; built in are soccer, futsal, basketball_fiba, basketball_nba, basketball_ncaa, ice_hockey_iihf, ice_hockey_nhl, american_football_nfl, american_football_ncaa, tennis, volleyball, handball, badminton, pickleball, padel, beach_volleyball, field_hockey, rugby_union, squash; a template of your own is given as a path ending in .json",
        ),
        (
            |d| _ = d.field.params.insert("length_m".into(), 12.0),
            "field: soccer field: length_m = 12 is outside 90 to 120 (IFAB Law 1.3: 90 to 120 m; 105 m recommended by UEFA and FIFA)",
        ),
        (
            |d| _ = d.field.params.insert("depth_m".into(), 1.0),
            "field: the field template \"soccer\" takes no parameter \"depth_m\"; it takes length_m, width_m",
        ),
        (
            |d| {
                d.frames[0].clicks[1] =
                    Click::landmark("center_mark".into(), ImagePoint::new(1.0, 2.0));
            },
            "frames[0] (images/0001.jpg): click 2 names the landmark \"center_mark\", which the field does not have; `touchline fields` lists them",
        ),
        (
            |d| {
                d.frames[0].clicks[0] =
                    Click::line("halfwayline".into(), ImagePoint::new(1.0, 2.0));
            },
            "frames[0] (images/0001.jpg): click 1 names the line \"halfwayline\", which the field does not have; `touchline fields` lists them",
        ),
        (
            |d| d.frames[0].clicks[0].target = None,
            "frames[0] (images/0001.jpg): click 1 has no name yet; name it or delete it",
        ),
        (
            |d| {
                d.frames[0].clicks[1] =
                    Click::landmark("centre_mark".into(), ImagePoint::new(1.0, 2.0));
            },
            "frames[0] (images/0001.jpg): clicks 1 and 2 both name the landmark \"centre_mark\"; delete one",
        ),
        (
            |d| d.frames[0].clicks[0].image.x = -3.25,
            "frames[0] (images/0001.jpg): click 1 at (-3.25, 789.18) lies outside the picture of 1920 × 1080 px",
        ),
        (
            |d| d.frames[0].clicks[0].image.x = f64::NAN,
            "frames[0] (images/0001.jpg): click 1 is not a finite number; enter it again",
        ),
        (
            |d| d.frames[0].ptz = None,
            "frames[0] (images/0001.jpg): is reference but has no ptz; solve it",
        ),
        (
            |d| d.frames[0].ptz.as_mut().unwrap().focal_px = f64::NAN,
            "frames[0] (images/0001.jpg): ptz is not a finite number; enter it again",
        ),
        (
            |d| d.frames[2].status = FrameStatus::Suggested,
            "frames[2] (/elsewhere/0003.jpg): is suggested but has no ptz; solve it",
        ),
        (
            |d| d.frames[1].reason = None,
            "frames[1] (images/0002.jpg): is rejected without a reason",
        ),
        (
            |d| d.frames[0].solution.as_mut().unwrap().disputed.push(3),
            "frames[0] (images/0001.jpg): its solution refers to click 4, but there are 3; solve it again",
        ),
    ];
    let mut wrong = Vec::new();
    for (row, (change, expected)) in table.iter().enumerate() {
        let said = problems(change).join(" | ");
        if said != *expected {
            wrong.push(format!("{row} {said:?}"));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// Writes a PNG of one colour.
fn picture(path: &Path, width: u32, height: u32, grey: u8) {
    image::GrayImage::from_pixel(width, height, image::Luma([grey]))
        .save(path)
        .unwrap();
}

#[test]
fn check_looks_at_the_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, width) in [("good.png", 64), ("small.png", 32), ("changed.png", 64)] {
        picture(&folder.join(name), width, 48, 9);
    }
    fs::write(folder.join("damaged.png"), b"\x89PNG\r\n\x1a\n____").unwrap();
    let mut document = soccer_document();
    let names = [
        "good.png",
        "missing.png",
        "small.png",
        "changed.png",
        "damaged.png",
    ];
    let frame = |name: &&str| new_frame(name, ImageSize::new(64, 48));
    document.frames = names.iter().map(|name| frame(name).into()).collect();
    document.frames[0].sha256 = Some(
        touchline_vision::media::sha256_of_file(&folder.join("good.png"))
            .unwrap()
            .to_uppercase(),
    );
    document.frames[3].sha256 = Some("0".repeat(64));
    let problems = check_pictures(document.at(folder), &Progress::default());
    let codes: Vec<_> = problems
        .iter()
        .map(|problem| (problem.frame.unwrap(), problem.fault.code()))
        .collect();
    let expected = [
        (1, "missing_picture"),
        (2, "picture_size"),
        (3, "picture_changed"),
        (4, "unreadable_picture"),
    ];
    assert_eq!(codes, expected);
    let size = "frames[2] (small.png): the picture is 32 × 48 px, the document says 64 × 48 px; it is not the one that was labelled";
    assert_eq!(problems[1].to_string(), size);
}
