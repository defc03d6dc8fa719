//! A field for typing a path, for systems without file dialogs.

use super::{cancel, has_just_opened, sheet};
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Align, Button, Context, Id, Key, Layout, RichText, TextEdit, vec2};
use std::path::PathBuf;
use touchline_application::app::{Action, Question};

/// Title, text of the button, and an example, for a question.
fn describe(question: Question) -> (&'static str, &'static str, &'static str) {
    match question {
        Question::Project => (
            "Open a project or dataset",
            "Open",
            "/matches/final/project.json",
        ),
        Question::Folder => ("Open a folder of frames", "Open", "/matches/final/frames"),
        Question::Video => ("Open a video", "Open", "/matches/final.mp4"),
        Question::Queue => (
            "Open the queue of a season",
            "Open",
            "/seasons/2026/queue.json",
        ),
        Question::CopyTo => (
            "Save a copy into a new folder",
            "Save copy",
            "/matches/final-copy",
        ),
        Question::ExportAs(format) if format.is_folder() => (
            "Export into a new folder",
            "Export",
            "/matches/final-export",
        ),
        Question::ExportAs(_) => ("Export to a file", "Export", "/matches/final.json"),
        Question::DatasetTo => (
            "A new folder for the dataset",
            "Write",
            "/matches/final-dataset",
        ),
        Question::ImportFrom(_) => (
            "Import labels from a file or folder",
            "Import",
            "/matches/labels",
        ),
        Question::CompareWith => (
            "Compare with another annotator's document",
            "Compare",
            "/matches/other/project.json",
        ),
        Question::CameraFrom => (
            "Load a camera from a project or dataset",
            "Load",
            "/matches/other/project.json",
        ),
    }
}

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context, question: Question) {
    let memory = Id::unique("typed path");
    let opened = has_just_opened(ctx, "path");
    let known = ctx.data_mut(|data| data.get_temp::<String>(memory));
    let mut typed = known.filter(|_| !opened).unwrap_or_default();
    let (title, does, example) = describe(question);
    sheet(panel, ctx, title, vec2(520.0, 160.0), |panel, ui| {
        ui.label(
            RichText::new("No file dialog is available. Type or paste the path.")
                .color(ui.palette().weak),
        );
        let field = TextEdit::singleline(&mut typed)
            .hint_text(example)
            .desired_width(f32::INFINITY);
        let response = ui
            .add(field)
            .accessible_name("Path")
            .on_hover_text("A path on this computer. Enter confirms it.");
        if opened {
            response.request_focus();
        }
        // A text field loses the focus with Enter.
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        ui.add_space(theme::SPACE);
        let row = vec2(ui.available_width(), 24.0);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            let path = typed.trim();
            let take = ui.add_enabled(
                !path.is_empty(),
                Button::new(does).fill(ui.palette().accent_ground),
            );
            let take = take
                .on_hover_text("Use this path. (Enter)")
                .on_disabled_hover_text("Type a path first.");
            if (take.clicked() || entered) && !path.is_empty() {
                panel
                    .actions
                    .push(Action::Answer(question, PathBuf::from(path)));
            }
            cancel(panel, ui, "Close without a change. (Esc)");
        });
    });
    ctx.data_mut(|data| data.insert_temp(memory, typed));
}
