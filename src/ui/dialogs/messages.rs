//! All messages since the program was started, the latest first.

use super::sheet;
use crate::ui::Panel;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{symbol, theme};
use crate::ui::rows::notices;
use egui::{Button, Context, Label, RichText, ScrollArea, vec2};
use touchline_application::app::Command;

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(panel, ctx, "Messages", vec2(640.0, 460.0), |panel, ui| {
        let dismiss = Command::DismissNotices;
        panel.command_button(ui, Button::new(dismiss.name()), dismiss);
        ui.add_space(theme::SPACE);
        ScrollArea::vertical()
            .auto_shrink([false, true])
            .show(ui, |ui| {
                for (level, text) in panel.app.session.messages.log.iter().rev() {
                    ui.horizontal_top(|ui| {
                        let (sign, colour) = notices::look(ui.palette(), *level);
                        symbol::show(ui, sign, colour);
                        ui.add(
                            Label::new(RichText::new(text).color(ui.palette().text))
                                .wrap()
                                .selectable(true),
                        );
                    });
                }
            });
    });
}
