//! The two kinds of forests that are compared, and forests trained on the splits of a set.

use super::answers::{FrameAnswer, RayCount};
use crate::report::paper::INLIER_DEG;
use crate::sets::{FrameSet, KnownFrame, Split};
use rayon::prelude::*;
use touchline::camera::{CameraBase, PanTilt, PtzCamera};
use touchline::geometry::{Angle, Vec3};
use touchline::progress::Progress;
use touchline::relocalize::{
    Forest, PredictOptions, RelocalizeOptions, Samples, SeenRange, TrainOptions, candidates_of,
    relocalize, train,
};

/// Number of leaves of each tree that the paper's program evaluates.
const PUBLISHED_LEAVES: u32 = 4;

/// The kind of forest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForestKind {
    /// This program's default settings.
    Default,
    /// The paper's settings: trained as by `touchline train --published`, and evaluated as in the
    /// paper.
    Published,
}

impl ForestKind {
    pub const BOTH: [Self; 2] = [Self::Default, Self::Published];
    /// Both, in the order of reports.
    pub const PAPER_FIRST: [Self; 2] = [Self::Published, Self::Default];

    /// Its name in files.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Published => "published",
        }
    }

    /// Its name in tables and legends.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Default => "default forest",
            Self::Published => "--published forest",
        }
    }

    pub fn training(self, seed: u64) -> TrainOptions {
        match self {
            Self::Default => TrainOptions {
                seed,
                ..TrainOptions::default()
            },
            Self::Published => TrainOptions {
                seed,
                ..TrainOptions::from_paper()
            },
        }
    }

    pub fn asking(self, seed: u64) -> RelocalizeOptions {
        let mut options = RelocalizeOptions::default();
        options.pose.seed = seed;
        if self == Self::Published {
            options.predict = PredictOptions {
                leaves_per_tree: PUBLISHED_LEAVES,
                // No limit on the spread of a leaf's rays, as in the paper's program.
                max_spread: Angle::from_degrees(180.0),
                ..options.predict
            };
        }
        options
    }
}

/// The forests of a set, one for each split.
pub struct Trained<'a> {
    set: &'a FrameSet,
    repeat: usize,
    /// None if the training frames have no features.
    forests: Vec<Option<(Forest, SeenRange)>>,
}

impl<'a> Trained<'a> {
    /// Trains a forest for each split. `repeat` is the index of the set among those of other seeds.
    pub fn train(set: &'a FrameSet, repeat: usize, training: &TrainOptions) -> Self {
        let forest = |split: &Split| {
            train_forest(
                split
                    .training_frames
                    .iter()
                    .map(|&frame| &set.frames[frame]),
                training,
            )
        };
        Self {
            set,
            repeat,
            forests: set.splits.iter().map(forest).collect(),
        }
    }

    /// The forests reduced to their first trees, as if no more had been trained.
    pub fn first_trees(&self, trees: usize) -> Self {
        let first =
            |(forest, seen): &(Forest, SeenRange)| (forest.first_trees(trees), seen.clone());
        Self {
            forests: self
                .forests
                .iter()
                .map(|forest| forest.as_ref().map(first))
                .collect(),
            ..*self
        }
    }

    /// Relocalizes all test frames. `base_of` gives the base to use, from the true camera.
    pub fn ask(
        &self,
        asking: &RelocalizeOptions,
        base_of: &(dyn Fn(&PtzCamera) -> CameraBase + Sync),
    ) -> Vec<FrameAnswer> {
        // All cameras are computed without the test, which is then applied to the stated
        // confidence: one run gives both answers.
        let untested = without_test(asking);
        let of_split = |(number, split): (usize, &Split)| -> Vec<FrameAnswer> {
            let one = |&frame: &usize| {
                let known = &self.set.frames[frame];
                let mut tested = FrameAnswer::blank(self.set, self.repeat, number, frame);
                let Some((forest, seen)) = &self.forests[number] else {
                    return tested;
                };
                // The base is that of the frame's true camera, or a changed one in the experiment
                // on distortion.
                let base = base_of(&known.truth);
                let answer = relocalize(&known.features, forest, seen, &base, &untested);
                tested.predict_ms = answer.predict_time.as_secs_f64() * 1e3;
                tested.pose_ms = answer.pose_time.as_secs_f64() * 1e3;
                if let Ok(pose) = answer.pose {
                    let camera = PtzCamera::new(base, pose.ptz);
                    let is_sure = pose.confidence >= asking.pose.min_confidence;
                    tested = tested.with_camera(self.set, &camera, is_sure);
                }
                tested
            };
            // In parallel within a split, in the order of the frames.
            split.test_frames.par_iter().map(one).collect()
        };
        self.set
            .splits
            .iter()
            .enumerate()
            .flat_map(of_split)
            .collect()
    }

