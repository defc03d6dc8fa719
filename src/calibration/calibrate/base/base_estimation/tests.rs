//! Bases of documents with rejected frames, wrong names and later edits.

use super::*;
use std::path::Path;
use touchline_core::geometry::{Mat3, Vec3};
use touchline_core::solve::base::{DisputedClick, ModelReason};
use touchline_core::testing::{SIZE, turned_base};
use touchline_documents::document::{Click, FrameStatus, Solution};
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
