//! Diagrams for publication, as SVG and PNG: labelled axes with units, legends, error bars.
//!
//! A [`Figure`] is laid out once into a few kinds of shapes. [`Figure::to_svg`] writes these, and
//! [`Figure::to_png`] rasterises them, so that both files agree. Text is drawn as outlines of the
//! program's own typeface in both. Neither needs a system font or a GPU. Colours are those of Okabe
//! and Ito, which remain distinct with colour vision deficiency. Marks and dashes differ as well,
//! for printing in grey.
//!
//! Why not `plotters` 0.3? Two of the figures were drawn with it for comparison. Its bitmaps do not
//! smooth wide lines and round every coordinate to a pixel, its SVG has integer coordinates only,
//! and its legend covers data and shows no dashes or marks. Using it would save only the SVG writer
//! and the polygon filling, some 300 lines.

mod layout;
mod raster;
mod shape;
mod svg;
mod ticks;
mod typeface;

#[doc(hidden)]
pub use raster::{SCALE, png_with_background};
#[doc(hidden)]
pub use shape::{Anchor, Drawing, Rgb, Shape};
pub use ticks::Ruler;

use thiserror::Error;

/// A diagram with two axes. The legend is above the axes, where it covers no data.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The title, which is drawn above the legend; empty for none.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The series, in drawing order: later ones cover earlier ones.
    pub series: Vec<Series>,
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity and its unit.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// First and last number; none to fit the series.
    pub range: Option<[f64; 2]>,
}

/// The spacing of numbers along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    #[default]
    Linear,
    /// Equal factors. Numbers that are not positive are not drawn.
    Log,
}

/// A series of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name in the legend; empty for no entry.
    pub name: String,
    /// Its points.
    pub points: Vec<[f64; 2]>,
    /// Error bars: low and high end for each point. Empty for none. An end beyond the axis is drawn
    /// open, such as a low end that is not positive on a logarithmic axis; a bar with an end that
    /// is NaN is not drawn.
    pub bars: Vec<[f64; 2]>,
    /// The mark at each point.
    pub mark: Mark,
    /// The line through them.
    pub line: Line,
    /// Its colour: 0 is black, 1 to 7 are seven other colours. Higher numbers repeat them.
    pub colour: usize,
}

/// The mark at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// Nothing.
    None,
    /// A disc.
    #[default]
    Disc,
    /// A small disc, for many points.
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
    /// Continuous.
    #[default]
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// Why a figure could not be drawn.
#[derive(Debug, Error)]
pub enum FigureError {
    /// The font that is built into the program is damaged.
    #[error("the program's typeface cannot be read: {0}")]
    Typeface(#[from] ab_glyph::InvalidFont),
    /// The PNG cannot be encoded.
    #[error("the figure cannot be written as PNG: {0}")]
    Png(#[from] image::ImageError),
}

impl Axis {
    /// A linear axis that fits the series.
    pub fn linear(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// A logarithmic axis that fits the series.
    pub fn log(label: &str) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::linear(label)
        }
    }

    /// Sets the first and the last number of the axis.
    #[must_use]
    pub fn within(self, from: f64, to: f64) -> Self {
        Self {
            range: Some([from, to]),
            ..self
        }
    }
}

impl Series {
    /// A solid line with discs in a colour of the palette.
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

    /// Sets error bars: low and high end for each point.
    #[must_use]
    pub fn with_bars(self, bars: Vec<[f64; 2]>) -> Self {
        Self { bars, ..self }
    }

    /// Sets the mark.
    #[must_use]
    pub fn with_mark(self, mark: Mark) -> Self {
        Self { mark, ..self }
    }

    /// Sets the line.
    #[must_use]
    pub fn with_line(self, line: Line) -> Self {
        Self { line, ..self }
    }

    /// The cumulative distribution of values, as a staircase. `of` is the number of all cases,
    /// including those without a value, which the curve never reaches.
    pub fn cumulative(name: &str, colour: usize, values: &[f64], of: usize) -> Self {
        let mut sorted: Vec<f64> = values
            .iter()
            .copied()
            .filter(|value| value.is_finite())
            .collect();
        sorted.sort_by(f64::total_cmp);
        // Each value has two points, at the share before and after it, which gives a vertical step.
        // Values that are not finite have none, but are among `of`. Without a case, the share is
        // zero, not NaN.
        let share = |count: usize| count as f64 / of.max(1) as f64;
        let steps = sorted.iter().enumerate();
        let points = steps
            .flat_map(|(index, value)| [[*value, share(index)], [*value, share(index + 1)]])
            .collect();
        Self::new(name, colour, points).with_mark(Mark::None)
    }
}

impl Figure {
    /// An empty figure with these axes.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            x,
            y,
            series: Vec::new(),
        }
    }

    /// Adds a series.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The figure as SVG. Text is drawn as outlines, and labelled for screen readers. They name a
    /// figure without a title by its axes.
    ///
    /// # Errors
    /// The program's typeface cannot be read.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        let drawing = self.laid_out()?;
        if self.title.trim().is_empty() {
            svg::write(&drawing, &format!("{} over {}", self.y.label, self.x.label))
        } else {
            svg::write(&drawing, &self.title)
        }
    }

    /// The figure as PNG, 84 mm wide (a column) at 300 dots per inch.
    ///
    /// # Errors
    /// The program's typeface cannot be read, or the PNG cannot be encoded.
    pub fn to_png(&self) -> Result<Vec<u8>, FigureError> {
        raster::png(&self.laid_out()?)
    }
}
