//! The pan-tilt forest: from a descriptor to its candidate rays (section 3.2 of the paper).
//!
//! A split tests one byte of the descriptor against a threshold. A leaf has descriptors with
//! their rays; samples of one place of the stadium, seen from several references, are averaged. A
//! query descends in all trees and is compared byte by byte with the content of the leaves reached,
//! and then, best first, with that of the branches of smallest margin. A gate on the squared
//! distance rejects outliers, and the nearest places remain as candidates.
//!
//! Rays are exact directions in `base`, so that one scene point has one label in every frame.
//!
//! # Where it departs from the paper, and what was tried
//!
//! The published forest ([`TrainOptions::from_paper`]) splits until a leaf has one sample or depth
//! 20 is reached, and represents a leaf by the mean of its samples. That has two drawbacks: a
//! single wrong branch on a long descent ends at an outlier, and at depth 20 leaves mix places. The
//! table shows the share of rays within 0.5° and the time for the features of one frame on a busy
//! machine, one descriptor at a time. Data are the drawn references and frames of the bench, 1000
//! SIFT features a frame, 120 000 samples; exhaustive search names 0.675 of the rays within 0.5°.
//!
//! | forest | rays | ms |
//! |---|---|---|
//! | published, 4 leaves per tree | 0.448 | 9.6 |
//! | the same without a limit of depth | 0.585 | 25 |
//! | leaves of 8 samples, published splits, 5 trees, 7 leaves in total | 0.620 | 16 |
//! | the same splits among the 24 bytes of largest variance, 2 trees | 0.610 | 4.4 |
//! | the widest gap among them instead, 2 trees, leaves of 16 | 0.604 | 0.9 |
//! | and places merged in the leaves, 2 trees, 2 leaves in total | 0.575 | 0.6 |
//! | 3 trees, leaves of 32, 3 leaves in total (the default) | 0.614 | 1.0 |
//! | 5 trees, leaves of 32, 5 leaves in total | 0.638 | 2.4 |
//!
//! With lookup in groups, and with sketches of a quarter of the bytes that reject outliers, the
//! default takes 0.7 ms for 0.604 of the rays, and 5 trees take 1.2 ms for 0.633. Of the content of
//! a leaf, 0.12 is within the gate. The share that remains to be compared, with one in a hundred of
//! these lost, is 0.15 for sketches of two by two cells that are allowed half of the gate, 0.16 for
//! those of rows of four cells, and 0.22 for one bit per byte. A bound that loses none leaves 0.41
//! for two by two cells, 0.54 for rows, and 0.19 for sketches of twice the size.
//!
//! Tried without gain: the mean as threshold (as in other randomised k-d trees), more than 2 bytes
//! per split, leaves of 64 (slower than their gain is worth), following branches whose margin
//! exceeds a quarter of the best distance, votes of several near neighbours (0.676 falls to 0.663
//! as more vote), and a minimum of three or more samples per leaf.
//!
//! Also without gain: excluding samples that overlapping references do not confirm. Each sample was
//! searched in up to six references that see its ray at a similar focal length, and confirmed by a
//! descriptor within the gate at that ray. The table has the drawn frames, and real ones (300
//! features, every clip of three matches answered by the others, 141 frames) with the number of
//! answers given with all references and with eight:
//!
//! | kept | drawn: places, rays | real: samples, answers |
//! |---|---|---|
//! | all | 220 000, 0.604 | 100 %, 139 and 137 |
//! | unless similar at another ray and never confirmed | 199 000, 0.595 | 92 %, 140 and 137 |
//! | confirmed as often as similar at another ray | 192 000, 0.586 | 91 %, 141 and 136 |
//! | confirmed, where four references or more overlap | 130 000, 0.578 | 41 %, 141 and 132 |
//! | confirmed, where any overlap | 88 000, 0.560 | 35 %, 139 and 121 |
//! | confirmed by a quarter | 73 000, 0.533 | 19 %, 138 and 99 |
//!
//! Accuracy was the same throughout. A frame between the references needs what only one of them
//! shows, and consensus rejects outliers at no cost; searching for confirmation takes longer than
//! training.

