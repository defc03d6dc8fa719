//! The answers of a method to test frames, their errors, and statistics of them.

use super::paper::{FAILURE_IOU, ROTATION};
use super::sets::FrameSet;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::quantile;
use touchline_core::score::{
    CameraError, Summary, camera_error, horizontal_view, iou_part, iou_whole,
};
use touchline_documents::report::{Cell, Table};

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
    pub fn of(set: &FrameSet, frame: usize, estimate: &PtzCamera) -> Self {
        let known = &set.frames[frame];
        Self {
            camera: *estimate,
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
            predict_ms: 0.0,
            pose_ms: 0.0,
        }
    }

    /// `IoU_part`, 0 without an answer; none if the picture shows nothing of the field.
    pub fn iou(&self) -> Option<f64> {
        self.found.map_or(Some(0.0), |found| found.iou)
    }

    /// Whether the frame counts as a failure: no answer, or an `IoU` below the paper's limit.
    pub fn is_failure(&self) -> bool {
        self.iou().is_some_and(|iou| iou < FAILURE_IOU)
    }
}

/// Counts of features: all, those with an accepted ray, and those with a correct one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCount {
    pub features: usize,
    pub passing: usize,
    pub right: usize,
}

impl RayCount {
    pub const fn plus(self, other: Self) -> Self {
        Self {
            features: self.features + other.features,
            passing: self.passing + other.passing,
            right: self.right + other.right,
        }
    }
}

/// Statistics of test frames. Frames without an answer count as `IoU` 0 and as outside every limit
/// of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    pub frames: usize,
    pub found: usize,
    pub failed: usize,
    pub iou_mean: f64,
    /// The standard deviation over the frames.
    pub iou_sd: f64,
    /// The 95 % interval of the mean, over the seeds.
    pub iou_interval: [f64; 2],
    pub iou_of_found: f64,
    pub within_rotation: f64,
    pub rotation_median_deg: f64,
    pub rotation_90_deg: f64,
    pub focal_median_px: f64,
    pub focal_90_px: f64,
}

/// The columns of [`Tally::cells`].
pub const TALLY_COLUMNS: [(&str, &str); 12] = [
    ("asked", "frames"),
    ("found", "found"),
    ("iou_mean", "IoU"),
    ("iou_sd", "SD"),
    ("iou_low", "95 % from"),
    ("iou_high", "to"),
    ("iou_of_found", "mean of found"),
    ("within_1_deg", "rotation within 1°"),
    ("rotation_median_deg", "median (°)"),
    ("rotation_90_deg", "90 % (°)"),
    ("focal_median_px", "focal length, median (px)"),
    ("focal_90_px", "90 % (px)"),
];

/// Explains the columns to readers of the report.
pub const TALLY_EXPLAINED: &str = "IoU: mean over all test frames, not found counting as 0; SD: standard deviation over the frames; 95 %: \
    interval of the mean over the seeds (Student's t; with one seed, bootstrap over the frames). Rotation within 1°: share of all \
    test frames. Medians and 90 % percentiles of errors are of the frames found.";

impl Tally {
    /// Computes the statistics of test frames.
    pub fn of<'a>(answers: impl Iterator<Item = &'a FrameAnswer>) -> Self {
        let all: Vec<&FrameAnswer> = answers.collect();
        let found: Vec<FoundCamera> = all.iter().filter_map(|answer| answer.found).collect();
        let ascending = |of: &dyn Fn(&FoundCamera) -> f64| {
            let mut values: Vec<f64> = found.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let ious: Vec<f64> = all.iter().filter_map(|answer| answer.iou()).collect();
        let [iou_mean, iou_sd] = mean_sd(&ious);
        let of_found: Vec<f64> = found.iter().filter_map(|found| found.iou).collect();
        let rotation = ascending(&|found| found.error.rotation.degrees());
        let focal = ascending(&|found| found.error.focal_px.abs());
        let within = rotation
            .iter()
            .filter(|degrees| **degrees <= ROTATION.0)
            .count();
        Self {
            frames: all.len(),
            found: found.len(),
            failed: all.iter().filter(|answer| answer.is_failure()).count(),
            iou_mean,
            iou_sd,
            iou_interval: interval_of_mean(&all),
            iou_of_found: mean_sd(&of_found)[0],
            within_rotation: within as f64 / all.len().max(1) as f64,
            rotation_median_deg: quantile(&rotation, 0.5),
            rotation_90_deg: quantile(&rotation, 0.9),
            focal_median_px: quantile(&focal, 0.5),
            focal_90_px: quantile(&focal, 0.9),
        }
    }

    pub fn cells(&self) -> Vec<Cell> {
        let number = |value: f64| {
            if value.is_finite() {
                Cell::Number(value)
            } else {
                Cell::Empty
            }
        };
        let fixed = |value: f64| {
            if value.is_finite() {
                Cell::Fixed(value, 3)
            } else {
                Cell::Empty
            }
        };
        vec![
            self.frames.into(),
            self.found.into(),
            fixed(self.iou_mean),
            fixed(self.iou_sd),
            fixed(self.iou_interval[0]),
            fixed(self.iou_interval[1]),
            fixed(self.iou_of_found),
            fixed(self.within_rotation),
            number(self.rotation_median_deg),
            number(self.rotation_90_deg),
            number(self.focal_median_px),
            number(self.focal_90_px),
        ]
    }

    /// The mean `IoU` with its standard deviation, as in the paper, and its interval.
    pub fn describe(&self) -> String {
        let [low, high] = self.iou_interval;
        format!(
            "{:.2} ± {:.2} ({low:.2} to {high:.2})",
            self.iou_mean, self.iou_sd
        )
    }
}

