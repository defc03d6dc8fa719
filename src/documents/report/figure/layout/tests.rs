//! What a figure draws, and where: everything within the frame, titles, error bars.

use super::title::{TITLE_FURTHER_ROW, TITLE_MARGIN, TITLE_ROW, TITLE_TEXT};
use super::{HEIGHT, SMALL_TEXT, WIDTH};
use crate::report::figure::shape::{PALETTE, Shape};
use crate::report::figure::typeface::Typeface;
use crate::report::figure::{Axis, Figure, Line, Mark, Series};

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
            .with_line(Line::Dashed)
            .with_mark(Mark::None),
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
        .with_line(Line::None)
        .with_mark(Mark::None)
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
