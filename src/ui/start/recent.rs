//! The documents that were opened last, each with its first picture.

use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use crate::ui::drawing::labels::lay_out_within;
use crate::ui::rows::menu::document_name;
use egui::{Color32, CornerRadius, FontId, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};
use touchline_application::app::{Action, settings::RecentDocument};

/// Maximum number of documents in the list.
const SHOWN: usize = 5;
/// Size of a picture, points.
const PICTURE: [f32; 2] = [80.0, 45.0];

/// Lists the documents.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.settings.recent.is_empty() {
        return;
    }
    ui.add_space(theme::SPACE);
    theme::title(ui, "RECENT");
    for document in panel.app.settings.recent.iter().take(SHOWN) {
        let picture = document.picture();
        let picture = picture.and_then(|picture| panel.pictures.thumbnail_of(picture));
        if row(ui, document, picture) {
            panel.actions.push(Action::Open(document.file.clone()));
        }
    }
}

/// Shows a document as a row, and whether it was clicked.
fn row(ui: &mut Ui, document: &RecentDocument, picture: Option<egui::TextureHandle>) -> bool {
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

    // The picture fills its box; what is longer than the box is cut.
    let place = rect.min + egui::Vec2::splat(theme::SPACE);
    let place = Rect::from_min_size(place, PICTURE.into());
    painter.rect_filled(place, CornerRadius::same(2), ui.palette().raised);
    if let Some(picture) = picture {
        let shape = picture.size_vec2();
        // `cut` is the scale at which the shorter side fills the box, `shown` the part of the
        // picture that is then within the box, in texture coordinates.
        let cut = (place.size() / shape).max_elem();
        let shown = place.size() / (shape * cut);
        let seen = Rect::from_center_size(pos2(0.5, 0.5), shown);
        painter.image(picture.id(), place, seen, Color32::WHITE);
    }

    let folder = document
        .file
        .parent()
        .map(|folder| folder.display().to_string());
    let width = rect.right() - place.right() - 4.0 * theme::SPACE;
    for (text, size, colour, y) in [
        (name, 13.0, ui.palette().strong, -17.0),
        (folder.unwrap_or_default(), 11.0, ui.palette().weak, 2.0),
    ] {
        let galley = lay_out_within(painter, text, FontId::proportional(size), colour, width);
        let at = pos2(place.right() + 2.0 * theme::SPACE, rect.center().y + y);
        painter.galley(at, galley, colour);
    }
    response
        .on_hover_text(document.file.display().to_string())
        .clicked()
}
