//! What is drawn over a picture or a field map, as plain data: no camera, no GPU, no widget.
//!
//! Positions are px of the picture (corner convention), in `f32` as the GPU takes them; sizes are
//! points of the screen, so that a line keeps its width while the picture is zoomed. Colours are
//! sRGB bytes as a screen shows them (gamma space) with straight alpha.

/// A colour: sRGB bytes and straight (not premultiplied) alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// Red.
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
    #[must_use]
    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, a: 255 }
    }

    /// The same colour with another alpha.
    #[must_use]
    pub const fn with_alpha(self, a: u8) -> Self {
        Self { a, ..self }
    }
}

/// A rim around a line or a marker that keeps it readable on any ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// Its colour.
    pub colour: Colour,
    /// How far it reaches beyond the core on each side, points.
    pub width_pt: f32,
}

/// Dashes along a line, measured from its first point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dash {
    /// Length of a dash without its round ends, points.
    pub on_pt: f32,
    /// From the end of a dash to the next one's start, points; the round ends reach into it.
    pub off_pt: f32,
}

/// A polyline with round joins and ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Its points, px of the picture; a line whose last point equals its first is closed.
    pub points: Vec<[f32; 2]>,
    /// The core's colour.
    pub colour: Colour,
    /// The core's width, points.
    pub width_pt: f32,
    /// The rim, if any.
    pub outline: Option<Outline>,
    /// Dashes, or a line without gaps.
    pub dash: Option<Dash>,
}

/// Strokes that fade as one: where they cross or join, nothing shows through twice.
///
/// All rims are drawn first, then all cores, so a crossing looks painted and not stacked.
#[derive(Clone, Debug, PartialEq)]
pub struct StrokeGroup {
    /// Later ones lie on top.
    pub strokes: Vec<Stroke>,
    /// Of the whole group, 0 to 1.
    pub opacity: f32,
    /// Nothing of the group shows outside this box: left, top, right, bottom, px of the picture.
    pub clip_px: Option<[f32; 4]>,
}

/// The shape of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkerShape {
    /// A cross whose centre is left open, so that the pixel that was clicked stays visible.
    Cross,
    /// A circle line.
    Ring,
    /// A filled disc.
    Dot,
    /// A square line standing on its tip.
    Diamond,
}

/// A symbol of constant size on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// Its centre, px of the picture.
    pub at: [f32; 2],
    /// What it looks like.
    pub shape: MarkerShape,
    /// The core's colour.
    pub colour: Colour,
    /// From the centre to the outermost point of the core, points.
    pub radius_pt: f32,
    /// The width of its lines, points; a dot has none.
    pub line_pt: f32,
    /// The rim, if any.
    pub outline: Option<Outline>,
}

/// A filled simple polygon, not necessarily convex.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// Its corners in either direction, px of the picture; the last is joined to the first.
    pub corners: Vec<[f32; 2]>,
    /// Its filling.
    pub colour: Colour,
}

/// A short text beside a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The point it belongs to, px of the picture.
    pub at: [f32; 2],
    /// From that point to the left end of the text's middle line, points.
    pub offset_pt: [f32; 2],
    /// What it says.
    pub text: String,
    /// The height of the type, points.
    pub size_pt: f32,
    /// The letters' colour.
    pub colour: Colour,
    /// The plate behind them.
    pub plate: Colour,
}

/// Everything that lies over one picture, the lowest first: areas, groups of strokes, markers,
/// labels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Filled areas.
    pub areas: Vec<Area>,
    /// Lines.
    pub strokes: Vec<StrokeGroup>,
    /// Symbols.
    pub markers: Vec<Marker>,
    /// Texts; the window writes them with its own fonts.
    pub labels: Vec<Label>,
}
