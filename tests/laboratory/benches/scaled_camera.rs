//! The camera of a picture that was made smaller and moved within a frame.

use touchline::camera::{Ptz, PtzCamera};
use touchline::geometry::ImagePoint;

/// A camera for its picture at `scale` times the size, with the top-left corner at `corner_px`.
pub fn scaled_camera(drawn: &PtzCamera, scale: f64, corner_px: [f64; 2]) -> PtzCamera {
    let (mut base, ptz) = (*drawn.base(), drawn.ptz());
    let (at, [left, top]) = (base.principal_point, corner_px);
    base.principal_point = ImagePoint::new(scale * at.x + left, scale * at.y + top);
    base.distortion.at_focal_px *= scale;
    base.distortion.per_1000_px /= scale;
    let focal_px = scale * ptz.focal_px;
    PtzCamera::new(base, Ptz { focal_px, ..ptz })
}
