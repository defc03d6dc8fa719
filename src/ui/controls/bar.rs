//! A row of a list with a name, a bar of proportional length, and a number.

use super::theme::{self, Themed as _};
use crate::ui::drawing::labels::lay_out_within;
use egui::{
    Align2, Color32, CornerRadius, FontId, Rect, Response, Role, Sense, Stroke, Ui, WidgetInfo,
    pos2, vec2,
};

/// Height of a row, points.
const ROW: f32 = 20.0;
/// Width of the column of numbers, points.
const NUMBER: f32 = 48.0;

/// A row with name, bar and number. It can be clicked.
pub struct Bar<'a> {
    pub name: &'a str,
    /// The number as text.
    pub value: &'a str,
    /// Length of the bar, 0 to 1; larger values are drawn as 1.
    pub share: f64,
    /// Where a mark across the bar shows the expected value, 0 to 1.
    pub expected: Option<f64>,
    /// Colour of the bar; the accent colour if `None`.
    pub colour: Option<Color32>,
    /// Whether the row is about the shown frame.
    pub selected: bool,
    /// Width of the column of bars, points.
    pub width: f32,
    /// Room for a button at the right end, points.
    pub tail: f32,
}

impl Default for Bar<'_> {
    fn default() -> Self {
        Self {
            name: "",
            value: "",
            share: 0.0,
            expected: None,
            colour: None,
            selected: false,
            width: 56.0,
            tail: 0.0,
        }
    }
}

impl Bar<'_> {
    /// Shows the row. Returns its rectangle, in which the caller may put a button, and the
    /// response.
    pub fn show(&self, ui: &mut Ui) -> (Rect, Response) {
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
        response.widget_info(|| {
            WidgetInfo::selected(
                Role::Button,
                true,
                self.selected,
                format!("{}: {}", self.name, self.value),
            )
        });
        // Rows out of view only take their place.
        if !ui.is_rect_visible(rect) {
            return (rect, response);
        }
        let painter = ui.painter();
        if self.selected || response.hovered() || response.has_focus() {
            let ground = if self.selected {
                ui.palette().accent_ground
            } else {
                ui.visuals().widgets.hovered.weak_bg_fill
            };
            painter.rect_filled(rect, CornerRadius::same(4), ground);
        }
        // From right to left: the number, the bar, and the name in the rest. Number and bar have
        // fixed widths, so that the bars of all rows of a list begin at one place and can be
        // compared; a long name ends in an ellipsis.
        let right = rect.right() - self.tail - 2.0;
        let number = pos2(right, rect.center().y);
        painter.text(
            number,
            Align2::RIGHT_CENTER,
            self.value,
            FontId::proportional(theme::SMALL),
            ui.palette().text,
        );
        let bar_left = right - NUMBER - self.width;
        let name = Rect::from_min_max(rect.min, pos2(bar_left - 6.0, rect.bottom()));
        let galley = lay_out_within(
            painter,
            self.name.to_owned(),
            FontId::proportional(theme::SMALL),
            ui.palette().text,
            name.width() - 4.0,
        );
        painter.galley(
            pos2(name.left() + 4.0, name.center().y - galley.size().y / 2.0),
            galley,
            ui.palette().text,
        );
        // The bar on its track, with the mark of the expected value.
        let track =
            Rect::from_min_size(pos2(bar_left, rect.center().y - 3.0), vec2(self.width, 6.0));
        painter.rect_filled(track, CornerRadius::same(2), ui.palette().line);
        let along = |share: f64| self.width * share.clamp(0.0, 1.0) as f32;
        let filled = Rect::from_min_size(track.min, vec2(along(self.share), track.height()));
        painter.rect_filled(
            filled,
            CornerRadius::same(2),
            self.colour.unwrap_or(ui.palette().accent),
        );
        if let Some(expected) = self.expected {
            let stroke = Stroke::new(1.5, ui.palette().strong);
            painter.vline(
                track.left() + along(expected),
                track.top() - 3.0..=track.bottom() + 3.0,
                stroke,
            );
        }
        (rect, response)
    }
}
