//! The shapes of a series: its line, marks and error bars.

use super::plot::{Plot, within_frame};
use crate::report::figure::shape::{PALETTE, Rgb, Shape};
use crate::report::figure::{Line, Mark, Series};

const MARK_RADIUS: f64 = 3.2;
const DOT_RADIUS: f64 = 1.5;
/// Half the width of the cap of an error bar.
const BAR_CAP: f64 = 3.0;

/// The numbers that an axis has to show for the error bars of a series.
///
/// A bar whose low end is not positive has no lower end on a logarithmic axis. Half of the number
/// at its point is added for it, so that the axis goes on below the point and the bar can be seen.
/// A linear axis shows that number anyway: it lies between the bar's low end and its point.
pub(super) fn bar_values(series: &Series) -> impl Iterator<Item = f64> {
    let bars = series.points.iter().zip(&series.bars);
    bars.filter(|(_, bar)| bar.iter().all(|end| !end.is_nan()))
        .flat_map(|(point, [low, high])| {
            let open = (*low <= 0.0 && point[1] > 0.0).then_some(point[1] / 2.0);
            [Some(*low), Some(*high), open].into_iter().flatten()
        })
}

fn colour(series: &Series) -> Rgb {
    PALETTE[series.colour % PALETTE.len()]
}

/// Adds a series: error bars, then the line, then the marks.
pub(super) fn add_series(shapes: &mut Vec<Shape>, series: &Series, plot: &Plot) {
    // A bar is drawn even where its point is not, such as a mean above the frame.
    for ([x, _], bar) in series.points.iter().zip(&series.bars) {
        if let Some(share) = plot.x.share(*x) {
            let x = plot.left + share * (plot.right - plot.left);
            add_bar(shapes, colour(series), x, *bar, plot);
        }
    }
    // The line is interrupted at points that an axis cannot show, and clipped at the frame.
    let mut run: Vec<[f64; 2]> = Vec::new();
    for point in series
        .points
        .iter()
        .map(|point| plot.at(*point))
        // An end like any interruption, so that the last run is drawn, too.
        .chain([None])
    {
        if let Some(at) = point {
            run.push(at);
        } else {
            for part in within_frame(plot, &run) {
                add_line(shapes, series, part);
            }
            run.clear();
        }
    }
    for at in series
        .points
        .iter()
        .filter_map(|point| plot.at(*point))
        .filter(|at| plot.contains(*at))
    {
        add_mark(shapes, series, at);
    }
}

/// Adds an error bar: a line with a cap at either end.
///
/// An end beyond the frame is open: the line goes up to the frame and has no cap there. On a
/// logarithmic axis, that includes a low end that is not positive, as mean minus standard deviation
/// often is. A bar with an end that is NaN, or without a part inside the frame, is not drawn.
fn add_bar(shapes: &mut Vec<Shape>, colour: Rgb, x: f64, [low, high]: [f64; 2], plot: &Plot) {
    // Positions grow downwards: the low end of a bar has the larger one.
    let (Some(low), Some(high)) = (plot.bar_end(low), plot.bar_end(high)) else {
        return;
    };
    let [from, to] = [low.min(plot.bottom), high.max(plot.top)];
    if !plot.contains([x, from]) || !plot.contains([x, to]) {
        return;
    }
    let caps = [low, high]
        .into_iter()
        .filter(|y| plot.contains([x, *y]))
        .map(|y| vec![[x - BAR_CAP, y], [x + BAR_CAP, y]]);
    for points in std::iter::once(vec![[x, from], [x, to]]).chain(caps) {
        shapes.push(Shape::Path {
            points,
            width: 1.2,
            colour,
            dashes: &[],
        });
    }
}

/// Adds a line in the style of a series.
pub(super) fn add_line(shapes: &mut Vec<Shape>, series: &Series, points: Vec<[f64; 2]>) {
    let dashes: &'static [f64] = match series.line {
        Line::None => return,
        Line::Solid => &[],
        Line::Dashed => &[6.0, 4.0],
        Line::Dotted => &[1.6, 2.6],
    };
    shapes.push(Shape::Path {
        points,
        width: 1.7,
        colour: colour(series),
        dashes,
    });
}

/// Adds a mark of a series at a position.
pub(super) fn add_mark(shapes: &mut Vec<Shape>, series: &Series, [x, y]: [f64; 2]) {
    let (colour, r) = (colour(series), MARK_RADIUS);
    match series.mark {
        Mark::None => {}
        Mark::Dot => shapes.push(Shape::Disc {
            centre: [x, y],
            radius: DOT_RADIUS,
            colour,
        }),
        Mark::Disc => shapes.push(Shape::Disc {
            centre: [x, y],
            radius: r,
            colour,
        }),
        Mark::Square => {
            let s = 0.9 * r;
            let points = vec![
                [x - s, y - s],
                [x + s, y - s],
                [x + s, y + s],
                [x - s, y + s],
            ];
            shapes.push(Shape::Area { points, colour });
        }
        Mark::Triangle => {
            let points = vec![
                [x, y - 1.25 * r],
                [x + 1.1 * r, y + 0.75 * r],
                [x - 1.1 * r, y + 0.75 * r],
            ];
            shapes.push(Shape::Area { points, colour });
        }
        Mark::Cross => {
            for [from, to] in [[[-r, -r], [r, r]], [[-r, r], [r, -r]]] {
                let points = vec![[x + from[0], y + from[1]], [x + to[0], y + to[1]]];
                shapes.push(Shape::Path {
                    points,
                    width: 1.5,
                    colour,
                    dashes: &[],
                });
            }
        }
    }
}
