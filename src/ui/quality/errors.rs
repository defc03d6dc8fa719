//! Histograms of the errors of clicks and of check points. A click on a bar shows its worst click.
//!
//! Errors are distances in px at 1920 px width between a click and where the frame's camera
//! projects its landmark or line.

use super::{card, legend};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::plot::Plot;
use egui::{
    CornerRadius, CursorIcon, Painter, Rect, Response, RichText, Role, Sense, Shape, Stroke, Ui,
    WidgetInfo, pos2, vec2,
};
use touchline_application::app::Command;
use touchline_application::app::quality::{ClickErrors, Histogram, Spread};
use touchline_core::geometry::pluralise;
use touchline_documents::report::figure::Ruler;

/// Height of a histogram, points.
const HEIGHT: f32 = 86.0;
/// Room for the numbers to the left and below, points.
const NUMBERS: f32 = 30.0;
const BELOW: f32 = 16.0;

/// The text while no frame has enough clicks for its errors to be evidence.
const NOTHING: &str = "The errors of clicks appear here. Two clicks alone can always be fitted: place a third one on some frames, \
                       or a check point.";

/// Shows the card: the histogram of the clicks that cameras were fitted to, and that of the check
/// points.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let errors = &panel.app.quality().errors;
    card(
        panel,
        ui,
        "ERRORS",
        |_, ui| {
            show_unit(ui);
            if !errors.clicks.is_empty() {
                show_key_of_correct_clicks(ui);
            }
        },
        |panel, ui| {
            if errors.clicks.is_empty() {
                theme::weak_text(ui, NOTHING);
            } else {
                one(panel, ui, errors.used.as_ref(), false);
                one(panel, ui, errors.held_out.as_ref(), true);
            }
            without_evidence(ui, errors);
        },
    );
}

fn show_unit(ui: &mut Ui) {
    let tip = "The distance between a click and where the frame's camera projects its landmark or line, scaled to 1920 px width.";
    theme::small_weak(ui, "px at 1920 px width").on_hover_text(tip);
}

/// Shows what the line over the bars means.
fn show_key_of_correct_clicks(ui: &mut Ui) {
    let tip = "The histogram expected of the same number of correct clicks, from the click noise of their landmarks and lines.";
    legend::entry(ui, "correct clicks", |painter, at| {
        painter.hline(
            at.x - 4.0..=at.x + 4.0,
            at.y,
            Stroke::new(1.5, painter.palette().good),
        );
    })
    .on_hover_text(tip);
}

/// Says how many frames are not counted.
fn without_evidence(ui: &mut Ui, errors: &ClickErrors) {
    let text = match errors.without_evidence {
        0 => return,
        1 => "1 frame is not counted: too few clicks for its errors to be evidence.".to_owned(),
        count => format!(
            "{count} frames are not counted: too few clicks for their errors to be evidence."
        ),
    };
    theme::weak_text(ui, text);
}

/// Shows one histogram: of the check points if `check`, else of the clicks that cameras were fitted
/// to.
fn one(panel: &mut Panel<'_>, ui: &mut Ui, spread: Option<&Spread>, check: bool) {
    let (what, about) = if check {
        ("Check points", "Points that were not used to fit a camera.")
    } else {
        (
            "Points",
            "Points that cameras were fitted to. Their errors are slightly smaller than those of other points.",
        )
    };
    // Without check points, how to make one.
    let Some(spread) = spread else {
        if check {
            let keys = &panel.app.settings.keys;
            let how = keys.with_key(Command::ToggleCheck, |key| {
                format!(" Press {key} to make a point a check point.")
            });
            theme::weak_text(ui, format!("No check points.{how}"));
        }
        return;
    };
    let (histogram, step_px) = (&spread.histogram, spread.histogram.step_px);
    let description = format!(
        "{what}: {}, median {}, {}",
        spread.count,
        px(spread.median_px),
        describe_most(spread.most_px)
    );
    ui.label(
        RichText::new(&description)
            .small()
            .color(ui.palette().strong),
    )
    .on_hover_text(about);
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT + BELOW), Sense::click());
    response.widget_info(|| {
        WidgetInfo::labeled(Role::Canvas, true, format!("Histogram. {description}"))
    });
    let area = Rect::from_min_max(rect.min + vec2(NUMBERS, 4.0), rect.max - vec2(4.0, BELOW));
    // The scale fits the expected histogram as well as the counted one.
    let highest = histogram
        .expected
        .iter()
        .copied()
        .fold(histogram.highest() as f64, f64::max);
    let ruler = Ruler::around([0.0, highest.max(1.0)], 2.0);
    let plot = Plot {
        area,
        x: [0.0, histogram.bins.len() as f64],
        y: ruler.range(),
    };
    if ui.is_rect_visible(rect) {
        let painter = ui.painter_at(rect);
        painter.rect_filled(area, CornerRadius::same(3), ui.palette().backdrop);
        plot.levels(&painter, &ruler);
        bars(&painter, &plot, histogram);
        // The median and the 90 % quantile as vertical lines.
        for (value, colour) in [
            (spread.median_px, ui.palette().strong),
            (spread.most_px, ui.palette().weak),
        ] {
            painter.vline(
                plot.x_of(value / step_px),
                area.y_range(),
                Stroke::new(1.0, colour),
            );
        }
        below(&painter, &plot, step_px);
    }
    read_pointer(panel, ui, &plot, histogram, response);
}

