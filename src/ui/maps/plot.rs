//! A small plot: a rectangle with two scales, lines and numbers at its sides.

use crate::ui::controls::theme::{self, Themed as _};
use egui::{Align2, FontId, Painter, Pos2, Rect, Stroke, pos2};
use touchline_documents::report::figure::Ruler;

/// A rectangle with two linear scales. Values outside a scale are drawn at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plot {
    /// The rectangle on the screen.
    pub area: Rect,
    /// The values at its left and its right border.
    pub x: [f64; 2],
    /// The values at its lower and its upper border.
    pub y: [f64; 2],
}

impl Plot {
    /// The x on the screen of a horizontal value.
    pub fn x_of(&self, x: f64) -> f32 {
        self.area.left() + self.area.width() * share(self.x, x)
    }

    /// The y on the screen of a vertical value.
    pub fn y_of(&self, y: f64) -> f32 {
        self.area.bottom() - self.area.height() * share(self.y, y)
    }

    /// The place on the screen of a pair of values.
    pub fn at(&self, x: f64, y: f64) -> Pos2 {
        pos2(self.x_of(x), self.y_of(y))
    }

    /// The horizontal value at an x on the screen; not limited to the scale.
    pub fn x_at(&self, at: f32) -> f64 {
        let along = f64::from((at - self.area.left()) / self.area.width().max(1.0));
        self.x[0] + along * (self.x[1] - self.x[0])
    }

    /// Draws a horizontal line at each tick of a ruler, with its number to the left.
    pub fn levels(&self, painter: &Painter, ruler: &Ruler) {
        for (value, words) in &ruler.ticks {
            let y = self.y_of(*value);
            painter.hline(
                self.area.x_range(),
                y,
                Stroke::new(1.0, painter.palette().line),
            );
            let place = pos2(self.area.left() - 4.0, y);
            painter.text(
                place,
                Align2::RIGHT_CENTER,
                words,
                small(),
                painter.palette().weak,
            );
        }
    }

    /// Writes numbers below the rectangle, with a short stroke at each.
    pub fn steps<'a>(&self, painter: &Painter, ticks: impl IntoIterator<Item = (f64, &'a str)>) {
        for (value, words) in ticks {
            let at = pos2(self.x_of(value), self.area.bottom());
            painter.vline(
                at.x,
                at.y..=at.y + 3.0,
                Stroke::new(1.0, painter.palette().weak),
            );
            painter.text(
                at + egui::vec2(0.0, 4.0),
                Align2::CENTER_TOP,
                words,
                small(),
                painter.palette().weak,
            );
        }
    }

    /// Writes in the upper left corner what the plot shows.
    pub fn caption(&self, painter: &Painter, words: &str) {
        let place = self.area.left_top() + egui::vec2(4.0, 1.0);
        painter.text(
            place,
            Align2::LEFT_TOP,
            words,
            small(),
            painter.palette().text,
        );
    }
}

/// The font of a plot's numbers.
pub fn small() -> FontId {
    FontId::proportional(theme::SMALL)
}

/// Where a value is between two borders, 0 to 1; the middle if the scale is empty.
fn share([from, upto]: [f64; 2], value: f64) -> f32 {
    let share = (value - from) / (upto - from);
    if share.is_finite() {
        share.clamp(0.0, 1.0) as f32
    } else {
        0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_between_the_borders_and_come_back() {
        let plot = Plot {
            area: Rect::from_min_max(pos2(10.0, 20.0), pos2(110.0, 70.0)),
            x: [0.0, 50.0],
            y: [-1.0, 1.0],
        };
        assert_eq!(plot.at(25.0, 0.0), pos2(60.0, 45.0));
        assert_eq!(
            plot.at(-5.0, 7.0),
            pos2(10.0, 20.0),
            "at the end of the scale"
        );
        assert!((plot.x_at(60.0) - 25.0).abs() < 1e-6);
        assert_eq!(
            Plot {
                y: [3.0, 3.0],
                ..plot
            }
            .y_of(3.0),
            45.0
        );
    }
}