    /// Relocalizes all test frames with their true bases.
    pub fn ask_plainly(&self, asking: &RelocalizeOptions) -> Vec<FrameAnswer> {
        self.ask(asking, &|truth| *truth.base())
    }

    /// Counts the features of all test frames, the rays that were predicted for them, and those
    /// within 0.5° of the true one: the nearest of each feature, and all.
    pub fn count_rays(&self, predict: &PredictOptions) -> RayCount {
        let of_split = |(number, split): (usize, &Split)| {
            let Some((forest, _)) = &self.forests[number] else {
                return RayCount::default();
            };
            let one = |&frame: &usize| {
                let known = &self.set.frames[frame];
                let matches = candidates_of(&known.features, forest, predict);
                let mut count = RayCount {
                    features: known.features.len(),
                    ..RayCount::default()
                };
                for feature in 0..matches.len() {
                    let rays = matches.rays(feature);
                    // A feature beyond the fold of the lens has no true ray to compare with.
                    let Ok(truth) = known.truth.ray_from_image(matches.point(feature)) else {
                        continue;
                    };
                    let is_right = |ray: &Vec3| {
                        PanTilt::from_direction(*ray).angle_to(truth).degrees() < INLIER_DEG
                    };
                    count.with_ray += usize::from(!rays.is_empty());
                    // The first ray is that of the nearest leaf.
                    count.nearest_right += usize::from(rays.first().is_some_and(is_right));
                    count.rays += rays.len();
                    count.right += rays.iter().filter(|ray| is_right(ray)).count();
                }
                count
            };
            split
                .test_frames
                .par_iter()
                .map(one)
                .reduce(RayCount::default, RayCount::plus)
        };
        self.set
            .splits
            .iter()
            .enumerate()
            .map(of_split)
            .fold(RayCount::default(), RayCount::plus)
    }
}

/// The same options without the test of confidence.
pub fn without_test(asking: &RelocalizeOptions) -> RelocalizeOptions {
    let mut untested = asking.clone();
    untested.pose.min_confidence = 0.0;
    untested
}

/// Trains a forest on these frames. Returns it with the range of their views; none if they have no
/// features.
pub fn train_forest<'a>(
    frames: impl Iterator<Item = &'a KnownFrame>,
    training: &TrainOptions,
) -> Option<(Forest, SeenRange)> {
    let mut samples = Samples::new();
    let mut looked = Vec::new();
    for known in frames {
        let rays = known
            .features
            .keypoints
            .iter()
            .map(|keypoint| known.truth.ray_from_image(keypoint.point));
        let pairs = rays.zip(&known.features.descriptors);
        // One frame at a time, because a tree may draw whole frames (30 in the paper's settings).
        samples.add_frame(pairs.filter_map(|(ray, descriptor)| Some((*descriptor, ray.ok()?))));
        looked.push(known.truth.ptz());
    }
    // None without frames. Without samples training fails, which is the same to the caller.
    let seen = SeenRange::from_cameras(&looked)?;
    let forest = train(&samples, training, &Progress::default()).ok()?;
    Some((forest, seen))
}

/// For each set in turn, trains its forests and relocalizes its test frames.
pub fn ask_all(sets: &[FrameSet], kind: ForestKind) -> Vec<FrameAnswer> {
    let of_set = |(repeat, set): (usize, &FrameSet)| {
        Trained::train(set, repeat, &kind.training(set.seed)).ask_plainly(&kind.asking(set.seed))
    };
    sets.iter().enumerate().flat_map(of_set).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setting::rng;
    use rand::RngExt;
    use touchline::features::Descriptor;

    #[test]
    fn the_first_trees_are_those_of_a_smaller_forest() {
        let mut draw = rng(4, [1, 2]);
        let mut samples = Samples::new();
        for _ in 0..40 {
            let each: Vec<(Descriptor, PanTilt)> = (0..50)
                .map(|_| {
                    let values = std::array::from_fn(|_| draw.random_range(0.0f32..1.0).powi(3));
                    let [pan, tilt] = [0.0..60.0, -14.0..-5.0]
                        .map(|range| Angle::from_degrees(draw.random_range(range)));
                    (Descriptor::root(&values), PanTilt { pan, tilt })
                })
                .collect();
            samples.add_frame(each);
        }
        for kind in ForestKind::BOTH {
            let trained = |trees: u32| {
                let options = TrainOptions {
                    trees,
                    ..kind.training(7)
                };
                train(&samples, &options, &Progress::default()).unwrap()
            };
            assert_eq!(trained(4).first_trees(2), trained(2), "{kind:?}");
        }
    }
}
