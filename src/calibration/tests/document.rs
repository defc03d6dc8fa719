//! Documents: what is read is written back, the same document gives the same bytes.

use proptest::prelude::*;
use touchline_core::camera::{FocalCurve, Ptz};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_core::testing::pixel_box;
use touchline_documents::document::{
    Camera, Click, Clip, Document, Frame, FramePtz, FrameStatus, RejectReason, Solution,
    SolutionSource, Target, document_from_bytes, document_to_string,
};
use touchline_documents::testing::{new_frame, soccer_document};

const SAMPLE: &str = include_str!("../../documents/tests/samples/document-v1.json");

fn value(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn the_first_version_opens_forever() {
    let document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    assert_eq!((document.cameras.len(), document.frames.len()), (2, 3));
    let frame = &document.frames[0];
    assert_eq!(frame.status, FrameStatus::Reference);
    assert_eq!(frame.clip, Some(Clip::Number(3)));
    assert_eq!(
        frame.clicks[1].target,
        Some(Target::Line("halfway_line".into()))
    );
    assert!(frame.clicks[2].check && !frame.clicks[0].check);
    assert_eq!(frame.video.as_ref().unwrap().frame_index, 412);
    assert_eq!(
        frame.solution.as_ref().unwrap().source,
        Some(SolutionSource::Clicks)
    );
    assert_eq!(document.frames[1].reason, Some(RejectReason::CloseUp));
    assert_eq!(document.frames[1].clip, Some(Clip::Name("b".to_owned())));
    let base = document.cameras[0].base().unwrap();
    assert_eq!(base.position_m.y, -60.0);
    assert!((base.sigma.rotation.x.to_degrees() - 0.05).abs() < 1e-15);
    assert_eq!(document.field_of(&document.frames[2]).params.len(), 0);
    assert_eq!(document.field_of(frame).params["crown_m"], 0.1);
    assert!(document.cameras[1].base().is_none());
}

#[test]
fn a_base_keeps_how_its_errors_go_together() {
    use touchline_core::camera::{BaseCorrelation, BaseSigma, SharedCovariance};
    let mut document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    let base = document.cameras[0].base().unwrap();
    assert_eq!(
        base.sigma.correlation,
        BaseCorrelation::NONE,
        "older documents say nothing of it"
    );
    let mixed = SharedCovariance::from_fn(|row, column| {
        0.1 + ((2 * row + 3 * column + row * column) % 7) as f64
    });
    let of_all = mixed * mixed.transpose() * 1e-4;
    let mut of_pose = SharedCovariance::zeros();
    of_pose
        .fixed_view_mut::<5, 5>(0, 0)
        .copy_from(&of_all.fixed_view::<5, 5>(0, 0));
    for (covariance, size) in [(of_pose, 5), (of_all, 10)] {
        let sigma = BaseSigma::from_covariance(&covariance, 68.0);
        document.cameras[0].set_base(&touchline_core::camera::CameraBase { sigma, ..base });
        let text = document_to_string(&document).unwrap();
        assert_eq!(
            value(&text)["cameras"][0]["sigma"]["correlation"]
                .as_array()
                .unwrap()
                .len(),
            size
        );
        let again = document_from_bytes(text.as_bytes()).unwrap().cameras[0]
            .base()
            .unwrap();
        assert_eq!(again.sigma.correlation, sigma.correlation);
        assert!((again.sigma.covariance() - covariance).amax() < 1e-12 * covariance.amax());

        let mut wrong = value(&text);
        wrong["cameras"][0]["sigma"]["correlation"][0][1] = 2.0.into();
        let error = document_from_bytes(wrong.to_string().as_bytes())
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("no correlation matrix") && error.contains("leave it out"),
            "{error}"
        );
    }
}

