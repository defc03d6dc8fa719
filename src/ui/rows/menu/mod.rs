//! The top row: menus, the open document with frame and shot, background work, and whether every
//! edit is saved.
//!
//! The menus contain every command. Their order is that of [`Command::all`]; [`SECTIONS`] and
//! [`SUBMENUS`] divide them.

mod background_work;
mod contents;
mod document_name;

use crate::ui::controls::show_button;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{symbol, theme};
use crate::ui::drawing::labels::text_width;
use crate::ui::{Panel, takes_keys};
use background_work::{jobs, saving};
use contents::{RECENT_BELOW, SECTIONS, rows, submenus, tip};
use document_name::place;
pub use document_name::{document_name, file_name};
use egui::{
    Align, Button, Event, FocusDirection, Id, Key, Layout, Modifiers, Rect, Response, Role,
    TextStyle, Ui, WidgetInfo, vec2,
};
use strum::IntoEnumIterator as _;
use touchline_application::app::session::SidePanel;
use touchline_application::app::{Action, App, Command, MenuGroup, Tool};
use touchline_application::scene;
use touchline_documents::document::{Click, Frame};

/// Shows the row.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let opens = is_menu_key(panel.app, ui);
    egui::MenuBar::new().ui(ui, |ui| {
        let titles = MenuGroup::iter().map(|group| {
            ui.menu_button(group.title(), |ui| menu(panel, ui, group))
                .response
                .on_hover_text(tip(group))
        });
        let titles: Vec<Response> = titles.collect();
        if let Some(title) = title_to_open(ui, &titles, opens) {
            title.request_focus();
            egui::Popup::open_id(ui.ctx(), egui::Popup::default_response_id(title));
        }
        ui.add_space(2.0 * theme::SPACE);
        // From the right: saving and background work; the document takes the rest.
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            saving(panel, ui);
            jobs(panel, ui);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                place(panel.app, ui);
            });
        });
    });
}

/// The title of the menu that a key opens now: the first one, or from an open menu the neighbour to
/// which an arrow key points.
fn title_to_open<'a>(ui: &Ui, titles: &'a [Response], first: bool) -> Option<&'a Response> {
    if first {
        return titles.first();
    }

    // The keys belong to a menu only while a title has the focus.
    if !titles.iter().any(Response::has_focus) {
        return None;
    }
    let at = titles.iter().position(|title| {
        egui::Popup::is_id_open(ui.ctx(), egui::Popup::default_response_id(title))
    })?;
    let step = ui.input_mut(|input| {
        let right = input.consume_key(Modifiers::NONE, Key::ArrowRight);
        let left = input.consume_key(Modifiers::NONE, Key::ArrowLeft);
        isize::from(right) - isize::from(left)
    });
    if step == 0 {
        return None;
    }

    // The arrow key must not move the focus as well.
    ui.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    titles.get((at as isize + step).rem_euclid(titles.len() as isize) as usize)
}

/// Whether F10 was pressed, or Alt was pressed and released alone; never while a dialog has the
/// keys, over which the menu would open.
fn is_menu_key(app: &App, ui: &Ui) -> bool {
    let is_covered = app.session.dialog.as_ref().is_some_and(takes_keys);
    // A press of a button, another key or the loss of the focus makes Alt a modifier: of a drag, of
    // a shortcut, of the desktop's own switch between windows.
    let (f10, alt, busy) = ui.input_mut(|input| {
        let f10 = input.consume_key(Modifiers::NONE, Key::F10);
        let busy =
            input.pointer.any_down() || !input.focused || input.events.iter().any(is_other_input);
        (f10 && !is_covered, input.modifiers.alt, busy || is_covered)
    });
    // Alt counts if nothing else happens from when it goes down until it goes up. Remembered:
    // whether Alt was down, and whether it was alone so far.
    let memory = Id::unique("alt is held alone");
    let tapped = ui.data_mut(|data| {
        let before = data.get_temp::<(bool, bool)>(memory).unwrap_or_default();
        let alone = alt && !busy && (!before.0 || before.1);
        data.insert_temp(memory, (alt, alone));
        !alt && before.1 && !busy
    });
    f10 || tapped
}

/// Whether an event is a key other than Alt, a text, or an action of the mouse.
const fn is_other_input(event: &Event) -> bool {
    match event {
        // The window system reports Alt as a key, too.
        Event::Key { key, .. } => !matches!(key, Key::AltLeft | Key::AltRight),
        Event::Text(_) | Event::PointerButton { .. } | Event::MouseWheel { .. } => true,
        _ => false,
    }
}

/// Shows the entries of a menu: submenus first.
fn menu(panel: &mut Panel<'_>, ui: &mut Ui, group: MenuGroup) {
    // A minimum width, so that short menus are not narrower than the others.
    ui.set_min_width(232.0);
    for (title, commands) in submenus(group) {
        ui.menu_button(title, |ui| entries(panel, ui, commands));
    }
    for command in rows(group) {
        if SECTIONS.contains(&command) {
            ui.separator();
        }
        entry(panel, ui, command);
        if command == RECENT_BELOW {
            recent(panel, ui);
        }
    }
}

/// Shows the entries of a submenu or of a context menu.
pub fn entries(panel: &mut Panel<'_>, ui: &mut Ui, commands: &[Command]) {
    ui.set_min_width(216.0);
    for command in commands {
        entry(panel, ui, *command);
    }
}

