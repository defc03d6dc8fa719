//! The logarithmic axis of 1 − `IoU` in figures.

use touchline::report::figure::Axis;

/// Its range. An `IoU` of 1 is drawn at the lower end, because a logarithmic axis has no 0; a frame
/// without an answer is at 1.
pub const ENDS: [f64; 2] = [1e-5, 1.3];

/// The axis.
pub fn axis() -> Axis {
    Axis::log("1 − IoU").within(ENDS[0], ENDS[1])
}
