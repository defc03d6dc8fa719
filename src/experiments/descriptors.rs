//! SIFT against ORB and AKAZE: each feature's nearest neighbour among all references' features is its ray, then the pose.

use super::answers::{AskedFrame, FoundCamera, Tally, tally_table};
use super::progress::Progress;
use super::sets::{FrameSet, KnownFrame, Split, as_picture};
use super::{ExperimentError, SharedInputs};
use crate::camera::{Ptz, PtzCamera};
use crate::features::{BinaryDescriptor, BinaryKind, Descriptor, Keypoint, MAX_SQUARED_DISTANCE, extract_binary};
use crate::media::FrameReader;
use crate::relocalize::{PoseOptions, RayCandidate, RayMatches, SeenRange, pose_from_candidates};
use crate::report::{Cell, Report};
use crate::score::horizontal_view;
use rayon::prelude::*;

/// Features of a picture at most, as SIFT's default is.
const MOST_FEATURES: usize = 1000;
/// The share of the largest distance up to which a nearest neighbour is a match: SIFT's is the forest's gate, 0.2 of 2.
const GATE: f32 = 0.1;
/// The same for bits: unrelated descriptors differ in half of them.
const BINARY_GATE: f32 = 0.15;

/// Pictures that lie in memory at a time.
const BATCH: usize = 16;

/// The features of all frames of one kind.
struct Described<D> {
    frames: Vec<(Vec<Keypoint>, Vec<D>)>,
    /// From 0 (the same) to 1.
    distance: fn(&D, &D) -> f32,
    gate: f32,
}

/// Runs the experiment.
///
/// # Errors
/// The frames or their pictures cannot be had.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.highlights(progress)?;
    let mut report = Report::new("descriptors", &set.heading("Descriptors: SIFT, ORB, AKAZE"));
    report.text(&format!(
        "Frames: {}. At most {MOST_FEATURES} features a picture, OpenCV's own settings; every feature's nearest neighbour among \
         all references' features is its ray, then the pose from two points. No forest: a forest splits numbers, not bits.",
        set.title
    ));
    let stride = inputs.options.sized(4, 2);
    let sift = Described {
        frames: set.frames.iter().map(|f| (f.features.keypoints.clone(), f.features.descriptors.clone())).collect(),
        distance: |a: &Descriptor, b| a.squared_distance(b) / MAX_SQUARED_DISTANCE,
        gate: GATE,
    };
    let mut tallies: Vec<(Cell, Tally)> = vec![("SIFT".into(), ask(set, &sift, stride, inputs.options.seed))];
    progress(1, 3);
    for (done, (name, kind)) in [("ORB", BinaryKind::Orb), ("AKAZE", BinaryKind::Akaze)].into_iter().enumerate() {
        let described = binary(set, kind)?;
        tallies.push((name.into(), ask(set, &described, stride, inputs.options.seed)));
        progress(done + 2, 3);
    }
    report.table("kinds", "By kind of features.", tally_table(("features", "features"), &tallies));
    report.text(
        "The paper compares SIFT with SURF, IoU .83 against .74 on its data; SURF is non-free and absent from Debian's \
         OpenCV, so it is quoted and not measured.",
    );
    Ok(report)
}

fn binary(set: &FrameSet, kind: BinaryKind) -> Result<Described<BinaryDescriptor>, ExperimentError> {
    let mut reader = FrameReader::new();
    let mut frames = Vec::with_capacity(set.frames.len());
    for batch in set.frames.chunks(BATCH) {
        // Read one after the other: a video's decoder stands at one place at a time.
        let pictures: Vec<_> = batch.iter().map(|known| known.picture(&mut reader)).collect::<Result<_, _>>()?;
        let of_frame = |(known, picture): (&KnownFrame, _)| {
            let found = extract_binary(&as_picture(picture)?, &known.masks, kind, MOST_FEATURES)?;
            Ok((found.keypoints, found.descriptors))
        };
        let found = batch.par_iter().zip(pictures).map(of_frame);
        frames.extend(found.collect::<Result<Vec<_>, ExperimentError>>()?);
    }
    let distance: fn(&BinaryDescriptor, &BinaryDescriptor) -> f32 = match kind {
        BinaryKind::Orb => |a, b| a.distance(b) as f32 / BinaryKind::Orb.bits() as f32,
        BinaryKind::Akaze => |a, b| a.distance(b) as f32 / BinaryKind::Akaze.bits() as f32,
    };
    Ok(Described { frames, distance, gate: BINARY_GATE })
}

fn ask<D: Sync>(set: &FrameSet, described: &Described<D>, stride: usize, seed: u64) -> Tally {
    let of_split = |(number, split): (usize, &Split)| -> Vec<AskedFrame> {
        let seen: Vec<Ptz> =
            split.training_frames.iter().map(|&training_frame| set.frames[training_frame].truth.ptz()).collect();
        let Some(seen) = SeenRange::of(&seen) else { return Vec::new() };
        let options = PoseOptions { seed, ranges: Some(seen.plausible()), ..PoseOptions::default() };
        let asked: Vec<usize> = split.asked.iter().copied().step_by(stride).collect();
        let one = |&frame: &usize| {
            let known = &set.frames[frame];
            let (base, size) = (*known.truth.base(), known.features.image_size);
            let matches = nearest(set, described, frame, &split.training_frames);
            let pose = pose_from_candidates(&matches, &base, size, &options).ok();
            AskedFrame {
                frame,
                split: number,
                view_deg: horizontal_view(known.truth.ptz().focal_px, size).degrees(),
                found: pose.map(|pose| FoundCamera::of(set, frame, &PtzCamera::new(base, pose.ptz))),
                predict_ms: 0.0,
                pose_ms: 0.0,
            }
        };
        asked.par_iter().map(one).collect()
    };
    let answers: Vec<AskedFrame> = set.splits.iter().enumerate().flat_map(of_split).collect();
    Tally::of(answers.iter())
}

/// For each feature of a frame the ray of its nearest neighbour among the training frames' features.
fn nearest<D>(set: &FrameSet, described: &Described<D>, frame: usize, training_frames: &[usize]) -> RayMatches {
    let mut matches = RayMatches::new();
    let (keypoints, descriptors) = &described.frames[frame];
    for (keypoint, descriptor) in keypoints.iter().zip(descriptors) {
        let mut best: Option<(f32, usize, usize)> = None;
        for &training_frame in training_frames {
            for (feature, other) in described.frames[training_frame].1.iter().enumerate() {
                let distance = (described.distance)(descriptor, other);
                if distance <= described.gate && best.is_none_or(|(least, ..)| distance < least) {
                    best = Some((distance, training_frame, feature));
                }
            }
        }
        let Some((distance, training_frame, feature)) = best else { continue };
        let point = described.frames[training_frame].0[feature].point;
        if let Ok(ray) = set.frames[training_frame].truth.ray_from_image(point) {
            matches.push(keypoint.point, &[RayCandidate { ray, squared_distance: distance }]);
        }
    }
    matches
}
