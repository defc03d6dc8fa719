//! What stands still on the screen between two pictures of a camera that moved.
//!
//! A score bug, a watermark or a black box lies at the same pixels whatever the camera does. Its
//! features agree perfectly with each other, and would outvote the stadium. Two pictures tell them:
//! features that look alike at the same place while the rest of the picture moved. Where the rest
//! did not move, the pair tells nothing: a still camera is no graphic.

use super::{Features, Keypoint};
use touchline_core::geometry::{ImagePoint, ImageSize};

/// A feature that is displaced by less stands still, px at 1920 px width.
pub const STANDING_PX: f64 = 1.5;

/// A picture whose features are displaced by less than this, px at 1920 px width, hardly moved.
pub(super) const NEAR_PX: f64 = 12.0;

/// The squared distance of descriptors that may show one thing, both of unit length.
const MAX_SQUARED_DISTANCE: f32 = 0.2;

/// Patches of one thing on the screen do not differ more in size.
const MAX_SIZE_RATIO: f32 = 1.25;

/// A pair has to show as many features that stand: fewer are chance.
const LEAST_STANDING: usize = 3;

/// Features that lie in at least this share of the places of a picture that have any are the
/// picture, and not a graphic on it.
pub const WHOLE_PICTURE: f64 = 0.3;

/// Columns and rows of the grid of places.
const PLACES: (usize, usize) = (16, 9);

/// The features of a picture by where they are: what is asked for are those within [`NEAR_PX`] of a
/// point.
pub(super) struct Placed<'a> {
    pub features: &'a Features,
    cell_px: f64,
    columns: usize,
    /// Where each cell's features end in `order`.
    ends: Vec<usize>,
    order: Vec<u32>,
}

impl<'a> Placed<'a> {
    pub(super) fn new(features: &'a Features) -> Self {
        let size = features.image_size;
        let cell_px = (NEAR_PX * size.scale_from_1920()).max(1.0);
        let columns = (f64::from(size.width) / cell_px) as usize + 1;
        let rows = (f64::from(size.height) / cell_px) as usize + 1;
        let cell = |keypoint: &Keypoint| {
            let along = |position: f64, count: usize| {
                ((position / cell_px).max(0.0) as usize).min(count - 1)
            };
            along(keypoint.point.y, rows) * columns + along(keypoint.point.x, columns)
        };
        let mut ends = vec![0; columns * rows];
        for keypoint in &features.keypoints {
            ends[cell(keypoint)] += 1;
        }
        let mut total = 0;
        for end in &mut ends {
            total += *end;
            *end = total;
        }
        let mut order: Vec<u32> = (0..features.len() as u32).collect();
        order.sort_by_key(|&feature| cell(&features.keypoints[feature as usize]));
        Self {
            features,
            cell_px,
            columns,
            ends,
            order,
        }
    }

    /// The features in the cells around a point.
    fn around(&self, point: ImagePoint) -> impl Iterator<Item = usize> {
        let rows = self.ends.len() / self.columns;
        let cells = |position: f64, count: usize| {
            let at = (position / self.cell_px).max(0.0) as usize;
            at.saturating_sub(1)..(at + 2).min(count)
        };
        let columns = cells(point.x, self.columns);
        cells(point.y, rows).flat_map(move |row| {
            let (first, last) = (
                row * self.columns + columns.start,
                row * self.columns + columns.end,
            );
            let start = if first == 0 { 0 } else { self.ends[first - 1] };
            let end = if last == 0 { 0 } else { self.ends[last - 1] };
            self.order[start.min(end)..end]
                .iter()
                .map(|&feature| feature as usize)
        })
    }

    /// The feature most alike to one of another picture among those near its place, and how far off
    /// that is, px.
    fn most_alike(&self, other: &Features, feature: usize) -> Option<(usize, f64)> {
        let keypoint = &other.keypoints[feature];
        let near_px = NEAR_PX * other.image_size.scale_from_1920();
        let alike = self.around(keypoint.point).filter_map(|near| {
            let candidate = &self.features.keypoints[near];
            let ratio =
                candidate.size_px.max(keypoint.size_px) / candidate.size_px.min(keypoint.size_px);
            let distance_px = candidate.point.distance_px(keypoint.point);
            if distance_px > near_px || ratio > MAX_SIZE_RATIO {
                return None;
            }
            let unlike =
                self.features.descriptors[near].squared_distance(&other.descriptors[feature]);
            (unlike <= MAX_SQUARED_DISTANCE).then_some((unlike, near, distance_px))
        });
        let best = alike.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        Some((best.1, best.2))
    }
}

/// The features of two pictures that stand still while the rest of the picture moves, by their
/// numbers; none where the pair does not tell: too few stand, the camera hardly moved, or the
/// pictures differ in size.
pub(super) fn standing_pair(one: &Placed<'_>, other: &Placed<'_>) -> Option<Vec<(usize, usize)>> {
    let (first, second) = (one.features, other.features);
    if first.image_size != second.image_size {
        return None;
    }
    let standing_px = STANDING_PX * first.image_size.scale_from_1920();
    let near: Vec<(usize, usize, f64)> = (0..first.len())
        .filter_map(|feature| {
            let (found, distance_px) = other.most_alike(first, feature)?;
            Some((feature, found, distance_px))
        })
        .collect();
    let hardly_moved = place_share(
        near.iter()
            .map(|&(feature, ..)| first.keypoints[feature].point),
        first.keypoints.iter().map(|keypoint| keypoint.point),
        first.image_size,
    );
    if hardly_moved >= WHOLE_PICTURE {
        return None;
    }
    let standing = near
        .into_iter()
        .filter(|(.., distance_px)| *distance_px <= standing_px);
    let standing: Vec<(usize, usize)> = standing
        .map(|(feature, found, _)| (feature, found))
        .collect();
    (standing.len() >= LEAST_STANDING).then_some(standing)
}

/// The share of the places (cells of a 16 × 9 grid) with any of `all` the points of a picture that
/// have some of them, 0 to 1; 0 where there are none.
#[must_use]
pub fn place_share(
    some: impl IntoIterator<Item = ImagePoint>,
    all: impl IntoIterator<Item = ImagePoint>,
    size: ImageSize,
) -> f64 {
    let place = |point: ImagePoint| {
        let along = |position: f64, extent: u32, cells: usize| {
            ((position / f64::from(extent.max(1)) * cells as f64).max(0.0) as usize).min(cells - 1)
        };
        along(point.y, size.height, PLACES.1) * PLACES.0 + along(point.x, size.width, PLACES.0)
    };
    let mut held = [(false, false); PLACES.0 * PLACES.1];
    for point in all {
        held[place(point)].0 = true;
    }
    for point in some {
        held[place(point)].1 = true;
    }
    let textured = held.iter().filter(|(any, _)| *any).count();
    let shared = held.iter().filter(|(any, some)| *any && *some).count();
    if textured == 0 {
        0.0
    } else {
        shared as f64 / textured as f64
    }
}
