//! A graphic that stands on the screen, and whether a picture shows it.

use super::reduced::{ReducedPicture, Slope};
use touchline_core::geometry::PixelBox;

/// A slope counts at most this, grey levels over two px: one strong edge of the stadium is not many
/// weak ones of a watermark.
pub(super) const CAP: f32 = 12.0;

/// A graphic is shown in a picture if its slopes there make this share of their mean.
const SHOWN: f32 = 0.5;

/// An edge that stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StandingEdge {
    pub column: usize,
    pub row: usize,
    /// Its mean slope, capped.
    pub slope: Slope,
}

/// A graphic that stands on the screen in some pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct StandingGraphic {
    /// The box that holds it, px.
    pub pixel_box: PixelBox,
    /// The first picture with it, by its place.
    pub first: usize,
    /// The last one.
    pub last: usize,
    pub(super) edges: Vec<StandingEdge>,
}

impl StandingGraphic {
    /// A box that is there in all of some pictures, with no edges to know it by.
    pub(super) const fn throughout(pixel_box: PixelBox, count: usize) -> Self {
        Self {
            pixel_box,
            first: 0,
            last: count.saturating_sub(1),
            edges: Vec::new(),
        }
    }

    /// How many edges of the reduced pictures stand.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.edges.len()
    }

    /// Whether another picture of the same size shows it.
    #[must_use]
    pub fn is_shown_in(&self, picture: &ReducedPicture) -> bool {
        let (mut seen, mut mean) = (0.0, 0.0);
        for edge in &self.edges {
            let within = edge.column + 1 < picture.width && edge.row + 1 < picture.height;
            let slope = if within {
                picture.slope(edge.column, edge.row).capped(CAP)
            } else {
                Slope::default()
            };
            seen += slope.dot(edge.slope.unit());
            mean += edge.slope.strength();
        }
        seen >= SHOWN * mean
    }

    /// Whether two are one: seen at the same place at the same time, or one a part of the other.
    pub(super) fn is_also(&self, other: &Self) -> bool {
        let at_once = self.first <= other.last && other.first <= self.last;
        let (one, two) = (&self.pixel_box, &other.pixel_box);
        let along = |a: f64, a_length: f64, b: f64, b_length: f64| {
            ((a + a_length).min(b + b_length) - a.max(b)).max(0.0)
        };
        let shared =
            along(one.x, one.width, two.x, two.width) * along(one.y, one.height, two.y, two.height);
        at_once && shared > 0.5 * (one.width * one.height).min(two.width * two.height)
    }
}
