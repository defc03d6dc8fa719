//! Two annotators on the same frames, and one annotator twice: the reported click noise is the
//! simulated one.

use crate::program::touchline;
use rand_pcg::Pcg64Mcg;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use touchline::calibrate::{ENOUGH_REPEATS, FrameLookup, OwnNoise, calibrate, check_values};
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::document::{
    Click, Document, Fields, FramePtz, FrameStatus, Repeat, StoredClickNoise, document_from_bytes,
    document_to_string,
};
use touchline::evaluate::{Agreement, agreement};
use touchline::geometry::{ImagePoint, ImageSize};
use touchline::markings::project_landmarks;
use touchline::store::{Location, write_document};
use touchline_core::testing::seeded::{normal, rng};
use touchline_core::testing::{soccer, turned_base};
use touchline_documents::testing::{match_from, new_frame};

/// Half of 1920 px: what is said in px at 1920 px width is twice as much.
const SIZE: ImageSize = ImageSize::new(960, 540);

fn base() -> CameraBase {
    turned_base([1.0, -60.0, 18.0], [0.0, -1.0, 0.0], SIZE)
}

/// Frames of a wide pan, each with up to five landmarks clicked where the truth has them, with
/// click noise of this sigma.
fn clicked_frames(frames: usize, sigma_px: f64, rng: &mut Pcg64Mcg) -> Document {
    let field = soccer();
    let mut document = match_from(&base(), SIZE);
    for index in 0..frames {
        let ptz = Ptz::from_degrees(-35.0 + 70.0 * index as f64 / frames as f64, -12.0, 1000.0);
        let mut frame = new_frame(&format!("images/{index:03}.jpg"), SIZE);
        frame.status = FrameStatus::Reference;
        frame.ptz = Some(FramePtz::new(ptz, None));
        for shown in project_landmarks(&field, &PtzCamera::new(base(), ptz), SIZE, 0.0) {
            let landmark = &field.landmarks[shown.landmark];
            if landmark.nominal_m.z == 0.0 && frame.clicks.len() < 5 {
                let at = jitter(shown.image, sigma_px, rng);
                frame.clicks.push(Click::landmark(landmark.id.clone(), at));
            }
        }
        document.frames.push(frame.into());
    }
    document
}

fn jitter(at: ImagePoint, sigma_px: f64, rng: &mut Pcg64Mcg) -> ImagePoint {
    ImagePoint::new(at.x + sigma_px * normal(rng), at.y + sigma_px * normal(rng))
}

/// The same document labelled by somebody else, with this click noise about the same spots.
fn by_another(
    document: &Document,
    truth: &Document,
    sigma_px: f64,
    rng: &mut Pcg64Mcg,
) -> Document {
    let mut other = document.clone();
    for (frame, exact) in other.frames.iter_mut().zip(&truth.frames) {
        for (click, exact) in frame.clicks.iter_mut().zip(&exact.clicks) {
            click.image = jitter(exact.image, sigma_px, rng);
        }
    }
    other
}

fn agreement_of(first: &Document, second: &Document) -> Agreement {
    agreement(first.at(Path::new("/no/a")), second.at(Path::new("/no/b"))).unwrap()
}

#[test]
fn click_noise_is_recovered_from_two_annotators() {
    let mut rng = rng("click_noise_is_recovered_from_two_annotators");
    let truth = clicked_frames(40, 0.0, &mut rng);
    for sigma_px in [0.4, 1.5] {
        let one = by_another(&truth, &truth, sigma_px, &mut rng);
        let found = agreement_of(&one, &by_another(&truth, &truth, sigma_px, &mut rng));
        let noise = found.noise.unwrap();
        let [low, high] = noise.interval_95;
        assert!(
            low < 2.0 * sigma_px && 2.0 * sigma_px < high && high < 1.3 * low,
            "{noise:?} {sigma_px}"
        );
        assert!(
            (found.distances.unwrap().median / (2.0 * sigma_px) - 1.665).abs() < 0.25,
            "of a Rayleigh variable"
        );
        assert!(
            found
                .noise_by_axis
                .iter()
                .all(|noise| (noise.unwrap().sigma / sigma_px - 2.0).abs() < 0.4)
        );
        assert!(
            found.frames.iter().all(
                |frame| frame.names.is_empty() && frame.cameras.unwrap().worst_corner_px < 1e-6
            )
        );
        assert!(
            found
                .landmarks
                .iter()
                .any(|landmark| landmark.noise.is_some())
        );
    }
}