#[test]
fn everything_that_is_read_is_written_back_with_unknown_keys() {
    let document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    let text = document_to_string(&document).unwrap();
    let mut expected = value(SAMPLE);
    expected["generator"] = touchline_documents::document::generator().into();
    // Fractions and whole numbers are the same number.
    expected["cameras"][0]["masks_px"][1] = serde_json::json!([10.5, 30, 64, 80.25]);
    let ids = ["48ffd214d244", "e84b7cec4fa4", "bccbd834ba92"];
    for (frame, id) in expected["frames"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .zip(ids)
    {
        frame["id"] = id.into();
    }
    assert_eq!(value(&text), expected);
    assert_eq!(
        document_to_string(&document_from_bytes(text.as_bytes()).unwrap()).unwrap(),
        text
    );
    assert_eq!(
        document_from_bytes(text.as_bytes()).unwrap().frames,
        document.frames
    );
    assert!(
        text.contains(
            "        { \"landmark\": \"centre_mark\", \"image_px\": [444.68, 789.18] },\n"
        ),
        "{text}"
    );
    assert!(text.lines().all(|line| line.len() <= 120), "{text}");
}

#[test]
fn masks_with_a_range_are_written_back() {
    let with_masks = SAMPLE.replace(
        r#""lens": { "serial""#,
        r#""masks": [{ "box_px": [8, 9.5, 300, 40], "from": 412, "to": 500, "source": "found", "seen": 7 }], "lens": { "serial""#,
    );
    let document = document_from_bytes(with_masks.as_bytes()).unwrap();
    let mask = pixel_box(8.0, 9.5, 300.0, 40.0);
    assert_eq!(document.cameras[0].ranged_masks[0].pixel_box, mask);
    assert!(
        document.masks_of(&document.frames[0]).contains(&mask),
        "it covers frame 412"
    );
    let text = document_to_string(&document).unwrap();
    let written = &value(&text)["cameras"][0]["masks"][0];
    assert_eq!(
        written,
        &serde_json::json!({ "box_px": [8, 9.5, 300, 40], "from": 412, "to": 500, "source": "found", "seen": 7 })
    );
}

#[test]
fn a_frames_k1_counts_only_where_its_camera_has_no_curve() {
    let mut document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    let pointed = document.ptz_camera(&document.frames[0]).unwrap();
    assert!((pointed.k1() - (-0.02 + 0.21 * 0.41)).abs() < 1e-12);
    document.frames[0].ptz.as_mut().unwrap().k1 = Some(-0.5);
    assert_eq!(
        document.ptz_camera(&document.frames[0]).unwrap().k1(),
        pointed.k1()
    );
    document.cameras[0].distortion = None;
    assert_eq!(document.ptz_camera(&document.frames[0]).unwrap().k1(), -0.5);
    document.frames[0].ptz.as_mut().unwrap().k1 = None;
    assert_eq!(document.ptz_camera(&document.frames[0]).unwrap().k1(), 0.0);
}

#[test]
fn setting_the_base_it_has_changes_nothing_and_another_one_is_kept() {
    let document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    let mut camera = (*document.cameras[0]).clone();
    let mut base = camera.base().unwrap();
    camera.set_base(&base);
    assert_eq!(camera, *document.cameras[0]);
    base.position_m.z = 19.5;
    base.distortion = FocalCurve {
        value: 0.01,
        ..base.distortion
    };
    camera.set_base(&base);
    assert_eq!(camera.base().unwrap(), base);
    assert_eq!(camera.distortion.as_ref().unwrap().extra["model"], "brown");
}

#[test]
fn angles_are_wrapped_when_they_are_read_and_when_they_are_recorded() {
    let text = SAMPLE
        .replace("\"pan_deg\": 12.5", "\"pan_deg\": 372.5")
        .replace("-11.2", "-371.0");
    let document = document_from_bytes(text.as_bytes()).unwrap();
    let ptz = document.frames[0].ptz.as_ref().unwrap();
    assert_eq!((ptz.pan_deg, ptz.tilt_deg), (12.5, -11.0));
    let record =
        touchline_documents::document::FramePtz::new(Ptz::from_degrees(190.0, -10.0, 2000.0), None);
    assert!((record.pan_deg + 170.0).abs() < 1e-12);
}

#[test]
fn a_dataset_holds_no_unnamed_click_and_its_indices_follow() {
    let mut document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    let frame = &mut document.frames[0];
    frame
        .clicks
        .insert(1, Click::without_name(ImagePoint::new(1.0, 2.0)));
    let solution = frame.solution.as_mut().unwrap();
    solution.disputed = vec![1, 2];
    solution.warnings[0].clicks = vec![0, 3];
    let project = document_to_string(&document).unwrap();
    assert_eq!(
        document_from_bytes(project.as_bytes()).unwrap().frames,
        document.frames
    );
    let dataset = document.clone().into_dataset();
    assert_eq!(dataset.frames[0].clicks.len(), 3);
    assert_eq!(dataset.frames[0].solution.as_ref().unwrap().disputed, [1]);
    assert_eq!(
        dataset.frames[0].solution.as_ref().unwrap().warnings[0].clicks,
        [0, 2]
    );
    assert!(
        dataset.frames[1].is_same(&document.frames[1]),
        "untouched frames are shared"
    );
}

#[test]
fn what_is_not_a_number_is_not_written() {
    let mut document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    document.frames[1]
        .clicks
        .push(Click::without_name(ImagePoint::new(f64::NAN, 2.0)));
    let error = document_to_string(&document).unwrap_err().to_string();
    assert_eq!(
        error,
        "frames[1] (images/0002.jpg): NaN cannot be written: JSON holds only finite numbers"
    );
    document.frames[1].clicks.clear();
    document
        .field
        .params
        .insert("crown_m".to_owned(), f64::INFINITY);
    let error = document_to_string(&document).unwrap_err().to_string();
    assert_eq!(
        error,
        "field: inf cannot be written: JSON holds only finite numbers"
    );
}

/// Any number that JSON holds, the awkward ones among them.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("finite", |x| x.is_finite()),
        -1e4..1e4,
        Just(-0.0),
        Just(f64::MIN_POSITIVE)
    ]
}

