//! The answers of a method to test frames, their errors, and statistics of them.

use super::coverage::{ViewBin, is_covered};
use crate::report::paper::{FAILURE_IOU, ROTATION};
use crate::report::statistics::{interval_of_mean, mean_sd, median_of};
use crate::sets::FrameSet;
use touchline::camera::PtzCamera;
use touchline::report::{Cell, Table};
use touchline::score::{CameraError, Summary, camera_error, horizontal_view, iou_part, iou_whole};

/// The result of one test frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameAnswer {
    /// Index of its set: one set for each seed.
    pub repeat: usize,
    /// Index of the frame in the set.
    pub frame: usize,
    /// Index of the split in which it was tested.
    pub split: usize,
    /// Horizontal field of view, degrees.
    pub view_deg: f64,
    /// The camera that was found; none if the method gave no answer.
    pub found: Option<FoundCamera>,
    /// The camera before the method's test of whether it is to be trusted.
    pub untested: Option<FoundCamera>,
    /// Time of the forest's predictions, ms.
    pub predict_ms: f64,
    /// Time of solving the camera, ms.
    pub pose_ms: f64,
}

/// A camera that was found, and its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundCamera {
    /// The camera.
    pub camera: PtzCamera,
    /// `IoU_part`; none if the picture shows nothing of the field.
    pub iou: Option<f64>,
    /// `IoU_whole`.
    pub iou_whole: f64,
    /// Errors of rotation, pan, tilt, focal length and position.
    pub error: CameraError,
}

impl FoundCamera {
    /// Measures the errors of an estimate.
    pub fn measure(set: &FrameSet, frame: usize, estimate: &PtzCamera) -> Self {
        let known = &set.frames[frame];
        Self {
            camera: *estimate,
            // Both measures, because the paper does not say which one it states.
            iou: iou_part(
                &known.field,
                &known.truth,
                estimate,
                known.features.image_size,
            ),
            iou_whole: iou_whole(&known.field, &known.truth, estimate),
            error: camera_error(&known.truth, estimate),
        }
    }
}

impl FrameAnswer {
    /// The result of a frame before a camera is found.
    pub fn blank(set: &FrameSet, repeat: usize, split: usize, frame: usize) -> Self {
        let known = &set.frames[frame];
        let view_deg =
            horizontal_view(known.truth.ptz().focal_px, known.features.image_size).degrees();
        Self {
            repeat,
            frame,
            split,
            view_deg,
            found: None,
            untested: None,
            predict_ms: 0.0,
            pose_ms: 0.0,
        }
    }

    /// The result with a camera that was found, and whether it passes the method's test.
    pub fn with_camera(self, set: &FrameSet, camera: &PtzCamera, passes: bool) -> Self {
        // The errors are measured whether the camera passes or not: the comparison with `CalibMe`,
        // which never tests its answer, uses all cameras.
        let untested = FoundCamera::measure(set, self.frame, camera);
        Self {
            found: passes.then_some(untested),
            untested: Some(untested),
            ..self
        }
    }

    /// The answer with the test of its confidence left off.
    pub const fn without_test(&self) -> Self {
        Self {
            found: self.untested,
            ..*self
        }
    }

    /// `IoU_part`, 0 without an answer; none if the picture shows nothing of the field.
    pub fn iou(&self) -> Option<f64> {
        // A refusal counts as 0, so that refusing raises no mean; a frame in which nothing of the
        // field is visible counts not at all.
        self.found.map_or(Some(0.0), |found| found.iou)
    }

    /// `IoU_whole`, 0 without an answer.
    fn iou_whole(&self) -> f64 {
        self.found.map_or(0.0, |found| found.iou_whole)
    }

    /// Whether it is right, wrong, or refused.
    pub fn outcome(&self) -> Outcome {
        match self.found {
            None => Outcome::Refused,
            // By the rotation, for which the paper states a limit.
            Some(found) if found.error.rotation.degrees() <= ROTATION.0 => Outcome::Right,
            Some(_) => Outcome::Wrong,
        }
    }