#[test]
fn agreement_reports_name_disputes_lone_frames_and_copies() {
    let mut rng = rng("agreement_reports_name_disputes_lone_frames_and_copies");
    let truth = clicked_frames(12, 0.0, &mut rng);
    let copies: usize = truth.frames.iter().map(|frame| frame.clicks.len()).sum();
    let found = agreement_of(&truth, &truth);
    assert_eq!(
        (found.copies, found.noise, found.says_something()),
        (copies, None, false)
    );

    let mut other = by_another(&truth, &truth, 0.5, &mut rng);
    // Near and far exchanged in one frame.
    for click in &mut other.frames[3].clicks {
        let name = click.target.as_ref().unwrap().as_str();
        let twin = if name.contains("near") {
            name.replace("near", "far")
        } else {
            name.replace("far", "near")
        };
        *click = Click::landmark(twin.as_str().into(), click.image);
    }
    other.frames[5].clicks.clear();
    other.frames[6].status = FrameStatus::Rejected;
    other.frames[5].status = FrameStatus::New;
    other.frames.remove(7);
    other.frames[4].ptz.as_mut().unwrap().pan_deg += 0.5;
    let found = agreement_of(&truth, &other);
    let named: Vec<(&str, usize)> = found
        .frames
        .iter()
        .filter(|frame| !frame.names.is_empty())
        .map(|frame| (&*frame.name, frame.names.len()))
        .collect();
    let twins = truth.frames[3].clicks.iter().filter(|click| {
        let name = click.target.as_ref().unwrap().as_str();
        name.contains("near") || name.contains("far")
    });
    assert_eq!(named, [("images/003.jpg", twins.count())]);
    let lone: Vec<(&str, bool, bool)> = found
        .lone
        .iter()
        .map(|lone| (&*lone.name, lone.by_first, lone.rejected))
        .collect();
    let expected = [
        ("images/005.jpg", true, false),
        ("images/006.jpg", true, true),
        ("images/007.jpg", true, false),
    ];
    assert_eq!(lone, expected);
    let cameras = found
        .frames
        .iter()
        .find(|frame| frame.name == "images/004.jpg")
        .unwrap()
        .cameras
        .unwrap();
    assert!((cameras.pan.degrees() - 0.5).abs() < 1e-9 && cameras.tilt.degrees().abs() < 1e-9);
    // Half a degree at 1000 px is 8.7 px, twice that at 1920 px width.
    assert!(
        (17.0..25.0).contains(&cameras.worst_corner_px),
        "{cameras:?}"
    );
}

#[test]
fn evaluate_says_how_two_annotators_agree() {
    let mut rng = rng("evaluate_says_how_two_annotators_agree");
    let truth = clicked_frames(12, 0.0, &mut rng);
    let folder = tempfile::tempdir().unwrap();
    for (name, document) in [
        ("a.json", &by_another(&truth, &truth, 1.0, &mut rng)),
        ("b.json", &by_another(&truth, &truth, 1.0, &mut rng)),
        ("exact.json", &truth),
    ] {
        write_document(
            &Location::for_new_document(&folder.path().join(name)).unwrap(),
            document,
            false,
        )
        .unwrap();
    }
    let ran = touchline(folder.path(), "evaluate a.json b.json").done();
    let report: Value = serde_json::from_str(&ran.stdout).unwrap();
    let noise = &report["agreement"]["one_annotator"];
    let ends: Vec<f64> = noise["interval_95_px"]
        .as_array()
        .unwrap()
        .iter()
        .map(|end| end.as_f64().unwrap())
        .collect();
    assert!(ends[0] < 2.0 && 2.0 < ends[1], "{noise}");
    let ran = touchline(folder.path(), "evaluate a.json b.json --table");
    assert!(
        ran.stdout.contains("Two annotators:")
            && ran.stdout.contains("Click noise of one annotator:"),
        "{}",
        ran.stdout
    );
    let ran = touchline(folder.path(), "evaluate exact.json exact.json");
    assert!(
        !ran.stdout.contains("agreement"),
        "copies are no second annotator"
    );
}

