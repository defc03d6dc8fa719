//! Graphics that are burnt into the pictures of a camera: their features, and the boxes that hold
//! them.
//!
//! # Problem
//!
//! A score bug, a watermark or a black box lies at the same pixels whatever the camera does. Its
//! features agree perfectly with each other and outvote the stadium: a forest learns them, a pose
//! is found from them, a clip seems to stand still. They have to be found without knowing the
//! camera, and without taking a camera that stands still for a graphic.
//!
//! # Method
//!
//! Two ways see two kinds of graphic, and `proposals::find_burnt_in` joins them.
//!
//! * **By features** (this file, `standing.rs`): a pair of pictures tells something only if the rest of the picture moved between them. Features
//!   that look alike at the same place in such a pair stand still. Those of all pairs are counted
//!   in cells of 48 px; cells in which features stand in enough pictures are joined to boxes. A
//!   single box has to hold six features.
//! * **By edges** (`standing_edges.rs`): an edge that has the same place and direction in all pictures. What counts at a pixel is how far the mean of its
//!   slopes is from zero, in standard errors, so that a faint watermark over a changing background
//!   shows after enough pictures. Windows of 32, 16 and 8 neighbouring pictures find what is shown
//!   for a while. Upright and level edges count apart, since level edges of boards stand while a
//!   camera pans. Whether the camera moved is said by blocks that are found elsewhere
//!   (`displaced.rs`), or by known cameras.
//!
//! # What it is proof against
//!
//! A still camera (what stands in 30 % of the places that have features is the picture), boards
//! that a slow pan moves along themselves, letters that change within a ticker (its rim is found),
//! a crowd by chance. It needs two pictures between which the camera moved; else nothing is
//! reported.

use super::Features;
use super::standing::{Placed, standing_pair};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};

/// Each picture is compared with this many that follow it, and with this many spread over all.
const FOLLOWING: usize = 4;
const SPREAD: usize = 8;

/// The side of the cells by which features are joined to graphics, px at 1920 px width: a gap of
/// less never parts one.
const CELL_PX: f64 = 48.0;

/// A graphic reaches beyond its features' centres, px at 1920 px width: letters are as large.
const MARGIN_PX: f64 = 14.0;

/// A cell belongs to a graphic if features stand still there in two pictures at least, and in this
/// share of all: with many pictures some coincide by chance anywhere.
const LEAST_PICTURES: f64 = 0.05;

/// A box with fewer features in all pictures together, or with less than one in each picture that
/// it lasts for, may be a coincidence.
const LEAST_FEATURES: usize = 6;

/// What is burnt into a set of pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BurntIn {
    /// The features of each picture that belong to a graphic, ascending.
    pub features: Vec<Vec<usize>>,
    /// The graphics, from the top left to the bottom right.
    pub graphics: Vec<BurntInGraphic>,
}

/// A graphic: where it is, and in which pictures of the set.
#[derive(Clone, Debug, PartialEq)]
pub struct BurntInGraphic {
    /// The box that holds it, px.
    pub pixel_box: PixelBox,
    /// The first picture of the set with it.
    pub first: usize,
    /// The last one.
    pub last: usize,
    /// How many features of all pictures together stand still there.
    pub features: usize,
}

