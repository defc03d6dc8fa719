//! Features that keep their position on the screen between two pictures of a camera that moved.
//!
//! A score bug, a watermark or a black box lies at the same pixels whatever the camera does. Its
//! features match perfectly and would outvote the stadium. They are recognised in a pair of
//! pictures: similar features at the same position while the rest of the picture moved. If the rest
//! did not move, the pair is not used, because a still camera looks the same.

use super::Features;
use super::descriptor::MAX_MATCH_SQUARED_DISTANCE;
use super::displaced::CoarsePicture;
use super::grid::cell_in_grid;
use super::reduced::{EdgeKind, ReducedPicture, count_edges};
use rayon::prelude::*;
use std::ops::Range;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// A feature that is displaced by at most this is static, px at 1920 px width.
pub const STANDING_PX: f64 = 1.5;

/// Radius in which the match of a feature is sought, px at 1920 px width. A picture with many
/// matches this near hardly moved.
pub(super) const NEAR_PX: f64 = 12.0;

/// Maximum ratio of the sizes of two keypoints of the same graphic.
const MAX_SIZE_RATIO: f32 = 1.25;

/// Minimum number of static features in a pair; fewer are chance.
const LEAST_STANDING: usize = 3;

/// Features in at least this share of the cells of a picture that have any are the picture itself,
/// not a graphic on it.
pub const WHOLE_PICTURE: f64 = 0.3;

/// Columns and rows of the grid of cells that measures how widely features are spread.
const PLACES: (usize, usize) = (16, 9);

/// The features of a picture in a grid, for look-ups within [`NEAR_PX`] of a point.
pub(super) struct FeatureGrid<'a> {
    pub features: &'a Features,
    cell_px: f64,
    columns: usize,
    /// For each cell, the end of its features in `order`; they begin where the previous cell's end.
    ends: Vec<usize>,
    /// Indices of the features, sorted by cell.
    order: Vec<u32>,
}

impl<'a> FeatureGrid<'a> {
    pub(super) fn new(features: &'a Features) -> Self {
        let size = features.image_size;
        // At least a pixel, so that a picture without width has cells, too.
        let cell_px = (NEAR_PX * size.scale_from_1920()).max(1.0);
        let columns = (f64::from(size.width) / cell_px) as usize + 1;
        let rows = (f64::from(size.height) / cell_px) as usize + 1;
        let cells: Vec<usize> = features
            .keypoints
            .iter()
            .map(|keypoint| {
                cell_along(keypoint.point.y, cell_px, rows) * columns
                    + cell_along(keypoint.point.x, cell_px, columns)
            })
            .collect();
        // Features per cell, then running sums: where each cell's features end in `order`.
        let mut ends = vec![0; columns * rows];
        for &cell in &cells {
            ends[cell] += 1;
        }
        let mut total = 0;
        for end in &mut ends {
            total += *end;
            *end = total;
        }
        let mut order: Vec<u32> = (0..features.len() as u32).collect();
        order.sort_by_key(|&feature| cells[feature as usize]);
        Self {
            features,
            cell_px,
            columns,
            ends,
            order,
        }
    }

    /// The features in the 3 × 3 cells around a point. Cells are [`NEAR_PX`] wide, so these include
    /// all features within that distance.
    fn around(&self, point: ImagePoint) -> impl Iterator<Item = usize> {
        let rows = self.ends.len() / self.columns;
        let columns = cells_around(point.x, self.cell_px, self.columns);
        cells_around(point.y, self.cell_px, rows).flat_map(move |row| {
            // Neighbouring cells of a row are adjacent in `order`, so a row of cells is one range.
            let (first, last) = (
                row * self.columns + columns.start,
                row * self.columns + columns.end,
            );
            let [start, end] =
                [first, last].map(|cell| cell.checked_sub(1).map_or(0, |last| self.ends[last]));
            self.order[start..end]
                .iter()
                .map(|&feature| feature as usize)
        })
    }

    /// The feature most similar to `feature` of another picture among those near its position, and
    /// the distance between the two, px.
    fn most_alike(&self, other: &Features, feature: usize) -> Option<(usize, f64)> {
        let keypoint = &other.keypoints[feature];
        let near_px = NEAR_PX * other.image_size.scale_from_1920();
        // Position and size first: the descriptors' distance is the expensive part.
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
            (unlike <= MAX_MATCH_SQUARED_DISTANCE).then_some((unlike, near, distance_px))
        });
        // Equal ones are ordered by index, so that the result is the same in every run.
        let best = alike.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        Some((best.1, best.2))
    }
}

