//! The bottom row: the next step, the pointer's position, the zoom, and what undo would revert.

use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::Themed as _;
use crate::ui::drawing::labels::text_width;
use egui::{Align, Button, Label, Layout, RectAlign, RichText, TextStyle, Tooltip, Ui};
use touchline_application::app::guidance::{Guidance, next_step};
use touchline_application::app::session::PictureView;
use touchline_application::app::{App, Command};

/// Widths of the zoom and of the pointer's position, points.
const ZOOM: f32 = 72.0;
const POINTER: f32 = 112.0;
/// Widths of a button without its text, and of the menu of buttons that have no room, points.
const AROUND: f32 = 24.0;
const MORE: f32 = 72.0;

/// Height of the row of messages above this row with some space, points.
const MESSAGES: f32 = 28.0;

/// Shows the row. In a narrow window the next step takes precedence: its second and later buttons
/// go into a menu, then the text of undo is left out, then the pointer's position.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let guidance = next_step(panel.app);
    let undo = undo_text(panel.app);
    let needed = [
        width(ui, &guidance.text),
        ZOOM,
        least_offers(ui, &guidance.offers),
    ];
    // The room that the next step leaves goes to the other parts in the order of importance. Widths
    // are measured before anything is drawn, because egui lays a row out in one pass.
    let mut room = ui.available_width() - needed.iter().sum::<f32>();
    let mut has_room = |width: f32| {
        let has = width <= room;
        room -= if has { width } else { 0.0 };
        has
    };
    let shows_pointer = has_room(POINTER);
    let undo = undo.filter(|text| has_room(width(ui, text) + AROUND));
    // From the right: undo, zoom, pointer; the next step takes the rest.
    ui.horizontal_centered(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(text) = undo {
                undo_button(panel, ui, text);
            }
            zoom(panel, ui);
            if shows_pointer {
                pointer(panel.app, ui);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                step(panel, ui, &guidance);
            });
        });
    });
}

/// Width of a text, points.
fn width(ui: &Ui, text: &str) -> f32 {
    text_width(ui.painter(), text, TextStyle::Body.resolve(ui.style()))
}

/// Minimum width of the buttons, points: the first button, and a menu with the others.
fn least_offers(ui: &Ui, offers: &[(&str, Command)]) -> f32 {
    let first = offers
        .first()
        .map_or(0.0, |(says, _)| width(ui, says) + AROUND);
    first + if offers.len() > 1 { MORE } else { 0.0 }
}

/// Shows the next step with its buttons.
fn step(panel: &mut Panel<'_>, ui: &mut Ui, guidance: &Guidance) {
    let offers = &guidance.offers;
    let room = ui.available_width();
    let text = width(ui, &guidance.text) + AROUND;
    // All buttons if they fit beside the text; otherwise the first and a menu, or a menu alone.
    let shown = match offers.len() {
        count if text + buttons_width(ui, offers) <= room => count,
        0 => 0,
        1 => 1,
        _ => usize::from(text + least_offers(ui, offers) <= room),
    };
    // The text gets what the buttons leave, at least 60 points: it is cut, never the buttons.
    let taken = buttons_width(ui, &offers[..shown]);
    let menu = if shown < offers.len() { MORE } else { 0.0 };
    ui.scope(|ui| {
        ui.set_max_width((room - taken - menu).max(60.0));
        let text = RichText::new(&guidance.text).color(ui.palette().strong);
        let step = ui.add(Label::new(text).truncate());
        // Above the row of messages, which lies between.
        let mut tooltip = Tooltip::for_enabled(&step).gap(MESSAGES);
        tooltip.popup = tooltip.popup.align(RectAlign::TOP_START);
        tooltip.show(|ui| ui.label(&guidance.text));
    });
    for (says, command) in &offers[..shown] {
        command_button(panel, ui, says, *command);
    }
    if shown < offers.len() {
        let says = if shown == 0 { "How…" } else { "More…" };
        ui.menu_button(says, |ui| {
            for (says, command) in &offers[shown..] {
                command_button(panel, ui, says, *command);
            }
        });
    }
}

/// Width of buttons with the space around them, points.
fn buttons_width(ui: &Ui, offers: &[(&str, Command)]) -> f32 {
    offers
        .iter()
        .map(|(says, _)| width(ui, says) + AROUND)
        .sum()
}

/// Shows a button for a command.
fn command_button(panel: &mut Panel<'_>, ui: &mut Ui, says: &str, command: Command) {
    if panel.run_on_click(ui.add(Button::new(says).small()), command) {
        ui.close();
    }
}

/// The step that undo would revert, with its frame if that is not the shown one.
fn undo_text(app: &App) -> Option<String> {
    let open = app.open()?;
    let step = open.history.next_undo()?;
    let position = step
        .frame
        .as_ref()
        .and_then(|id| open.document.frames.position_of(id));
    let elsewhere = position.filter(|position| *position != app.session.frame);
    let place = elsewhere
        .map(|position| format!(" (frame {})", open.frame_number(position)))
        .unwrap_or_default();
    Some(format!("Undo: {}{place}", step.name))
}

/// Shows the button that reverts the last step.
fn undo_button(panel: &mut Panel<'_>, ui: &mut Ui, text: String) {
    let button = Button::new(RichText::new(text).color(ui.palette().weak)).frame(false);
    panel.run_on_click(ui.add(button), Command::Undo);
    ui.separator();
}

/// Shows the zoom in physical px per px of the picture; a click fits the picture.
fn zoom(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.frame().is_none() {
        return;
    }
    // The viewport reports the fitting scale when it is first laid out; until then it is zero.
    let (scale, fits) = match panel.app.session.picture.view {
        PictureView::Fit => (panel.app.session.picture.fit_scale, true),
        PictureView::Zoomed { scale, .. } => (scale, false),
    };
    if scale > 0.0 {
        let text = format!("{:.0} %{}", 100.0 * scale, if fits { " fit" } else { "" });
        let button = Button::new(RichText::new(text).color(ui.palette().text)).frame(false);
        let tip = format!(
            "Screen px per px of the picture. {} The wheel zooms to the pointer.",
            panel.app.settings.keys.tooltip(Command::ZoomToFit)
        );
        if show_button(ui, button, tip) {
            panel.run(Command::ZoomToFit);
        }
        ui.separator();
    }
}

/// Shows the pointer's position in the picture, px from its upper left corner.
fn pointer(app: &App, ui: &mut Ui) {
    let Some(at) = app.session.points.hover else {
        return;
    };
    ui.label(
        RichText::new(format!("{:.1}, {:.1}", at.x, at.y))
            .monospace()
            .color(ui.palette().text),
    )
    .on_hover_text("The pointer, px of the picture from its top-left corner.");
    ui.separator();
}
