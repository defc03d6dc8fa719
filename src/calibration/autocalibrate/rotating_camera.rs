//! A known rotating camera for the tests of single stages: its frames with exact paint and exact matches, without any picture.

use super::field_prior::FieldPrior;
use super::hypothesis::Hypothesis;
use super::matched_frames::{FramesAtScale, MatchedFrames};
use super::pitch_map::PitchMap;
use super::sampled_frames::SampledFrame;
use crate::calibrate::{UnclickedCamera, UnclickedEvidence, UnclickedFrame};
use std::path::Path;
use std::sync::Arc;
use touchline_core::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Mat3, Vec3};
use touchline_documents::document::{Document, FieldSpec};
use touchline_vision::features::Features;
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, Strokes};
use touchline_vision::track::{PosePrior, PriorSource, Tie, Turns};

pub const IMAGE_SIZE: ImageSize = ImageSize::new(960, 540);

/// The camera stands on the main stand and looks at the middle of the field.
pub fn base() -> CameraBase {
    let angles = BaseAngles { heading: Angle::from_degrees(3.0), ..BaseAngles::default() };
    CameraBase::new(Vec3::new(-6.0, -62.0, 14.0), angles.base_from_world(), IMAGE_SIZE.centre())
}

/// Seven views from left to right.
pub fn ptz() -> Vec<Ptz> {
    let view = |view: i32| {
        let pan_deg = 11.0 * f64::from(view);
        Ptz::from_degrees(pan_deg, -11.0, 1000.0 + 40.0 * f64::from(view.abs()))
    };
    (-3..=3).map(view).collect()
}

pub fn soccer() -> FieldPrior {
    let document = Document::new(FieldSpec::new("soccer"));
    FieldPrior::from_document(document.at(Path::new("")), &"main".into()).unwrap()
}

/// The centres of the field's lines as a frame shows them, a sample each metre.
pub fn paint(field: &FieldModel, ptz: Ptz) -> Vec<ImagePoint> {
    let camera = PtzCamera::new(base(), ptz);
    let seen = |at: Vec3| camera.image_from_world(at).ok().filter(|at| IMAGE_SIZE.contains(*at));
    PitchMap::without_grid(field).samples(1.0).filter_map(|line| seen(line.at)).collect()
}

/// The exact matches of two frames on a grid of pixels; none if they share too little.
pub fn exact_match(first: usize, second: usize) -> Option<Tie> {
    let ptz = ptz();
    let [one, other] = [first, second].map(|frame| PtzCamera::new(base(), ptz[frame]));
    let grid = (0..150_u32)
        .map(|index| ImagePoint::new(f64::from(index % 15) * 64.0 + 32.0, f64::from(index / 15) * 54.0 + 27.0));
    let pair = |at: ImagePoint| {
        let there = other.image_from_ray(one.ray_from_image(at).ok()?).ok()?;
        IMAGE_SIZE.contains(there).then_some((at, there))
    };
    let matches: Vec<(ImagePoint, ImagePoint)> = grid.filter_map(pair).collect();
    let agreeing = matches.len();
    (agreeing >= 15).then_some(Tie { first, second, matches, agreeing, second_from_first: Mat3::identity() })
}

/// The matches of all pairs of views that overlap.
pub fn exact_matches() -> Vec<Tie> {
    let num = ptz().len();
    let pairs = (0..num).flat_map(|first| (first + 1..num).map(move |second| (first, second)));
    pairs.filter_map(|(first, second)| exact_match(first, second)).collect()
}

/// A sampled frame whose picture shows neither features nor paint.
pub fn bare_frame(index: usize, image_size: ImageSize) -> SampledFrame {
    let picture = Picture::filled(image_size, [60, 120, 60, 255]);
    let features = Features { image_size, keypoints: Vec::new(), descriptors: Vec::new() };
    let strokes = Strokes::of(&GroundPicture::new(&picture, &[]));
    SampledFrame { index, masks: Vec::new(), features, strokes }
}

/// All views, matched. Their indices in the document are ten and more.
pub fn matched() -> MatchedFrames {
    let strokes = bare_frame(0, IMAGE_SIZE).strokes;
    let num = ptz().len();
    MatchedFrames {
        indices: (10..10 + num).collect(),
        others: Vec::new(),
        image_size: IMAGE_SIZE,
        matches: exact_matches(),
        strokes: vec![strokes; num],
        masks: vec![Vec::new(); num],
    }
}

/// The views as exact matches turn them, with the paint of a field.
pub fn frames_at_scale(field: &FieldModel) -> Arc<FramesAtScale> {
    let ptz = ptz();
    let paint = ptz.iter().map(|ptz| paint(field, *ptz)).collect();
    let rotations = Turns { ptz, lens: FocalCurve::NONE, image_size: IMAGE_SIZE, residual_px: 0.3 };
    Arc::new(FramesAtScale { log_scale: 0.0, rotations, paint })
}

/// What paint that is exact to 1 px or so says of a frame.
pub fn paint_prior(frame: usize, ptz: Ptz) -> PosePrior {
    let information = Mat3::from_diagonal(&Vec3::new(1e6, 1e6, 1e5));
    PosePrior::new(frame, ptz, information, PriorSource::Paint)
}

/// The right hypothesis, with an index for each frame and no evidence.
pub fn hypothesis(field: &FieldModel) -> Hypothesis {
    let ptz = ptz();
    let placed = ptz.iter().enumerate().map(|(number, &ptz)| UnclickedFrame {
        index: 10 + number,
        ptz,
        uncertainty: None,
        snapped: None,
    });
    let camera = UnclickedCamera {
        base: base(),
        field: field.clone(),
        sizes: Vec::new(),
        frames: placed.collect(),
        others: Vec::new(),
        paint: Vec::new(),
        evidence: UnclickedEvidence::default(),
    };
    let paint_priors = ptz.iter().enumerate().map(|(frame, &ptz)| paint_prior(frame, ptz)).collect();
    let ptz = ptz.into_iter().map(Some).collect();
    Hypothesis { camera, ptz, paint_priors, frames: frames_at_scale(field) }
}
