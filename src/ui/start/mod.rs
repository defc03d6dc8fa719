//! The start page. It takes the place of the picture while nothing is open: what the program does,
//! as a film ([`film`]), beside it what one can begin with, and the documents that were opened
//! last.

mod film;

use super::Panel;
use super::controls::theme::Themed as _;
use super::drawing::labels::lay_out_within;
use super::drawing::pictures::paint_filling;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::{symbol, theme};
use crate::ui::rows::menu::document_name;
use egui::{
    Align, Button, CornerRadius, FontId, Id, Key, Layout, Margin, Rect, RichText, Role, ScrollArea,
    Sense, TextEdit, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};
use std::path::PathBuf;
use touchline_application::app::settings::RecentDocument;
use touchline_application::app::{Action, Command};

/// Smallest and largest width of the film, points.
const FILM: [f32; 2] = [360.0, 820.0];
/// Smallest and largest width of the column beside it, points.
const COLUMN: [f32; 2] = [400.0, 520.0];
/// Between the two, and around them, points.
const GAP: f32 = 32.0;

/// Largest height of the page, points: a taller window has room above and below.
const HEIGHT: f32 = 860.0;

/// What the program does.
const PURPOSE: &str = "Calibrates a sports camera from two clicks in a frame, and proposes the \
                       camera of every other frame.";

/// What one needs.
const NEEDED: &str = "All you need is a video, or frames, of a camera that pans and zooms from a \
                      fixed position, over a field with painted lines.";

/// What may be dropped on the window.
const INVITATION: &str = "Or drop on this window a video, frames, a project, several of them as a \
                          queue, or cameras of another program with their video.";

/// Height of a row to begin with, points.
const ROW: f32 = 44.0;

/// Shows the start page.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let area = ui.available_rect_before_wrap();
    ui.painter().rect_filled(area, 0.0, ui.palette().backdrop);
    let (film, column) = widths(area.width());
    let beside = film.map_or(0.0, |film| film + GAP);
    let page = vec2(beside + column, area.height().min(HEIGHT) - GAP);
    let page = Rect::from_center_size(area.center(), page).intersect(area.shrink(GAP / 2.0));
    let title = Rect::from_min_size(page.min, vec2(page.width(), 72.0));
    ui.scope_builder(UiBuilder::new().max_rect(title), |ui| {
        ui.label(
            RichText::new("touchline")
                .size(theme::TITLE)
                .color(ui.palette().strong),
        );
        ui.label(
            RichText::new(PURPOSE)
                .size(theme::BODY)
                .color(ui.palette().text),
        );
    });
    let below = page.with_min_y(title.bottom() + 2.0 * theme::SPACE);
    if let Some(film) = film {
        let left = below.with_max_x(below.left() + film);
        ui.scope_builder(UiBuilder::new().max_rect(left), |ui| {
            film::show(ui, film);
            ui.add_space(2.0 * theme::SPACE);
            theme::weak(ui, NEEDED);
        });
    }
    let right = below.with_min_x(below.right() - column);
    ui.scope_builder(UiBuilder::new().max_rect(right), |ui| {
        ScrollArea::vertical().show(ui, |ui| beginnings(panel, ui));
    });
}

/// The widths of the film and of the column beside it in a window of this width. The film takes
/// 56 % of what the gaps leave, the column the rest, both within their limits. Where there is no
/// room for both, the column is alone.
fn widths(window: f32) -> (Option<f32>, f32) {
    let free = window - 3.0 * GAP;
    let film = (0.56 * free).min(free - COLUMN[0]).min(FILM[1]);
    let film = Some(film).filter(|film| *film >= FILM[0]);
    let column = film.map_or(free + GAP, |film| free - film);
    (film, column.min(COLUMN[1]))
}

/// Shows what one can begin with, or what is being opened.
fn beginnings(panel: &mut Panel<'_>, ui: &mut Ui) {
    ui.spacing_mut().item_spacing.y = 2.0 * theme::SPACE;
    waiting_labels(panel, ui);
    // While something is being opened, it can only be cancelled.
    if let Some(opening) = &panel.app.session.disk.opening {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(RichText::new(opening).color(ui.palette().accent));
        });
        let cancel = ui.button("Cancel").on_hover_text("Stop opening. (Esc)");
        if cancel.clicked() {
            panel.run(Command::Cancel);
        }
        return;
    }
    for (symbol, name, about, command) in [
        (
            Symbol::Film,
            "Video…",
            "A match or a clip",
            Command::OpenVideo,
        ),
        (
            Symbol::Folder,
            "Folder…",
            "Frames as pictures",
            Command::OpenFolder,
        ),
        (
            Symbol::Document,
            "Project…",
            "Work that you began",
            Command::OpenProject,
        ),
        (
            Symbol::List,
            "Queue…",
            "Several matches, one after the other",
            Command::OpenQueue,
        ),
        (
            Symbol::Picture,
            "Demo match",
            "27 drawn frames to try things on",
            Command::OpenDemo,
        ),
        (
            Symbol::Lesson,
            "Take the tour",
            "Five steps, 2 minutes",
            Command::StartTour,
        ),
    ] {
        let text = RichText::new(name)
            .size(theme::BODY)
            .color(ui.palette().strong);
        let mut row = Button::new((symbol::atom(symbol, ui.palette().accent), text))
            .gap(3.0 * theme::SPACE)
            .right_text(RichText::new(about).color(ui.palette().weak))
            .min_size(vec2(ui.available_width(), ROW));
        // Whoever has opened nothing yet probably does not know the program.
        if command == Command::StartTour && panel.app.settings.recent.is_empty() {
            row = row.fill(ui.palette().accent_ground);
        }
        panel.run_on_click(ui.add(row), command);
    }
    path_field(panel, ui);
    theme::small_weak(ui, INVITATION);
    show_recent(panel, ui);
}