/// Every landmark of the first frames clicked again, blind, with this click noise about the true
/// spots.
fn repeat(
    document: &mut Document,
    truth: &Document,
    frames: usize,
    sigma_px: f64,
    rng: &mut Pcg64Mcg,
) {
    let round = document.next_round();
    for (frame, exact) in document.frames.iter_mut().zip(&truth.frames).take(frames) {
        let ids: Vec<_> = frame.landmarks_to_repeat().cloned().collect();
        for (id, exact) in ids.into_iter().zip(&exact.clicks) {
            frame
                .repeats
                .push(Repeat::new(id, jitter(exact.image, sigma_px, rng), round));
        }
    }
}

fn own(document: &Document) -> OwnNoise {
    OwnNoise::estimate(document.at(Path::new("."))).unwrap()
}

#[test]
fn repeats_give_the_click_noise_and_a_usual_one_changes_nothing() {
    let mut rng = rng("repeats_give_the_click_noise_and_a_usual_one_changes_nothing");
    let truth = clicked_frames(40, 0.0, &mut rng);
    assert_eq!(own(&truth), OwnNoise::default());
    let sigma_px = 0.6;
    let mut document = by_another(&truth, &truth, sigma_px, &mut rng);
    repeat(&mut document, &truth, 2, sigma_px, &mut rng);
    let few = own(&document);
    assert!(
        few.repeats < ENOUGH_REPEATS && few.click_noise.is_none() && few.missing() > 0,
        "{few:?}"
    );
    repeat(&mut document, &truth, 40, sigma_px, &mut rng);
    repeat(&mut document, &truth, 40, sigma_px, &mut rng);
    let found = own(&document);
    let noise = found.noise.unwrap();
    let [low, high] = noise.interval_95;
    assert!(low < 1.2 && 1.2 < high && high < 1.25 * low, "{noise:?}");

    // The usual click noise: half of the template's variance.
    let stated: BTreeMap<String, f64> = soccer()
        .landmarks
        .iter()
        .map(|landmark| (landmark.id.to_string(), landmark.click_sigma_px))
        .collect();
    let mut usual = truth.clone();
    for round in 1..=4 {
        for (frame, exact) in usual.frames.iter_mut().zip(&truth.frames) {
            for click in &exact.clicks {
                let id = click.target.as_ref().unwrap().as_str();
                let at = jitter(click.image, 0.5 * stated[id] * 0.5_f64.sqrt(), &mut rng);
                frame.repeats.push(Repeat::new(id.into(), at, round));
            }
        }
    }
    for frame in &mut usual.frames {
        frame.clicks.clear();
    }
    let noise = own(&usual).click_noise.unwrap();
    assert!((noise.factor - 1.0).abs() < 0.08, "{noise:?}");
    assert!(
        noise
            .factor_by_landmark
            .values()
            .all(|factor| (factor - 1.0).abs() < 0.35),
        "{noise:?}"
    );
    usual.set_click_noise(&noise).unwrap();
    let weighed = Fields::from_document(usual.at(Path::new("."))).unwrap();
    let weighed = weighed.for_frame(&usual, &usual.frames[0]);
    let changed = weighed
        .landmarks
        .iter()
        .zip(soccer().landmarks)
        .map(|(a, b)| a.click_sigma_px / b.click_sigma_px);
    assert!(changed.into_iter().all(|factor| (factor - 1.0).abs() < 0.2));
}

#[test]
fn low_click_noise_lowers_the_solves_sigmas_and_the_document_keeps_it() {
    let mut rng = rng("low_click_noise_lowers_the_solves_sigmas_and_the_document_keeps_it");
    let truth = clicked_frames(10, 0.0, &mut rng);
    let mut document = by_another(&truth, &truth, 0.2, &mut rng);
    repeat(&mut document, &truth, 10, 0.2, &mut rng);
    let sigma = |document: &Document| {
        let fields = Fields::from_document(document.at(Path::new("."))).unwrap();
        let frame = &document.frames[4];
        let field = fields.for_frame(document, frame);
        calibrate(
            document,
            &FrameLookup::from_document(document),
            frame,
            field,
            4,
        )
        .unwrap()
        .worst_corner_sigma_px
    };
    let before = sigma(&document);
    let mut noise = own(&document).click_noise.unwrap();
    document.set_click_noise(&noise).unwrap();
    let steady = sigma(&document);
    // What the place is worth stays: half of the variance.
    assert!(
        (0.70..0.85).contains(&(steady / before)),
        "{steady} of {before}"
    );
    let text = document_to_string(&document.clone().into_dataset()).unwrap();
    let read = document_from_bytes(text.as_bytes()).unwrap();
    assert_eq!(
        (read.own_click_noise(), &read.frames[0].repeats),
        (Some(&noise), &document.frames[0].repeats)
    );
    noise.in_use = false;
    document.set_click_noise(&noise).unwrap();
    assert_eq!(sigma(&document), before);
}

