//! The list of shots: a thumbnail from the middle, camera and kind, how many frames have a camera,
//! and what is left to do. Only rows in view become widgets.

use super::list::{paint_ground, text_within};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::maps::miniature;
use crate::ui::rows::menu;
use egui::{
    Button, Context, Frame, Id, Margin, Rect, Role, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2,
};
use std::path::PathBuf;
use std::sync::Arc;
use strum::IntoEnumIterator as _;
use touchline_application::app::{Command, OpenProject, ViewAction};
use touchline_application::scene::shot_list::{ShotOrder, ShotRow, ShotShows, in_order, shot_rows};
use touchline_core::geometry::{pluralise, thousands};

/// Height of a row, points.
const ROW: f32 = 58.0;
/// Size of a thumbnail, points.
const PICTURE: egui::Vec2 = vec2(80.0, 45.0);

/// The commands in the context menu of a row.
const MENU: [Command; 8] = [
    Command::AcceptShot,
    Command::RejectShot,
    Command::ShotContent,
    Command::AssignToCamera,
    Command::Track,
    Command::AddCut,
    Command::RemoveCut,
    Command::SelectShot,
];

/// The rows that were computed last, with the document, the version and the choice that they are
/// of.
#[derive(Clone)]
struct CachedRows {
    of: (PathBuf, u64, ShotOrder, bool),
    rows: Arc<Vec<ShotRow>>,
}

/// Shows orders and filter, and below them the list.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    orders(panel, ui);
    let Some(open) = panel.app.open() else { return };
    let choice = panel.app.session.review.shots;
    let rows = cached_rows(ui.ctx(), open, (choice.order, choice.fields_only));
    if rows.is_empty() {
        Frame::new()
            .inner_margin(Margin::symmetric(8, 4))
            .show(ui, |ui| {
                theme::weak_text(
                    ui,
                    "No shots are marked. Find the cuts of this video, or cut before a frame.",
                );
            });
        return;
    }
    let area = ScrollArea::vertical()
        .id_salt("shot list")
        .auto_shrink(false);
    area.show_rows(ui, ROW, rows.len(), |ui, range| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for row in &rows[range] {
            show_row(panel, ui, row);
        }
    });
}

/// The chosen rows of the document in their order, computed again when it or the choice has
/// changed.
fn cached_rows(
    ctx: &Context,
    open: &OpenProject,
    (order, fields_only): (ShotOrder, bool),
) -> Arc<Vec<ShotRow>> {
    let version = open.document.version();
    let of = (open.file.clone(), version, order, fields_only);
    let memory = Id::unique("shot rows");
    let known = ctx.data(|data| data.get_temp::<CachedRows>(memory));
    if let Some(known) = known.filter(|known| known.of == of) {
        return known.rows;
    }
    let rows = in_order(shot_rows(&open.document), order, fields_only);
    let rows = Arc::new(rows);
    let cached = CachedRows {
        of,
        rows: Arc::clone(&rows),
    };
    ctx.data_mut(|data| data.insert_temp(memory, cached));
    rows
}

/// Shows the choice of the order, and whether shots of fields alone are listed.
fn orders(panel: &mut Panel<'_>, ui: &mut Ui) {
    Frame::new()
        .inner_margin(Margin::symmetric(8, 0))
        .show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = theme::SPACE;
                let choice = panel.app.session.review.shots;
                for order in ShotOrder::iter() {
                    let is_chosen = order == choice.order;
                    if ui
                        .add(Button::selectable(is_chosen, order.label()))
                        .clicked()
                    {
                        panel.view(ViewAction::SetShotOrder(order));
                    }
                }
                let mut only = choice.fields_only;
                ui.checkbox(&mut only, "Fields only")
                    .on_hover_text("Leave out close-ups, crowd and transitions.");
                if only != choice.fields_only {
                    panel.view(ViewAction::ListFieldsOnly(only));
                }
            });
        });
    ui.add_space(theme::SPACE);
}

/// Shows a shot. A click shows its first frame.
fn show_row(panel: &mut Panel<'_>, ui: &mut Ui, row: &ShotRow) {
    let (place, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let Some(open) = panel.app.open() else { return };
    let current = (row.first..=row.last).contains(&panel.app.session.frame);
    let [first, last] = [row.first, row.last].map(|index| open.frame_number(index));
    let shows = row.shows.label();
    let title = if row.shows == ShotShows::Field {
        format!("{first}–{last}  {}", row.camera.as_str())
    } else {
        format!("{first}–{last}  {shows}")
    };
    let counts = describe_counts(row);
    response.widget_info(|| {
        let label = format!("Shot {title}, {shows}, {counts}, {}", row.reason());
        WidgetInfo::selected(Role::Button, true, current, label)
    });
    paint_ground(ui, place, &response, current);
    let painter = ui.painter();
    let picture = Rect::from_min_size(place.min + vec2(8.0, (ROW - PICTURE.y) / 2.0), PICTURE);
    miniature::paint(panel, painter, open, row.first.midpoint(row.last), picture);
    let left = picture.right() + 8.0;
    let width = place.right() - 10.0 - left;
    let is_done = row.doubtful() == 0;
    let reason_colour = if is_done {
        ui.palette().weak
    } else {
        ui.palette().caution
    };
    for (line, (text, colour)) in [
        (title.clone(), ui.palette().strong),
        (counts.clone(), ui.palette().text),
        (row.reason().to_owned(), reason_colour),
    ]
    .into_iter()
    .enumerate()
    {
        let at = pos2(left, place.top() + 13.0 + 16.0 * line as f32);
        text_within(painter, at, width, text, colour);
    }
    // A right click shows the shot as well, because the commands of its menu act on the shown one.
    if response.clicked() || response.secondary_clicked() {
        panel.go_to(row.first);
    }
    response.context_menu(|ui| menu::entries(panel, ui, &MENU));
    response.on_hover_text(format!("{title}: {counts}. Click to go there."));
}

/// How many frames of a shot are right, uncertain, and without a camera.
fn describe_counts(row: &ShotRow) -> String {
    if row.shows != ShotShows::Field {
        return pluralise(row.frames, "frame");
    }
    let mut parts = vec![format!("{} right", thousands(row.certain))];
    for (count, name) in [(row.uncertain, "uncertain"), (row.none, "none")] {
        if count > 0 {
            parts.push(format!("{} {name}", thousands(count)));
        }
    }
    if row.accepted > 0 {
        parts.push(format!("{} accepted", thousands(row.accepted)));
    }
    parts.join(", ")
}
