//! The warning before unsaved edits are lost by closing or opening.

use super::{cancel, closing_button, sheet};
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Align, Button, Context, Label, Layout, RichText, vec2};
use touchline_application::app::session::{Leaving, Saving};
use touchline_application::app::{Action, Command};

/// Shows the dialog. `leaving` is what the user was about to do.
pub fn show(panel: &mut Panel<'_>, ctx: &Context, leaving: &Leaving) {
    let (title, does, does_only) = match leaving {
        Leaving::Close => ("Quit without saving?", "Quit and lose edits", "Quit"),
        Leaving::Open(_) | Leaving::OpenDemo => {
            ("Open without saving?", "Open and lose edits", "Open")
        }
    };
    sheet(panel, ctx, title, vec2(520.0, 220.0), |panel, ui| {
        // Why edits may be lost. After a change by another program nothing is lost, but the version
        // is set aside.
        let (what, does) = match &panel.app.session.disk.saving {
            Saving::Failed { message, since } => {
                let edits = since.as_ref().map_or_else(
                    || "Your edits are only in memory.".to_owned(),
                    |at| format!("Your edits since {at} are only in memory."),
                );
                (format!("{edits} {message}."), does)
            }
            Saving::Pending => ("Your last edits are still being written to disk.".to_owned(), does),
            Saving::Untouched | Saving::Saved { .. } => (
                "Another program changed the document. Your version is kept beside it and is offered for merging when you open \
                 it again."
                    .to_owned(),
                does_only,
            ),
        };
        ui.add(Label::new(RichText::new(what).color(ui.palette().strong)).wrap());
        ui.add_space(2.0 * theme::SPACE);
        let row = vec2(ui.available_width(), 28.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            let elsewhere = Button::new("Save elsewhere…").fill(ui.palette().accent_ground);
            closing_button(panel, ui, elsewhere, Command::SaveAs);
            cancel(panel, ui, "Continue working; saving is tried again. (Esc)");
            if ui
                .button(RichText::new(does).color(ui.palette().bad))
                .on_hover_text("This cannot be undone.")
                .clicked()
            {
                panel.actions.push(Action::LeaveUnsaved);
            }
        });
    });
}