fn click() -> impl Strategy<Value = Click> {
    (0..3, "\\PC{0,12}", number(), number(), any::<bool>()).prop_map(|(kind, name, x, y, check)| {
        let image = ImagePoint::new(x, y);
        let click = match kind {
            0 => Click::landmark(name.as_str().into(), image),
            1 => Click::line(name.as_str().into(), image),
            _ => Click::without_name(image),
        };
        Click { check, ..click }
    })
}

fn frame() -> impl Strategy<Value = Frame> {
    let numbers = prop::collection::vec(number(), 8);
    let clicks = prop::collection::vec(click(), 0..5);
    (
        "\\PC{1,20}",
        clicks,
        numbers,
        any::<[bool; 4]>(),
        -180.0..180.0f64,
    )
        .prop_map(|(image, clicks, n, some, angle)| {
            let mut frame = new_frame(&image, ImageSize::new(1280, 720));
            frame.clicks = clicks;
            frame.comment = some[0].then(|| image.clone());
            frame.masks = vec![pixel_box(n[0], n[1].round(), n[2], n[3])];
            frame.ptz = some[1].then(|| FramePtz {
                k1: some[2].then_some(n[4]),
                k2: some[1].then_some(0.01),
                imported: None,
                extra: touchline_documents::document::Extra::new(),
                pan_deg: -angle,
                tilt_deg: -angle / 3.0,
                focal_px: n[5].abs() + f64::MIN_POSITIVE,
            });
            frame.solution = some[3].then(|| Solution {
                rms_px: Some(n[6]),
                ..Solution::default()
            });
            frame.extra.insert(
                "note".to_owned(),
                serde_json::json!({ "x": n[7], "list": [1, "two", null] }),
            );
            frame
        })
}

proptest! {
    #[test]
    fn every_document_comes_back_to_the_last_digit(
        frames in prop::collection::vec(frame(), 0..4), position in prop::array::uniform3(number()),
        crown in number(), name in "\\PC{1,8}",
    ) {
        let mut document = soccer_document();
        document.field.params.insert("crown_m".to_owned(), crown);
        let mut camera = Camera::new(name.as_str().into(), ImageSize::new(1280, 720));
        camera.position_m = Some(Vec3::from(position));
        document.cameras.push(camera.into());
        document.frames = frames.into_iter().map(Into::into).collect();
        let text = document_to_string(&document).unwrap();
        let again = document_from_bytes(text.as_bytes()).unwrap();
        prop_assert_eq!(&again, &document);
        prop_assert_eq!(document_to_string(&again).unwrap(), text);
    }
}

