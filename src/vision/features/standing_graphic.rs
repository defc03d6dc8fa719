//! A static graphic on the screen, and a test whether a picture shows it.

use super::reduced::{ReducedPicture, Slope};
use touchline_core::geometry::PixelBox;

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