/// Says which labels wait for their pictures.
fn waiting_labels(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(labels) = panel.app.waiting_labels() else {
        return;
    };
    let name = document_name(&labels.path);
    let text = format!(
        "{name}: {}. Now drop or open the video or the frames that they belong to.",
        labels.format.about().title
    );
    ui.label(RichText::new(text).color(ui.palette().accent));
    let leave = ui
        .button("Leave them")
        .on_hover_text("Import nothing. (Esc)");
    if leave.clicked() {
        panel.run(Command::Cancel);
    }
}

/// A field for a typed or pasted path, for systems without file dialogs.
fn path_field(panel: &mut Panel<'_>, ui: &mut Ui) {
    // Another id than that of the dialog for typing a path, which may open over this page.
    let memory = Id::unique("typed path of the start page");
    let mut typed: String = ui.data_mut(|data| data.get_temp(memory).unwrap_or_default());
    let width = ui.available_width();
    let row = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, 28.0), row, |ui| {
        let field = TextEdit::singleline(&mut typed)
            .hint_text("Path of a project, folder, video or labels")
            .margin(Margin::symmetric(8, 6))
            .desired_width(width - 72.0 - 2.0 * theme::SPACE);
        let response = ui.add(field).accessible_name("Path to open").on_hover_text(
            "The path of a project, a folder of frames, a video, or labels of another program; \
             Enter opens it.",
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
            let path = PathBuf::from(typed.trim());
            panel.act(Action::OpenAny(vec![path]));
        }
    });
    ui.data_mut(|data| data.insert_temp(memory, typed));
}

/// Maximum number of documents in the list.
const SHOWN: usize = 5;
/// Size of a picture, points.
const PICTURE: [f32; 2] = [80.0, 45.0];

/// Lists the documents.
pub fn show_recent(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.settings.recent.is_empty() {
        return;
    }
    ui.add_space(theme::SPACE);
    theme::title(ui, "RECENT");
    for document in panel.app.settings.recent.iter().take(SHOWN) {
        let picture = document.picture();
        let picture = picture.and_then(|picture| panel.pictures.thumbnail_of(picture));
        if recent_row(ui, document, picture) {
            panel.act(Action::Open(document.file.clone()));
        }
    }
}

/// Shows a document as a row, and whether it was clicked.
fn recent_row(
    ui: &mut Ui,
    document: &RecentDocument,
    picture: Option<egui::TextureHandle>,
) -> bool {
    let size = vec2(ui.available_width(), PICTURE[1] + 2.0 * theme::SPACE);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let name = document_name(&document.file);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    let visuals = ui.style().interact(&response);
    let (ground, border) = (visuals.weak_bg_fill, visuals.bg_stroke);
    let painter = ui.painter();
    painter.rect(
        rect,
        CornerRadius::same(4),
        ground,
        border,
        egui::StrokeKind::Inside,
    );

    let place = rect.min + egui::Vec2::splat(theme::SPACE);
    let place = Rect::from_min_size(place, PICTURE.into());
    paint_filling(painter, picture, place, ui.palette().raised);

    let folder = document
        .file
        .parent()
        .map(|folder| folder.display().to_string());
    let width = rect.right() - place.right() - 4.0 * theme::SPACE;
    for (text, size, colour, y) in [
        (name, theme::BODY, ui.palette().strong, -17.0),
        (
            folder.unwrap_or_default(),
            theme::SMALL,
            ui.palette().weak,
            2.0,
        ),
    ] {
        let galley = lay_out_within(painter, text, FontId::proportional(size), colour, width);
        let at = pos2(place.right() + 2.0 * theme::SPACE, rect.center().y + y);
        painter.galley(at, galley, colour);
    }
    response
        .on_hover_text(document.file.display().to_string())
        .clicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn film_and_column_stand_side_by_side_or_the_column_alone() {
        for window in [600.0, 855.0, 856.0, 900.0, 1280.0, 2560.0] {
            let (film, column) = widths(window);
            assert_eq!(film.is_some(), window >= 856.0, "{window}");
            let taken = film.map_or(0.0, |film| film + GAP) + column;
            assert!(taken <= window - 2.0 * GAP + 0.01, "{window}: {taken}");
            assert!(film.is_none() || column >= COLUMN[0], "{window}: {column}");
        }
    }
}
