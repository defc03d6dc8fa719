//! What the forest is compared with: matching to the nearest reference and a homography (the paper's baseline), and plain
//! nearest neighbours among all references' features.

use super::answers::{AskedFrame, FoundCamera, Tally, tally_table};
use super::progress::Progress;
use super::ransac::{Match, by_four_points, through};
use super::sets::FrameSet;
use super::setting::rng;
use super::{ExperimentError, SharedInputs};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::features::Descriptor;
use crate::geometry::{Angle, ImagePoint, Vec3};
use crate::relocalize::{
    PoseOptions, RayCandidate, RayMatches, RelocalizeOptions, SeenRange, TrainOptions, pose_from_candidates,
    relocalize, train,
};
use crate::report::figure::{Axis, Figure, Mark, Series};
use crate::report::{Cell, Column, Report, Table};
use crate::score::{horizontal_view, quantile};
use crate::solve::pose_from_plane;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// A match counts if the nearest descriptor is nearer than this share of the second nearest (Lowe 2004), squared.
const RATIO_SQUARED: f32 = 0.8 * 0.8;
/// The gate on descriptors' distances, as the forest has it.
const GATE: f32 = 0.2;
/// The methods, as the report names them.
const METHODS: [&str; 3] = ["nearest reference, homography", "nearest neighbours, two points", "forest, two points"];

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be had.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.highlights(progress)?;
    let mut report = Report::new("baselines", &set.heading("Baselines: over the number of references"));
    let most = set.splits.iter().map(|split| split.training_frames.len()).max().unwrap_or(0);
    let wanted: &[usize] = if inputs.options.quick { &[3, 10] } else { &[5, 10, 20, 40, 87] };
    let mut counts: Vec<usize> = wanted.iter().map(|count| (*count).min(most)).collect();
    counts.dedup();
    let stride = inputs.options.sized(4, 2);
    report.text(&format!(
        "Frames: {}. References are drawn at random from the training frames of a sequence; one frame in {stride} is asked. \
         The first method is the one that the paper compares with: the reference with most matches (ratio test), four-point \
         RANSAC, a homography, and the camera of it; it does not use the base. The second takes each feature's nearest \
         neighbour among all references as its ray.",
        set.title
    ));
    let done = AtomicUsize::new(0);
    let total = counts.len() * set.splits.len();
    let mut by_count: Vec<(usize, [Vec<AskedFrame>; 3])> = Vec::new();
    for &count in &counts {
        let mut methods: [Vec<AskedFrame>; 3] = [const { Vec::new() }; 3];
        for number in 0..set.splits.len() {
            let asked = ask_split(set, number, count, stride, inputs.options.seed);
            for (all, asked) in methods.iter_mut().zip(asked) {
                all.extend(asked);
            }
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
        }
        by_count.push((count, methods));
    }
    write(&mut report, &by_count);
    Ok(report)
}

/// The frames of one split, asked of `count` of its training frames, by each method.
fn ask_split(set: &FrameSet, number: usize, count: usize, stride: usize, seed: u64) -> [Vec<AskedFrame>; 3] {
    let split = &set.splits[number];
    let mut training_frames = split.training_frames.clone();
    training_frames.shuffle(&mut rng(seed, [70, number as u64]));
    training_frames.truncate(count);
    training_frames.sort_unstable();
    let taught = set.training_samples(&training_frames).and_then(|(samples, seen)| {
        let options = TrainOptions { seed, ..TrainOptions::default() };
        let forest = train(&samples, &options, &|_| ControlFlow::Continue(())).ok()?;
        Some((forest, seen))
    });
    let asked: Vec<usize> = split.asked.iter().copied().step_by(stride).collect();
    let one = |&frame: &usize| {
        let known = &set.frames[frame];
        let (size, base) = (known.features.image_size, *known.truth.base());
        let view_deg = horizontal_view(known.truth.ptz().focal_px, size).degrees();
        let blank = AskedFrame { frame, split: number, view_deg, found: None, predict_ms: 0.0, pose_ms: 0.0 };
        let Some((forest, seen)) = &taught else { return [blank; 3] };

        let start = Instant::now();
        let matched: Vec<Vec<Nearest>> =
            training_frames.iter().map(|&training_frame| match_to(set, frame, training_frame)).collect();
        let match_ms = start.elapsed().as_secs_f64() * 1e3;
        let pose_options = PoseOptions { seed, ranges: Some(seen.plausible()), ..PoseOptions::default() };
        let timed = |work: &dyn Fn() -> Option<PtzCamera>| {
            let start = Instant::now();
            let camera = work();
            let found = camera.map(|camera| FoundCamera::of(set, frame, &camera));
            AskedFrame { found, predict_ms: match_ms, pose_ms: start.elapsed().as_secs_f64() * 1e3, ..blank }
        };
        let by_homography = timed(&|| by_nearest_reference(set, frame, &training_frames, &matched, seed));
        let by_neighbours = timed(&|| {
            let matches = nearest_of_all(set, frame, &training_frames, &matched);
            let pose = pose_from_candidates(&matches, &base, size, &pose_options).ok()?;
            Some(PtzCamera::new(base, pose.ptz))
        });
        let by_forest = ask_forest(set, frame, (forest, seen), seed, &blank);
        [by_homography, by_neighbours, by_forest]
    };
    let answers: Vec<[AskedFrame; 3]> = asked.par_iter().map(one).collect();
    std::array::from_fn(|method| answers.iter().map(|answer| answer[method]).collect())
}

