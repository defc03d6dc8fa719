//! Layout of a figure: positions of axes, legend, series and text.

use super::shape::{Anchor, Drawing, PALETTE, Rgb, Shape};
use super::ticks::Ruler;
use super::typeface::Typeface;
use super::{Figure, FigureError, Line, Mark, Series};

/// Size of a figure without title and legend, px. Printed 84 mm wide (a column), the text is 7.5
/// points high.
const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 288.0;
const TEXT: f64 = 13.0;
const SMALL_TEXT: f64 = 12.0;
const INK: Rgb = [0, 0, 0];
const GRID: Rgb = [225, 225, 225];
const MARK_RADIUS: f64 = 3.2;
const DOT_RADIUS: f64 = 1.5;
/// Half the width of the cap of an error bar.
const BAR_CAP: f64 = 3.0;
const LEGEND_ROW: f64 = 16.0;
const LEGEND_SAMPLE: f64 = 26.0;
const LEGEND_GAP: f64 = 14.0;
/// A little larger than the axes' labels.
const TITLE_TEXT: f64 = 15.0;
/// Height of a title of one line, and of each further line.
const TITLE_ROW: f64 = 22.0;
const TITLE_FURTHER_ROW: f64 = 16.0;
/// Left and right of a title, at least.
const TITLE_MARGIN: f64 = 12.0;

/// The rectangle between the axes, px, and the axes.
struct Plot {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    x: Ruler,
    y: Ruler,
}

impl Plot {
    /// The position of a point, px; none if an axis cannot show it, such as 0 on a logarithmic one.
    fn at(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let (right, up) = (self.x.share(x)?, self.y.share(y)?);
        Some([
            self.left + right * (self.right - self.left),
            self.bottom - up * (self.bottom - self.top),
        ])
    }

    /// The height of an end of an error bar, px, which may lie beyond the frame: infinitely far for
    /// an infinite end, and below it for a number that a logarithmic axis cannot show. None for NaN.
    fn bar_end(&self, value: f64) -> Option<f64> {
        if value.is_nan() {
            return None;
        }
        let Some(share) = self.y.share(value) else {
            return Some(if value > 0.0 {
                f64::NEG_INFINITY
            } else {
                f64::INFINITY
            });
        };
        Some(self.bottom - share * (self.bottom - self.top))
    }

    /// Whether a position is inside the plot, within half a px.
    fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let slack = 0.5;
        x >= self.left - slack
            && x <= self.right + slack
            && y >= self.top - slack
            && y <= self.bottom + slack
    }
}

