//! The start screen. It takes the place of the picture while nothing is open.

use super::{
    Panel,
    menu::document_name,
    theme::{self, Themed as _},
};
use egui::{Align, Button, Id, Key, Layout, Margin, RichText, TextEdit, Ui, vec2};
use std::path::PathBuf;
use touchline_application::app::{Action, Command};

/// Maximum number of recent documents in the list.
const RECENT: usize = 5;
/// Width of the column, points.
const WIDTH: f32 = 560.0;

/// What one can begin with.
const INVITATION: &str = "Drop a video, a folder of frames, a project, or cameras of another \
                          program with their video. Or try the demo match (2 minutes).";

/// Shows the start screen.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let area = ui.available_rect_before_wrap();
    ui.painter().rect_filled(area, 0.0, ui.palette().backdrop);
    let column = area.shrink2(vec2(
        (area.width() - WIDTH).max(0.0) / 2.0,
        (area.height() / 5.0).max(24.0),
    ));
    ui.scope_builder(
        egui::UiBuilder::new()
            .max_rect(column)
            .layout(Layout::top_down(Align::Center)),
        |ui| {
            ui.spacing_mut().item_spacing.y = 3.0 * theme::SPACE;
            ui.label(
                RichText::new("touchline")
                    .size(26.0)
                    .color(ui.palette().strong),
            );
            ui.label(RichText::new(INVITATION).color(ui.palette().text));
            waiting_labels(panel, ui);
            ui.add_space(theme::SPACE);
            // While something is being opened, it can only be cancelled.
            if let Some(opening) = &panel.app.session.disk.opening {
                ui.spinner();
                ui.label(RichText::new(opening).color(ui.palette().accent));
                if ui
                    .button("Cancel")
                    .on_hover_text("Stop opening. (Esc)")
                    .clicked()
                {
                    panel.actions.push(Action::Command(Command::Cancel));
                }
                return;
            }
            ui.allocate_ui_with_layout(
                vec2(WIDTH, 36.0),
                Layout::left_to_right(Align::Center),
                |ui| {
                    ui.spacing_mut().item_spacing.x = 2.0 * theme::SPACE;
                    let width = (WIDTH - 6.0 * theme::SPACE) / 4.0;
                    for (says, command) in [
                        ("Video…", Command::OpenVideo),
                        ("Folder…", Command::OpenFolder),
                        ("Project…", Command::OpenProject),
                        ("Demo match", Command::OpenDemo),
                    ] {
                        let mut button = Button::new(says).min_size(vec2(width, 36.0));
                        if command == Command::OpenDemo {
                            button = button.fill(ui.palette().accent_ground);
                        }
                        if ui
                            .add(button)
                            .on_hover_text(panel.app.settings.keys.tooltip(command))
                            .clicked()
                        {
                            panel.actions.push(Action::Command(command));
                        }
                    }
                },
            );
            let tour = Button::new(
                "New here? Take the tour: five steps on the demo match, three minutes.",
            )
            .frame(false);
            if ui
                .add(tour)
                .on_hover_text(Command::StartTour.about())
                .clicked()
            {
                panel.actions.push(Action::Command(Command::StartTour));
            }
            path_field(panel, ui);
            recent(panel, ui);
        },
    );
}

/// Says which labels wait for their pictures.
fn waiting_labels(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(labels) = panel.app.waiting_labels() else {
        return;
    };
    let name = document_name(&labels.path);
    let text = format!(
        "{name}: {}. Now drop or open the video or the frames that they belong to.",
        labels.format.title()
    );
    ui.label(RichText::new(text).color(ui.palette().accent));
    if ui
        .button("Leave them")
        .on_hover_text("Import nothing. (Esc)")
        .clicked()
    {
        panel.actions.push(Action::Command(Command::Cancel));
    }
}

/// A field for a typed or pasted path, for systems without file dialogs.
fn path_field(panel: &mut Panel<'_>, ui: &mut Ui) {
    let memory = Id::unique("typed path");
    let mut typed: String = ui.data_mut(|data| data.get_temp(memory).unwrap_or_default());
    ui.allocate_ui_with_layout(
        vec2(WIDTH, 28.0),
        Layout::left_to_right(Align::Center),
        |ui| {
            let field = TextEdit::singleline(&mut typed)
                .hint_text("or type a path: a project, a folder, a video, labels")
                .margin(Margin::symmetric(8, 6))
                .desired_width(WIDTH - 72.0 - 3.0 * theme::SPACE);
            let response = ui.add(field).accessible_name("Path to open").on_hover_text(
                "The path of a project, a folder of frames, a video, or labels of another \
                 program; Enter opens it.",
            );
            // A text field loses the focus with Enter.
            let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            let open = ui.add_enabled(
                !typed.trim().is_empty(),
                Button::new("Open").min_size(vec2(72.0, 28.0)),
            );
            let open = open
                .on_hover_text("Open this path. (Enter)")
                .on_disabled_hover_text("Type a path first.");
            if (entered || open.clicked()) && !typed.trim().is_empty() {
                panel
                    .actions
                    .push(Action::OpenAny(vec![PathBuf::from(typed.trim())]));
            }
        },
    );
    ui.data_mut(|data| data.insert_temp(memory, typed));
}

/// Lists the documents that were opened last.
fn recent(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.settings.recent.is_empty() {
        return;
    }
    ui.allocate_ui_with_layout(vec2(WIDTH, 0.0), Layout::top_down(Align::Min), |ui| {
        ui.spacing_mut().item_spacing.y = theme::SPACE;
        theme::title(ui, "RECENT");
        for path in panel.app.settings.recent.iter().take(RECENT) {
            let shown = path
                .parent()
                .map(|folder| folder.display().to_string())
                .unwrap_or_default();
            let row = Button::new(RichText::new(document_name(path)).color(ui.palette().strong))
                .right_text(RichText::new(shown).small().color(ui.palette().weak))
                .truncate()
                .min_size(vec2(WIDTH, 26.0));
            if ui
                .add(row)
                .on_hover_text(path.display().to_string())
                .clicked()
            {
                panel.actions.push(Action::Open(path.clone()));
            }
        }
    });
}
