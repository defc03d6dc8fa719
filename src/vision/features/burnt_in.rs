//! Finds graphics that are burnt into the pictures of a camera: their features and their boxes.
//!
//! # Problem
//!
//! A score bug, a watermark or a black box lies at the same pixels whatever the camera does. Its
//! features match perfectly and outvote the stadium: a forest learns them, a pose is computed from
//! them, a clip seems not to move. They must be found without knowing the camera, and a camera that
//! does not move must not be mistaken for a graphic.
//!
//! # Method
//!
//! Two detectors find two kinds of graphic, and `proposals::find_burnt_in` combines them.
//!
//! * **By features** (this file, `standing.rs`): a pair of pictures is used only if the rest of the
//!   picture moved between them. Features that look alike at the same position in such a pair are
//!   static. Those of all pairs are counted in cells of 48 px; cells with static features in enough
//!   pictures are joined to boxes. A box has at least six features.
//! * **By edges** (`standing_edges.rs`): an edge that has the same position and direction in all
//!   pictures. The mean of its gradients is tested against zero in units of its standard error, so
//!   that a faint watermark over a changing background appears after enough pictures. Windows of
//!   32, 16 and 8 consecutive pictures find what is shown for a while. Upright and level edges are
//!   tested separately, because level edges of boards stay in place while a camera pans. Block
//!   matching (`displaced.rs`), or known cameras, decide whether the camera moved.
//!
//! # Robustness
//!
//! Robust against a still camera (static features in 30 % of the cells that have features are the
//! picture itself), boards that a slow pan moves along themselves, letters that change within a
//! ticker (its rim is found), and chance in a crowd. Needs two pictures between which the camera
//! moved; otherwise nothing is reported.

use super::Features;
use super::grid::join_touching_cells;
use super::reduced::{ReducedPicture, Slope};
use super::standing::{FeatureGrid, standing_pair};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};

/// Each picture is compared with this many that follow it, and with [`SPREAD`] ones spread over
/// all.
const FOLLOWING: usize = 4;
const SPREAD: usize = 8;

/// Side of the cells by which features are joined to graphics, px at 1920 px width. Smaller gaps
/// never separate a graphic.
const CELL_PX: f64 = 48.0;

/// Margin of a box around the centres of its features, px at 1920 px width: about the size of
/// letters.
const MARGIN_PX: f64 = 14.0;

/// Minimum share of the pictures with static features in a cell of a graphic, and at least two
/// pictures. Among many pictures some features coincide by chance anywhere.
const LEAST_PICTURES: f64 = 0.05;

/// Minimum number of features of a graphic in all pictures together; also at least one per picture
/// that it lasts for. Fewer may be chance.
const LEAST_FEATURES: usize = 6;

/// The graphics in a set of pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BurntIn {
    /// For each picture, the indices of its features that belong to a graphic, ascending.
    pub features: Vec<Vec<usize>>,
    /// The graphics, from top left to bottom right.
    pub graphics: Vec<BurntInGraphic>,
}

/// A graphic: its box, and the pictures that show it.
#[derive(Clone, Debug, PartialEq)]
pub struct BurntInGraphic {
    /// Its box, px.
    pub pixel_box: PixelBox,
    /// Index of the first picture that shows it.
    pub first: usize,
    /// Index of the last one.
    pub last: usize,
    /// Number of static features in it, over all pictures.
    pub features: usize,
}

/// Finds the graphics burnt into pictures of one camera, which are in order of time as far as they
/// have one.
///
/// `moved(one, other, point)` says whether the content at a point of the first picture lies
/// elsewhere in the second; static features are evidence only there. With known cameras it is
/// computed from them, without cameras it is always true.
///
/// Two pictures are enough. If the camera hardly moved between the pictures, nothing is reported.
pub fn burnt_in(
    pictures: &[&Features],
    moved: &(dyn Fn(usize, usize, ImagePoint) -> bool + Sync),
) -> BurntIn {
    // One grid per picture serves all its pairs.
    let placed: Vec<FeatureGrid<'_>> = pictures
        .iter()
        .map(|features| FeatureGrid::new(features))
        .collect();
    // Static features of all pairs in which the camera moved.
    let standing: Vec<(usize, usize)> = pairs(pictures.len())
        .par_iter()
        .flat_map_iter(|&(one, other)| {
            let found = standing_pair(&placed[one], &placed[other]).unwrap_or_default();
            let elsewhere = found.into_iter().filter(move |(feature, _)| {
                moved(one, other, pictures[one].keypoints[*feature].point)
            });
            elsewhere.flat_map(move |(feature, found)| [(one, feature), (other, found)])
        })
        .collect();
    // A feature may be static in several pairs; it counts once.
    let mut features = vec![BTreeSet::new(); pictures.len()];
    for (picture, feature) in standing {
        features[picture].insert(feature);
    }
    let graphics = graphics(pictures, &features);
    // All features in the box of a graphic, while it is shown, belong to it: digits that change,
    // letters found only once.
    for (picture, burnt) in features.iter_mut().enumerate() {
        for graphic in graphics
            .iter()
            .filter(|graphic| (graphic.first..=graphic.last).contains(&picture))
        {
            let inside = pictures[picture].keypoints.iter().enumerate();
            burnt.extend(
                inside
                    .filter(|(_, keypoint)| graphic.pixel_box.contains(keypoint.point))
                    .map(|(at, _)| at),
            );
        }
    }
    BurntIn {
        features: features
            .into_iter()
            .map(|burnt| burnt.into_iter().collect())
            .collect(),
        graphics,
    }
}