    /// Whether the frame counts as a failure: no answer, or an `IoU` below the paper's limit.
    pub fn is_failure(&self) -> bool {
        self.iou().is_some_and(|iou| iou < FAILURE_IOU)
    }
}

/// What an answer is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Within the paper's limit of the rotation.
    Right,
    /// Beyond it.
    Wrong,
    /// No camera was given.
    Refused,
}

/// Counts of features and of the rays that a forest predicts for them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCount {
    pub features: usize,
    /// Features with a ray that passes the gate.
    pub with_ray: usize,
    /// Features whose nearest leaf has the right ray.
    pub nearest_right: usize,
    /// All rays that pass the gate: those of every tree.
    pub rays: usize,
    /// The right ones of them.
    pub right: usize,
}

impl RayCount {
    pub const fn plus(self, other: Self) -> Self {
        Self {
            features: self.features + other.features,
            with_ray: self.with_ray + other.with_ray,
            nearest_right: self.nearest_right + other.nearest_right,
            rays: self.rays + other.rays,
            right: self.right + other.right,
        }
    }
}

/// Statistics of test frames. Frames without an answer count as `IoU` 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    pub right: usize,
    pub wrong: usize,
    pub refused: usize,
    /// Number of frames with an `IoU` below the paper's limit.
    pub failed: usize,
    pub iou_mean: f64,
    /// The standard deviation over the frames.
    pub iou_sd: f64,
    /// The 95 % interval of the mean, over the seeds.
    pub iou_interval: [f64; 2],
    pub iou_whole_mean: f64,
    pub rotation_median_deg: f64,
    pub focal_median_px: f64,
}

/// The columns of [`Tally::cells`]. Those without a heading are in files only.
const TALLY_COLUMNS: [(&str, &str); 11] = [
    ("right", "right"),
    ("wrong", "wrong"),
    ("refused", "refused"),
    ("iou", "IoU of the part (95 %)"),
    ("iou_mean", ""),
    ("iou_sd", ""),
    ("iou_low", ""),
    ("iou_high", ""),
    ("iou_whole_mean", "IoU of the whole"),
    ("rotation_median_deg", ""),
    ("focal_median_px", ""),
];

impl Tally {
    /// Computes the statistics of test frames.
    pub fn from_answers<'a>(answers: impl Iterator<Item = &'a FrameAnswer>) -> Self {
        let all: Vec<&FrameAnswer> = answers.collect();
        let count = |outcome: Outcome| {
            all.iter()
                .filter(|answer| answer.outcome() == outcome)
                .count()
        };
        let median = |of: fn(&FoundCamera) -> f64| {
            // Medians of errors are over the answers. A refusal has no error; the counts beside say
            // how many there are.
            let found = all.iter().filter_map(|answer| answer.found.as_ref());
            median_of(found.map(of).collect())
        };
        let ious: Vec<f64> = all.iter().filter_map(|answer| answer.iou()).collect();
        let wholes: Vec<f64> = all.iter().map(|answer| answer.iou_whole()).collect();
        let [iou_mean, iou_sd] = mean_sd(&ious);
        Self {
            right: count(Outcome::Right),
            wrong: count(Outcome::Wrong),
            refused: count(Outcome::Refused),
            failed: all.iter().filter(|answer| answer.is_failure()).count(),
            iou_mean,
            iou_sd,
            iou_interval: interval_of_iou(&all),
            iou_whole_mean: mean_sd(&wholes)[0],
            rotation_median_deg: median(|found| found.error.rotation.degrees()),
            focal_median_px: median(|found| found.error.focal_px.abs()),
        }
    }

    fn cells(&self) -> Vec<Cell> {
        // Without an answer a median is NaN, which a file would not show as a number.
        let fixed = |value: f64, decimals: usize| {
            if value.is_finite() {
                Cell::Fixed(value, decimals)
            } else {
                Cell::Empty
            }
        };
        let [low, high] = self.iou_interval;
        vec![
            self.right.into(),
            self.wrong.into(),
            self.refused.into(),
            self.describe().into(),
            fixed(self.iou_mean, 3),
            fixed(self.iou_sd, 3),
            fixed(low, 3),
            fixed(high, 3),
            fixed(self.iou_whole_mean, 3),
            fixed(self.rotation_median_deg, 6),
            fixed(self.focal_median_px, 3),
        ]
    }

    /// The mean `IoU` with its interval.
    fn describe(&self) -> String {
        let [low, high] = self.iou_interval;
        if low.is_nan() {
            return format!("{:.3}", self.iou_mean);
        }
        format!("{:.3} ({low:.3} to {high:.3})", self.iou_mean)
    }
}

