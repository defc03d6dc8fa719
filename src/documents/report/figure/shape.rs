//! The shapes of a laid-out figure.

/// A colour, red, green, blue.
pub type Rgb = [u8; 3];

/// The colours of series (Okabe and Ito 2008), black first.
pub const PALETTE: [Rgb; 8] = [
    [0, 0, 0],
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [120, 120, 120],
];

/// A drawing: its size, px, and its shapes in drawing order.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub width: f64,
    pub height: f64,
    pub shapes: Vec<Shape>,
}

/// A shape. Coordinates and widths are px, y down.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A polyline. `dashes` are lengths of pen down and pen up in turn, px; empty for a solid line.
    Path {
        points: Vec<[f64; 2]>,
        width: f64,
        colour: Rgb,
        dashes: &'static [f64],
    },
    /// A filled polygon.
    Area { points: Vec<[f64; 2]>, colour: Rgb },
    /// A filled circle.
    Disc {
        centre: [f64; 2],
        radius: f64,
        colour: Rgb,
    },
    /// Black text. `at` is a point of its baseline, at the `anchor`. Upright text runs from bottom
    /// to top.
    Text {
        text: String,
        at: [f64; 2],
        size: f64,
        anchor: Anchor,
        upright: bool,
    },
}

/// The part of a text that lies at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}
