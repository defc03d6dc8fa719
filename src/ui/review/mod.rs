//! The review panel: the list of suggestions or of shots, accepting many of them together, and
//! where a label would help most.

mod facts;
mod list;
mod shots;

pub use facts::RowFacts;
pub use list::{paint_ground, text_within};

use super::{Panel, inspector};
use crate::ui::controls::show_button;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{Heading, symbol, theme};
use egui::{Button, DragValue, Frame, Margin, RichText, Role, Sense, Ui, WidgetInfo, vec2};
use strum::IntoEnumIterator as _;
use touchline_application::app::review::{ReviewOrder, percent};
use touchline_application::app::{Command, ViewAction};
use touchline_core::geometry::pluralise;

pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    heading(panel, ui);
    // The footer is laid out first; the list takes the rest.
    egui::Panel::bottom("review footer")
        .resizable(false)
        .frame(Frame::new().inner_margin(Margin::same(8)))
        .show(ui, |ui| footer(panel, ui));
    choose_list(panel, ui);
    if panel.app.session.review.shots.is_shown {
        return shots::show(panel, ui);
    }
    if panel.app.review().rows.is_empty() {
        Frame::new().inner_margin(Margin::symmetric(8, 4)).show(ui, |ui| {
            let none = if panel.app.session.trainer.status.forest.is_some() {
                "There are no suggestions to review."
            } else {
                "There are no proposals yet. The forest proposes cameras once it has been trained on a few references."
            };
            theme::weak_text(ui, none);
        });
        return;
    }
    orders(panel, ui);
    list::show(panel, ui);
}

/// Shows the choice between suggestions and shots, where the document has shots.
fn choose_list(panel: &mut Panel<'_>, ui: &mut Ui) {
    let has_shots = panel
        .app
        .open()
        .is_some_and(|open| !open.document.shots.is_empty());
    let shown = panel.app.session.review.shots.is_shown;
    if !has_shots && !shown {
        return;
    }
    Frame::new()
        .inner_margin(Margin::symmetric(8, 2))
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                for (shots, name) in [(false, "Suggestions"), (true, "Shots")] {
                    if ui.add(Button::selectable(shots == shown, name)).clicked() {
                        panel.view(ViewAction::ListShots(shots));
                    }
                }
            });
        });
}

/// Shows the title, the number of suggestions, and the close button.
fn heading(panel: &mut Panel<'_>, ui: &mut Ui) {
    let heading = Heading {
        title: "Review",
        command: Command::ReviewPanel,
        closes: "review panel",
        behind: "frame",
    };
    heading.show(panel, ui, count, |_, _| {});
}

/// Shows the number of suggestions.
fn count(panel: &mut Panel<'_>, ui: &mut Ui) {
    let said = pluralise(panel.app.review().count(), "suggestion");
    theme::weak(ui, said);
}

/// Shows the choice of the order, and whether only one suggestion of each shot is listed.
pub fn orders(panel: &mut Panel<'_>, ui: &mut Ui) {
    Frame::new()
        .inner_margin(Margin::symmetric(8, 0))
        .show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = theme::SPACE;
                let chosen = panel.app.session.review.order;
                for order in ReviewOrder::iter() {
                    let says = Button::selectable(order == chosen, order.label());
                    if show_button(ui, says, order.about()) {
                        panel.view(ViewAction::SetReviewOrder(order));
                    }
                }
            });
        });
    if panel.app.review().several_shots {
        Frame::new()
            .inner_margin(Margin::symmetric(8, 0))
            .show(ui, |ui| {
                let mut one = panel.app.session.review.one_per_shot;
                let before = one;
                ui.checkbox(&mut one, "One per shot")
                    .on_hover_text("List only the first of each shot in this order.");
                if one != before {
                    panel.view(ViewAction::SetOnePerShot(one));
                }
            });
    }
    ui.add_space(theme::SPACE);
}

/// Shows below the list where to label next, accepting together, and the main button of the shown
/// frame.
fn footer(panel: &mut Panel<'_>, ui: &mut Ui) {
    label_next(panel, ui);
    if !panel.app.review().rows.is_empty() {
        together(panel, ui);
        ui.add_space(theme::SPACE);
    }
    inspector::accept(panel, ui);
}

/// Shows where a label would help most; a click shows the next frame without an answer.
fn label_next(panel: &mut Panel<'_>, ui: &mut Ui) {
    let advice = panel.app.review().advice;
    let Some(text) = panel.app.where_to_label() else {
        return;
    };
    // The text wraps, so it is laid out first to know the height of the row.
    let galley = egui::WidgetText::from(RichText::new(&text)).into_galley(
        ui,
        Some(egui::TextWrapMode::Wrap),
        ui.available_width() - 22.0,
        egui::TextStyle::Body,
    );
    let size = vec2(ui.available_width(), galley.size().y.max(theme::LIST_ROW));
    let leads = advice.next.is_some();
    let (row, response) = ui.allocate_exact_size(
        size,
        if leads {
            Sense::click()
        } else {
            Sense::hover()
        },
    );
    response.widget_info(|| {
        WidgetInfo::labeled(if leads { Role::Button } else { Role::Label }, true, &text)
    });
    // Drawn like a link: brighter under the pointer, but only if it leads somewhere.
    let lit = leads && (response.hovered() || response.has_focus());
    let sign = egui::Rect::from_min_size(row.min, vec2(16.0, row.height()));
    symbol::paint(ui.painter(), Symbol::Info, sign, ui.palette().accent);
    let left = row.left_center() + vec2(22.0, -galley.size().y / 2.0);
    ui.painter().galley(
        left,
        galley,
        if lit {
            ui.palette().strong
        } else {
            ui.palette().text
        },
    );
    if leads {
        panel.run_on_click(response, Command::NextUnanswered);
    }
}

/// Shows the button that accepts all suggestions above a threshold, the threshold, and how many are
/// left out because they disagree with their neighbours.
fn together(panel: &mut Panel<'_>, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let (taken, left_out, lowest) = panel.app.review().bulk_size(&panel.app.session.review);
        let command = Command::AcceptAllAbove;
        let says = ui.add(Button::new(format!("Accept {taken} above…")));
        let lowest = lowest.map_or_else(String::new, |lowest| {
            format!(" The lowest confidence is {}.", percent(lowest))
        });
        if says
            .on_hover_text(format!(
                "{}{lowest}",
                panel.app.settings.keys.tooltip(command)
            ))
            .clicked()
        {
            panel.run(command);
        }
        threshold(panel, ui);
        if left_out > 0 {
            ui.label(
                RichText::new(format!("{left_out} disagree"))
                    .small()
                    .color(ui.palette().caution),
            )
            .on_hover_text(
                "Confident, but out of line with the frames before and after. Check each one.",
            );
        }
    });
}

/// The number field of the threshold.
pub fn threshold(panel: &mut Panel<'_>, ui: &mut Ui) {
    // At most 99.9 %, the highest confidence that is ever shown (`percent`): a threshold of 100 %
    // would pass nothing.
    let before = 100.0 * panel.app.session.review.threshold;
    let mut percent = before;
    let field = DragValue::new(&mut percent)
        .range(0.0..=99.9)
        .speed(0.2)
        .max_decimals(1)
        .suffix(" %");
    let tip = "Suggestions with at least this confidence are accepted together.";
    ui.add(field)
        .accessible_name("Accept above, per cent")
        .on_hover_text(tip);
    if percent != before {
        panel.view(ViewAction::SetReviewThreshold(percent / 100.0));
    }
}