/// The 95 % interval of the mean `IoU`. Frames of one seed share stadium, crowd and camera path, so
/// only the seeds are independent: the interval is that of the seeds' means, cut at 0 and 1. With a
/// single seed, it is a bootstrap interval over the frames.
fn interval_of_iou(all: &[&FrameAnswer]) -> [f64; 2] {
    // The numbers of each seed, by the index of its set.
    let mut seeds: Vec<Vec<f64>> = Vec::new();
    for answer in all {
        if seeds.len() <= answer.repeat {
            seeds.resize(answer.repeat + 1, Vec::new());
        }
        seeds[answer.repeat].extend(answer.iou());
    }
    seeds.retain(|ious| !ious.is_empty());
    // The bootstrap takes frames as independent, which they are not: the interval is too narrow,
    // but the only one that a single seed gives.
    if let [one] = &seeds[..] {
        return Summary::from_values(one, 0).map_or([f64::NAN; 2], |summary| summary.mean_interval);
    }
    let means: Vec<f64> = seeds.iter().map(|ious| mean_sd(ious)[0]).collect();
    // Adding 0 makes −0 a 0.
    interval_of_mean(&means, 1).map(|end| end.clamp(0.0, 1.0) + 0.0)
}

/// A table with a row for each tally.
pub fn tally_table(heading: (&str, &str), tallies: &[(Cell, Tally)]) -> Table {
    let mut columns = vec![heading];
    columns.extend(TALLY_COLUMNS);
    let mut table = Table::new(&columns);
    for (name, tally) in tallies {
        let mut row = vec![name.clone()];
        row.extend(tally.cells());
        table.push(row);
    }
    table
}

/// The frames of each split name, and all frames.
pub fn by_name<'a>(
    set: &'a FrameSet,
    answers: &'a [FrameAnswer],
) -> Vec<(&'a str, Vec<&'a FrameAnswer>)> {
    let of = |name: &str| {
        answers
            .iter()
            .filter(|answer| set.splits[answer.split].name == name)
            .collect()
    };
    let mut parts: Vec<(&str, Vec<&FrameAnswer>)> = set
        .names()
        .into_iter()
        .map(|name| (name, of(name)))
        .collect();
    // Last, where `sequences` expects it.
    parts.push(("all", answers.iter().collect()));
    parts
}

/// A table with a row for each test frame. `ways` names the methods.
pub fn frame_table<'a, N: AsRef<str>>(
    sets: &[FrameSet],
    ways: impl IntoIterator<Item = (N, &'a [FrameAnswer])>,
) -> Table {
    let mut table = Table::new(&[
        ("way", "way"),
        ("seed", "seed"),
        ("sequence", "sequence"),
        ("frame", "frame"),
        ("view_deg", "view (°)"),
        ("view", "view"),
        ("covered", "covered"),
        ("right", "right"),
        ("wrong", "wrong"),
        ("refused", "refused"),
        ("failed", "failed"),
        ("iou_part", "IoU_part"),
        ("iou_whole", "IoU_whole"),
        ("rotation_deg", "rotation error (°)"),
        ("focal_px", "focal length error (px)"),
    ]);
    for (way, answers) in ways {
        for answer in answers {
            table.push(frame_row(way.as_ref(), &sets[answer.repeat], answer));
        }
    }
    table
}

