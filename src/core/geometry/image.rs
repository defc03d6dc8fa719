//! Points, segments, ellipses, sizes and boxes in a picture.

use super::Vec2;
use nalgebra::{Matrix2, SVector, SymmetricEigen};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A point of a picture, px, corner convention: (0, 0) is the top-left corner, x right, y down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct ImagePoint {
    /// To the right, px.
    pub x: f64,
    /// Downwards, px.
    pub y: f64,
}

impl ImagePoint {
    /// A point from its coordinates in px.
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// The vector from `origin` to this point, px.
    pub fn offset_from(self, origin: Self) -> Vec2 {
        Vec2::new(self.x - origin.x, self.y - origin.y)
    }

    /// This point moved by `offset` px.
    #[must_use]
    pub fn translate(self, offset: Vec2) -> Self {
        Self::new(self.x + offset.x, self.y + offset.y)
    }

    /// The distance to another point, px.
    pub fn distance_px(self, other: Self) -> f64 {
        (self.x - other.x).hypot(self.y - other.y)
    }

    /// Whether both coordinates are finite.
    pub const fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

impl From<[f64; 2]> for ImagePoint {
    fn from([x, y]: [f64; 2]) -> Self {
        Self::new(x, y)
    }
}

impl From<ImagePoint> for [f64; 2] {
    fn from(point: ImagePoint) -> Self {
        [point.x, point.y]
    }
}

/// The size of a picture, px.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(into = "[u32; 2]")]
pub struct ImageSize {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl From<ImageSize> for [u32; 2] {
    fn from(size: ImageSize) -> Self {
        [size.width, size.height]
    }
}

impl ImageSize {
    /// The centres of the cells of a regular grid over the picture, px, row by row.
    pub fn cell_centres(self, columns: u32, rows: u32) -> impl Iterator<Item = ImagePoint> {
        (0..rows).flat_map(move |row| {
            (0..columns).map(move |column| self.cell_centre([column, row], [columns, rows]))
        })
    }

    /// The centre of one cell of such a grid, px.
    pub fn cell_centre(self, [column, row]: [u32; 2], [columns, rows]: [u32; 2]) -> ImagePoint {
        ImagePoint::new(
            cell_centre_px(column, columns, self.width),
            cell_centre_px(row, rows, self.height),
        )
    }

    /// The largest width or height of a picture, px.
    pub const MAX_SIDE_PX: u32 = 65_535;

    /// A size from its columns and rows.
    pub const fn new(width: u32, height: u32) -> Self {
        Self { width, height }
    }

    /// Whether this is a valid width or height of a picture, px.
    pub fn is_side_px(value: f64) -> bool {
        (1.0..=f64::from(Self::MAX_SIDE_PX)).contains(&value)
    }

    /// Reads `1920x1080` or `1920 × 1080`; none where that is no size of a picture.
    pub fn parse(text: &str) -> Option<Self> {
        let (width, height) = text.split_once(['x', '×'])?;
        Some(Self::new(parse_side_px(width)?, parse_side_px(height)?))
    }

    /// The factor from a picture of this size to one of the same proportions; the height may have
    /// been rounded in either; none where the proportions differ.
    pub fn factor_to(self, other: Self) -> Option<f64> {
        let factor = f64::from(other.width) / f64::from(self.width);
        let off_px = f64::from(self.height) * factor - f64::from(other.height);
        (off_px.abs() <= factor.max(1.0)).then_some(factor)
    }

    /// The middle of the picture.
    pub fn centre(self) -> ImagePoint {
        ImagePoint::new(f64::from(self.width) / 2.0, f64::from(self.height) / 2.0)
    }

    /// The four corners, clockwise from the top left.
    pub fn corners(self) -> [ImagePoint; 4] {
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        [
            ImagePoint::new(0.0, 0.0),
            ImagePoint::new(width, 0.0),
            ImagePoint::new(width, height),
            ImagePoint::new(0.0, height),
        ]
    }

