//! The quality page: how good labels and proposals are. It takes the place of the picture.
//!
//! Each section is a card in a file of its own. It shows what
//! [`touchline_application::app::quality`] has computed and computes nothing itself.
//!
//! | card | file |
//! |---|---|
//! | pan, tilt and focal length over time | `course.rs`, `course_plots.rs`, `course_drag.rs` |
//! | errors of clicks; by landmark and line | `errors.rs`, `targets.rs` |
//! | where frames look | `coverage.rs` |
//! | the annotator's own click noise | `gold.rs`, `scatter.rs` |
//! | two annotators compared | `agreement.rs`, `scatter.rs` |
//!
//! A click on a mark shows its frame in the picture and closes the page.

mod agreement;
mod course;
mod course_drag;
mod course_plots;
mod coverage;
mod errors;
mod gold;
mod legend;
mod scatter;
mod targets;

use super::Panel;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{Heading, theme};
use egui::layers::ShapeIdx;
use egui::{Align, CornerRadius, Frame, Layout, Margin, RichText, ScrollArea, Shape, Ui, vec2};
use touchline_application::app::{Command, ViewAction};

/// Gap between two cards, points.
const GAP: f32 = 8.0;
/// Rounding of a card's corners.
const CORNER: CornerRadius = CornerRadius::same(6);

/// Height of the curves below the picture, points.
pub const CURVES: f32 = course::STRIP;

/// Shows pan, tilt and focal length over time below the picture.
pub fn curves(panel: &mut Panel<'_>, ui: &mut Ui) {
    course::strip(panel, ui);
}

/// Shows the page.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let area = ui.available_rect_before_wrap();
    ui.painter().rect_filled(area, 0.0, ui.palette().panel);
    heading(panel, ui);
    let inside = Frame::new().inner_margin(Margin {
        left: 8,
        right: 12,
        top: 0,
        bottom: 8,
    });
    ScrollArea::vertical()
        .id_salt("quality page")
        .auto_shrink(false)
        .show(ui, |ui| {
            inside.show(ui, |ui| {
                ui.spacing_mut().item_spacing = vec2(GAP, GAP);
                course::show(panel, ui);
                row(panel, ui, [errors::show, targets::show, coverage::show]);
                gold::show(panel, ui);
                agreement::show(panel, ui);
            });
        });
}

/// Shows the title, the camera that the page is about, frames that their paint contradicts, and the
/// close button.
fn heading(panel: &mut Panel<'_>, ui: &mut Ui) {
    let heading = Heading {
        title: "Quality",
        command: Command::QualityPage,
        closes: "quality page",
        behind: "picture",
    };
    heading.show(
        panel,
        ui,
        |panel, ui| {
            cameras(panel, ui);
            off_paint(panel, ui);
        },
        |_, _| {},
    );
}

/// Shows how many accepted frames their paint contradicts; a click shows the first of them.
fn off_paint(panel: &mut Panel<'_>, ui: &mut Ui) {
    let off = &panel.app.quality().off_paint;
    let Some(first) = off.first().copied() else {
        return;
    };
    let says = match off.len() {
        1 => "1 accepted frame is off its painted lines".to_owned(),
        count => format!("{count} accepted frames are off their painted lines"),
    };
    let says = RichText::new(says).color(ui.palette().caution);
    let button = ui
        .button(says)
        .on_hover_text("The paint contradicts the camera. Click to look at the first.");
    if button.clicked() {
        panel.look_at(first, None);
    }
}

/// Shows which camera the page is about, and lets the user choose another, if there are several.
fn cameras(panel: &mut Panel<'_>, ui: &mut Ui) {
    let (Some(open), Some(chosen)) = (panel.app.open(), &panel.app.quality().camera) else {
        return;
    };
    if open.document.cameras.len() < 2 {
        return;
    }
    let shown = egui::ComboBox::from_id_salt("quality camera")
        .selected_text(chosen.as_str())
        .show_ui(ui, |ui| {
            for camera in &open.document.cameras {
                if ui
                    .selectable_label(camera.id == *chosen, camera.id.as_str())
                    .clicked()
                {
                    panel.view(ViewAction::SetQualityCamera(camera.id.clone()));
                    ui.close();
                }
            }
        });
    shown
        .response
        .accessible_name("Camera")
        .on_hover_text("The camera that this page is about.");
}

/// Shows cards side by side, all as high as the highest.
fn row<const N: usize>(
    panel: &mut Panel<'_>,
    ui: &mut Ui,
    sections: [fn(&mut Panel<'_>, &mut Ui); N],
) {
    ui.columns(N, |columns| {
        // The background of a column comes before its contents but needs the final height. So a
        // placeholder reserves its place in the drawing order and is filled in below.
        let grounds: Vec<ShapeIdx> = columns
            .iter()
            .map(|column| column.painter().add(Shape::Noop))
            .collect();
        for (column, section) in columns.iter_mut().zip(sections) {
            section(panel, column);
        }
        let bottom = columns
            .iter()
            .map(|column| column.min_rect().bottom())
            .fold(0.0, f32::max);
        for (column, ground) in columns.iter().zip(grounds) {
            let mut rect = column.min_rect();
            rect.set_bottom(bottom);
            column.painter().set(
                ground,
                Shape::rect_filled(rect, CORNER, column.palette().raised),
            );
        }
    });
}

/// Shows a card: the title, the section's controls at the right (`beside`), the contents
/// (`inside`).
fn card(
    panel: &mut Panel<'_>,
    ui: &mut Ui,
    title: &str,
    beside: impl FnOnce(&mut Panel<'_>, &mut Ui),
    inside: impl FnOnce(&mut Panel<'_>, &mut Ui),
) {
    let ground = Frame::new()
        .fill(ui.palette().raised)
        .corner_radius(CORNER)
        .inner_margin(Margin::same(10));
    ground.show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(2.0 * theme::SPACE, theme::SPACE);
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            theme::title(ui, title);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| beside(panel, ui));
        });
        inside(panel, ui);
    });
}