/// The row of a test frame. Numbers have so many digits as a reader of the file can use.
fn frame_row(way: &str, set: &FrameSet, answer: &FrameAnswer) -> Vec<Cell> {
    let is = |outcome: Outcome| Cell::from(usize::from(answer.outcome() == outcome));
    let error = |of: fn(&FoundCamera) -> f64| answer.found.as_ref().map(of).map(to_file).into();
    vec![
        way.into(),
        (set.seed as usize).into(),
        set.splits[answer.split].name.as_str().into(),
        set.frames[answer.frame].name.as_str().into(),
        to_file(answer.view_deg).into(),
        ViewBin::from_view_deg(answer.view_deg).key().into(),
        usize::from(is_covered(set, answer.frame, answer.split)).into(),
        is(Outcome::Right),
        is(Outcome::Wrong),
        is(Outcome::Refused),
        usize::from(answer.is_failure()).into(),
        answer.iou().map(to_file).into(),
        to_file(answer.iou_whole()).into(),
        error(|found| found.error.rotation.degrees()),
        error(|found| found.error.focal_px),
    ]
}

/// A number rounded to a millionth.
fn to_file(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(repeat: usize, iou: Option<f64>) -> FrameAnswer {
        let base = crate::setting::base();
        let camera = PtzCamera::new(
            base,
            touchline::camera::Ptz::from_degrees(50.0, -9.0, 3000.0),
        );
        let error = camera_error(&camera, &camera);
        let found = iou.map(|iou| FoundCamera {
            camera,
            iou: Some(iou),
            iou_whole: iou,
            error,
        });
        FrameAnswer {
            repeat,
            frame: 0,
            split: 0,
            view_deg: 24.0,
            found,
            untested: found,
            predict_ms: 0.0,
            pose_ms: 0.0,
        }
    }

    #[test]
    fn what_was_refused_counts_as_zero_and_an_answer_is_right_or_wrong() {
        let mut wrong = answer(0, Some(0.5));
        if let Some(found) = &mut wrong.found {
            found.error.rotation = touchline::geometry::Angle::from_degrees(1.5);
        }
        let all = [
            answer(0, Some(0.9)),
            answer(0, None),
            wrong,
            answer(0, Some(1.0)),
        ];
        let tally = Tally::from_answers(all.iter());
        assert_eq!((tally.right, tally.wrong, tally.refused), (2, 1, 1));
        assert_eq!(tally.failed, 2);
        assert!((tally.iou_mean - 0.6).abs() < 1e-12 && (tally.iou_whole_mean - 0.6).abs() < 1e-12);
        let [low, high] = tally.iou_interval;
        assert!(low < 0.6 && high > 0.6 && low >= 0.0, "{low} {high}");
        let tested = FrameAnswer {
            found: None,
            ..all[0]
        };
        assert_eq!(tested.outcome(), Outcome::Refused);
        assert_eq!(tested.without_test().outcome(), Outcome::Right);
    }

    #[test]
    fn the_interval_is_that_of_the_means_of_the_seeds() {
        // Means 0.5 and 0.7: their SD is 0.1414, t with one degree of freedom 12.706.
        let all = [
            answer(0, Some(0.4)),
            answer(0, Some(0.6)),
            answer(1, Some(0.7)),
            answer(1, Some(0.7)),
        ];
        assert_eq!(Tally::from_answers(all.iter()).iou_interval, [0.0, 1.0]);
        assert!(Tally::from_answers([].iter()).iou_mean.is_nan());
    }
}
