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
mod coverage;
mod distribution;
mod field_grid;
mod ground;
mod landmarks;
mod marking_match;
mod overlap;
mod plane;
mod polygon;
mod statistics;
mod view;

pub use camera_error::{CameraError, camera_error, horizontal_view};
pub use click_scatter::ClickScatter;
pub use coverage::{SigmaCoverage, squared_mahalanobis};

pub(crate) use distribution::chi_squared_quantile;
pub use distribution::{median_normal_size, median_rayleigh, rayleigh_share};
pub use field_grid::field_grid;
pub use ground::visible_field;
pub use landmarks::{LandmarkError, ground_error_m, landmark_errors};
pub use marking_match::{AnnotatedLine, MarkingMatch, NamedMatch, annotated_lines};
pub use overlap::{iou_part, iou_segments, iou_whole};
pub use plane::PlaneView;
pub use statistics::Summary;
pub use view::FieldView;
