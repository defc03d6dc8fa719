//! What an unknown length or width of the field leaves open: where the base would stand, and which
//! lines would lie elsewhere.
//!
//! What a camera has seen of a field is right there whatever the field's size is: the base goes
//! with it. Lines of other parts go another way. Where the middle of a pitch alone was seen, its ends
//! are drawn half a metre off for each metre that its length is off, and nothing that was seen
//! tells.

use super::shared_parameters::SharedError;

/// The error of one dimension of the field, and what follows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SizeError {
    /// 1-σ of the dimension, m; zero where it is known.
    pub sigma_m: f64,
    /// Ground up to this distance from the middle has lines that stay where they are, m.
    pub still_m: f64,
    /// Ground from this distance on has lines that go with the end, half a metre for each metre, m;
    /// zero where none is known to.
    pub end_m: f64,
    /// The change of the shared parameters per metre of the dimension.
    pub base_by_m: SharedError,
}

impl SizeError {
    /// A dimension that nothing else depends on.
    pub fn alone(sigma_m: f64) -> Self {
        Self {
            sigma_m,
            ..Self::default()
        }
    }

    /// By how much lines at a place along the dimension, m from the middle, move for each metre of
    /// it, which is the length (`axis` 0) or the width (1). Between the middle and the ends no line
    /// crosses the dimension, and what is drawn there goes with the base.
    pub fn motion_at(&self, along_m: f64, axis: usize) -> f64 {
        let from_middle_m = along_m.abs();
        if from_middle_m <= self.still_m {
            0.0
        } else if self.end_m > 0.0 && from_middle_m >= self.end_m {
            0.5 * along_m.signum()
        } else {
            self.base_by_m[axis]
        }
    }
}
