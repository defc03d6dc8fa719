//! Figures that can stand in a paper: labelled axes with units, legends, error bars, as SVG and
//! PNG.
//!
//! A [`Figure`] is laid out once into a few kinds of shapes, which [`Figure::to_svg`] writes and
//! [`Figure::to_png`] paints: both show the same, and neither needs a font library or a GPU.
//! Colours are those of Okabe and Ito, apart for the colour-blind too; marks and dashes differ as
//! well, for print in grey.
//!
//! Two of the figures were drawn through `plotters` 0.3 as well, and looked worse: its bitmaps do
//! not smooth wide lines and round every coordinate to a pixel, its SVG has whole pixels only, and
//! its legend covers data and shows no dashes or marks. Layout would have stayed here anyway; only
//! the writing of SVG and the filling of polygons, some 300 lines, would have gone.

mod layout;
mod raster;
mod shape;
mod svg;
mod ticks;
mod typeface;

pub(super) use raster::{SCALE, painted};
pub(super) use shape::{Anchor, Drawing, Rgb, Shape};
pub use ticks::Ruler;

use thiserror::Error;

/// A diagram with two axes; its legend stands above them, where it hides nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What stands above it; empty: nothing.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// What is drawn, the first one at the bottom.
    pub series: Vec<Series>,
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with the unit.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Where it begins and ends; none: as the series need.
    pub range: Option<[f64; 2]>,
}

/// How numbers lie along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    #[default]
    Linear,
    /// Equal factors; numbers that are not positive are left out.
    Log,
}

/// A series of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name in the legend; empty: none there.
    pub name: String,
    /// Its points.
    pub points: Vec<[f64; 2]>,
    /// Error bars: from and to, for each point. Empty: none.
    pub bars: Vec<[f64; 2]>,
    /// What marks its points.
    pub mark: Mark,
    /// The line through them.
    pub line: Line,
    /// Its colour: 0 black, then seven that are easy to distinguish, then again.
    pub colour: usize,
}

/// What marks a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// Nothing.
    None,
    /// A disc.
    #[default]
    Disc,
    /// A small disc, where there are many points.
    Dot,
    /// A square.
    Square,
    /// A triangle.
    Triangle,
    /// A diagonal cross.
    Cross,
}

/// The line through a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Line {
    /// None.
    None,
    /// Drawn through.
    #[default]
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// Why a figure has no picture.
#[derive(Debug, Error)]
pub enum FigureError {
    /// The font that comes with the program is damaged.
    #[error("the program's typeface cannot be read: {0}")]
    Typeface(#[from] ab_glyph::InvalidFont),
    /// The picture cannot be made or encoded.
    #[error("the figure cannot be written as PNG: {0}")]
    Png(#[from] image::ImageError),
}

impl Axis {
    /// A linear axis from what the series need.
    #[must_use]
    pub fn linear(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// A logarithmic axis.
    #[must_use]
    pub fn log(label: &str) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::linear(label)
        }
    }

    /// The same axis from here to there.
    #[must_use]
    pub fn within(self, from: f64, to: f64) -> Self {
        Self {
            range: Some([from, to]),
            ..self
        }
    }
}

impl Series {
    /// A line with discs, coloured by its number.
    #[must_use]
    pub fn new(name: &str, colour: usize, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            bars: Vec::new(),
            mark: Mark::Disc,
            line: Line::Solid,
            colour,
        }
    }

    /// With error bars: from and to, for each point.
    #[must_use]
    pub fn with_bars(self, bars: Vec<[f64; 2]>) -> Self {
        Self { bars, ..self }
    }

    /// With another mark.
    #[must_use]
    pub fn marked(self, mark: Mark) -> Self {
        Self { mark, ..self }
    }

    /// With another line.
    #[must_use]
    pub fn lined(self, line: Line) -> Self {
        Self { line, ..self }
    }

    /// The share of values up to each, as a staircase: a cumulative distribution. `of` is how many
    /// there are with those that have no value, which count as never reached.
    #[must_use]
    pub fn cumulative(name: &str, colour: usize, values: &[f64], of: usize) -> Self {
        let mut sorted: Vec<f64> = values
            .iter()
            .copied()
            .filter(|value| value.is_finite())
            .collect();
        sorted.sort_by(f64::total_cmp);
        let share = |count: usize| count as f64 / of.max(1) as f64;
        let steps = sorted.iter().enumerate();
        let points = steps
            .flat_map(|(index, value)| [[*value, share(index)], [*value, share(index + 1)]])
            .collect();
        Self::new(name, colour, points).marked(Mark::None)
    }
}

impl Figure {
    /// A figure with these axes and nothing in it.
    #[must_use]
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            x,
            y,
            series: Vec::new(),
        }
    }

    /// With one more series.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The figure as SVG; text stays text.
    ///
    /// # Errors
    /// The program's typeface cannot be read (it measures the text).
    pub fn to_svg(&self) -> Result<String, FigureError> {
        Ok(svg::write(&self.laid_out()?, &self.title))
    }

    /// The figure as PNG, at 300 dots an inch for a column 84 mm wide.
    ///
    /// # Errors
    /// The program's typeface cannot be read, or the PNG cannot be encoded.
    pub fn to_png(&self) -> Result<Vec<u8>, FigureError> {
        raster::png(&self.laid_out()?)
    }
}