/// The pairs of pictures that are compared. Near ones find graphics that are shown for a short
/// time, far ones find them in slow shots.
fn pairs(count: usize) -> Vec<(usize, usize)> {
    let mut pairs = BTreeSet::new();
    for one in 0..count {
        let following = 1..=FOLLOWING;
        let spread = (1..=SPREAD).map(|step| step * count / (SPREAD + 1));
        // Indices wrap around, so that the last pictures have as many partners as the first.
        for other in following
            .chain(spread)
            .filter(|step| *step > 0)
            .map(|step| (one + step) % count)
        {
            if one != other {
                pairs.insert((one.min(other), one.max(other)));
            }
        }
    }
    pairs.into_iter().collect()
}

/// The graphics: boxes of static features that lie together in enough pictures.
fn graphics(pictures: &[&Features], burnt: &[BTreeSet<usize>]) -> Vec<BurntInGraphic> {
    // Pictures of one camera have one size, but some may have no features and no size.
    let sizes = pictures.iter().map(|features| features.image_size);
    let size = sizes.fold(ImageSize::new(0, 0), |all, one| {
        ImageSize::new(all.width.max(one.width), all.height.max(one.height))
    });
    let least_pictures = ((LEAST_PICTURES * pictures.len() as f64) as usize).max(2);
    // All static features of all pictures, each with the index of its picture.
    let mut points: Vec<(ImagePoint, usize)> = Vec::new();
    for (picture, features) in burnt.iter().enumerate() {
        points.extend(
            features
                .iter()
                .map(|&feature| (pictures[picture].keypoints[feature].point, picture)),
        );
    }
    let mut found: Vec<BurntInGraphic> =
        group_points(&points, CELL_PX * size.scale_from_1920(), least_pictures)
            .into_iter()
            .filter_map(|members| graphic_from_points(&points, &members, size))
            // A graphic that lasts for n pictures has at least n features. With six alone, drawn
            // clips had false boxes of 6 to 12 features (tests/benches/graphics.md).
            .filter(|graphic| {
                graphic.features >= LEAST_FEATURES.max(graphic.last - graphic.first + 1)
            })
            .collect();
    found.sort_by(|a, b| {
        let (one, other) = (&a.pixel_box, &b.pixel_box);
        one.y.total_cmp(&other.y).then(one.x.total_cmp(&other.x))
    });
    found
}

/// Groups of points in touching cells of a grid, diagonals included, as lists of indices. Cells
/// with points of fewer than `least_pictures` pictures are left out.
fn group_points(
    points: &[(ImagePoint, usize)],
    cell_px: f64,
    least_pictures: usize,
) -> Vec<Vec<usize>> {
    let mut cells = BTreeMap::<(i64, i64), Vec<usize>>::new();
    for (at, (point, _)) in points.iter().enumerate() {
        let cell = (
            (point.y / cell_px).floor() as i64,
            (point.x / cell_px).floor() as i64,
        );
        cells.entry(cell).or_default().push(at);
    }
    cells.retain(|_, members| {
        let pictures: BTreeSet<usize> = members.iter().map(|&member| points[member].1).collect();
        pictures.len() >= least_pictures
    });
    join_touching_cells(cells)
}

/// The box of some points, with a margin, clipped to the picture, and the pictures that they span.
fn graphic_from_points(
    points: &[(ImagePoint, usize)],
    members: &[usize],
    size: ImageSize,
) -> Option<BurntInGraphic> {
    let margin_px = MARGIN_PX * size.scale_from_1920();
    let at = members.iter().map(|&member| points[member].0);
    let ((left, right), (top, bottom)) = (
        extent_px(at.clone().map(|point| point.x), margin_px, size.width),
        extent_px(at.map(|point| point.y), margin_px, size.height),
    );
    let pictures = members.iter().map(|&member| points[member].1);
    Some(BurntInGraphic {
        pixel_box: PixelBox::new(left, top, right - left, bottom - top),
        first: pictures.clone().min()?,
        last: pictures.max()?,
        features: members.len(),
    })
}