fn ask_forest(
    set: &FrameSet,
    frame: usize,
    (forest, seen): (&crate::relocalize::Forest, &SeenRange),
    seed: u64,
    blank: &AskedFrame,
) -> AskedFrame {
    let known = &set.frames[frame];
    let mut options = RelocalizeOptions::default();
    options.pose.seed = seed;
    let answer = relocalize(&known.features, forest, seen, known.truth.base(), &options);
    let found = answer.pose.ok().map(|pose| {
        let camera = PtzCamera::new(*known.truth.base(), pose.ptz);
        FoundCamera::of(set, frame, &camera)
    });
    let ms = |time: std::time::Duration| time.as_secs_f64() * 1e3;
    AskedFrame { found, predict_ms: ms(answer.predict_time), pose_ms: ms(answer.pose_time), ..*blank }
}

/// The feature of a reference that is nearest to one of a picture.
#[derive(Clone, Copy)]
struct Nearest {
    feature: usize,
    squared_distance: f32,
    second: f32,
}

/// For each feature of a frame the nearest one of a reference.
fn match_to(set: &FrameSet, frame: usize, training_frame: usize) -> Vec<Nearest> {
    let descriptors: &[Descriptor] = &set.frames[training_frame].features.descriptors;
    let nearest = |descriptor: &Descriptor| {
        let mut best = Nearest { feature: 0, squared_distance: f32::INFINITY, second: f32::INFINITY };
        for (feature, other) in descriptors.iter().enumerate() {
            let squared_distance = descriptor.squared_distance(other);
            if squared_distance < best.squared_distance {
                best = Nearest { feature, squared_distance, second: best.squared_distance };
            } else if squared_distance < best.second {
                best.second = squared_distance;
            }
        }
        best
    };
    set.frames[frame].features.descriptors.iter().map(nearest).collect()
}

/// The paper's baseline: the reference with most matches, a homography between the pictures, the camera that it makes with
/// the reference's own.
fn by_nearest_reference(
    set: &FrameSet,
    frame: usize,
    training_frames: &[usize],
    matched: &[Vec<Nearest>],
    seed: u64,
) -> Option<PtzCamera> {
    let good = |nearest: &Nearest| nearest.squared_distance < RATIO_SQUARED * nearest.second;
    let counts = matched.iter().map(|matches| matches.iter().filter(|nearest| good(nearest)).count());
    // The first of equals, so that the order decides nothing else.
    let (at, _) = counts.enumerate().max_by_key(|(index, count)| (*count, std::cmp::Reverse(*index)))?;
    let reference = &set.frames[training_frames[at]];
    let asked = &set.frames[frame].features;
    let pairs: Vec<Match> = asked
        .keypoints
        .iter()
        .zip(&matched[at])
        .filter(|(_, nearest)| good(nearest))
        .map(|(keypoint, nearest)| {
            let from = reference.features.keypoints[nearest.feature].point;
            Match { ground: Vec3::new(from.x, from.y, 0.0), image: keypoint.point }
        })
        .collect();
    if pairs.len() < 4 {
        return None;
    }
    let (h, _) = by_four_points(&pairs, &mut rng(seed, [71, frame as u64]));
    let h = h?;
    // Points of the ground in the reference, carried over.
    let size = asked.image_size;
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let grid = (0..5).flat_map(|i| (0..4).map(move |j| (0.1 + 0.2 * f64::from(i), 0.35 + 0.2 * f64::from(j))));
    let carried = grid.filter_map(|(x, y)| {
        let pixel = ImagePoint::new(x * width, y * height);
        let ground = reference.truth.plane_from_image(pixel, 0.0)?;
        Some((ground.xy(), through(&h, Vec3::new(pixel.x, pixel.y, 0.0))?))
    });
    let points: Vec<_> = carried.collect();
    let pose = pose_from_plane(&points, size.centre()).ok()?;
    let base = CameraBase::new(pose.position_m, pose.cam_from_world, size.centre());
    Some(PtzCamera::new(base, Ptz { pan: Angle::ZERO, tilt: Angle::ZERO, focal_px: pose.focal_px }))
}

