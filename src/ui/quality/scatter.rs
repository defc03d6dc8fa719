//! A scatter plot of the offsets between two clicks on the same point of the picture. A dot can be
//! pointed at and clicked.

use crate::ui::controls::theme::{self, Themed as _};
use egui::{Align2, FontId, Role, Sense, Stroke, Ui, WidgetInfo, vec2};
use touchline_core::geometry::{Vec2, quantile};

/// Side of the plot, points.
const SIDE: f32 = 190.0;
/// Distance within which the pointer picks a dot, points.
const REACH: f32 = 10.0;

/// A scatter plot of offsets in px at 1920 px width, x to the right, y down.
pub struct Scatter<'a> {
    /// Its accessible name.
    pub name: &'a str,
    /// The offsets, one dot each.
    pub offsets: &'a [Vec2],
    /// 1-σ of an offset in each direction, px, if known. Rings are drawn at one and two σ.
    pub sigma_px: Option<f64>,
}

impl Scatter<'_> {
    /// Shows the plot. Returns the index of the dot under the pointer and whether it was clicked.
    pub fn show(&self, ui: &mut Ui) -> Option<(usize, bool)> {
        let (rect, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, self.name));
        let reach_px = self.reach_px();
        let points_per_px = f64::from(SIDE / 2.0 - 6.0) / reach_px;
        let centre = rect.center();
        // Axes, and rings at one and two σ.
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 4.0, ui.palette().panel);
        painter.hline(
            rect.x_range(),
            centre.y,
            Stroke::new(1.0, ui.palette().line),
        );
        painter.vline(
            centre.x,
            rect.y_range(),
            Stroke::new(1.0, ui.palette().line),
        );
        for times in [1.0, 2.0] {
            if let Some(sigma_px) = self.sigma_px {
                let radius = (times * sigma_px * points_per_px) as f32;
                painter.circle_stroke(centre, radius, Stroke::new(1.0, ui.palette().weak));
            }
        }
        // The nearest dot within reach of the pointer.
        let dots: Vec<_> = self
            .offsets
            .iter()
            .map(|offset| {
                // Offsets beyond the range are moved to its border, in their direction.
                let shown_px = shorten(offset, reach_px);
                centre
                    + vec2(
                        (shown_px.x * points_per_px) as f32,
                        (shown_px.y * points_per_px) as f32,
                    )
            })
            .collect();
        let under = response.hover_pos().and_then(|at| {
            let near = dots
                .iter()
                .map(|dot| dot.distance(at))
                .enumerate()
                .filter(|(_, apart)| *apart <= REACH);
            near.min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(index, _)| index)
        });
        // The dots; those beyond the range have another colour.
        for (index, dot) in dots.iter().enumerate() {
            let pointed = under == Some(index);
            let (radius, colour) = if pointed {
                (4.0, ui.palette().strong)
            } else {
                (2.4, ui.palette().accent)
            };
            let beyond = self.offsets[index].norm() > reach_px;
            painter.circle_filled(
                *dot,
                radius,
                if beyond && !pointed {
                    ui.palette().caution
                } else {
                    colour
                },
            );
        }
        // The range of the plot as a number in the corner.
        let corner = rect.right_bottom() - vec2(4.0, 2.0);
        let text = format!("±{reach_px:.1} px");
        painter.text(
            corner,
            Align2::RIGHT_BOTTOM,
            text,
            FontId::proportional(theme::SMALL),
            ui.palette().weak,
        );
        if under.is_some() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
        under.map(|index| (index, response.clicked()))
    }

    /// The plot's range, px: 1.4 times the 90 % quantile of the offsets and at least 2.4 σ, so that
    /// the rings fit. Offsets beyond it are drawn at the border, in another colour.
    fn reach_px(&self) -> f64 {
        let mut sizes: Vec<f64> = self.offsets.iter().map(Vec2::norm).collect();
        sizes.sort_by(f64::total_cmp);
        let most = if sizes.is_empty() {
            1.0
        } else {
            quantile(&sizes, 0.9)
        };
        (1.4 * most)
            .max(2.4 * self.sigma_px.unwrap_or(0.0))
            .max(0.5)
    }
}

/// An offset, shortened to `longest_px` if it is longer.
fn shorten(offset: &Vec2, longest_px: f64) -> Vec2 {
    if offset.norm() > longest_px {
        offset * (longest_px / offset.norm())
    } else {
        *offset
    }
}