#[test]
fn frames_keep_their_ids_and_two_with_one_are_refused() {
    let document = document_from_bytes(SAMPLE.as_bytes()).unwrap();
    let mut json = value(&document_to_string(&document).unwrap());
    json["frames"][1]["id"] = "anna/7".into();
    json["frames"].as_array_mut().unwrap().swap(0, 2);
    let moved = document_from_bytes(json.to_string().as_bytes()).unwrap();
    let ids = |document: &Document| {
        document
            .frames
            .iter()
            .map(|frame| frame.id.to_string())
            .collect::<Vec<_>>()
    };
    let before = ids(&document);
    assert_eq!(
        ids(&moved),
        [before[2].as_str(), "anna/7", before[0].as_str()]
    );
    json["frames"][2]["id"] = "anna/7".into();
    let refused = document_from_bytes(json.to_string().as_bytes())
        .unwrap_err()
        .to_string();
    assert!(
        refused.starts_with("frames[2].id: anna/7 is also the id of frames[1]"),
        "{refused}"
    );
}

#[cfg(feature = "schema")]
#[test]
fn the_shipped_schema_is_that_of_the_types() {
    let of_types = touchline_documents::document::schema_of_types() + "\n";
    assert!(
        of_types == touchline_documents::document::SCHEMA,
        "`make schema` writes it again"
    );
}

/// Keys that once were read from the unknown ones, and those that only a newer program writes.
#[test]
fn what_the_schema_names_is_read_typed_checked_and_written() {
    let mut json = value(SAMPLE);
    json["click_noise"] = serde_json::json!({ "use": true, "hand_factor": 1.5, "sigma_px": 2.0,
        "sigma_interval_95_px": [1.8, 2.2], "repeats": 40 });
    json["shots"] = serde_json::json!([{ "from": 0, "to": 412, "kind": "cut", "camera": "main" },
        { "from": "nobody", "to": 500, "kind": "by_hand" }]);
    json["cameras"][0]["click_noise_px"] = (-1.5).into();
    json["cameras"][0]["sensor_width_mm"] = 9.59.into();
    let frame = &mut json["frames"][0];
    frame["use_for_base"] = false.into();
    frame["teaches"] = false.into();
    frame["gold"] = true.into();
    frame["edited"] =
        serde_json::json!({ "by": "anna", "at": "yesterday", "seconds": 4.5, "tool": "pen" });
    frame["solution"]["timings_ms"] =
        serde_json::json!({ "features": 80.0, "predict": 1.5, "pose": 3.0 });
    json["frames"][1]["sha256"] = "abc".into();
    let document = document_from_bytes(json.to_string().as_bytes()).unwrap();
    assert_eq!(document.own_click_noise().unwrap().repeats, 40);
    let frame = &document.frames[0];
    assert!(!frame.use_for_base && frame.gold && !frame.is_used_for_training());
    assert_eq!(
        frame.use_for_training,
        Some(false),
        "read under its earlier name, too"
    );
    assert_eq!(frame.edited.as_ref().unwrap().extra["tool"], "pen");
    assert_eq!(
        frame.extra.keys().collect::<Vec<_>>(),
        ["weather"],
        "only the unknown key"
    );
    let codes: Vec<_> =
        touchline_calibration::calibrate::check_values(document.at(std::path::Path::new(".")))
            .iter()
            .map(|problem| problem.fault.code())
            .collect();
    for code in ["unknown_frame", "not_positive", "no_time", "no_sha256"] {
        assert!(codes.contains(&code), "{code} is not among {codes:?}");
    }
    let text = document_to_string(&document).unwrap();
    let written = value(&text);
    assert_eq!(written["shots"], json["shots"]);
    assert_eq!(
        (
            &written["frames"][0]["use_for_training"],
            &written["frames"][0]["teaches"]
        ),
        (&false.into(), &().into())
    );
    assert_eq!(document_from_bytes(text.as_bytes()).unwrap(), document);
    json["frames"][0]["gold"] = "very".into();
    let refused = document_from_bytes(json.to_string().as_bytes())
        .unwrap_err()
        .to_string();
    assert!(
        refused.starts_with("frames[0].gold (images/0001.jpg): "),
        "{refused}"
    );
}
