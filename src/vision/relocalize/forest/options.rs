//! Options of training and prediction.

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
