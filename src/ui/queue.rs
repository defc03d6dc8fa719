//! The queue panel: the matches of the open queue, beside the picture while one works through them.

use super::Panel;
use super::controls::symbol::Symbol;
use super::controls::theme::Themed as _;
use super::controls::{Heading, replace_remembered, symbol};
use super::drawing::pictures::paint_filling;
use super::review::{paint_ground, text_within};
use egui::{Align, Button, Layout, Rect, Role, ScrollArea, Sense, Ui, Vec2, WidgetInfo, vec2};
use touchline_application::app::{Action, App, Command, MatchRow};
use touchline_application::scene::match_list::{MatchStage, MatchState};

/// Width of the panel where there is room for texts beside the pictures, and where there is not,
/// points.
const WIDTHS: [f32; 2] = [232.0, 100.0];
/// Size of a picture, points.
const PICTURE: Vec2 = vec2(80.0, 45.0);
/// Height of a line of text, points.
const LINE: f32 = 16.0;
/// Space around the content of a row, points.
const EDGE: f32 = 8.0;

/// The width of the panel, points, in a window with this width to spare; 0 while it is not shown.
pub fn width(app: &App, spare: f32) -> f32 {
    let is_shown = app.queue().is_some() && app.settings.queue_panel && app.round().is_none();
    let width = WIDTHS.into_iter().find(|width| *width <= spare);
    width.filter(|_| is_shown).unwrap_or(0.0)
}

/// Shows the panel.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(queue) = panel.app.queue() else {
        return;
    };
    // The edge of the panel takes a point.
    let is_wide = ui.available_width() > WIDTHS[1];
    let heading = Heading {
        title: "Queue",
        command: Command::QueuePanel,
        closes: "queue panel",
        behind: "picture alone",
    };
    heading.show(panel, ui, |_, _| {}, |_, _| {});
    egui::Panel::bottom("queue footer")
        .resizable(false)
        .frame(egui::Frame::new().inner_margin(EDGE))
        .show(ui, |ui| footer(panel, ui, is_wide));
    let memory = egui::Id::unique("match of the queue");
    let scrolled = replace_remembered(ui, memory, queue.at()) != Some(queue.at());
    ScrollArea::vertical()
        .id_salt("queue")
        .auto_shrink(false)
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for (at, row) in queue.rows().iter().enumerate() {
                let response = show_row(panel, ui, (at, row), is_wide);
                if scrolled && at == queue.at() {
                    response.scroll_to_me(None);
                }
                if response.clicked() {
                    panel.act(Action::OpenMatch(at));
                }
            }
        });
}

/// Shows a match: its picture, name, state, length and doubts; in a narrow panel below each other.
fn show_row(
    panel: &mut Panel<'_>,
    ui: &mut Ui,
    (at, row): (usize, &MatchRow),
    is_wide: bool,
) -> egui::Response {
    let (name, state) = (row.queued.name.clone(), row.state.as_ref());
    let says = state.map_or_else(|| "…".to_owned(), MatchState::describe);
    let rest = state.map_or_else(String::new, MatchState::describe_rest);
    let height = if is_wide {
        PICTURE.y
    } else {
        PICTURE.y + 3.0 * LINE
    };
    let size = vec2(ui.available_width(), height + 1.5 * EDGE);
    // A row out of view costs neither a picture nor a text.
    let (place, response) = ui.allocate_exact_size(size, Sense::click());
    let is_shown = panel.app.queue().is_some_and(|queue| queue.at() == at);
    let full = [says.as_str(), rest.as_str()].map(str::trim);
    let full = full
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(", ");
    response.widget_info(|| {
        WidgetInfo::selected(
            Role::Button,
            true,
            is_shown,
            format!("Match {name}, {full}"),
        )
    });
    if !ui.is_rect_visible(place) {
        return response;
    }
    paint_ground(ui, place, &response, is_shown);
    let picture = Rect::from_min_size(place.min + vec2(EDGE, 0.75 * EDGE), PICTURE);
    let source = state.and_then(|state| state.picture.clone());
    let texture = source.and_then(|source| panel.pictures.thumbnail_of(source));
    let painter = ui.painter();
    paint_filling(painter, texture, picture, ui.palette().raised);
    let (left, top) = if is_wide {
        (picture.right() + EDGE, picture.top() - 1.5)
    } else {
        (picture.left(), picture.bottom() + 1.0)
    };
    let palette = ui.palette();
    let has_failed = state.is_some_and(|state| matches!(state.stage, MatchStage::Failed(_)));
    let colour = if has_failed {
        palette.caution
    } else {
        palette.text
    };
    let lines = [
        (name.clone(), palette.strong),
        (says, colour),
        (rest, palette.weak),
    ];
    for (line, (text, colour)) in lines.into_iter().enumerate() {
        let at = egui::pos2(left, top + LINE * (line as f32 + 0.5));
        text_within(painter, at, place.right() - EDGE - left, text, colour);
    }
    response.on_hover_text(format!("{name}: {full}. Click to open it."))
}

/// Shows the buttons that lead to the previous and to the next match.
fn footer(panel: &mut Panel<'_>, ui: &mut Ui, is_wide: bool) {
    ui.with_layout(Layout::top_down_justified(Align::Center), |ui| {
        let next = Button::new((
            symbol::atom(Symbol::Return, ui.palette().accent),
            "Next match",
        ));
        panel.command_button(
            ui,
            next.fill(ui.palette().accent_ground),
            Command::NextMatch,
        );
        let previous = if is_wide {
            "Previous match"
        } else {
            "Previous"
        };
        panel.command_button(ui, Button::new(previous), Command::PreviousMatch);
        ui.add_space(LINE);
    });
}
