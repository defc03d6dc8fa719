//! The middle of the top row: the name of the open document, with its frame and shot. Long names
//! are shortened in the middle.

use crate::ui::controls::theme::{self, Themed as _};
use egui::{RichText, Ui};
use std::path::Path;
use touchline_application::app::App;
use touchline_core::geometry::{pluralise, thousands};
use touchline_documents::store::{PROJECT_FILE, PROJECT_SUFFIX};

/// Maximum length of a name in the row, characters; the tooltip has the whole name.
pub(super) const LONGEST_NAME: usize = 48;

/// The name of a document: of its folder if it is a project, else of its file.
pub fn document_name(file: &Path) -> String {
    let is_project = file.file_name().is_some_and(|name| name == PROJECT_FILE);
    let named = if is_project {
        file.parent().unwrap_or(file)
    } else {
        file
    };
    let name = named.file_name().map_or_else(
        || named.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    );
    name.strip_suffix(PROJECT_SUFFIX)
        .unwrap_or(&name)
        .to_owned()
}

/// Shows document, frame and shot.
pub(super) fn place(app: &App, ui: &mut Ui) {
    // From left to right: document, frame, shot, file of the picture, place in the queue, and
    // whether the document is read-only.
    let Some(open) = app.open() else { return };
    let name = shorten_text(&document_name(&open.file), LONGEST_NAME);
    ui.add(egui::Label::new(RichText::new(name).color(ui.palette().strong)).truncate())
        .on_hover_text(open.file.display().to_string());
    let count = open.document.frames.len();
    if let Some(frame) = app.frame() {
        let number = frame.number_at(app.session.frame);
        ui.label(RichText::new(format!("frame {number}")).color(ui.palette().text))
            .on_hover_text(format!(
                "Frame {number}, counted from 0; the document has {}: {}",
                pluralise(count, "frame"),
                frame.name()
            ));
        if let Some(clip) = &frame.clip {
            let shot = format!("shot {}", shorten_text(&clip.to_string(), LONGEST_NAME / 2));
            theme::weak(ui, shot).on_hover_text(format!("The frame's shot, {clip}"));
        }
        ui.add(
            egui::Label::new(RichText::new(file_name(&frame.name())).color(ui.palette().weak))
                .truncate(),
        )
        .on_hover_text(frame.name());
    }
    if let Some(queue) = app.queue().filter(|_| app.queue_position().is_none()) {
        let (number, of) = (queue.at() + 1, queue.rows().len());
        let text = format!("match {} of {}", thousands(number), thousands(of));
        ui.label(RichText::new(text).color(ui.palette().text))
            .on_hover_text("Its place in the queue.");
    }
    if let Some((number, of)) = app.queue_position() {
        let text = format!("{} of {} in the queue", thousands(number), thousands(of));
        ui.label(RichText::new(text).color(ui.palette().text))
            .on_hover_text("The next frame to do is the next of the queue.");
    }
    if let Some(reason) = &open.read_only {
        ui.label(
            RichText::new("READ ONLY")
                .small()
                .strong()
                .color(ui.palette().caution),
        )
        .on_hover_text(reason.clone());
    }
}

/// A text of at most `most` characters: longer ones lose their middle.
pub(super) fn shorten_text(text: &str, most: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= most {
        return text.to_owned();
    }

    // Two thirds from the beginning, one third from the end: both distinguish names.
    let (head, tail) = (most * 2 / 3, most / 3 - 1);
    let ends = [&letters[..head], &['…'], &letters[letters.len() - tail..]];
    ends.into_iter().flatten().collect()
}

/// The last part of a frame's path.
pub fn file_name(path: &str) -> String {
    path.rsplit(['/', '\\']).next().unwrap_or(path).to_owned()
}