/// Finds the graphics burnt into pictures of one camera, which stand in the order of time as far as
/// they have one. A pair of pictures counts only as far as `moved` says that what is at a point of
/// the first lies elsewhere in the second: it knows more where the cameras are known, and else says
/// yes throughout.
///
/// Two pictures are enough. If the camera hardly moved between the pictures, nothing is reported.
#[must_use]
pub fn burnt_in(
    pictures: &[&Features],
    moved: &(dyn Fn(usize, usize, ImagePoint) -> bool + Sync),
) -> BurntIn {
    let placed: Vec<Placed<'_>> = pictures
        .iter()
        .map(|features| Placed::new(features))
        .collect();
    let pairs = pairs(pictures.len());
    let standing: Vec<(usize, usize)> = pairs
        .par_iter()
        .flat_map_iter(|&(one, other)| {
            let found = standing_pair(&placed[one], &placed[other]).unwrap_or_default();
            let elsewhere = found.into_iter().filter(move |(feature, _)| {
                moved(one, other, pictures[one].keypoints[*feature].point)
            });
            elsewhere.flat_map(move |(feature, found)| [(one, feature), (other, found)])
        })
        .collect();
    let mut features = vec![BTreeSet::new(); pictures.len()];
    for (picture, feature) in standing {
        features[picture].insert(feature);
    }
    let graphics = graphics(pictures, &features);
    // What lies in the box of a graphic while it is shown belongs to it: digits that change,
    // letters found once.
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

/// The pairs of pictures that are compared.
fn pairs(count: usize) -> Vec<(usize, usize)> {
    let mut pairs = BTreeSet::new();
    for one in 0..count {
        let following = 1..=FOLLOWING;
        let spread = (1..=SPREAD).map(|step| step * count / (SPREAD + 1));
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

/// Boxes of features that lie together.
fn graphics(pictures: &[&Features], burnt: &[BTreeSet<usize>]) -> Vec<BurntInGraphic> {
    let Some(size) = pictures.first().map(|features| features.image_size) else {
        return Vec::new();
    };
    let least_pictures = ((LEAST_PICTURES * pictures.len() as f64) as usize).max(2);
    let mut points: Vec<(ImagePoint, usize)> = Vec::new();
    for (picture, features) in burnt.iter().enumerate() {
        points.extend(
            features
                .iter()
                .map(|&feature| (pictures[picture].keypoints[feature].point, picture)),
        );
    }
    let mut found: Vec<BurntInGraphic> =
        joined(&points, CELL_PX * size.scale_from_1920(), least_pictures)
            .into_iter()
            .filter_map(|members| boxed(&points, &members, size))
            .filter(|graphic| {
                graphic.features >= LEAST_FEATURES.max(graphic.last - graphic.first + 1)
            })
            .collect();
    found.sort_by(|a, b| {
        let corner = |graphic: &BurntInGraphic| (graphic.pixel_box.y, graphic.pixel_box.x);
        let ((y, x), (other_y, other_x)) = (corner(a), corner(b));
        y.total_cmp(&other_y).then(x.total_cmp(&other_x))
    });
    found
}

/// Groups of points whose cells of a grid touch, corners included; cells with points of fewer
/// pictures are left out.
fn joined(points: &[(ImagePoint, usize)], cell_px: f64, least_pictures: usize) -> Vec<Vec<usize>> {
    let mut cells = BTreeMap::<(i64, i64), Vec<usize>>::new();
    for (at, (point, _)) in points.iter().enumerate() {
        let cell = |position: f64| (position / cell_px).floor() as i64;
        cells
            .entry((cell(point.y), cell(point.x)))
            .or_default()
            .push(at);
    }
    cells.retain(|_, members| {
        let pictures: BTreeSet<usize> = members.iter().map(|&member| points[member].1).collect();
        pictures.len() >= least_pictures
    });
    let mut groups = Vec::new();
    while let Some((first, members)) = cells.pop_first() {
        let (mut group, mut open) = (members, vec![first]);
        while let Some((row, column)) = open.pop() {
            for neighbour in (row - 1..=row + 1)
                .flat_map(|row| (column - 1..=column + 1).map(move |column| (row, column)))
            {
                if let Some(members) = cells.remove(&neighbour) {
                    group.extend(members);
                    open.push(neighbour);
                }
            }
        }
        groups.push(group);
    }
    groups
}

/// The box of some points of a picture with a margin.
fn boxed(
    points: &[(ImagePoint, usize)],
    members: &[usize],
    size: ImageSize,
) -> Option<BurntInGraphic> {
    let margin_px = MARGIN_PX * size.scale_from_1920();
    let along = |of: fn(&ImagePoint) -> f64, extent: u32| {
        let values = || members.iter().map(|&member| of(&points[member].0));
        let least = values().fold(f64::INFINITY, f64::min) - margin_px;
        let greatest = values().fold(f64::NEG_INFINITY, f64::max) + margin_px;
        (
            least.max(0.0).floor(),
            greatest.min(f64::from(extent)).ceil(),
        )
    };
    let ((left, right), (top, bottom)) = (
        along(|point| point.x, size.width),
        along(|point| point.y, size.height),
    );
    let pictures = || members.iter().map(|&member| points[member].1);
    Some(BurntInGraphic {
        pixel_box: PixelBox {
            x: left,
            y: top,
            width: right - left,
            height: bottom - top,
        },
        first: pictures().min()?,
        last: pictures().max()?,
        features: members.len(),
    })
}
