//! A tie: what two frames of one camera show alike.

use touchline_core::geometry::{ImagePoint, Mat3, Vec3};

/// Matches of two frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Tie {
    /// The first frame, by its place among those that were tied.
    pub first: usize,
    /// The second.
    pub second: usize,
    /// Where the same thing is in the first and in the second frame, px.
    pub matches: Vec<(ImagePoint, ImagePoint)>,
    /// How many matches agreed before they were thinned.
    pub agreeing: usize,
    /// The homography from the first to the second frame, px.
    pub second_from_first: Mat3,
}

/// Where a homography between two frames brings a point; none where it lies behind the second
/// frame's camera.
pub(super) fn brought(to_from: &Mat3, at: ImagePoint) -> Option<ImagePoint> {
    let there = to_from * Vec3::new(at.x, at.y, 1.0);
    (there.z > 0.0).then(|| ImagePoint::new(there.x / there.z, there.y / there.z))
}

/// How much larger the second frame shows what is at a point of the first, and how far it is turned
/// there, degrees.
pub(super) fn zoom_and_turn(second_from_first: &Mat3, at: ImagePoint) -> Option<(f64, f64)> {
    let h = second_from_first;
    let w = h[(2, 0)] * at.x + h[(2, 1)] * at.y + h[(2, 2)];
    let x = (h[(0, 0)] * at.x + h[(0, 1)] * at.y + h[(0, 2)]) / w;
    let y = (h[(1, 0)] * at.x + h[(1, 1)] * at.y + h[(1, 2)]) / w;
    let along =
        |row: usize, column: usize, value: f64| (h[(row, column)] - value * h[(2, column)]) / w;
    let (xx, xy, yx, yy) = (
        along(0, 0, x),
        along(0, 1, x),
        along(1, 0, y),
        along(1, 1, y),
    );
    let area = xx * yy - xy * yx;
    let turn = (yx - xy).atan2(xx + yy).to_degrees();
    (area.is_finite() && area > 0.0).then(|| (area.sqrt(), turn))
}
