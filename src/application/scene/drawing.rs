//! The types of what is drawn over a picture or a field map: plain data without camera, GPU or
//! widgets.
//!
//! Positions are px of the picture (corner convention), in `f32` as the GPU takes them. Sizes are
//! points of the screen, so that a line keeps its width when the picture is zoomed. Colours are
//! sRGB bytes (gamma space) with straight alpha.

/// A colour: sRGB bytes and straight (not premultiplied) alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    pub r: u8,
    /// Green.
    pub g: u8,
    /// Blue.
    pub b: u8,
    /// 0 is invisible, 255 opaque.
    pub a: u8,
}

impl Colour {
    /// An opaque colour.
    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, a: 255 }
    }

    /// The same colour with another alpha.
    #[must_use]
    pub const fn with_alpha(self, a: u8) -> Self {
        Self { a, ..self }
    }
}

/// A rim around a line or a marker that keeps it readable on any background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// The colour of the rim.
    pub colour: Colour,
    /// Width of the rim on each side of the core, points.
    pub width_pt: f32,
}

/// Dashes along a line, starting at its first point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dash {
    /// Length of a dash without its round caps, points.
    pub on_pt: f32,
    /// Length of the gap to the next dash, points; the round caps reach into it.
    pub off_pt: f32,
}

/// A polyline with round joins and caps.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Points, px of the picture. The line is closed if the last point equals the first.
    pub points: Vec<[f32; 2]>,
    /// Colour of the core.
    pub colour: Colour,
    /// Width of the core, points.
    pub width_pt: f32,
    /// The rim, if the line has one.
    pub outline: Option<Outline>,
    /// The dashes; `None` draws a solid line.
    pub dash: Option<Dash>,
}

/// Strokes with a common opacity: crossings and joins are not darker than the rest.
///
/// All rims are drawn before all cores, so that crossings look painted, not stacked.
#[derive(Clone, Debug, PartialEq)]
pub struct StrokeGroup {
    /// Strokes; later ones lie on top.
    pub strokes: Vec<Stroke>,
    /// Opacity of the whole group, 0 to 1.
    pub opacity: f32,
    /// The group is clipped to this box: left, top, right, bottom, px of the picture.
    pub clip_px: Option<[f32; 4]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkerShape {
    /// A cross with an open centre, so that the clicked pixel stays visible.
    Cross,
    /// A circle.
    Ring,
    /// A filled disc.
    Dot,
    /// The outline of a square that stands on its corner.
    Diamond,
}

/// A symbol of constant size on screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// Centre, px of the picture.
    pub at: [f32; 2],
    pub shape: MarkerShape,
    /// Colour of the core.
    pub colour: Colour,
    /// Distance of the outermost point of the core from the centre, points.
    pub radius_pt: f32,
    /// Width of its lines, points. A dot has none.
    pub line_pt: f32,
    /// The rim, if the marker has one.
    pub outline: Option<Outline>,
}

/// A filled simple polygon, not necessarily convex.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// Corners in either direction, px of the picture; the polygon is closed.
    pub corners: Vec<[f32; 2]>,
    /// Colour of the filling.
    pub colour: Colour,
}

/// A short text beside a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The point that it labels, px of the picture.
    pub at: [f32; 2],
    /// Offset from that point to the left end of the text's middle line, points.
    pub offset_pt: [f32; 2],
    pub text: String,
    /// Height of the type, points.
    pub size_pt: f32,
    /// Colour of the letters.
    pub colour: Colour,
    /// Colour of the plate behind them.
    pub plate: Colour,
}

/// All that lies over one picture, from bottom to top: areas, groups of strokes, markers, labels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Filled areas.
    pub areas: Vec<Area>,
    /// Lines.
    pub strokes: Vec<StrokeGroup>,
    /// Symbols.
    pub markers: Vec<Marker>,
    /// Texts; the window draws them with its own fonts.
    pub labels: Vec<Label>,
}
