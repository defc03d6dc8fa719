//! Layout of a figure: positions of axes, legend, series and text.

mod plot;
mod series;
mod title;

use super::shape::{Anchor, Drawing, Rgb, Shape};
use super::ticks::Ruler;
use super::typeface::Typeface;
use super::{Figure, FigureError};
use plot::Plot;
use series::{add_line, add_mark, add_series, bar_values};

/// Size of a figure without title and legend, px. Printed 84 mm wide (a column), the text is 7.5
/// points high.
const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 288.0;
const TEXT: f64 = 13.0;
const SMALL_TEXT: f64 = 12.0;
const INK: Rgb = [0, 0, 0];
const GRID: Rgb = [225, 225, 225];
/// Height of a row of the legend, width of the piece of line before a name, and the gap behind the
/// name, px.
const LEGEND_ROW: f64 = 16.0;
const LEGEND_SAMPLE: f64 = 26.0;
const LEGEND_GAP: f64 = 14.0;

impl Figure {
    /// Lays the figure out from top to bottom: title, legend, plot, labels.
    pub(super) fn laid_out(&self) -> Result<Drawing, FigureError> {
        let typeface = Typeface::load()?;
        let points = || self.series.iter().flat_map(|series| &series.points);
        let bars = self.series.iter().flat_map(bar_values);
        let x = Ruler::new(&self.x, points().map(|point| point[0]));
        let y = Ruler::new(&self.y, points().map(|point| point[1]).chain(bars));
        // The widest number of the y axis determines the left margin. Before it stands the label of
        // the axis, upright; behind it the tick mark.
        let widest = y
            .ticks
            .iter()
            .map(|(_, label)| typeface.width(label, SMALL_TEXT))
            .fold(0.0, f64::max);
        let (left, right) = (34.0 + widest, WIDTH - 16.0);
        let mut shapes = Vec::new();
        let heading = self.add_title(&mut shapes, &typeface);
        let rows = self.add_legend(&mut shapes, [left, right], heading, &typeface);
        // The plot's height does not depend on title and legend: figures beside each other have
        // plots of one size, and those with more text are taller.
        let top = heading + LEGEND_ROW * rows as f64 + 9.0;
        let plot = Plot {
            left,
            right,
            top,
            bottom: top + HEIGHT - 53.0,
            x,
            y,
        };
        self.add_axes(&mut shapes, &plot);
        for series in &self.series {
            add_series(&mut shapes, series, &plot);
        }
        Ok(Drawing {
            width: WIDTH,
            height: plot.bottom + 44.0,
            shapes,
        })
    }

    /// Adds grid, tick marks, numbers, frame and labels.
    fn add_axes(&self, shapes: &mut Vec<Shape>, plot: &Plot) {
        let Plot {
            left,
            right,
            top,
            bottom,
            ..
        } = *plot;
        // Grid lines, tick marks and numbers of both axes.
        for (value, label) in &plot.x.ticks {
            let Some(share) = plot.x.share(*value) else {
                continue;
            };
            let x = left + share * (right - left);
            shapes.push(thin_line([x, top], [x, bottom], GRID));
            shapes.push(thin_line([x, bottom], [x, bottom + 4.0], INK));
            shapes.push(number(label, [x, bottom + 17.0], Anchor::Middle));
        }
        for (value, label) in &plot.y.ticks {
            let Some(share) = plot.y.share(*value) else {
                continue;
            };
            let y = bottom - share * (bottom - top);
            shapes.push(thin_line([left, y], [right, y], GRID));
            shapes.push(thin_line([left - 4.0, y], [left, y], INK));
            shapes.push(number(label, [left - 7.0, y + 4.2], Anchor::End));
        }
        // The frame covers the ends of the grid lines.
        let frame = vec![
            [left, top],
            [right, top],
            [right, bottom],
            [left, bottom],
            [left, top],
        ];
        shapes.push(Shape::Path {
            points: frame,
            width: 1.0,
            colour: INK,
            dashes: &[],
        });
        // Labels, centred on their side of the plot.
        let middle = f64::midpoint(left, right);
        shapes.push(Shape::Text {
            text: self.x.label.clone(),
            at: [middle, bottom + 35.0],
            size: TEXT,
            anchor: Anchor::Middle,
            upright: false,
        });
        shapes.push(Shape::Text {
            text: self.y.label.clone(),
            at: [15.0, f64::midpoint(top, bottom)],
            size: TEXT,
            anchor: Anchor::Middle,
            upright: true,
        });
    }

    /// Adds the legend, in rows above the plot. Returns the number of rows.
    fn add_legend(
        &self,
        shapes: &mut Vec<Shape>,
        [left, right]: [f64; 2],
        top: f64,
        typeface: &Typeface,
    ) -> usize {
        // Entries are placed like words: from left to right, in a new row where one does not fit.
        // One that is wider than a row stands alone in it.
        let (mut x, mut row) = (left, 0);
        let mut named = self
            .series
            .iter()
            .filter(|series| !series.name.is_empty())
            .peekable();
        if named.peek().is_none() {
            return 0;
        }
        for series in named {
            let width = LEGEND_SAMPLE + 5.0 + typeface.width(&series.name, SMALL_TEXT);
            if x > left && x + width > right {
                (x, row) = (left, row + 1);
            }
            let y = top + 6.0 + LEGEND_ROW * (row as f64 + 0.5);
            let (from, to) = ([x, y], [x + LEGEND_SAMPLE, y]);
            add_line(shapes, series, vec![from, to]);
            add_mark(shapes, series, [f64::midpoint(from[0], to[0]), y]);
            shapes.push(Shape::Text {
                text: series.name.clone(),
                at: [to[0] + 5.0, y + 4.2],
                size: SMALL_TEXT,
                anchor: Anchor::Start,
                upright: false,
            });
            x += width + LEGEND_GAP;
        }
        row + 1
    }
}

/// A line of the grid, or a tick mark.
fn thin_line(from: [f64; 2], to: [f64; 2], colour: Rgb) -> Shape {
    Shape::Path {
        points: vec![from, to],
        width: 1.0,
        colour,
        dashes: &[],
    }
}

/// A number of an axis.
fn number(label: &str, at: [f64; 2], anchor: Anchor) -> Shape {
    Shape::Text {
        text: label.to_owned(),
        at,
        size: SMALL_TEXT,
        anchor,
        upright: false,
    }
}

#[cfg(test)]
mod tests;