    /// Whether a point lies in the picture, its border included.
    pub fn contains(self, point: ImagePoint) -> bool {
        point.x >= 0.0
            && point.y >= 0.0
            && point.x <= f64::from(self.width)
            && point.y <= f64::from(self.height)
    }

    /// The width of the 16:9 picture that this one fits into, px. A picture that is narrower was cut
    /// from a wider one, or taken by a camera that was turned: its pixels are as fine as those of a
    /// 16:9 picture of its height, so tolerances and priors in px refer to that.
    pub fn reference_width_px(self) -> f64 {
        f64::from(self.width).max(f64::from(self.height) * 16.0 / 9.0)
    }

    /// The factor from px of a 16:9 picture 1920 px wide to px of this picture.
    pub fn scale_from_1920(self) -> f64 {
        self.reference_width_px() / 1920.0
    }
}

/// The centre of one of the equal cells that divide a side of a picture, px from where it begins.
fn cell_centre_px(cell: u32, cells: u32, side_px: u32) -> f64 {
    (f64::from(cell) + 0.5) / f64::from(cells) * f64::from(side_px)
}

/// Reads a width or height of a picture, px; none where it is not a valid one.
fn parse_side_px(text: &str) -> Option<u32> {
    text.trim()
        .parse::<u32>()
        .ok()
        .filter(|side_px| ImageSize::is_side_px(f64::from(*side_px)))
}

/// An axis-aligned box of pixels (`masks_px`): a score bug, a player.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelBox {
    /// Left edge, px.
    pub x: f64,
    /// Top edge, px.
    pub y: f64,
    /// Extent to the right, px.
    pub width: f64,
    /// Extent downwards, px.
    pub height: f64,
}

impl PixelBox {
    /// From the left and top edge and the extents, px.
    pub const fn new(x: f64, y: f64, width: f64, height: f64) -> Self {
        Self {
            x,
            y,
            width,
            height,
        }
    }

    /// Whether a point lies in the box, its left and top border included.
    pub fn contains(&self, point: ImagePoint) -> bool {
        point.x >= self.x
            && point.y >= self.y
            && point.x < self.x + self.width
            && point.y < self.y + self.height
    }

    /// The same box in a picture of another scale.
    #[must_use]
    pub fn scale_by(&self, by: f64) -> Self {
        Self {
            x: self.x * by,
            y: self.y * by,
            width: self.width * by,
            height: self.height * by,
        }
    }

