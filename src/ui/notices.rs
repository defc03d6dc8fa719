//! Messages over the picture's lower left: they inform, may offer a remedy, and never take the focus.

use super::symbol::{self, Symbol};
use super::{Panel, theme};
use crate::app::Action;
use crate::app::session::{Level, Notice};
use egui::{Align2, Button, Color32, Frame, Id, Label, Margin, Order, Rect, Role, Stroke, Ui, vec2};
use std::time::Duration;

/// Informative messages disappear after this time, s; not while the pointer is on them.
const INFO_SECONDS: f64 = 5.0;
/// They fade during the last part of it, s.
const FADE_SECONDS: f64 = 0.6;
/// The least time that a message stays after the pointer has left it, s.
const HOVERED_SECONDS: f64 = 2.0;
/// The largest width of a message, points.
const WIDTH: f32 = 400.0;

/// A message by its number and text (numbers begin anew with every document), and when it was first seen.
#[derive(Clone, Default)]
struct Seen(Vec<((u64, String), f64)>);

fn key(notice: &Notice) -> (u64, String) {
    (notice.id, notice.text.clone())
}

/// Shows the messages over `canvas`.
pub fn show(panel: &mut Panel<'_>, ui: &Ui, canvas: Rect) {
    let notices = &panel.app.session.notices;
    if notices.is_empty() {
        return;
    }
    let ctx = ui.ctx();
    let memory = Id::unique("notices");
    let mut seen: Seen = ctx.data_mut(|data| data.get_temp(memory).unwrap_or_default());
    seen.0.retain(|(known, _)| notices.iter().any(|notice| key(notice) == *known));
    let now = ctx.input(|input| input.time);
    let width = WIDTH.min(canvas.width() - 6.0 * theme::SPACE).max(160.0);
    egui::Area::new(Id::unique("notices area"))
        .order(Order::Foreground)
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(canvas.left_bottom() + vec2(3.0, -3.0) * theme::SPACE)
        .role(egui::accesskit::Role::Log)
        .accessible_name("Messages")
        .show(ctx, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0 * theme::SPACE;
            for notice in notices {
                let known = seen.0.iter().position(|(known, _)| *known == key(notice));
                let place = known.unwrap_or_else(|| {
                    seen.0.push((key(notice), now));
                    seen.0.len() - 1
                });
                let since = &mut seen.0[place].1;
                let left = INFO_SECONDS - (now - *since);
                let fades = notice.level == Level::Info;
                let opacity = if fades { (left / FADE_SECONDS).clamp(0.0, 1.0) } else { 1.0 };
                let hovered = ui
                    .scope(|ui| {
                        ui.multiply_opacity(opacity as f32);
                        card(panel.app, &mut *panel.actions, ui, notice, width)
                    })
                    .inner;
                if !fades {
                    continue;
                }
                if hovered {
                    *since = now - INFO_SECONDS + left.max(HOVERED_SECONDS);
                } else if left <= 0.0 {
                    panel.actions.push(Action::DismissNotice(notice.id));
                }
                let wait = if left > FADE_SECONDS { left - FADE_SECONDS } else { 0.03 };
                ctx.request_repaint_after(Duration::from_secs_f64(wait.max(0.03)));
            }
        });
    ctx.data_mut(|data| data.insert_temp(memory, seen));
}

const fn look(level: Level) -> (Symbol, Color32) {
    match level {
        Level::Info | Level::Question => (Symbol::Info, theme::ACCENT),
        Level::Warning => (Symbol::Warning, theme::CAUTION),
        Level::Error => (Symbol::Warning, theme::BAD),
    }
}

/// One message; true while the pointer is on it.
fn card(app: &crate::app::App, actions: &mut Vec<Action>, ui: &mut Ui, notice: &Notice, width: f32) -> bool {
    let (sign, colour) = look(notice.level);
    let frame = Frame::new()
        .fill(Color32::from_rgba_unmultiplied(29, 32, 36, 244))
        .stroke(Stroke::new(1.0, theme::LINE))
        .corner_radius(6)
        .inner_margin(Margin::symmetric(10, 7));
    let shown = frame.show(ui, |ui| {
        ui.set_width(width);
        ui.horizontal_top(|ui| {
            symbol::show(ui, sign, colour);
            let offers: f32 = notice.offers.iter().map(|(says, _)| 8.0 * says.len() as f32 + 28.0).sum();
            ui.allocate_ui(vec2(width - 16.0 - 20.0 - offers - 24.0, 0.0), |ui| {
                let said = ui.add(Label::new(egui::RichText::new(&notice.text).color(theme::STRONG)).wrap());
                said.widget_info(|| egui::WidgetInfo::labeled(Role::Label, true, &notice.text));
            });
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
                let tip = format!("Dismiss: {}", notice.text);
                if symbol::button(ui, Symbol::Cross, &tip, theme::WEAK).on_hover_text("Dismiss this message.").clicked()
                {
                    actions.push(Action::DismissNotice(notice.id));
                }
                // They are laid out from the right.
                for &(says, command) in notice.offers.iter().rev() {
                    if ui.add(Button::new(says)).on_hover_text(app.settings.keys.tooltip(command)).clicked() {
                        actions.push(Action::Command(command));
                        actions.push(Action::DismissNotice(notice.id));
                    }
                }
            });
        });
    });
    shown.response.contains_pointer()
}
