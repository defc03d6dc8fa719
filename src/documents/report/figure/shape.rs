//! What a laid-out figure consists of.

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

/// A drawing: its size in px and its shapes, the first one at the bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub width: f64,
    pub height: f64,
    pub shapes: Vec<Shape>,
}

/// Something drawn; y runs down.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A line through points.
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
    /// Text; `at` is on its baseline.
    Text {
        text: String,
        at: [f64; 2],
        size: f64,
        anchor: Anchor,
        upright: bool,
    },
}

/// Which part of a text lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}
