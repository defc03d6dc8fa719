//! How a forest is trained and asked.

use touchline_core::geometry::Angle;

/// How a split is chosen among the descriptor bytes that are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplitRule {
    /// Among the bytes that vary most, in the widest gap between values that leaves each side its
    /// share: samples near a threshold, which noise sends to the wrong side, are the fewest there.
    /// It looks at descriptors alone.
    WidestGap,
    /// The published rule: among any bytes, at this many random thresholds each, where the unit
    /// rays of the two sides deviate least from their means in sum of squares.
    RayDeviation {
        /// Thresholds tried for each byte.
        thresholds: u32,
    },
}

/// How a forest is trained. The defaults are what won on drawn and real frames (see the room's
/// documentation);
/// [`Self::published`] gives the settings of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrainOptions {
    /// How many trees. 3 by default.
    pub trees: u32,
    /// The longest way from the root to a leaf. 64 by default: longer than any that is needed.
    pub max_depth: u32,
    /// How a split is chosen. The widest gap by default.
    pub rule: SplitRule,
    /// Descriptor bytes tried at a split. 2 by default.
    pub dimensions: u32,
    /// A node with at most as many samples is a leaf. 32 by default.
    pub leaf_samples: u32,
    /// No leaf holds fewer samples than this. 1 by default; three and more were tried and lose.
    pub min_leaf: u32,
    /// Samples of a leaf whose rays are nearer to each other than this become one, their mean.
    /// 0.05° by default: about what a keypoint's own noise makes of one place.
    pub merge_within: Angle,
    /// At most this many samples are looked at to choose a split. 1000 by default.
    pub node_samples: u32,
    /// Frames drawn for each tree, without replacement; none takes all.
    pub frames_per_tree: Option<u32>,
    /// Where chance starts. The same seed gives the same forest on any number of threads.
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
    /// and a leaf that is the mean of all its samples.
    #[must_use]
    pub fn published() -> Self {
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

/// How a forest is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictOptions {
    /// Leaves examined per tree, on average: every tree's own first, then the branches missed by
    /// least, whichever tree they stand in. 1 by default; the paper has 4.
    pub leaves_per_tree: u32,
    /// What is farther off is no match; squared, of descriptors of unit length. 0.2 by default, as
    /// in the paper.
    pub max_squared_distance: f32,
    /// Means whose rays spread more than this (root mean square) mix different places and are no
    /// match. 0.5° by default.
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