/// Shows an entry. One that is not available is disabled, with the reason in its tooltip.
fn entry(panel: &mut Panel<'_>, ui: &mut Ui, command: Command) {
    let why_not = panel.app.why_not(command);
    let button =
        Button::new(command.name()).shortcut_text(panel.app.settings.keys.key_label(command));
    let response = ui.add_enabled(why_not.is_none(), button);
    if is_on(panel.app, command) {
        let font = TextStyle::Button.resolve(ui.style());
        let name = text_width(ui.painter(), command.name(), font);
        // The tick comes after the name.
        let after = ui.spacing().button_padding.x + name + 2.5 * theme::SPACE;
        let within = Rect::from_center_size(
            response.rect.left_center() + vec2(after, 0.0),
            vec2(theme::SPACE, theme::SPACE),
        );
        symbol::paint(ui.painter(), Symbol::Tick, within, ui.palette().accent);
        response.widget_info(|| {
            WidgetInfo::selected(Role::Button, why_not.is_none(), true, command.name())
        });
    }
    let response = response.on_hover_text(command.about());
    let response = match why_not {
        Some(reason) => response.on_disabled_hover_text(format!("{} {reason}", command.about())),
        None => response,
    };
    if response.clicked() {
        panel.run(command);
        ui.close();
    }
}

/// Whether a command that switches something on and off is on; then its entry has a tick.
pub fn is_on(app: &App, command: Command) -> bool {
    match command {
        // Exactly one of the tools is on.
        Command::PointTool => app.session.picture.tool == Tool::Point,
        Command::SelectTool => app.session.picture.tool == Tool::Select,
        Command::LineTool => app.session.picture.tool == Tool::Line,
        Command::CheckTool => app.session.picture.tool == Tool::Check,
        Command::ShowMasks => app.session.picture.tool == Tool::Mask,
        Command::ShowFieldMap => app.settings.field_map,
        Command::QueuePanel => app.queue().is_some() && app.settings.queue_panel,
        Command::ShowCurves => app.settings.curves,
        Command::SnapPoints => app.settings.snap_points,
        Command::BaseOnPaint => app.settings.base_on_paint,
        Command::SnapSuggestions => app.settings.snap_suggestions,
        Command::HideOverlay => app.session.picture.held.hide_overlay,
        Command::Compare => app.session.picture.held.compare,
        Command::CameraPanel => app.session.panel == SidePanel::Camera,
        Command::TrainerPanel => app.session.panel == SidePanel::Trainer,
        Command::PauseTrainer => app.session.trainer.paused,
        Command::ShowFeatures => app.session.trainer.show_features,
        Command::ReviewPanel => app.session.panel == SidePanel::Review,
        Command::QualityPage => app.session.quality.open,
        Command::UseForTraining => app.frame().is_some_and(Frame::is_used_for_training),
        Command::PlaceOnLine => app.session.points.next_on_line,
        Command::Uncertainty => {
            app.session.picture.uncertainty != scene::uncertainty::UncertaintyView::Off
        }
        // This command is named after leaving the frame out.
        Command::UseForBase => app.frame().is_some_and(|frame| !frame.use_for_base),
        Command::MarkGold => app.frame().is_some_and(|frame| frame.gold),
        Command::ToggleCheck => selected_click(app).is_some_and(|click| click.check),
        _ => false,
    }
}

/// The selected point of the shown frame.
fn selected_click(app: &App) -> Option<&Click> {
    app.frame()?.clicks.get(app.session.points.selected?)
}

/// Shows the submenu of documents that were opened before.
fn recent(panel: &mut Panel<'_>, ui: &mut Ui) {
    // Disabled rather than absent without documents: entries of a menu keep their places.
    let none = panel.app.settings.recent.is_empty();
    ui.add_enabled_ui(!none, |ui| {
        let opened = ui.menu_button("Open recent", |ui| {
            for document in &panel.app.settings.recent {
                if show_button(
                    ui,
                    Button::new(document_name(&document.file)),
                    document.file.display().to_string(),
                ) {
                    panel.act(Action::Open(document.file.clone()));
                    ui.close();
                }
            }
        });
        opened
            .response
            .on_hover_text("Documents that you opened before.")
            .on_disabled_hover_text("You have not opened a document yet.");
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alt_alone_is_reported_as_a_key_and_is_no_other_input() {
        let event = |key| Event::Key {
            key,
            physical_key: Some(key),
            pressed: true,
            repeat: false,
            modifiers: Modifiers::ALT,
        };
        assert!(!is_other_input(&event(Key::AltLeft)));
        assert!(is_other_input(&event(Key::Tab)));
        assert!(is_other_input(&Event::Text("a".to_owned())));
    }

    fn opens_with_f10(app: &App) -> bool {
        let press = Event::Key {
            key: Key::F10,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        let input = egui::RawInput {
            events: vec![press],
            focused: true,
            ..egui::RawInput::default()
        };
        let (ctx, mut opens) = (egui::Context::default(), false);
        let mut output = ctx.run_ui(input, |ui| opens = is_menu_key(app, ui));
        output.textures_delta.clear();
        opens
    }

    #[test]
    fn no_menu_opens_over_a_dialog_that_has_the_keys() {
        let mut app = App::default();
        assert!(opens_with_f10(&app));
        app.update(Action::Command(Command::PictureLook));
        assert!(opens_with_f10(&app));
        app.update(Action::Command(Command::Preferences));
        assert!(!opens_with_f10(&app));
    }
}