/// The index, along one axis, of the cell at a position; that of the last cell beyond it.
fn cell_along(position_px: f64, cell_px: f64, cells: usize) -> usize {
    ((position_px / cell_px).max(0.0) as usize).min(cells - 1)
}

/// The indices, along one axis, of the cell at a position and of its neighbours.
fn cells_around(position_px: f64, cell_px: f64, cells: usize) -> Range<usize> {
    let at = cell_along(position_px, cell_px, cells);
    at.saturating_sub(1)..(at + 2).min(cells)
}

/// The features of two pictures that are static while the rest of the picture moves, as pairs of
/// indices. None if the pair cannot be used: too few static features, a camera that hardly moved,
/// or pictures of different sizes.
pub(super) fn standing_pair(
    one: &FeatureGrid<'_>,
    other: &FeatureGrid<'_>,
) -> Option<Vec<(usize, usize)>> {
    let (first, second) = (one.features, other.features);
    if first.image_size != second.image_size {
        return None;
    }
    let standing_px = STANDING_PX * first.image_size.scale_from_1920();
    // Similar features within [`NEAR_PX`] of each other.
    let near: Vec<(usize, usize, f64)> = (0..first.len())
        .filter_map(|feature| {
            let (found, distance_px) = other.most_alike(first, feature)?;
            Some((feature, found, distance_px))
        })
        .collect();
    // If they are spread over the picture, the camera hardly moved. Counting cells, not features,
    // keeps a graphic with many features from looking like the whole picture.
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

/// Share of the cells of a 16 × 9 grid that contain some of the points `some`, among those that
/// contain any of `all`, 0 to 1; 0 if there are none.
pub fn place_share(
    some: impl IntoIterator<Item = ImagePoint>,
    all: impl IntoIterator<Item = ImagePoint>,
    size: ImageSize,
) -> f64 {
    // For each cell, whether it has points of `all`, and of `some`. Cells without any feature, as
    // on plain grass, say nothing and are left out of the share.
    let mut cells = [(false, false); PLACES.0 * PLACES.1];
    for point in all {
        cells[cell_in_grid(point, size, PLACES)].0 = true;
    }
    for point in some {
        cells[cell_in_grid(point, size, PLACES)].1 = true;
    }
    let textured = cells.iter().filter(|(any, _)| *any).count();
    let shared = cells.iter().filter(|(any, some)| *any && *some).count();
    if textured == 0 {
        0.0
    } else {
        shared as f64 / textured as f64
    }
}

/// The camera moved if less than this share of the edges of a kind, upright or level, is static. By
/// chance it is 0.2 and 0.3. A pure pan leaves level edges in place, a pure tilt upright ones.
const MOVED_OF_KIND: [f32; 2] = [0.36, 0.45];

/// For each kind of edge, the indices of pictures such that the camera moved from each to the next.
/// The motion must be so large that a camera which moves by only a degree or two in all has too few
/// of them for anything to be found.
pub(super) fn camera_views(pictures: &[ReducedPicture]) -> [Vec<usize>; 2] {
    let coarse: Vec<CoarsePicture> = pictures.par_iter().map(CoarsePicture::new).collect();
    EdgeKind::ALL.map(|kind| views_of_kind(kind, pictures, &coarse))
}

/// The indices of pictures such that the camera moved from each to the next, by edges of one kind.
fn views_of_kind(
    kind: EdgeKind,
    pictures: &[ReducedPicture],
    coarse: &[CoarsePicture],
) -> Vec<usize> {
    let mut views: Vec<usize> = Vec::new();
    for (place, picture) in pictures.iter().enumerate() {
        // Few static edges, and no block match that says otherwise: edges alone are unreliable
        // while a camera pans slowly along boards. Undecided blocks (None) are no objection.
        let is_new_view = views.last().is_none_or(|&before| {
            count_edges(&pictures[before], picture).is_some_and(|counts| {
                let count = &counts[kind as usize];
                count.standing < MOVED_OF_KIND[kind as usize] * count.all
            }) && coarse[before].is_displaced(&coarse[place], kind) != Some(false)
        });
        if is_new_view {
            views.push(place);
        }
    }
    views
}