/// The extent of positions along a side of the picture, with a margin, clipped to the picture, in
/// whole px.
fn extent_px(
    positions_px: impl Iterator<Item = f64> + Clone,
    margin_px: f64,
    side_px: u32,
) -> (f64, f64) {
    let least_px = positions_px.clone().fold(f64::INFINITY, f64::min) - margin_px;
    let greatest_px = positions_px.fold(f64::NEG_INFINITY, f64::max) + margin_px;
    (
        least_px.max(0.0).floor(),
        greatest_px.min(f64::from(side_px)).ceil(),
    )
}

/// Maximum strength of a gradient, grey levels over two px: one strong edge of the stadium must not
/// outweigh many weak ones of a watermark.
pub(super) const CAP: f32 = 12.0;

/// A picture shows a graphic if the components of its gradients along the graphic's sum to this
/// share of the graphic's own.
const SHOWN: f32 = 0.5;

/// A static edge: column and row in the reduced picture, and mean gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StaticEdge {
    pub column: usize,
    pub row: usize,
    /// Mean gradient, each capped.
    pub slope: Slope,
}

/// A graphic that is static on the screen in some pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticGraphic {
    /// Its box, px of the full picture.
    pub pixel_box: PixelBox,
    /// Index of the first picture that shows it.
    pub first: usize,
    /// Index of the last one.
    pub last: usize,
    pub(super) edges: Vec<StaticEdge>,
}

impl StaticGraphic {
    /// A box that all of `count` pictures show, without edges by which it could be recognised.
    pub(super) const fn throughout(pixel_box: PixelBox, count: usize) -> Self {
        Self {
            pixel_box,
            first: 0,
            last: count.saturating_sub(1),
            edges: Vec::new(),
        }
    }

    /// Number of static edges in the reduced pictures.
    pub fn edges(&self) -> usize {
        self.edges.len()
    }

    /// Whether another picture of the same size shows the graphic.
    pub fn is_shown_in(&self, picture: &ReducedPicture) -> bool {
        // Sums over all edges, not a count of edges: a half-transparent graphic over a busy picture
        // hides single edges, but the components along its own add up.
        let (mut seen, mut mean) = (0.0, 0.0);
        for edge in &self.edges {
            // An edge at the border has no gradient and counts as missing.
            let within = edge.column + 1 < picture.width && edge.row + 1 < picture.height;
            let slope = if within {
                picture.slope(edge.column, edge.row).clamp_strength(CAP)
            } else {
                Slope::default()
            };
            seen += slope.dot(edge.slope.unit());
            mean += edge.slope.strength();
        }
        seen >= SHOWN * mean
    }

    /// Whether two graphics are the same: their pictures overlap, and so do their boxes, by more
    /// than half of the smaller one.
    pub(super) fn is_also(&self, other: &Self) -> bool {
        let at_once = self.first <= other.last && other.first <= self.last;
        let (one, two) = (&self.pixel_box, &other.pixel_box);
        at_once
            && shared_area(one, two) > 0.5 * (one.width * one.height).min(two.width * two.height)
    }
}

/// The area in which two boxes overlap, px².
pub(super) fn shared_area(one: &PixelBox, two: &PixelBox) -> f64 {
    overlap_px(one.x, one.width, two.x, two.width)
        * overlap_px(one.y, one.height, two.y, two.height)
}

/// The length of the overlap of two intervals, px; 0 if they are apart.
fn overlap_px(from_px: f64, length_px: f64, other_from_px: f64, other_length_px: f64) -> f64 {
    let to_px = (from_px + length_px).min(other_from_px + other_length_px);
    (to_px - from_px.max(other_from_px)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::Keypoint;
    use touchline_core::testing::pixel_box;

    #[test]
    fn a_picture_without_features_hides_no_graphic() {
        let keypoints = (0..6).map(|index| Keypoint {
            point: ImagePoint::new(100.0 + 3.0 * f64::from(index), 60.0),
            size_px: 4.0,
            strength: 1.0,
        });
        let shown = Features {
            image_size: ImageSize::new(1920, 1080),
            keypoints: keypoints.collect(),
            ..Features::default()
        };
        let none = Features::default();
        let static_features: BTreeSet<usize> = (0..6).collect();
        let burnt = [BTreeSet::new(), static_features.clone(), static_features];
        let found = graphics(&[&none, &shown, &shown], &burnt);
        let expected = BurntInGraphic {
            pixel_box: pixel_box(86.0, 46.0, 43.0, 28.0),
            first: 1,
            last: 2,
            features: 12,
        };
        assert_eq!(found, [expected]);
    }
}
