//! The row of messages, between filmstrip and status row. Messages inform and may name remedies.
//! They never cover the picture and never take the focus. Messages that have left the row stay in
//! the list of messages.

use crate::ui::Panel;
use crate::ui::controls::symbol::{self, Symbol};
use crate::ui::controls::theme::{Palette, Themed as _};
use egui::{Align, Button, Color32, Id, Label, Layout, RichText, Role, Ui, WidgetInfo};
use std::time::Duration;
use touchline_application::app::session::{Level, Notice, in_row};
use touchline_application::app::{Action, Command, ViewAction};

/// Time after which information without a button leaves the row, s, unless the pointer is on it.
const INFO_SECONDS: f64 = 8.0;
/// Last part of that time, in which it fades, s.
const FADE_SECONDS: f64 = 0.6;
/// Minimum time that a message stays after the pointer has left it, s.
const HOVERED_SECONDS: f64 = 2.0;

/// A message and the time at which it appeared in the row. A message is identified by number and
/// text, because numbers begin anew with every document.
type NoticeArrival = ((u64, String), f64);

/// Shows one message with its remedies, the number of the others, and the button that lists all.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let app = panel.app;
    let shown = in_row(&app.session.messages.notices);
    // The opacity applies to the whole row, and whoever points at the row can read it in full.
    let opacity = shown.map_or(1.0, |notice| opacity(panel.actions, ui, notice));
    ui.multiply_opacity(opacity);
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if let Some(notice) = shown {
            let tip = format!("Dismiss: {}", notice.text);
            let palette = ui.palette();
            if symbol::button(ui, Symbol::Cross, &tip, palette.weak)
                .on_hover_text("Dismiss this message.")
                .clicked()
            {
                panel.view(ViewAction::DismissNotice(notice.id));
            }
        }
        others(panel, ui);
        let Some(notice) = shown else { return };
        // The layout runs from right to left, so the last remedy comes first. Choosing a remedy
        // answers the message, which goes.
        for &(says, command) in notice.offers.iter().rev() {
            if panel.run_on_click(ui.add(Button::new(says).small()), command) {
                panel.view(ViewAction::DismissNotice(notice.id));
            }
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let (sign, colour) = look(ui.palette(), notice.level);
            symbol::show(ui, sign, colour);
            let said = ui
                .add(Label::new(RichText::new(&notice.text).color(ui.palette().strong)).truncate());
            said.widget_info(|| WidgetInfo::labeled(Role::Label, true, &notice.text));
            said.on_hover_text(&notice.text);
        });
    });
}

/// Shows how many more messages wait; a click lists all of them.
fn others(panel: &mut Panel<'_>, ui: &mut Ui) {
    let messages = &panel.app.session.messages;
    if messages.log.is_empty() {
        return;
    }
    let more = messages.notices.len().saturating_sub(1);
    let says = if more > 0 {
        format!("{more} more")
    } else {
        "Messages".to_owned()
    };
    let button = Button::new(RichText::new(says).small().color(ui.palette().weak)).frame(false);
    panel.run_on_click(ui.add(button), Command::Messages);
}

/// Symbol and colour of a level.
pub const fn look(palette: &Palette, level: Level) -> (Symbol, Color32) {
    match level {
        Level::Info | Level::Question => (Symbol::Info, palette.accent),
        Level::Warning => (Symbol::Warning, palette.caution),
        Level::Error => (Symbol::Warning, palette.bad),
    }
}

/// The opacity of a message, 0 to 1. Information without a button fades and leaves the row;
/// everything else stays until the user answers or dismisses it.
fn opacity(actions: &mut Vec<Action>, ui: &Ui, notice: &Notice) -> f32 {
    if notice.level != Level::Info || !notice.offers.is_empty() {
        return 1.0;
    }
    let (key, now) = (
        (notice.id, notice.text.clone()),
        ui.input(|input| input.time),
    );
    let hovered = ui.rect_contains_pointer(ui.max_rect());
    let left = ui.data_mut(|data| {
        let seen = data
            .get_temp_mut_or_insert_with::<NoticeArrival>(Id::unique("message in the row"), || {
                (key.clone(), now)
            });
        if seen.0 != key {
            *seen = (key, now);
        }
        let left = INFO_SECONDS - (now - seen.1);
        // The pointer on the message stops the time shortly before its end.
        if hovered {
            seen.1 = now - INFO_SECONDS + left.max(HOVERED_SECONDS);
        }
        left
    });
    if left <= 0.0 && !hovered {
        actions.push(Action::View(ViewAction::DismissNotice(notice.id)));
    }
    // Repaints when the fading begins, and often during it.
    let wait = if left > FADE_SECONDS {
        left - FADE_SECONDS
    } else {
        0.03
    };
    ui.ctx()
        .request_repaint_after(Duration::from_secs_f64(wait.max(0.03)));
    if hovered {
        1.0
    } else {
        (left / FADE_SECONDS).clamp(0.0, 1.0) as f32
    }
}