    /// Its middle.
    pub const fn centre(&self) -> ImagePoint {
        ImagePoint::new(self.x + self.width / 2.0, self.y + self.height / 2.0)
    }
}

/// The distance of a point from the segment between two ends, in any number of dimensions; a
/// segment of zero length is a point.
pub fn distance_from_segment<const D: usize>(
    point: SVector<f64, D>,
    [from, to]: [SVector<f64, D>; 2],
) -> f64 {
    let (along, offset) = (to - from, point - from);
    (offset - along * share_along(offset, along)).norm()
}

/// Where the foot of a point lies on a segment, as a share of its length from 0 to 1; both are
/// vectors from the segment's beginning.
fn share_along<const D: usize>(offset: SVector<f64, D>, along: SVector<f64, D>) -> f64 {
    // The foot of the perpendicular is clamped to the segment: beyond an end, the end is nearest.
    let length_squared = along.norm_squared();
    if length_squared > 0.0 {
        (offset.dot(&along) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

impl ImagePoint {
    /// The distance from the segment between two points, px.
    pub fn distance_from_segment_px(self, from: Self, to: Self) -> f64 {
        distance_from_segment(
            self.offset_from(from),
            [super::Vec2::zeros(), to.offset_from(from)],
        )
    }

    /// The distance from a polyline, px; infinite if that has fewer than two points.
    pub fn distance_from_polyline_px(self, polyline: &[Self]) -> f64 {
        polyline
            .windows(2)
            .map(|ends| self.distance_from_segment_px(ends[0], ends[1]))
            .fold(f64::INFINITY, f64::min)
    }

    /// The point of the segment between two points that is nearest to this one.
    #[must_use]
    pub fn nearest_on_segment(self, from: Self, to: Self) -> Self {
        let along = to.offset_from(from);
        from.translate(along * share_along(self.offset_from(from), along))
    }
}

/// The 1-σ ellipse of a covariance as offsets from its centre, in the unit of the covariance's
/// root: `corners` points, evenly spread in the angle of the unit circle that the ellipse is the
/// image of. Where rounding left a variance below zero it counts as zero.
pub fn covariance_ellipse(covariance: Matrix2<f64>, corners: u32) -> Vec<Vec2> {
    // C = V diag(λ) Vᵀ, so V diag(√λ) takes the unit circle to the 1-σ ellipse.
    let axes = SymmetricEigen::new(covariance);
    let radii = axes.eigenvalues.map(|value| value.max(0.0).sqrt());
    (0..corners)
        .map(|step| {
            let angle = f64::from(step) / f64::from(corners) * TAU;
            axes.eigenvectors * Vec2::new(radii.x * angle.cos(), radii.y * angle.sin())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;

    #[test]
    fn a_picture_cut_from_a_wider_one_keeps_its_scale() {
        for (width, height) in [
            (1920, 1080),
            (1280, 720),
            (960, 540),
            (854, 480),
            (1280, 544),
        ] {
            let wide = ImageSize::new(width, height);
            assert_eq!(wide.scale_from_1920(), f64::from(width) / 1920.0);
            for cut in [height, height * 4 / 3, height * 9 / 16] {
                let cut = ImageSize::new(cut, height);
                let scale = f64::from(height) / 1080.0;
                assert!((cut.scale_from_1920() - scale).abs() < 1e-12, "{cut:?}");
            }
        }
    }

    #[test]
    fn the_nearest_point_is_the_foot_or_an_end() {
        let ends = [ImagePoint::new(10.0, 5.0), ImagePoint::new(30.0, 5.0)];
        for (at, nearest) in [
            ((20.0, 9.0), (20.0, 5.0)),
            ((7.0, 1.0), (10.0, 5.0)),
            ((34.0, 8.0), (30.0, 5.0)),
        ] {
            let found = ImagePoint::new(at.0, at.1).nearest_on_segment(ends[0], ends[1]);
            assert_eq!((found.x, found.y), nearest);
        }
        let point = ImagePoint::new(13.0, 9.0).nearest_on_segment(ends[0], ends[0]);
        assert_eq!(point, ends[0], "a segment without length");
    }

    #[test]
    fn beside_beyond_and_a_segment_without_length() {
        let ends = [ImagePoint::new(10.0, 5.0), ImagePoint::new(30.0, 5.0)];
        let distance = |x, y| ImagePoint::new(x, y).distance_from_segment_px(ends[0], ends[1]);
        assert_eq!(
            (distance(20.0, 9.0), distance(7.0, 1.0), distance(34.0, 8.0)),
            (4.0, 5.0, 5.0)
        );
        assert_eq!(
            ImagePoint::new(13.0, 9.0).distance_from_segment_px(ends[0], ends[0]),
            5.0
        );
        assert_eq!(
            distance_from_segment(Vec3::z(), [Vec3::zeros(), Vec3::x()]),
            1.0
        );
    }

    #[test]
    fn every_corner_lies_one_sigma_out() {
        let covariance = Matrix2::new(4.0, 1.2, 1.2, 0.9);
        let inverse = covariance.try_inverse().unwrap();
        for corner in covariance_ellipse(covariance, 48) {
            assert!(
                (corner.dot(&(inverse * corner)) - 1.0).abs() < 1e-12,
                "{corner:?}"
            );
        }
    }

    #[test]
    fn a_covariance_of_rank_one_is_a_line() {
        let flat = covariance_ellipse(Matrix2::new(9.0, 0.0, 0.0, -1e-18), 8);
        assert!(flat.iter().all(|corner| corner.y == 0.0));
        assert!(
            flat.iter()
                .any(|corner| (corner.x.abs() - 3.0).abs() < 1e-12)
        );
    }
}
