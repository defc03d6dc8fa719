//! SIFT compared with ORB and AKAZE, without a forest: each feature gets the ray of its nearest
//! neighbour among all references' features, then the camera is solved.

use super::answers::{FoundCamera, FrameAnswer, TALLY_EXPLAINED, Tally, frame_table, tally_table};
use super::matching::{DescriptorRows, nearest};
use super::paper::SIFT_SURF;
use super::progress::Progress;
use super::sequences::introduce;
use super::sets::{FrameSet, KnownFrame, SetKind, Split, as_picture};
use super::{ExperimentError, SharedInputs};
use rayon::prelude::*;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_documents::report::{Cell, Report, Verdict};
use touchline_vision::features::{
    BinaryDescriptor, BinaryKind, Keypoint, MAX_SQUARED_DISTANCE, extract_binary,
};
use touchline_vision::media::FrameReader;
use touchline_vision::relocalize::{
    PoseOptions, RayCandidate, RayMatches, SeenRange, pose_from_candidates,
};

/// Maximum number of features in a picture, as SIFT's default.
const MOST_FEATURES: usize = 1000;
/// Maximum distance of a match for SIFT, as a share of the largest possible distance: the forest's
/// threshold, 0.2 of 2.
const GATE: f32 = 0.1;
/// The same for binary descriptors. Unrelated ones differ in half of their bits.
const BINARY_GATE: f32 = 0.15;

/// Number of pictures in memory.
const BATCH: usize = 16;

/// The features of all frames of a set.
enum Described {
    Sift(Vec<DescriptorRows>),
    Bits {
        frames: Vec<(Vec<Keypoint>, Vec<BinaryDescriptor>)>,
        kind: BinaryKind,
    },
}

/// The distance between two descriptors, as a share of the largest possible one, and the index of
/// the neighbour.
type Neighbour = (f32, usize);

impl Described {
    fn sift(set: &FrameSet) -> Self {
        Self::Sift(
            set.frames
                .iter()
                .map(|known| DescriptorRows::of(&known.features.descriptors))
                .collect(),
        )
    }

    fn keypoints<'a>(&'a self, set: &'a FrameSet, frame: usize) -> &'a [Keypoint] {
        match self {
            Self::Sift(_) => &set.frames[frame].features.keypoints,
            Self::Bits { frames, .. } => &frames[frame].0,
        }
    }

    /// For each feature of a frame, the nearest feature of another frame; none if that has no
    /// features.
    fn neighbours(&self, frame: usize, other: usize) -> Vec<Option<Neighbour>> {
        match self {
            Self::Sift(rows) if rows[other].is_empty() => vec![None; rows[frame].len()],
            Self::Sift(rows) => {
                let found = nearest(&rows[frame], &rows[other]);
                found
                    .iter()
                    .map(|found| {
                        Some((found.squared_distance / MAX_SQUARED_DISTANCE, found.feature))
                    })
                    .collect()
            }
            Self::Bits { frames, kind } => {
                let others = || frames[other].1.iter().enumerate();
                let of_feature = |query: &BinaryDescriptor| {
                    let (bits, feature) = others()
                        .map(|(feature, other)| (query.distance(other), feature))
                        .min()?;
                    Some((bits as f32 / kind.bits() as f32, feature))
                };
                frames[frame].1.iter().map(of_feature).collect()
            }
        }
    }

    const fn gate(&self) -> f32 {
        match self {
            Self::Sift(_) => GATE,
            Self::Bits { .. } => BINARY_GATE,
        }
    }
}

/// Runs the experiment.
///
/// # Errors
/// The frames or their pictures cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let mut report = Report::new(
        "descriptors",
        &sets[0].heading("Descriptors: SIFT, ORB, AKAZE"),
    );
    let stride = inputs.options.sized(2, 2);
    introduce(
        &mut report,
        sets,
        &format!("One frame in {stride} is asked, the same ones of every kind."),
    );
    report.text(&format!(
        "At most {MOST_FEATURES} features a picture, OpenCV's own settings; every feature's nearest neighbour among all references' features \
         is its ray, then the pose from two points. No forest: a forest splits numbers, not bits. {TALLY_EXPLAINED}"
    ));
    let names = ["SIFT", "ORB", "AKAZE"];
    let mut answers: [Vec<FrameAnswer>; 3] = std::array::from_fn(|_| Vec::new());
    for (repeat, set) in sets.iter().enumerate() {
        for (number, answers) in answers.iter_mut().enumerate() {
            // Extract one kind at a time, so that only its features are in memory.
            let described = match number {
                0 => Described::sift(set),
                1 => binary(set, BinaryKind::Orb)?,
                _ => binary(set, BinaryKind::Akaze)?,
            };
            answers.extend(ask(set, repeat, &described, stride));
            progress(3 * repeat + number + 1, 3 * sets.len());
        }
    }
    let tallies: Vec<(Cell, Tally)> = names
        .iter()
        .zip(&answers)
        .map(|(name, answers)| ((*name).into(), Tally::of(answers.iter())))
        .collect();
    let mut table = tally_table(("features", "features"), &tallies);
    let is_own = sets[0].kind == SetKind::Own;
    let [sift, surf] = SIFT_SURF;
    // SURF is not available; its row has only the paper's number.
    if !is_own {
        let mut row: Vec<Cell> = vec!["SURF (paper only)".into()];
        row.resize(table.columns.len(), Cell::Empty);
        table.push(row);
        let paper = [
            Cell::Fixed(sift, 2),
            Cell::Empty,
            Cell::Empty,
            Cell::Fixed(surf, 2),
        ];
        table = table.with_column("paper_iou", "paper: IoU (forest)", paper);
    }
    report.table("kinds", "By kind of features.", table);
    let ways = names.into_iter().zip(answers.iter().map(Vec::as_slice));
    report.data(
        "frames",
        "Every frame asked, by kind of features.",
        frame_table(sets, ways),
    );
    if !is_own {
        let shown = tallies
            .iter()
            .map(|(name, tally)| format!("{name} {:.2}", tally.iou_mean));
        report.claim(
            Verdict::NotMeasured,
            &format!("SURF in place of SIFT: IoU {surf} (SIFT {sift})"),
            &format!(
                "{} (nearest neighbours, no forest)",
                shown.collect::<Vec<_>>().join(", ")
            ),
            "SURF is non-free and absent from Debian's OpenCV; ORB and AKAZE are what users have",
        );
    }
    Ok(report)
}