/// For each feature the ray of its nearest neighbour among all references.
fn nearest_of_all(set: &FrameSet, frame: usize, training_frames: &[usize], matched: &[Vec<Nearest>]) -> RayMatches {
    let mut matches = RayMatches::new();
    for (feature, keypoint) in set.frames[frame].features.keypoints.iter().enumerate() {
        let of_all = matched.iter().enumerate().map(|(training_frame, nearest)| (training_frame, nearest[feature]));
        let best = of_all.min_by(|a, b| a.1.squared_distance.total_cmp(&b.1.squared_distance));
        let Some((training_frame, nearest)) = best.filter(|(_, nearest)| nearest.squared_distance <= GATE) else {
            continue;
        };
        let reference = &set.frames[training_frames[training_frame]];
        let Ok(ray) = reference.truth.ray_from_image(reference.features.keypoints[nearest.feature].point) else {
            continue;
        };
        matches.push(keypoint.point, &[RayCandidate { ray, squared_distance: nearest.squared_distance }]);
    }
    matches
}

fn write(report: &mut Report, by_count: &[(usize, [Vec<AskedFrame>; 3])]) {
    let median_ms = |asked: &[AskedFrame]| {
        let mut values: Vec<f64> = asked.iter().map(|asked| asked.predict_ms + asked.pose_ms).collect();
        values.sort_by(f64::total_cmp);
        quantile(&values, 0.5)
    };
    let marks = [Mark::Square, Mark::Triangle, Mark::Disc];
    let colours = [2, 3, 1];
    let references = || Axis::linear("references");
    let mut shares = Figure::new("", references(), Axis::linear("share of frames with IoU ≥ 0.95").within(0.0, 1.05));
    let mut times = Figure::new("", references(), Axis::log("time of one frame (ms)"));
    let mut time_table = Table::new(&[("references", "references")]);
    time_table.columns.extend(METHODS.map(|name| Column::new(&name.replace([' ', ','], "_"), name)));
    for (method, name) in METHODS.into_iter().enumerate() {
        let tallies: Vec<(Cell, Tally)> =
            by_count.iter().map(|(count, asked)| ((*count).into(), Tally::of(asked[method].iter()))).collect();
        report.table(
            &format!("method-{}", method + 1),
            &format!("{name}."),
            tally_table(("references", "references"), &tallies),
        );
        let share = |asked: &[AskedFrame]| {
            let good =
                asked.iter().filter(|asked| asked.found.is_some_and(|found| found.iou.is_some_and(|iou| iou >= 0.95)));
            good.count() as f64 / asked.len().max(1) as f64
        };
        let points = |of: &dyn Fn(&[AskedFrame]) -> f64| {
            by_count.iter().map(|(count, asked)| [*count as f64, of(&asked[method])]).collect::<Vec<_>>()
        };
        shares = shares.with(Series::new(name, colours[method], points(&share)).marked(marks[method]));
        times = times.with(Series::new(name, colours[method], points(&median_ms)).marked(marks[method]));
    }
    for (count, asked) in by_count {
        let mut row: Vec<Cell> = vec![(*count).into()];
        row.extend(asked.iter().map(|asked| Cell::Number(median_ms(asked))));
        time_table.push(row);
    }
    report.figure("shares", "Right answers over the number of references.", shares);
    report.text(
        "The paper's claim: the time of its baseline grows with the number of references, that of the forest does not. The \
         times of this run stand in the file of times.",
    );
    report.time_table("references-times", "One frame, features found already, median (ms).", time_table);
    report.time_figure("growth-times", "The time of one frame over the number of references.", times);
}