#[test]
fn the_interval_of_a_round_holds_the_truth_as_often_as_it_says() {
    let mut rng = rng("the_interval_of_a_round_holds_the_truth_as_often_as_it_says");
    let truth = clicked_frames(5, 0.0, &mut rng);
    let (rounds, sigma_px) = (200, 0.7);
    let mut held = 0;
    for _ in 0..rounds {
        let mut document = by_another(&truth, &truth, sigma_px, &mut rng);
        repeat(&mut document, &truth, 5, sigma_px, &mut rng);
        let found = own(&document);
        assert!(
            found.repeats >= ENOUGH_REPEATS && found.click_noise.is_some(),
            "{found:?}"
        );
        let [low, high] = found.noise.unwrap().interval_95;
        held += usize::from(low <= 2.0 * sigma_px && 2.0 * sigma_px <= high);
    }
    let share = held as f64 / f64::from(rounds);
    assert!((0.92..=0.99).contains(&share), "{share}");
}

#[test]
fn the_commands_weight_clicks_as_the_document_says() {
    let mut rng = rng("the_commands_weight_clicks_as_the_document_says");
    let truth = clicked_frames(8, 0.0, &mut rng);
    let mut document = by_another(&truth, &truth, 0.2, &mut rng);
    repeat(&mut document, &truth, 8, 0.2, &mut rng);
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, document: &Document| {
        write_document(
            &Location::for_new_document(&folder.path().join(name)).unwrap(),
            document,
            false,
        )
        .unwrap();
    };
    write("usual.json", &document);
    document
        .set_click_noise(&own(&document).click_noise.unwrap())
        .unwrap();
    write("own.json", &document);
    for command in [
        "solve",
        "refine-base --distortion none --crown 0 --principal-point=false",
    ] {
        let sigma = |name: &str| {
            let ran = touchline(folder.path(), &format!("{command} {name}"));
            let solved = document_from_bytes(ran.stdout.as_bytes()).unwrap();
            let sigmas = solved.frames[4]
                .solution
                .as_ref()
                .unwrap()
                .worst_corner_sigma_px
                .unwrap();
            (
                sigmas,
                ran.stderr
                    .contains("weighted by their annotator's own click noise"),
            )
        };
        let ((usual, silent), (own, said)) = (sigma("usual.json"), sigma("own.json"));
        assert!(
            own < 0.95 * usual && !silent && said,
            "{command}: {own} of {usual}"
        );
    }
}

#[test]
fn check_reports_faults_in_repeats_and_click_noise() {
    let mut rng = rng("check_reports_faults_in_repeats_and_click_noise");
    let mut document = clicked_frames(2, 0.0, &mut rng);
    assert_eq!(check_values(document.at(Path::new("."))), []);
    document.frames[0].repeats.push(Repeat::new(
        "centre_spot".into(),
        ImagePoint::new(5.0, 5.0),
        1,
    ));
    document.frames[1].repeats.push(Repeat::new(
        "centre_mark".into(),
        ImagePoint::new(5.0, 600.0),
        1,
    ));
    document.click_noise = Some(StoredClickNoise::Unreadable(
        serde_json::json!({ "use": true, "hand_factor": -1.0 }),
    ));
    let codes: Vec<&str> = check_values(document.at(Path::new(".")))
        .iter()
        .map(|problem| problem.fault.code())
        .collect();
    assert_eq!(
        codes,
        ["click_noise", "unknown_landmark_again", "repeat_outside"]
    );
    assert_eq!(
        document.click_noise_in_use(),
        None,
        "unreadable click noise is not used"
    );
}
