//! How a forest is trained and asked.

use crate::geometry::Angle;

/// How a forest is trained; the defaults are those of the paper, except where it says otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrainOptions {
    /// How many trees. 5 by default.
    pub trees: u32,
    /// The longest way from the root to a leaf. 20 by default.
    pub max_depth: u32,
    /// Descriptor bytes tried at a split. 6 by default.
    pub dimensions: u32,
    /// Thresholds tried for each. 10 by default.
    pub thresholds: u32,
    /// No leaf holds fewer samples than this. 1 by default; three and more were tried and lose.
    pub min_leaf: u32,
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
            trees: 5,
            max_depth: 20,
            dimensions: 6,
            thresholds: 10,
            min_leaf: 1,
            node_samples: 1000,
            frames_per_tree: None,
            seed: 0,
        }
    }
}

/// How a forest is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictOptions {
    /// Leaves examined per tree, on average: the branches missed by least are taken first, whichever tree they stand in.
    /// 4 by default, as in the paper.
    pub leaves_per_tree: u32,
    /// Leaves whose descriptor is farther off are no match; squared, of descriptors of unit length. 0.2 by default.
    pub max_squared_distance: f32,
    /// Leaves whose rays spread more than this (root mean square) mix different places and are no match. 0.5° by default.
    pub max_spread: Angle,
}

impl Default for PredictOptions {
    fn default() -> Self {
        Self { leaves_per_tree: 4, max_squared_distance: 0.2, max_spread: Angle::from_degrees(0.5) }
    }
}
