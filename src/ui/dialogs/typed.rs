//! Fields to type into: a path where there is no file dialog, a comment, a frame or time.

use super::{cancel, has_just_opened, recall, sheet};
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::rows::menu::file_name;
use egui::{Align, Button, Context, Id, Key, Layout, Modifiers, RichText, TextEdit, vec2};
use std::path::PathBuf;
use touchline_application::app::place::FrameOrTime;
use touchline_application::app::{Action, EditAction, Navigation, Question, sentence};
use touchline_documents::document::Frame;

/// Title, text of the button, and an example, for a question.
fn describe_question(question: Question) -> (&'static str, &'static str, &'static str) {
    match question {
        Question::Project => (
            "Open a project or dataset",
            "Open",
            "/matches/final/project.json",
        ),
        Question::Folder => ("Open a folder of frames", "Open", "/matches/final/frames"),
        Question::Video => ("Open a video", "Open", "/matches/final.mp4"),
        Question::Queue => (
            "Open a queue of matches",
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
            "Load a camera from a project, dataset or venue",
            "Load",
            "/matches/other/project.json",
        ),
    }
}

/// Shows the dialog.
pub fn show_path(panel: &mut Panel<'_>, ctx: &Context, question: Question) {
    let memory = Id::unique("typed path");
    let opened = has_just_opened(ctx, "path");
    let mut typed: String = recall(ctx, memory, opened).unwrap_or_default();
    let (title, does, example) = describe_question(question);
    sheet(panel, ctx, title, vec2(520.0, 160.0), |panel, ui| {
        theme::weak(ui, "No file dialog is available. Type or paste the path.");
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
                panel.act(Action::Answer(question, PathBuf::from(path)));
            }
            cancel(panel, ui, "Close without a change. (Esc)");
        });
    });
    ctx.data_mut(|data| data.insert_temp(memory, typed));
}

/// Shows the dialog. `before` is the comment when it opened.
pub fn show_comment(panel: &mut Panel<'_>, ctx: &Context, before: &str) {
    let memory = Id::unique("comment");
    let opened = has_just_opened(ctx, "comment");
    let known = recall(ctx, memory, opened);
    let mut typed: String = known.unwrap_or_else(|| before.to_owned());
    sheet(panel, ctx, "Comment", vec2(440.0, 220.0), |panel, ui| {
        // Read before the text field sees it, where Enter begins a new line.
        let save = ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Enter));
        let name = panel.app.frame().map(Frame::name).unwrap_or_default();
        theme::weak(ui, file_name(&name));
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
            if show_button(
                ui,
                Button::new("Save comment").fill(ui.palette().accent_ground),
                "Save the comment; an empty one is removed. (Ctrl+Enter)",
            ) || save
            {
                panel.edit(EditAction::SetComment(typed.clone()));
            }
            cancel(panel, ui, "Leave the comment as it was. (Esc)");
        });
    });
    ctx.data_mut(|data| data.insert_temp(memory, typed));
}

/// Shows the dialog.
pub fn show_go_to(panel: &mut Panel<'_>, ctx: &Context) {
    let memory = Id::unique("typed place");
    let opened = has_just_opened(ctx, "place");
    let mut typed: String = recall(ctx, memory, opened).unwrap_or_default();
    let (first, last) = panel
        .app
        .open()
        .map_or((0, 0), |open| open.numbers_beside(panel.app.session.frame));
    sheet(
        panel,
        ctx,
        "Go to frame or time",
        vec2(320.0, 150.0),
        |panel, ui| {
            let place = ui.horizontal(|ui| {
                let field = TextEdit::singleline(&mut typed)
                    .hint_text("500 or 1:23.4")
                    .desired_width(210.0);
                let response = ui.add(field).accessible_name("Frame or time");
                let response = response
                    .on_hover_text("A frame's number, or minutes and seconds. Enter goes there.");
                if opened {
                    response.request_focus();
                }
                // A text field loses the focus with Enter. A text that is not a place is explained
                // below, and Enter does nothing.
                let place = typed.parse::<FrameOrTime>();
                let entered =
                    response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                if entered && place.is_err() {
                    // The user goes on to correct the text.
                    response.request_focus();
                }
                let go = ui.add_enabled(
                    place.is_ok(),
                    Button::new("Go").fill(ui.palette().accent_ground),
                );
                let go = go.on_hover_text("Show this frame. (Enter)");
                if let (true, Ok(place)) = (go.clicked() || entered, &place) {
                    panel.navigate(Navigation::GoToPlace(*place));
                }
                place
            });
            ui.add_space(theme::SPACE);
            // What is wrong with the text, or else which numbers there are.
            let says = match &place.inner {
                Err(error) if !typed.trim().is_empty() => {
                    RichText::new(sentence(&error.to_string())).color(ui.palette().caution)
                }
                _ => RichText::new(format!("Frames are numbered from {first} to {last}."))
                    .color(ui.palette().weak),
            };
            ui.label(says.small());
        },
    );
    ctx.data_mut(|data| data.insert_temp(memory, typed));
}
