//! Landmarks and lines of a template, with expressions for their coordinates; groups of variants
//! are expanded.

use super::{Expression, PaintEdge};

/// A landmark whose coordinates are still expressions.
#[derive(Clone, Debug, PartialEq)]
pub struct LandmarkPart {
    pub id: String,
    pub label: String,
    pub code: String,
    pub at: PointPart,
    pub click_sigma_px: f64,
    pub spot_diameter_m: Option<Scoped>,
    pub is_unmarked: bool,
}

/// A line whose coordinates are still expressions.
#[derive(Clone, Debug, PartialEq)]
pub struct LinePart {
    pub id: String,
    pub label: String,
    pub code: String,
    pub curve: CurvePart,
    pub width_m: Scoped,
    pub edge: PaintEdge,
    /// A point of the area that a straight line bounds; present if `edge` is not the centre.
    pub inside: Option<PointPart>,
    pub painted: bool,
    /// Length of the dashes and of the gaps, m; none for a whole line.
    pub dash_m: Option<[Scoped; 2]>,
}

/// Three coordinates, m, with the names that their entry's variant adds to the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct PointPart {
    pub coordinates: [Expression; 3],
    pub names: Vec<(&'static str, f64)>,
}

/// One number, with the names that its entry's variant adds to the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Scoped {
    pub expression: Expression,
    pub names: Vec<(&'static str, f64)>,
}

/// The curve of a line.
#[derive(Clone, Debug, PartialEq)]
pub enum CurvePart {
    /// Straight.
    Segment { from: PointPart, to: PointPart },
    /// The circle through three points, from the first to the last.
    Arc(Box<[PointPart; 3]>),
    /// A whole circle.
    Circle { centre: PointPart, radius_m: Scoped },
}