mod file;
mod predict;
mod search;
mod split;
mod train;
mod tree;

pub use file::ForestFileError;
pub(super) use file::{Reader, write_forest};
pub use predict::RayCandidate;
pub use search::Search;
pub use split::Samples;
pub use train::{Stopped, TrainProgress, train, train_without};
pub use tree::Forest;

use touchline_core::geometry::Angle;

/// The rule that chooses a split among the descriptor bytes tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplitRule {
    /// The widest gap between values that leaves each side its share, among the bytes of largest
    /// variance: few samples lie near such a threshold, where noise would send them to the wrong
    /// side. Uses descriptors only.
    WidestGap,
    /// The published rule: among any bytes, with this many random thresholds each, the split of
    /// least summed squared deviation of the unit rays from the mean of their side.
    RayDeviation {
        /// Thresholds tried for each byte.
        thresholds: u32,
    },
}

/// Options of training. The defaults are the settings that performed best on drawn and real frames
/// (see the documentation of the module); [`Self::from_paper`] gives those of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrainOptions {
    /// Number of trees. Default: 3.
    pub trees: u32,
    /// Maximum depth. Default: 64, more than is ever needed.
    pub max_depth: u32,
    /// The rule that chooses a split. Default: the widest gap.
    pub rule: SplitRule,
    /// Number of descriptor bytes tried per split. Default: 2.
    pub dimensions: u32,
    /// A node with at most this many samples becomes a leaf. Default: 32.
    pub leaf_samples: u32,
    /// Minimum number of samples of a leaf. Default: 1; three and more were tried and are worse.
    pub min_leaf: u32,
    /// Samples of a leaf whose rays are closer than this are averaged. Default: 0.05°, about the
    /// effect of a keypoint's own noise.
    pub merge_within: Angle,
    /// Maximum number of samples considered to choose a split. Default: 1000.
    pub node_samples: u32,
    /// Number of frames drawn per tree, without replacement; `None` takes all.
    pub frames_per_tree: Option<u32>,
    /// Seed of the random draws. The same seed gives the same forest for any number of threads.
    pub seed: u64,
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self {
            trees: 3,
            max_depth: 64,
            rule: SplitRule::WidestGap,
            dimensions: 2,
            leaf_samples: 32,
            min_leaf: 1,
            merge_within: Angle::from_degrees(0.05),
            node_samples: 1000,
            frames_per_tree: None,
            seed: 0,
        }
    }
}

impl TrainOptions {
    /// The settings of the paper: 5 trees of 30 frames, depth 20, 6 bytes with 10 thresholds each,
    /// and leaves that contain the mean of all their samples.
    pub fn from_paper() -> Self {
        Self {
            trees: 5,
            max_depth: 20,
            rule: SplitRule::RayDeviation { thresholds: 10 },
            dimensions: 6,
            leaf_samples: 1,
            merge_within: Angle::from_degrees(180.0),
            frames_per_tree: Some(30),
            ..Self::default()
        }
    }
}

/// Options of prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictOptions {
    /// Mean number of leaves examined per tree: the first leaf of every tree, then the branches of
    /// smallest margin over all trees. Default: 1; the paper has 4.
    pub leaves_per_tree: u32,
    /// Maximum squared distance of a match, of descriptors of unit length. Default: 0.2, as in the
    /// paper.
    pub max_squared_distance: f32,
    /// Maximum root mean square spread of a mean's rays; a larger one mixes different places.
    /// Default: 0.5°.
    pub max_spread: Angle,
}

impl Default for PredictOptions {
    fn default() -> Self {
        Self {
            leaves_per_tree: 1,
            max_squared_distance: 0.2,
            max_spread: Angle::from_degrees(0.5),
        }
    }
}