/// Mean and standard deviation (n − 1).
pub fn mean_sd(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0).max(1.0)).sqrt()]
}

/// The 97.5 % quantile of Student's t for 1, 2, 3, … degrees of freedom. With more than nine, that
/// of the normal distribution is used.
const STUDENT_975: [f64; 9] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262,
];

/// The 95 % interval of the mean `IoU`. Frames of one seed share stadium, crowd and camera path, so
/// only the seeds are independent: the interval is that of the seeds' means. With a single seed, it
/// is a bootstrap interval over the frames.
fn interval_of_mean(all: &[&FrameAnswer]) -> [f64; 2] {
    let ious: Vec<Vec<f64>> = by_seed(all.iter().copied())
        .into_iter()
        .map(|answer| answer.into_iter().filter_map(FrameAnswer::iou).collect())
        .filter(|ious: &Vec<f64>| !ious.is_empty())
        .collect();
    if let [one] = &ious[..] {
        return Summary::of(one, 0).map_or([f64::NAN; 2], |summary| summary.mean_interval);
    }
    let means: Vec<f64> = ious.iter().map(|ious| mean_sd(ious)[0]).collect();
    interval_over_seeds(&means).map(|end| end.clamp(0.0, 1.0))
}

/// The frames of each seed.
fn by_seed<'a>(answers: impl IntoIterator<Item = &'a FrameAnswer>) -> Vec<Vec<&'a FrameAnswer>> {
    let mut seeds: Vec<Vec<&FrameAnswer>> = Vec::new();
    for answer in answers {
        if seeds.len() <= answer.repeat {
            seeds.resize(answer.repeat + 1, Vec::new());
        }
        seeds[answer.repeat].push(answer);
    }
    seeds
}

/// The 95 % interval of a mean from its values for each seed (Student's t). NaN with a single seed.
pub fn interval_over_seeds(values: &[f64]) -> [f64; 2] {
    if values.len() < 2 {
        return [f64::NAN; 2];
    }
    let [mean, sd] = mean_sd(values);
    let t = STUDENT_975.get(values.len() - 2).copied().unwrap_or(1.96);
    let half = t * sd / (values.len() as f64).sqrt();
    [mean - half, mean + half]
}

/// The 95 % interval, over the seeds, of a statistic of the answers.
pub fn over_seeds<'a>(
    answers: impl IntoIterator<Item = &'a FrameAnswer>,
    number: impl Fn(Vec<&'a FrameAnswer>) -> f64,
) -> [f64; 2] {
    interval_over_seeds(&by_seed(answers).into_iter().map(number).collect::<Vec<_>>())
}

/// The 95 % interval, over the seeds, of the difference of a statistic: that of `of` minus that of
/// `than`, seed by seed.
pub fn difference<'a>(
    of: impl IntoIterator<Item = &'a FrameAnswer>,
    than: impl IntoIterator<Item = &'a FrameAnswer>,
    number: impl Fn(&Tally) -> f64,
) -> [f64; 2] {
    let tallied = |answers: Vec<&'a FrameAnswer>| number(&Tally::of(answers.into_iter()));
    let pairs = by_seed(of).into_iter().zip(by_seed(than));
    let differences: Vec<f64> = pairs
        .map(|(of, than)| tallied(of) - tallied(than))
        .collect();
    interval_over_seeds(&differences)
}

