//! Editing the comment on the shown frame.

use super::{cancel, has_just_opened, sheet};
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use crate::ui::rows::menu::file_name;
use egui::{Align, Button, Context, Id, Key, Layout, Modifiers, RichText, TextEdit, vec2};
use touchline_application::app::{Action, EditAction};
use touchline_documents::document::Frame;

/// Shows the dialog. `before` is the comment when it opened.
pub fn show(panel: &mut Panel<'_>, ctx: &Context, before: &str) {
    let memory = Id::unique("comment");
    let opened = has_just_opened(ctx, "comment");
    let known = ctx.data_mut(|data| data.get_temp::<String>(memory));
    let mut typed = known
        .filter(|_| !opened)
        .unwrap_or_else(|| before.to_owned());
    sheet(panel, ctx, "Comment", vec2(440.0, 220.0), |panel, ui| {
        // Read before the text field sees it, where Enter begins a new line.
        let save = ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Enter));
        let name = panel.app.frame().map(Frame::name).unwrap_or_default();
        ui.label(RichText::new(file_name(&name)).color(ui.palette().weak));
        let field = TextEdit::multiline(&mut typed)
            .desired_rows(4)
            .desired_width(f32::INFINITY);
        let response = ui.add(field).accessible_name("Comment on this frame");
        let response = response.on_hover_text("A note for anybody who opens this frame.");
        if opened {
            response.request_focus();
        }
        ui.add_space(theme::SPACE);
        let row = vec2(ui.available_width(), 24.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            let keep = ui.add(Button::new("Save comment").fill(ui.palette().accent_ground));
            if keep
                .on_hover_text("Save the comment; an empty one is removed. (Ctrl+Enter)")
                .clicked()
                || save
            {
                panel
                    .actions
                    .push(Action::Edit(EditAction::SetComment(typed.clone())));
            }
            cancel(panel, ui, "Leave the comment as it was. (Esc)");
        });
    });
    ctx.data_mut(|data| data.insert_temp(memory, typed));
}