/// Draws the bars, and as a stepped line the histogram expected of correct clicks. The last bar
/// counts all larger errors; it has its own colour and no expectation.
fn bars(painter: &Painter, plot: &Plot, histogram: &Histogram) {
    // A histogram always has the bin of larger errors. Bars are half a point narrower at each side,
    // so that neighbours are distinguishable.
    let last = histogram.bins.len() - 1;
    for (place, bin) in histogram
        .bins
        .iter()
        .enumerate()
        .filter(|(_, bin)| bin.count > 0)
    {
        let (left, right) = (plot.x_of(place as f64), plot.x_of(place as f64 + 1.0));
        let bar = Rect::from_min_max(
            pos2(left + 0.5, plot.y_of(bin.count as f64)),
            pos2(right - 0.5, plot.area.bottom()),
        );
        painter.rect_filled(
            bar,
            0.0,
            if place == last {
                painter.palette().caution
            } else {
                painter.palette().accent
            },
        );
    }
    let steps = histogram
        .expected
        .iter()
        .take(last)
        .enumerate()
        .flat_map(|(place, count)| {
            let y = plot.y_of(*count);
            [
                pos2(plot.x_of(place as f64), y),
                pos2(plot.x_of(place as f64 + 1.0), y),
            ]
        })
        .collect();
    painter.add(Shape::line(steps, Stroke::new(1.0, painter.palette().good)));
}

/// Writes the numbers below the bars; the last bar is labelled "more".
fn below(painter: &Painter, plot: &Plot, step_px: f64) {
    // The axis of the plot counts bins. Numbers that would touch the word at the end are left out.
    let last = plot.x[1] - 1.0;
    let ruler = Ruler::within([0.0, last * step_px], f64::from(plot.area.width() / 50.0));
    let ticks = ruler
        .ticks
        .iter()
        .map(|(value, words)| (value / step_px, words.as_str()));
    plot.steps(
        painter,
        ticks
            .filter(|(at, _)| *at < last - 1.0)
            .chain([(last + 0.5, "more")]),
    );
}

/// Describes the bar under the pointer; a click shows its worst click.
fn read_pointer(
    panel: &mut Panel<'_>,
    ui: &Ui,
    plot: &Plot,
    histogram: &Histogram,
    response: Response,
) {
    let Some(pointer) = response.hover_pos() else {
        return;
    };
    let place = (plot.x_at(pointer.x).max(0.0) as usize).min(histogram.bins.len() - 1);
    let bin = histogram.bins[place];
    let from = place as f64 * histogram.step_px;
    // The tooltip: range, count, and the count expected of correct clicks.
    let range = if place + 1 == histogram.bins.len() {
        format!("{} and more", px(from))
    } else {
        format!("{} to {}", number(from), px(from + histogram.step_px))
    };
    let count = pluralise(bin.count, "click");
    let right = format!(
        "{:.0} expected if all names and cameras are correct (green)",
        histogram.expected[place]
    );
    let there = if bin.worst.is_some() {
        " Click to go to the worst one."
    } else {
        ""
    };
    if let Some((frame, click)) = bin.worst {
        ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
        if response.clicked() {
            panel.look_at(frame, Some(click));
        }
    }
    response.on_hover_text_at_pointer(format!("{range}: {count}; {right}.{there}"));
}

/// The 90 % quantile of errors, px, in words.
pub fn describe_most(most_px: f64) -> String {
    if most_px.is_finite() {
        format!("90 % below {}", px(most_px))
    } else {
        "10 % or more out of view".to_owned()
    }
}

/// An error in px. It is infinite where the camera does not see the landmark.
pub fn px(value: f64) -> String {
    if value.is_finite() {
        format!("{} px", number(value))
    } else {
        "out of view".to_owned()
    }
}

/// A number with one decimal below 10, without decimals above.
fn number(value: f64) -> String {
    if value < 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    }
}