/// Formats the interval of a difference for readers.
pub fn describe_difference([low, high]: [f64; 2]) -> String {
    format!("{low:+.3} to {high:+.3}")
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
        ("found", "found"),
        ("iou_part", "IoU_part"),
        ("iou_whole", "IoU_whole"),
        ("rotation_deg", "rotation error (°)"),
        ("pan_deg", "pan error (°)"),
        ("tilt_deg", "tilt error (°)"),
        ("focal_px", "focal length error (px)"),
    ]);
    for (way, answers) in ways {
        for answer in answers {
            let set = &sets[answer.repeat];
            let mut row: Vec<Cell> = vec![
                way.as_ref().into(),
                (set.seed as usize).into(),
                set.splits[answer.split].name.as_str().into(),
                set.frames[answer.frame].name.as_str().into(),
                answer.view_deg.into(),
                usize::from(answer.found.is_some()).into(),
            ];
            match &answer.found {
                Some(found) => row.extend([
                    found.iou.into(),
                    found.iou_whole.into(),
                    found.error.rotation.degrees().into(),
                    found.error.pan.degrees().into(),
                    found.error.tilt.degrees().into(),
                    found.error.focal_px.into(),
                ]),
                None => row.resize(table.columns.len(), Cell::Empty),
            }
            table.push(row);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(repeat: usize, iou: Option<f64>) -> FrameAnswer {
        let base = crate::setting::base();
        let camera = PtzCamera::new(
            base,
            touchline_core::camera::Ptz::from_degrees(50.0, -9.0, 3000.0),
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
            predict_ms: 0.0,
            pose_ms: 0.0,
        }
    }

    #[test]
    fn what_was_not_found_counts_as_zero_and_the_mean_of_found_does_not_know_it() {
        let all = [
            answer(0, Some(0.9)),
            answer(0, None),
            answer(0, Some(0.5)),
            answer(0, Some(1.0)),
        ];
        let tally = Tally::of(all.iter());
        assert_eq!((tally.frames, tally.found, tally.failed), (4, 3, 2));
        assert!((tally.iou_mean - 0.6).abs() < 1e-12 && (tally.iou_of_found - 0.8).abs() < 1e-12);
        assert!((tally.within_rotation - 0.75).abs() < 1e-12);
        let [low, high] = tally.iou_interval;
        assert!(low < 0.6 && high > 0.6 && low >= 0.0, "{low} {high}");
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
        assert_eq!(Tally::of(all.iter()).iou_interval, [0.0, 1.0]);
        let three = [0.60, 0.61, 0.62].map(|iou| [answer(0, Some(iou)); 1]);
        let all: Vec<FrameAnswer> = three
            .iter()
            .enumerate()
            .map(|(repeat, [answer])| FrameAnswer { repeat, ..*answer })
            .collect();
        let [low, high] = Tally::of(all.iter()).iou_interval;
        // 4.303 × 0.01 / √3 = 0.02484.
        assert!(
            (low - 0.585_16).abs() < 1e-4 && (high - 0.634_84).abs() < 1e-4,
            "{low} {high}"
        );
        assert!(Tally::of([].iter()).iou_mean.is_nan());
    }

    #[test]
    fn a_difference_is_taken_in_each_seed() {
        // The seeds differ by 0.3, the methods by 0.1 in each of them.
        let of: Vec<FrameAnswer> = [0.5, 0.8]
            .iter()
            .enumerate()
            .map(|(seed, iou)| answer(seed, Some(*iou)))
            .collect();
        let than: Vec<FrameAnswer> = [0.4, 0.7]
            .iter()
            .enumerate()
            .map(|(seed, iou)| answer(seed, Some(*iou)))
            .collect();
        let [low, high] = difference(&of, &than, |tally| tally.iou_mean);
        assert!(
            (low - 0.1).abs() < 1e-9 && (high - 0.1).abs() < 1e-9,
            "{low} {high}"
        );
        let [low, high] = difference(&of[..1], &than[..1], |tally| tally.iou_mean);
        assert!(low.is_nan() && high.is_nan());
        assert_eq!(describe_difference([-0.01, 0.2]), "-0.010 to +0.200");
    }
}
