//! Bases of documents with rejected frames, wrong names and later edits.

use super::*;
use std::path::Path;
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Mat3, Vec3};
use touchline_core::solve::base::{DisputedClick, ModelReason};
use touchline_core::testing::{SIZE, ground_landmarks, soccer, turned_base};
use touchline_documents::document::{Click, FieldSize, FrameStatus, Solution};
use touchline_documents::testing::match_from;
use touchline_documents::testing::{new_frame, ptz_at};

fn base(heading_deg: f64) -> CameraBase {
    let position_m = Vec3::new(0.0, -60.0, 18.0);
    turned_base(position_m, [heading_deg, 0.0, 0.0], SIZE)
}

/// An estimate of a base along world +y that took no frame.
fn estimate() -> BaseEstimate {
    BaseEstimate {
        base: base(0.0),
        crown_m: 0.0,
        model: BaseModel {
            lens: LensModel::Pinhole,
            crown: CrownModel::Fixed(0.0),
            principal_point: None,
        },
        reason: ModelReason::Prescribed,
        scores: Vec::new(),
        position_covariance: Mat3::zeros(),
        frames: Vec::new(),
        median_px: 1.0,
        p90_px: 1.0,
        previous_median_px: None,
        one_more_frame: None,
        pixel_aspect: None,
        disputed: Vec::new(),
        mirrored: Vec::new(),
    }
}

fn problem(document: &Document) -> Result<BaseProblem, BaseEstimationError> {
    BaseProblem::from_document(document.at(Path::new("/")), &"main".into())
}

#[test]
fn a_rejected_frame_keeps_its_direction_in_the_world() {
    let mut document = match_from(&base(20.0), SIZE);
    let mut frame = new_frame("1.jpg", SIZE);
    frame.ptz = ptz_at(5.0, -12.0, 2000.0);
    frame.status = FrameStatus::Rejected;
    document.frames.push(frame.into());
    let estimated = problem(&document)
        .unwrap()
        .estimated_base(&document, estimate());
    estimated.write_to(&mut document, Path::new("/")).unwrap();
    let pan_deg = document.frames[0].ptz.as_ref().unwrap().pan_deg;
    assert!((pan_deg - 25.0).abs() < 1e-9, "{pan_deg}");
}

#[test]
fn a_wrong_name_in_a_rejected_frame_does_not_end_the_estimation() {
    let mut document = match_from(&base(0.0), SIZE);
    let mut frame = new_frame("1.jpg", SIZE);
    let click = Click::landmark("no_such_mark".into(), SIZE.centre());
    frame.clicks.push(click);
    document.frames.push(frame.into());
    assert!(problem(&document).is_err());
    document.frames[0].status = FrameStatus::Rejected;
    assert!(problem(&document).is_ok());
}

#[test]
fn clicks_that_changed_after_the_estimation_are_not_disputed() {
    let mut document = match_from(&base(0.0), SIZE);
    let mut frame = new_frame("1.jpg", SIZE);
    for landmark in ["centre_mark", "halfway_far"] {
        let click = Click::landmark(landmark.into(), SIZE.centre());
        frame.clicks.push(click);
    }
    frame.solution = Some(Solution::default());
    document.frames.push(frame.into());
    let disputed = DisputedClick {
        frame: 0,
        click: 1,
        error_px: Some(90.0),
        fits_better: None,
    };
    let estimate = BaseEstimate {
        disputed: vec![disputed],
        ..estimate()
    };
    let estimated = problem(&document)
        .unwrap()
        .estimated_base(&document, estimate);
    let mut same = document.clone();
    estimated.mark_disputes(&mut same);
    assert_eq!(same.frames[0].solution.as_ref().unwrap().disputed, [1]);
    document.frames[0].clicks.remove(0);
    estimated.mark_disputes(&mut document);
    let solution = document.frames[0].solution.as_ref().unwrap();
    assert!(solution.disputed.is_empty());
}

/// A match clicked exactly at some pans, with all landmarks of the ground in view.
fn clicked_at(pans_deg: &[f64], focal_px: f64) -> Document {
    let mut document = match_from(&base(0.0), SIZE);
    let field = soccer();
    for pan_deg in pans_deg {
        let mut frame = new_frame(&format!("{pan_deg}.jpg"), SIZE);
        let camera = PtzCamera::new(base(0.0), Ptz::from_degrees(*pan_deg, -13.0, focal_px));
        frame.clicks = ground_landmarks(&field, &camera)
            .filter(|(_, _, at)| SIZE.contains(*at))
            .map(|(_, landmark, at)| Click::landmark(landmark.id.clone(), at))
            .collect();
        document.frames.push(frame.into());
    }
    document
}

/// A base on an assumed size knows what its clicks leave open of it, even where it is not fitted.
#[test]
fn a_base_on_an_assumed_size_states_what_its_frames_leave_open_of_it() {
    let length_sigma_m = |document: &Document| {
        let found = problem(document).unwrap().estimate(
            document,
            &BaseOptions::default(),
            &Progress::default(),
        );
        let found = found.unwrap();
        assert_eq!(found.sizes, [], "the size was not fitted");
        let mut written = document.clone();
        found.write_camera(&mut written);
        let [length, _] = written.cameras[0].base().unwrap().sigma.size;
        length.sigma_m
    };
    let middle = clicked_at(&[-6.0, -2.0, 2.0, 6.0], 3600.0);
    let both_ends = clicked_at(&[-36.0, -18.0, 0.0, 18.0, 36.0], 2600.0);
    let (open_m, seen_m) = (length_sigma_m(&middle), length_sigma_m(&both_ends));
    assert!(open_m > 3.0 && seen_m < 0.5, "{open_m} {seen_m}");
    let mut stated = middle;
    stated.field.size = Some(FieldSize::Confirmed);
    assert_eq!(length_sigma_m(&stated), 0.0);
}
