//! A pairwise match: an edge of the view graph of one camera's frames.

use touchline_core::geometry::{ImagePoint, Mat3, Vec3};

/// Point correspondences of two frames of one camera, and the homography that they agree on.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewGraphEdge {
    /// The first frame, as an index into the frames that were matched.
    pub first: usize,
    /// The second frame, likewise.
    pub second: usize,
    /// The same point in the first and in the second frame, px.
    pub matches: Vec<(ImagePoint, ImagePoint)>,
    /// Number of inliers before the matches were subsampled.
    pub agreeing: usize,
    /// The homography from the first to the second frame, px.
    pub second_from_first: Mat3,
}

/// Maps a point by a homography; `None` if it lies behind the second camera.
pub(super) fn brought(to_from: &Mat3, at: ImagePoint) -> Option<ImagePoint> {
    let there = to_from * Vec3::new(at.x, at.y, 1.0);
    (there.z > 0.0).then(|| ImagePoint::new(there.x / there.z, there.y / there.z))
}

/// Zoom and image rotation, degrees, of a homography at a point. `None` if the map reverses
/// orientation there.
pub(super) fn zoom_and_turn(second_from_first: &Mat3, at: ImagePoint) -> Option<(f64, f64)> {
    // The image (x, y) of the point, dehomogenised by w. A homography has no sign: w may be
    // negative, and x, y and the Jacobian are the same for H and −H.
    let h = second_from_first;
    let w = h[(2, 0)] * at.x + h[(2, 1)] * at.y + h[(2, 2)];
    let x = (h[(0, 0)] * at.x + h[(0, 1)] * at.y + h[(0, 2)]) / w;
    let y = (h[(1, 0)] * at.x + h[(1, 1)] * at.y + h[(1, 2)]) / w;
    // The Jacobian of the dehomogenised map (x, y) at the point.
    let [xx, xy] = [0, 1].map(|column| (h[(0, column)] - x * h[(2, column)]) / w);
    let [yx, yy] = [0, 1].map(|column| (h[(1, column)] - y * h[(2, column)]) / w);
    // The zoom is the root of the change of area; the angle is that of the rotation nearest to the
    // 2 × 2 Jacobian.
    let area = xx * yy - xy * yx;
    let turn = (yx - xy).atan2(xx + yy).to_degrees();
    (area.is_finite() && area > 0.0).then(|| (area.sqrt(), turn))
}
