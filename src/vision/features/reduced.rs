//! Pictures of reduced size, their gradients, and a test whether the camera moved between two.

use crate::media::Picture;
use touchline_core::geometry::ImageSize;

/// Approximate width of reduced pictures, px.
const WIDTH: u32 = 480;

/// Minimum strength of an edge, grey levels over two px of the reduced picture; weaker ones may be
/// noise.
const LEAST_EDGE: f32 = 4.0;

/// A gradient belongs to an edge of known direction if its component along that direction is at
/// least this share of its strength.
const MIN_SHARE_ALONG: f32 = 0.7;

/// The camera moved if less than this share of the edges of two pictures is static. By chance it is
/// a third; from frame to frame of a slow pan it is four fifths.
const MOVED: f32 = 0.5;

/// Minimum number of edges, as a share of the reduced picture's pixels. A fade or a white-out has
/// fewer.
const MIN_EDGE_SHARE: f32 = 0.01;

/// The gradient of the brightness, grey levels over two px of a reduced picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Slope {
    pub right: f32,
    pub down: f32,
}

impl Slope {
    pub fn strength(self) -> f32 {
        self.right.hypot(self.down)
    }

    pub fn dot(self, other: Self) -> f32 {
        self.right * other.right + self.down * other.down
    }

    pub fn times(self, factor: f32) -> Self {
        Self {
            right: self.right * factor,
            down: self.down * factor,
        }
    }

    pub fn plus(self, other: Self) -> Self {
        Self {
            right: self.right + other.right,
            down: self.down + other.down,
        }
    }

    /// The same direction with the strength limited.
    pub fn clamp_strength(self, strength: f32) -> Self {
        self.times((strength / self.strength().max(f32::MIN_POSITIVE)).min(1.0))
    }

    /// The unit vector of the direction; zero for a zero gradient.
    pub fn unit(self) -> Self {
        self.times(1.0 / self.strength().max(f32::MIN_POSITIVE))
    }

    /// Whether it is that of an edge with the gradient direction `direction`, a unit vector: most
    /// of it lies along the direction, and is more than noise.
    pub fn is_edge_along(self, direction: Self) -> bool {
        let along = self.dot(direction);
        along > LEAST_EDGE && along > MIN_SHARE_ALONG * self.strength()
    }

    pub fn kind(self) -> EdgeKind {
        if self.down.abs() > self.right.abs() {
            EdgeKind::Level
        } else {
            EdgeKind::Upright
        }
    }
}

/// The direction of an edge: upright if the gradient is mainly horizontal, level if it is mainly
/// vertical.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EdgeKind {
    Upright,
    Level,
}

impl EdgeKind {
    pub const ALL: [Self; 2] = [Self::Upright, Self::Level];
}

/// The brightness of a picture of reduced size.
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedPicture {
    /// Size of the full picture, px.
    pub(super) size: ImageSize,
    /// Side of a reduced pixel, px of the full picture.
    pub(super) step: usize,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) grey: Vec<f32>,
}

impl ReducedPicture {
    /// Reduces a picture by a whole factor.
    pub fn new(picture: &Picture) -> Self {
        // A whole factor, so that every reduced pixel averages the same number of pixels.
        let size = picture.size();
        let step = (f64::from(size.width) / f64::from(WIDTH)).round().max(1.0) as usize;
        let (width, height) = (size.width as usize / step, size.height as usize / step);
        // Brightness (R + 2 G + B) / 4, averaged over squares of `step` px. Columns and rows that
        // do not fill a square are dropped.
        let mut grey = vec![0.0_f32; width * height];
        let rows = picture.rgba().chunks_exact(4 * size.width as usize);
        for (row, pixels) in rows.take(height * step).enumerate() {
            let reduced = &mut grey[row / step * width..][..width];
            for (column, pixel) in pixels.chunks_exact(4).take(width * step).enumerate() {
                reduced[column / step] +=
                    f32::from(pixel[0]) + 2.0 * f32::from(pixel[1]) + f32::from(pixel[2]);
            }
        }
        let weight = 1.0 / (4 * step * step) as f32;
        for value in &mut grey {
            *value *= weight;
        }
        Self {
            size,
            step,
            width,
            height,
            grey,
        }
    }

    /// Central differences at a pixel that is not on the border.
    pub(super) fn slope(&self, column: usize, row: usize) -> Slope {
        let at = row * self.width + column;
        Slope {
            right: self.grey[at + 1] - self.grey[at - 1],
            down: self.grey[at + self.width] - self.grey[at - self.width],
        }
    }
}

/// Whether the camera moved between two pictures: if so, less than half of the edges are static.
/// None for pictures of different sizes or with too few edges.
pub fn has_moved(one: &ReducedPicture, other: &ReducedPicture) -> Option<bool> {
    let [upright, level] = count_edges(one, other)?;
    let all = upright.all + level.all;
    // Too few edges would make the share random.
    let tells = all > MIN_EDGE_SHARE * one.grey.len() as f32;
    tells.then_some(upright.standing + level.standing < MOVED * all)
}

/// Number of edges of one kind, averaged over two pictures, and how many of them are static.
#[derive(Clone, Copy, Default)]
pub(super) struct EdgeCount {
    pub all: f32,
    pub standing: f32,
}

/// Counts the edges of both kinds. None for pictures of different sizes.
pub(super) fn count_edges(one: &ReducedPicture, other: &ReducedPicture) -> Option<[EdgeCount; 2]> {
    if one.size != other.size {
        return None;
    }
    let mut counts = [EdgeCount::default(); 2];
    for row in 1..one.height.saturating_sub(1) {
        for column in 1..one.width.saturating_sub(1) {
            let slopes = [one.slope(column, row), other.slope(column, row)];
            // The mean over both pictures: each edge counts 1/2.
            for slope in slopes.iter().filter(|slope| slope.strength() > LEAST_EDGE) {
                counts[slope.kind() as usize].all += 0.5;
            }
            // Static: both gradients are strong along the direction of their sum. Opposite ones,
            // as of a bright and a dark line at one place, have a small sum and fail.
            let shared = slopes[0].plus(slopes[1]);
            let direction = shared.unit();
            if slopes.iter().all(|slope| slope.is_edge_along(direction)) {
                counts[shared.kind() as usize].standing += 1.0;
            }
        }
    }
    Some(counts)
}