impl Figure {
    /// Lays the figure out from top to bottom: title, legend, plot, labels.
    pub(super) fn laid_out(&self) -> Result<Drawing, FigureError> {
        let typeface = Typeface::load()?;
        let points = || self.series.iter().flat_map(|series| &series.points);
        let bars = self.series.iter().flat_map(bar_values);
        let x = Ruler::new(&self.x, points().map(|point| point[0]));
        let y = Ruler::new(&self.y, points().map(|point| point[1]).chain(bars));
        // The widest number of the y axis determines the left margin.
        let widest = y
            .ticks
            .iter()
            .map(|(_, label)| typeface.width(label, SMALL_TEXT))
            .fold(0.0, f64::max);
        let (left, right) = (34.0 + widest, WIDTH - 16.0);
        let mut shapes = Vec::new();
        let heading = self.add_title(&mut shapes, &typeface);
        let rows = self.add_legend(&mut shapes, [left, right], heading, &typeface);
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

    /// Adds the title, centred at the top of the figure. Returns the height that it takes.
    ///
    /// A title that is too wide is shrunk, at most to the size of the smallest text; one that is too
    /// wide even then is broken at spaces. A word that is wider than the figure shrinks the title
    /// further.
    fn add_title(&self, shapes: &mut Vec<Shape>, typeface: &Typeface) -> f64 {
        let title = self.title.trim();
        if title.is_empty() {
            return 0.0;
        }
        let room = WIDTH - 2.0 * TITLE_MARGIN;
        let fitting = TITLE_TEXT * room / typeface.width(title, TITLE_TEXT);
        let (lines, size) = if fitting >= SMALL_TEXT {
            (vec![title.to_owned()], fitting.min(TITLE_TEXT))
        } else {
            let lines = break_lines(title, SMALL_TEXT, room, typeface);
            let widths = lines.iter().map(|line| typeface.width(line, SMALL_TEXT));
            let widest = widths.fold(room, f64::max);
            (lines, SMALL_TEXT * room / widest)
        };
        let further = |rows: usize| TITLE_FURTHER_ROW * rows as f64;
        let height = TITLE_ROW + further(lines.len() - 1);
        for (row, text) in lines.into_iter().enumerate() {
            shapes.push(Shape::Text {
                text,
                at: [WIDTH / 2.0, 18.0 + further(row)],
                size,
                anchor: Anchor::Middle,
                upright: false,
            });
        }
        height
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
        let line = |from, to, colour| Shape::Path {
            points: vec![from, to],
            width: 1.0,
            colour,
            dashes: &[],
        };
        let text = |text: &str, at, size, anchor, upright| Shape::Text {
            text: text.to_owned(),
            at,
            size,
            anchor,
            upright,
        };
        // Grid lines, tick marks and numbers of both axes.
        for (value, label) in &plot.x.ticks {
            let Some(share) = plot.x.share(*value) else {
                continue;
            };
            let x = left + share * (right - left);
            shapes.push(line([x, top], [x, bottom], GRID));
            shapes.push(line([x, bottom], [x, bottom + 4.0], INK));
            shapes.push(text(
                label,
                [x, bottom + 17.0],
                SMALL_TEXT,
                Anchor::Middle,
                false,
            ));
        }
        for (value, label) in &plot.y.ticks {
            let Some(share) = plot.y.share(*value) else {
                continue;
            };
            let y = bottom - share * (bottom - top);
            shapes.push(line([left, y], [right, y], GRID));
            shapes.push(line([left - 4.0, y], [left, y], INK));
            shapes.push(text(
                label,
                [left - 7.0, y + 4.2],
                SMALL_TEXT,
                Anchor::End,
                false,
            ));
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
        shapes.push(text(
            &self.x.label,
            [middle, bottom + 35.0],
            TEXT,
            Anchor::Middle,
            false,
        ));
        shapes.push(text(
            &self.y.label,
            [15.0, f64::midpoint(top, bottom)],
            TEXT,
            Anchor::Middle,
            true,
        ));
    }

    /// Adds the legend, in rows above the plot. Returns the number of rows.
    fn add_legend(
        &self,
        shapes: &mut Vec<Shape>,
        [left, right]: [f64; 2],
        top: f64,
        typeface: &Typeface,
    ) -> usize {
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

/// Breaks text at spaces into lines that are no wider than `room`, as far as its words allow.
fn break_lines(text: &str, size: f64, room: f64, typeface: &Typeface) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if typeface.width(&longer, size) <= room {
                *line = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    lines
}

/// The numbers that an axis has to show for the error bars of a series.
///
/// A bar whose low end is not positive has no lower end on a logarithmic axis. Half of the number at
/// its point is added for it, so that the axis goes on below the point and the bar can be seen. A
/// linear axis shows that number anyway: it lies between the bar's low end and its point.
fn bar_values(series: &Series) -> impl Iterator<Item = f64> {
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
fn add_series(shapes: &mut Vec<Shape>, series: &Series, plot: &Plot) {
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
    let (Some(low), Some(high)) = (plot.bar_end(low), plot.bar_end(high)) else {
        return;
    };
    let mut add_stroke = |points| {
        shapes.push(Shape::Path {
            points,
            width: 1.2,
            colour,
            dashes: &[],
        });
    };
    let [from, to] = [low.min(plot.bottom), high.max(plot.top)];
    if !plot.contains([x, from]) || !plot.contains([x, to]) {
        return;
    }
    add_stroke(vec![[x, from], [x, to]]);
    for end in [low, high].into_iter().filter(|y| plot.contains([x, *y])) {
        add_stroke(vec![[x - BAR_CAP, end], [x + BAR_CAP, end]]);
    }
}

/// The parts of a polyline inside the plot.
fn within_frame(plot: &Plot, line: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut parts: Vec<Vec<[f64; 2]>> = Vec::new();
    for pair in line.windows(2) {
        let Some([from, to]) = cut(plot, pair[0], pair[1]) else {
            continue;
        };
        match parts.last_mut() {
            Some(part) if part.last() == Some(&from) => part.push(to),
            _ => parts.push(vec![from, to]),
        }
    }
    parts
}

/// Clips a segment to the plot (Liang, Barsky 1984).
fn cut(plot: &Plot, from: [f64; 2], to: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for (axis, low, high) in [(0, plot.left, plot.right), (1, plot.top, plot.bottom)] {
        for (slope, room) in [
            (-along[axis], from[axis] - low),
            (along[axis], high - from[axis]),
        ] {
            if slope == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if slope < 0.0 {
                start = start.max(room / slope);
            } else {
                end = end.min(room / slope);
            }
        }
    }
    let at = |share: f64| [from[0] + along[0] * share, from[1] + along[1] * share];
    // Ends that are not clipped stay exact, because `within_frame` joins pieces with equal ends.
    (start <= end).then(|| {
        [
            if start == 0.0 { from } else { at(start) },
            if end == 1.0 { to } else { at(end) },
        ]
    })
}

/// Adds a line in the style of a series.
fn add_line(shapes: &mut Vec<Shape>, series: &Series, points: Vec<[f64; 2]>) {
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
fn add_mark(shapes: &mut Vec<Shape>, series: &Series, [x, y]: [f64; 2]) {
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

#[cfg(test)]
mod tests {
    use super::super::{Axis, Figure, Series};
    use super::*;

    fn figure() -> Figure {
        let measured = Series::new(
            "measured",
            1,
            vec![[0.0, 1.0], [1.0, 2.0], [2.0, f64::NAN], [3.0, 9.0]],
        );
        Figure::new(
            "Errors <of> two",
            Axis::linear("noise (px)").within(0.0, 3.0),
            Axis::linear("error (°)").within(0.0, 4.0),
        )
        .with(measured.with_bars(vec![[0.5, 1.5], [1.0, 30.0], [0.0, 0.0], [8.0, 9.5]]))
        .with(
            Series::new("bound", 0, vec![[0.0, 0.0], [3.0, 3.0]])
                .lined(Line::Dashed)
                .marked(Mark::None),
        )
    }

    #[test]
    fn everything_drawn_stays_within_the_frame() {
        let drawing = figure().laid_out().unwrap();
        for shape in &drawing.shapes {
            let points = match shape {
                Shape::Path { points, .. } | Shape::Area { points, .. } => points.clone(),
                Shape::Disc { centre, .. } => vec![*centre],
                Shape::Text { at, .. } => vec![*at],
            };
            for [x, y] in points {
                assert!(
                    (0.0..=drawing.width).contains(&x) && (0.0..=drawing.height).contains(&y),
                    "{shape:?}"
                );
            }
        }
        let discs = drawing
            .shapes
            .iter()
            .filter(|shape| matches!(shape, Shape::Disc { .. }))
            .count();
        // Two of four points have a place (one is NaN, one is above), and the legend shows one.
        assert_eq!(discs, 3);
    }

    #[test]
    fn svg_and_png_are_made_and_repeat() {
        let svg = figure().to_svg().unwrap();
        assert!(svg.starts_with("<svg xmlns=") && svg.ends_with("</svg>\n"));
        // Once as the figure's name, once as the label of what is drawn.
        assert_eq!(svg.matches("Errors &lt;of&gt; two").count(), 2);
        assert!(
            svg.contains("aria-label=\"noise (px)\"")
                && svg.contains("stroke-dasharray=\"6 4\"")
                && !svg.contains("<text")
        );
        assert!(!svg.contains("NaN"));
        let png = figure().to_png().unwrap();
        assert_eq!(png, figure().to_png().unwrap());
        let picture = image::load_from_memory(&png).unwrap().to_rgb8();
        // 288 px, a title and one row of the legend.
        assert_eq!(picture.dimensions(), (992, 770));
        let blue = picture
            .pixels()
            .filter(|pixel| pixel.0 == [0, 114, 178])
            .count();
        let ink = picture
            .pixels()
            .filter(|pixel| pixel.0 == [0, 0, 0])
            .count();
        assert!(blue > 200 && ink > 2000, "{blue} {ink}");
    }

    #[test]
    fn a_figure_without_a_title_is_named_by_its_axes() {
        let untitled = Figure {
            title: String::new(),
            ..figure()
        };
        let svg = untitled.to_svg().unwrap();
        assert!(svg.contains("<title>error (°) over noise (px)</title>"));
        assert!(!svg.contains("Errors"));
        let height = |figure: Figure| figure.laid_out().unwrap().height;
        assert_eq!(height(figure()) - height(untitled), TITLE_ROW);
    }

    /// The lines of a title with their size, and the height that they take.
    fn lay_out_title(title: &str) -> (Vec<String>, f64, f64) {
        let figure = Figure::new(title, Axis::linear("x"), Axis::linear("y"));
        let typeface = Typeface::load().unwrap();
        let mut shapes = Vec::new();
        let height = figure.add_title(&mut shapes, &typeface);
        let mut sizes = Vec::new();
        let mut lines = Vec::new();
        for shape in shapes {
            let Shape::Text { text, at, size, .. } = shape else {
                continue;
            };
            assert!(typeface.width(&text, size) <= WIDTH - 2.0 * TITLE_MARGIN + 1e-9);
            // Room for the parts of letters below the baseline.
            assert!(at[1] + 0.25 * size <= height, "{} {height}", at[1]);
            lines.push(text);
            sizes.push(size);
        }
        (lines, sizes.first().copied().unwrap_or(0.0), height)
    }

    #[test]
    fn a_title_that_is_too_wide_is_shrunk_then_broken() {
        assert_eq!(lay_out_title(" "), (vec![], 0.0, 0.0));
        let (lines, size, height) = lay_out_title("Errors of two");
        assert_eq!((lines.len(), size, height), (1, TITLE_TEXT, TITLE_ROW));
        let (lines, size, height) = lay_out_title(&"noise ".repeat(12));
        assert_eq!((lines.len(), height), (1, TITLE_ROW));
        assert!(size > SMALL_TEXT && size < TITLE_TEXT, "{size}");
        let (lines, size, height) = lay_out_title(&"noise ".repeat(20));
        assert_eq!((lines.len(), size), (2, SMALL_TEXT));
        assert_eq!(height, TITLE_ROW + TITLE_FURTHER_ROW);
        let (lines, size, _) = lay_out_title(&"noise".repeat(20));
        assert!(lines.len() == 1 && size < SMALL_TEXT, "{size}");
    }

    /// The error bar of one point on this vertical axis: the upper and the lower end of its line, as
    /// shares of the plot's height from the top, and the number of its caps.
    fn lay_out_bar(y: Axis, point: f64, bar: [f64; 2]) -> Option<([f64; 2], usize)> {
        let series = Series::new("", 1, vec![[1.0, point]])
            .lined(Line::None)
            .marked(Mark::None)
            .with_bars(vec![bar]);
        let x = Axis::linear("").within(0.0, 2.0);
        let drawing = Figure::new("", x, y).with(series).laid_out().unwrap();
        let (mut line, mut caps) = (None, 0);
        for shape in drawing.shapes {
            match shape {
                Shape::Path { points, colour, .. } if colour == PALETTE[1] => {
                    if points[0][0] == points[1][0] {
                        // Without legend, the plot begins 9 px below the top.
                        let share = |at: [f64; 2]| (at[1] - 9.0) / (HEIGHT - 53.0);
                        line = Some([share(points[1]), share(points[0])]);
                    } else {
                        caps += 1;
                    }
                }
                _ => {}
            }
        }
        line.map(|line| (line, caps))
    }

    #[test]
    fn error_bars_are_open_beyond_the_axis() {
        let log = || Axis::log("").within(0.1, 10.0);
        let linear = || Axis::linear("").within(0.0, 4.0);
        let closed = lay_out_bar(linear(), 2.0, [1.0, 3.0]);
        assert_eq!(closed, Some(([0.25, 0.75], 2)));
        // A low end that a logarithmic axis cannot show.
        for low in [0.0, -1.0, f64::NEG_INFINITY] {
            let ([top, bottom], caps) = lay_out_bar(log(), 1.0, [low, 1.0]).unwrap();
            assert!((top - 0.5).abs() < 1e-9, "{top}");
            assert_eq!((bottom, caps), (1.0, 1));
        }
        // Ends beyond the range.
        let open = lay_out_bar(linear(), 2.0, [1.0, 30.0]);
        assert_eq!(open, Some(([0.0, 0.75], 1)));
        let open = lay_out_bar(linear(), 2.0, [-1.0, f64::INFINITY]);
        assert_eq!(open, Some(([0.0, 1.0], 0)));
        // Bars that are nowhere within it.
        assert_eq!(lay_out_bar(linear(), 2.0, [5.0, 6.0]), None);
        assert_eq!(lay_out_bar(log(), 2.0, [-2.0, -1.0]), None);
    }

    #[test]
    fn error_bars_without_an_end_are_not_drawn() {
        for bar in [[f64::NAN, 3.0], [1.0, f64::NAN], [f64::NAN; 2]] {
            assert_eq!(lay_out_bar(Axis::linear(""), 2.0, bar), None);
            assert_eq!(lay_out_bar(Axis::log(""), 2.0, bar), None);
        }
    }

    #[test]
    fn a_log_axis_goes_on_below_a_point_with_an_open_bar() {
        let log = Axis::log("");
        let ([top, bottom], caps) = lay_out_bar(log, 1.0, [-1.0, 5.0]).unwrap();
        // The axis goes from half of the point to the upper end.
        assert!(top.abs() < 1e-9, "{top}");
        assert_eq!((bottom, caps), (1.0, 1));
        // A linear axis gains nothing by it, below zero either.
        let bar = lay_out_bar(Axis::linear(""), -6.0, [-7.0, -5.0]);
        assert_eq!(bar, Some(([0.0, 1.0], 2)));
    }

    #[test]
    fn a_cumulative_series_counts_what_was_never_reached() {
        let series = Series::cumulative("x", 1, &[3.0, 1.0, f64::INFINITY], 4);
        assert_eq!(
            series.points,
            [[1.0, 0.0], [1.0, 0.25], [3.0, 0.25], [3.0, 0.5]]
        );
    }
}