/// Extracts binary features from all frames of a set.
fn binary(set: &FrameSet, kind: BinaryKind) -> Result<Described, ExperimentError> {
    let mut reader = FrameReader::new();
    let mut frames = Vec::with_capacity(set.frames.len());
    for batch in set.frames.chunks(BATCH) {
        // Read sequentially, because a video decoder has one position.
        let pictures: Vec<_> = batch
            .iter()
            .map(|known| known.picture(&mut reader))
            .collect::<Result<_, _>>()?;
        let of_frame = |(known, picture): (&KnownFrame, _)| {
            let found = extract_binary(
                &as_picture(picture)?,
                known.used_masks(),
                kind,
                MOST_FEATURES,
            )?;
            Ok((found.keypoints, found.descriptors))
        };
        let found = batch.par_iter().zip(pictures).map(of_frame);
        frames.extend(found.collect::<Result<Vec<_>, ExperimentError>>()?);
    }
    Ok(Described::Bits { frames, kind })
}

/// Solves the cameras of the test frames, one in `stride`.
fn ask(set: &FrameSet, repeat: usize, described: &Described, stride: usize) -> Vec<FrameAnswer> {
    let of_split = |(number, split): (usize, &Split)| -> Vec<FrameAnswer> {
        let seen: Vec<Ptz> = split
            .training_frames
            .iter()
            .map(|&training_frame| set.frames[training_frame].truth.ptz())
            .collect();
        let Some(seen) = SeenRange::of(&seen) else {
            return Vec::new();
        };
        let options = PoseOptions {
            seed: set.seed,
            ranges: Some(seen.plausible()),
            ..PoseOptions::default()
        };
        let tested: Vec<usize> = split.test_frames.iter().copied().step_by(stride).collect();
        let one = |&frame: &usize| {
            let known = &set.frames[frame];
            let base = *known.truth.base();
            let matches = nearest_rays(set, described, frame, &split.training_frames);
            let pose =
                pose_from_candidates(&matches, &base, known.features.image_size, &options).ok();
            let found =
                pose.map(|pose| FoundCamera::of(set, frame, &PtzCamera::new(base, pose.ptz)));
            FrameAnswer {
                found,
                ..FrameAnswer::blank(set, repeat, number, frame)
            }
        };
        tested.par_iter().map(one).collect()
    };
    set.splits.iter().enumerate().flat_map(of_split).collect()
}

/// For each feature of a frame, the ray of its nearest neighbour among the training frames'
/// features.
fn nearest_rays(
    set: &FrameSet,
    described: &Described,
    frame: usize,
    training_frames: &[usize],
) -> RayMatches {
    let keypoints = described.keypoints(set, frame);
    let mut best: Vec<Option<(Neighbour, usize)>> = vec![None; keypoints.len()];
    for &training_frame in training_frames {
        let neighbours = described.neighbours(frame, training_frame);
        for (best, neighbour) in best.iter_mut().zip(neighbours) {
            if let Some(neighbour) = neighbour
                && best.is_none_or(|(least, _)| neighbour.0 < least.0)
            {
                *best = Some((neighbour, training_frame));
            }
        }
    }
    let mut matches = RayMatches::new();
    for (keypoint, best) in keypoints.iter().zip(best) {
        let Some(((distance, feature), training_frame)) =
            best.filter(|((distance, _), _)| *distance <= described.gate())
        else {
            continue;
        };
        let point = described.keypoints(set, training_frame)[feature].point;
        if let Ok(ray) = set.frames[training_frame].truth.ray_from_image(point) {
            matches.push(
                keypoint.point,
                &[RayCandidate {
                    ray,
                    squared_distance: distance,
                }],
            );
        }
    }
    matches
}
