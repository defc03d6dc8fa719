//! Errors of an estimated camera against the true one, and statistics of errors.
//!
//! | what | where |
//! |---|---|
//! | rotation, pan, tilt, focal length, position | [`camera_error`] |
//! | the field seen from above: the part in the picture, its segments, the whole | [`iou_part`], [`iou_segments`], [`iou_whole`] |
//! | the same for a homography of the ground | [`PlaneView`] |
//! | pixels in which a picture shows the field | [`field_grid`] |
//! | landmarks, px in the picture, m on the ground | [`landmark_errors`], [`ground_error_m`] |
//! | markings found within some px, as in `SoccerNet` | [`MarkingMatch`] |
//! | whether stated sigmas match the errors | [`SigmaCoverage`] |
//! | mean, spread, percentiles, bootstrap intervals | [`Summary`] |
//! | click noise of an annotator | [`ClickScatter`] |

mod camera_error;
mod click_scatter;
mod field_grid;
mod ground;
mod marking_match;
mod overlap;
mod plane;
mod polygon;
mod statistics;

pub use click_scatter::ClickScatter;
pub use statistics::{SigmaCoverage, Summary};

pub use camera_error::camera_error;
pub use field_grid::field_grid;
pub(crate) use statistics::chi_squared_quantile;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    camera_error::CameraError, camera_error::FieldView, camera_error::LandmarkError,
    camera_error::ground_error_m, camera_error::horizontal_view, camera_error::landmark_errors,
    ground::visible_field, ground::visible_outline, marking_match::AnnotatedLine,
    marking_match::MarkingMatch, marking_match::NamedMatch, marking_match::annotated_lines,
    overlap::iou_part, overlap::iou_segments, overlap::iou_whole, plane::PlaneView,
    statistics::median_normal_size, statistics::median_rayleigh, statistics::rayleigh_share,
    statistics::squared_mahalanobis,
};
