//! The axis of 1 − `IoU` in figures.

use touchline_documents::report::figure::Axis;

/// Its ends: a log axis has no place for an `IoU` of 1, and a frame that was not found lies at 1.
pub const ENDS: [f64; 2] = [1e-5, 1.3];

/// The axis.
pub fn axis() -> Axis {
    Axis::log("1 − IoU").within(ENDS[0], ENDS[1])
}
