//! A known rotating camera for the tests of single stages: its frames with exact paint and exact
//! matches, and drawn pictures where these are needed.

use crate::autocalibrate::adjustment::hypothesis::Hypothesis;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::{
    FramePaint, FramesAtScale, MatchedFrames, PaintPoint, renumber_matches,
};
use crate::autocalibrate::frames::sampled_frames::SampledFrame;
use crate::autocalibrate::search::pitch_map::PitchMap;
use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence};
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera, StatedLens};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec2, Vec3, homography};
use touchline_core::markings::{SampleOptions, sample_lines};
use touchline_core::testing::turned_base;
use touchline_documents::document::Document;
use touchline_documents::testing::{a_match, new_frame, soccer_document};
use touchline_vision::features::Features;
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, MarkingPixels};
use touchline_vision::track::{PosePrior, PriorSource, RelativeRotations, ViewGraphEdge};

pub const IMAGE_SIZE: ImageSize = ImageSize::new(960, 540);

/// The base of a camera on the main stand, facing the middle of the field.
pub fn base() -> CameraBase {
    turned_base([-6.0, -62.0, 14.0], [3.0, 0.0, 0.0], IMAGE_SIZE)
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
    let document = soccer_document();
    FieldPrior::from_document(document.at(Path::new("")), &"main".into()).unwrap()
}

/// The centres of the field's lines as a frame shows them, a sample each metre.
pub fn paint(field: &FieldModel, ptz: Ptz) -> FramePaint {
    let camera = PtzCamera::new(base(), ptz);
    let seen = |at: Vec3| {
        camera
            .image_from_world(at)
            .ok()
            .filter(|at| IMAGE_SIZE.contains(*at))
    };
    PitchMap::without_grid(field)
        .samples(1.0)
        .filter_map(|line| seen(line.at).map(PaintPoint::from))
        .collect()
}

/// The exact matches of two frames on a grid of pixels; none if they share too little.
pub fn exact_match(first: usize, second: usize) -> Option<ViewGraphEdge> {
    let ptz = ptz();
    let [one, other] = [first, second].map(|frame| PtzCamera::new(base(), ptz[frame]));
    let grid = (0..150_u32).map(|index| {
        ImagePoint::new(
            f64::from(index % 15) * 64.0 + 32.0,
            f64::from(index / 15) * 54.0 + 27.0,
        )
    });
    let pair = |at: ImagePoint| {
        let there = other.image_from_ray(one.ray_from_image(at).ok()?).ok()?;
        IMAGE_SIZE.contains(there).then_some((at, there))
    };
    let matches: Vec<(ImagePoint, ImagePoint)> = grid.filter_map(pair).collect();
    let agreeing = matches.len();
    if agreeing < 15 {
        return None;
    }
    let vector = |at: ImagePoint| Vec2::new(at.x, at.y);
    let pairs: Vec<(Vec2, Vec2)> = matches
        .iter()
        .map(|(here, there)| (vector(*here), vector(*there)))
        .collect();
    let second_from_first = homography(&pairs).ok()?;
    Some(ViewGraphEdge {
        first,
        second,
        matches,
        agreeing,
        second_from_first,
    })
}

/// The matches of all pairs of views that overlap.
pub fn exact_matches() -> Vec<ViewGraphEdge> {
    let num = ptz().len();
    let pairs = (0..num).flat_map(|first| (first + 1..num).map(move |second| (first, second)));
    pairs
        .filter_map(|(first, second)| exact_match(first, second))
        .collect()
}

/// A sampled frame whose picture shows neither features nor paint.
pub fn bare_frame(index: usize, image_size: ImageSize) -> SampledFrame {
    let picture = Picture::with_colour(image_size, [60, 120, 60, 255]);
    let features = Features {
        image_size,
        keypoints: Vec::new(),
        descriptors: Vec::new(),
    };
    let marking_pixels = MarkingPixels::detect(&GroundPicture::new(&picture, &[]));
    SampledFrame {
        index,
        masks: Vec::new(),
        features,
        marking_pixels,
    }
}

/// All views, matched. Their indices in the document are ten and more.
pub fn matched_views() -> MatchedFrames {
    let marking_pixels = bare_frame(0, IMAGE_SIZE).marking_pixels;
    let num = ptz().len();
    MatchedFrames {
        indices: (10..10 + num).collect(),
        others: Vec::new(),
        image_size: IMAGE_SIZE,
        lens: StatedLens::default(),
        matches: exact_matches(),
        marking_pixels: vec![marking_pixels; num],
        masks: vec![Vec::new(); num],
    }
}

/// The views with the rotations of exact matches, and the paint of a field.
pub fn frames_at_scale(field: &FieldModel) -> Arc<FramesAtScale> {
    let ptz = ptz();
    let paint = ptz.iter().map(|ptz| paint(field, *ptz)).collect();
    let rotations = RelativeRotations {
        ptz,
        lens: FocalCurve::NONE,
        principal_point: IMAGE_SIZE.centre(),
        residual_px: 0.3,
    };
    Arc::new(FramesAtScale {
        log_scale: 0.0,
        rotations,
        paint,
    })
}

