//! Frames asked of a forest, and how far its answers are from the truth.

use super::sets::{FrameSet, Split};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::relocalize::{RelocalizeOptions, TrainOptions, relocalize, train};
use crate::report::{Cell, Table};
use crate::score::{CameraError, camera_error, horizontal_view, iou_part, quantile};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// What became of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AskedFrame {
    /// Which frame of the set.
    pub frame: usize,
    /// Which split it was asked in.
    pub split: usize,
    /// Its horizontal field of view, degrees.
    pub view_deg: f64,
    /// What the answer errs by; none: not found.
    pub found: Option<FoundCamera>,
    /// How long features waited for their rays, and those for a camera, ms.
    pub predict_ms: f64,
    /// Finding the camera, ms.
    pub pose_ms: f64,
}

/// The errors of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundCamera {
    /// The camera that was found.
    pub camera: PtzCamera,
    /// `IoU_part`; none where the picture shows nothing of the field.
    pub iou: Option<f64>,
    /// Of rotation, pan, tilt, focal length.
    pub error: CameraError,
}

impl FoundCamera {
    /// The errors of an estimate.
    pub fn of(set: &FrameSet, frame: usize, estimate: &PtzCamera) -> Self {
        let known = &set.frames[frame];
        Self {
            camera: *estimate,
            iou: iou_part(&known.field, &known.truth, estimate, known.features.image_size),
            error: camera_error(&known.truth, estimate),
        }
    }
}

/// Trains a forest for every split and asks it for all test frames of that split. `base_of` may give the asked frames another base than
/// the true one.
pub fn ask(
    set: &FrameSet,
    training: &TrainOptions,
    asking: &RelocalizeOptions,
    base_of: &(dyn Fn(&PtzCamera) -> CameraBase + Sync),
) -> Vec<AskedFrame> {
    let of_split = |(number, split): (usize, &Split)| -> Vec<AskedFrame> {
        let forest = set.training_samples(&split.training_frames).and_then(|(samples, seen)| {
            let forest = train(&samples, training, &|_| ControlFlow::Continue(())).ok()?;
            Some((forest, seen))
        });
        let one = |&frame: &usize| {
            let known = &set.frames[frame];
            let view_deg = horizontal_view(known.truth.ptz().focal_px, known.features.image_size).degrees();
            let mut asked = AskedFrame { frame, split: number, view_deg, found: None, predict_ms: 0.0, pose_ms: 0.0 };
            let Some((forest, seen)) = &forest else { return asked };
            let base = base_of(&known.truth);
            let answer = relocalize(&known.features, forest, seen, &base, asking);
            asked.predict_ms = answer.predict_time.as_secs_f64() * 1e3;
            asked.pose_ms = answer.pose_time.as_secs_f64() * 1e3;
            let found = |ptz: Ptz| FoundCamera::of(set, frame, &PtzCamera::new(base, ptz));
            asked.found = answer.pose.ok().map(|pose| found(pose.ptz));
            asked
        };
        split.asked.par_iter().map(one).collect()
    };
    set.splits.iter().enumerate().flat_map(of_split).collect()
}

/// Asks with the true bases.
pub fn ask_plainly(set: &FrameSet, training: &TrainOptions, asking: &RelocalizeOptions) -> Vec<AskedFrame> {
    ask(set, training, asking, &|truth| *truth.base())
}

/// How many frames went, in a few numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    pub asked: usize,
    pub found: usize,
    pub iou_mean: f64,
    pub iou_std: f64,
    pub rotation_median_deg: f64,
    pub rotation_90_deg: f64,
    pub focal_median_px: f64,
    pub focal_90_px: f64,
}

/// The columns of [`Tally::cells`].
pub const TALLY_COLUMNS: [(&str, &str); 8] = [
    ("asked", "frames"),
    ("found", "found"),
    ("iou_mean", "IoU, mean of found"),
    ("iou_std", "±"),
    ("rotation_median_deg", "rotation error, median (°)"),
    ("rotation_90_deg", "90 % (°)"),
    ("focal_median_px", "focal error, median (px)"),
    ("focal_90_px", "90 % (px)"),
];

impl Tally {
    pub fn of<'a>(asked: impl Iterator<Item = &'a AskedFrame>) -> Self {
        let all: Vec<&AskedFrame> = asked.collect();
        let found: Vec<FoundCamera> = all.iter().filter_map(|asked| asked.found).collect();
        let ascending = |of: &dyn Fn(&FoundCamera) -> f64| {
            let mut values: Vec<f64> = found.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let ious: Vec<f64> = found.iter().filter_map(|found| found.iou).collect();
        let count = ious.len() as f64;
        let iou_mean = ious.iter().sum::<f64>() / count;
        let squares: f64 = ious.iter().map(|iou| (iou - iou_mean).powi(2)).sum();
        let rotation = ascending(&|found| found.error.rotation.degrees());
        let focal = ascending(&|found| found.error.focal_px.abs());
        Self {
            asked: all.len(),
            found: found.len(),
            iou_mean,
            iou_std: (squares / (count - 1.0).max(1.0)).sqrt(),
            rotation_median_deg: quantile(&rotation, 0.5),
            rotation_90_deg: quantile(&rotation, 0.9),
            focal_median_px: quantile(&focal, 0.5),
            focal_90_px: quantile(&focal, 0.9),
        }
    }

    pub fn cells(&self) -> Vec<Cell> {
        let number = |value: f64| if value.is_finite() { Cell::Number(value) } else { Cell::Empty };
        vec![
            self.asked.into(),
            self.found.into(),
            number(self.iou_mean),
            number(self.iou_std),
            number(self.rotation_median_deg),
            number(self.rotation_90_deg),
            number(self.focal_median_px),
            number(self.focal_90_px),
        ]
    }
}

/// A table of tallies, one for each name.
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

/// The frames asked by the name of their split, and all together.
pub fn by_name<'a>(set: &'a FrameSet, asked: &'a [AskedFrame]) -> Vec<(&'a str, Vec<&'a AskedFrame>)> {
    let of = |name: &str| asked.iter().filter(|asked| set.splits[asked.split].name == name).collect();
    let mut parts: Vec<(&str, Vec<&AskedFrame>)> = set.names().into_iter().map(|name| (name, of(name))).collect();
    parts.push(("all", asked.iter().collect()));
    parts
}