/// A frame's picture: the white lines of a field on turf of one colour.
///
/// Each line is drawn in steps of half a pixel: the pixels across it are covered as far as the
/// paint covers them, and where lines cross the larger share counts.
pub fn draw_picture(field: &FieldModel, ptz: Ptz) -> Picture {
    const TURF: [f64; 3] = [60.0, 120.0, 60.0];
    const PAINT: [f64; 3] = [225.0, 230.0, 225.0];
    let (width, height) = (IMAGE_SIZE.width as usize, IMAGE_SIZE.height as usize);
    let mut covered = vec![0.0_f64; width * height];
    let options = SampleOptions {
        spacing_px: 0.5,
        border_px: 0.0,
    };
    for sample in sample_lines(field, &PtzCamera::new(base(), ptz), IMAGE_SIZE, &options) {
        let half_px = 0.5 * sample.width_px;
        let reach_px = half_px.ceil() as i64 + 1;
        for step in -reach_px..=reach_px {
            let at = sample.image.translate(sample.normal * step as f64);
            let (column, row) = (at.x.floor(), at.y.floor());
            if !IMAGE_SIZE.contains(at) || column as usize >= width || row as usize >= height {
                continue;
            }
            // The centre of a pixel is half a pixel from its corner.
            let middle = ImagePoint::new(column + 0.5, row + 0.5);
            let across_px = middle.offset_from(sample.image).dot(&sample.normal).abs();
            let share = (half_px + 0.5 - across_px)
                .clamp(0.0, 1.0)
                .min(sample.width_px);
            let pixel = &mut covered[row as usize * width + column as usize];
            *pixel = pixel.max(share);
        }
    }
    let channel = |share: f64, index: usize| {
        (TURF[index] + share * (PAINT[index] - TURF[index])).round() as u8
    };
    let rgba = covered.iter().flat_map(|share| {
        [
            channel(*share, 0),
            channel(*share, 1),
            channel(*share, 2),
            255,
        ]
    });
    Picture::new(IMAGE_SIZE, rgba.collect()).unwrap()
}

/// Some of the views, by their numbers, with few matches and the marking pixels of their drawn pictures.
pub fn matched_views_with_pixels(field: &FieldModel, views: &[usize]) -> MatchedFrames {
    const MATCHES_OF_PAIR: usize = 20;
    let (all, ptz) = (matched_views(), ptz());
    let mut matches = renumber_matches(&all.matches, views);
    for pair in &mut matches {
        let stride = pair.matches.len().div_ceil(MATCHES_OF_PAIR);
        pair.matches = pair.matches.iter().copied().step_by(stride).collect();
    }
    let marking_pixels_of = |&view: &usize| {
        MarkingPixels::detect(&GroundPicture::new(&draw_picture(field, ptz[view]), &[]))
    };
    MatchedFrames {
        indices: views.iter().map(|&view| all.indices[view]).collect(),
        matches,
        marking_pixels: views.par_iter().map(marking_pixels_of).collect(),
        masks: vec![Vec::new(); views.len()],
        ..all
    }
}

/// A document whose frames from the tenth on are the views. Nothing is known of them.
pub fn document() -> Document {
    let mut document = a_match(IMAGE_SIZE);
    for index in 0..10 + ptz().len() {
        document
            .frames
            .push(new_frame(&format!("{index}.png"), IMAGE_SIZE).into());
    }
    document
}

/// The pose prior of a frame from paint that is exact to about 1 px.
pub fn paint_prior(frame: usize, ptz: Ptz) -> PosePrior {
    let information = Mat3::from_diagonal(&Vec3::new(1e6, 1e6, 1e5));
    PosePrior::new(frame, ptz, information, PriorSource::Paint)
}

/// The right hypothesis, with an index for each frame and no evidence.
pub fn hypothesis(field: &FieldModel) -> Hypothesis {
    let ptz = ptz();
    let placed = ptz
        .iter()
        .enumerate()
        .map(|(number, &ptz)| AutocalibratedFrame {
            index: 10 + number,
            ptz,
            uncertainty: None,
            snapped: None,
            unaligned_score: None,
        });
    let camera = AutocalibratedCamera {
        base: base(),
        field: field.clone(),
        sizes: Vec::new(),
        frames: placed.collect(),
        others: Vec::new(),
        paint: Vec::new(),
        evidence: AutocalibrationEvidence::default(),
    };
    let paint_priors = ptz
        .iter()
        .enumerate()
        .map(|(frame, &ptz)| paint_prior(frame, ptz))
        .collect();
    let ptz = ptz.into_iter().map(Some).collect();
    Hypothesis {
        camera,
        ptz,
        paint_priors,
        frames: frames_at_scale(field),
    }
}
