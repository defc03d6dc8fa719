//! The top row: menus, the open document with frame and shot, background work, and whether every
//! edit is saved.
//!
//! The menus contain every command. Their order is that of [`Command::all`]; [`SECTIONS`] and
//! [`SUBMENUS`] divide them.

use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{symbol, theme};
use crate::ui::drawing::labels::text_width;
use crate::ui::{Panel, key_in_brackets, takes_keys};
use egui::{
    Align, Button, Color32, Event, FocusDirection, Id, Key, Layout, Modifiers, Rect, Response,
    RichText, Role, TextStyle, Ui, WidgetInfo, vec2,
};
use std::path::Path;
use touchline_application::app::session::{Saving, SidePanel};
use touchline_application::app::{Action, App, Command, MenuGroup, Tool};
use touchline_application::scene;
use touchline_core::geometry::{pluralise, thousands};
use touchline_documents::document::{Click, Frame};
use touchline_documents::store::{PROJECT_FILE, PROJECT_SUFFIX};

/// Commands with a line above them.
const SECTIONS: [Command; 12] = [
    Command::Save,
    Command::Quit,
    Command::Cancel,
    Command::Preferences,
    Command::PlayPause,
    Command::Comment,
    Command::HideOverlay,
    Command::Compare,
    Command::TrainerPanel,
    Command::CameraPanel,
    Command::KeepBurntIn,
    Command::About,
];

/// The command below which the submenu of recent documents stands: the last that opens something.
const RECENT_BELOW: Command = Command::OpenQueue;

/// Groups of commands that are submenus at the top of their menu. No menu is longer than twelve
/// rows.
const SUBMENUS: [(&str, &[Command]); 13] = [
    ("Open other", &[Command::OpenDemo, Command::Orphans]),
    (
        "Points",
        &[
            Command::DeleteClick,
            Command::RenameClick,
            Command::NameNext,
            Command::PlaceOnLine,
            Command::ToggleCheck,
            Command::NextClick,
            Command::PreviousClick,
        ],
    ),
    (
        "Tools",
        &[
            Command::PointTool,
            Command::LineTool,
            Command::CheckTool,
            Command::SelectTool,
            Command::ShowMasks,
        ],
    ),
    (
        "Go to",
        &[
            Command::NextFrame,
            Command::PreviousFrame,
            Command::NextTenFrames,
            Command::PreviousTenFrames,
            Command::FirstFrame,
            Command::LastFrame,
            Command::GoToPlace,
            Command::NextNeedsMe,
            Command::PreviousNeedsMe,
            Command::NextUnanswered,
            Command::NextReference,
            Command::PreviousReference,
        ],
    ),
    (
        "Shots",
        &[
            Command::NextShot,
            Command::PreviousShot,
            Command::SelectShot,
            Command::FindShots,
            Command::StopShotSearch,
            Command::AddCut,
            Command::MoveCutHere,
            Command::RemoveCut,
        ],
    ),
    (
        "Accept and reject",
        &[
            Command::Accept,
            Command::AcceptAndStay,
            Command::AcceptAnyway,
            Command::AcceptStretch,
            Command::AcceptAllAbove,
            Command::Reject,
            Command::RejectShot,
        ],
    ),
    (
        "Lines and tracking",
        &[
            Command::Snap,
            Command::SearchLines,
            Command::StopSearch,
            Command::Track,
            Command::RefineBaseOnShot,
            Command::StopTracking,
            Command::MendCameras,
            Command::StopMending,
            Command::DiscardTracked,
            Command::DiscardBatch,
            Command::TakeLength,
        ],
    ),
    (
        "Gold frames",
        &[
            Command::MarkGold,
            Command::ChooseGold,
            Command::ClickAgain,
            Command::SkipAgain,
            Command::UseOwnNoise,
            Command::UseUsualNoise,
        ],
    ),
    (
        "Training",
        &[Command::UseForTraining, Command::PauseTrainer],
    ),
    (
        "Find without a click",
        &[
            Command::FindCamera,
            Command::StopFindCamera,
            Command::TryFirstCamera,
            Command::TryOtherCamera,
        ],
    ),
    (
        "Base",
        &[
            Command::EstimateBase,
            Command::BaseOnPaint,
            Command::ShowForBase,
            Command::UseEstimatedBase,
            Command::DropEstimatedBase,
            Command::StopSolving,
            Command::UseForBase,
        ],
    ),
    (
        "Field",
        &[
            Command::ChooseSport,
            Command::ConfirmFieldSize,
            Command::FitFieldSize,
        ],
    ),
    (
        "Zoom",
        &[
            Command::ZoomIn,
            Command::ZoomOut,
            Command::ZoomToFit,
            Command::ZoomToClick,
        ],
    ),
];

/// Shows the row.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let opens = is_menu_key(panel.app, ui);
    egui::MenuBar::new().ui(ui, |ui| {
        let titles = MenuGroup::ALL.map(|group| {
            ui.menu_button(group.title(), |ui| menu(panel, ui, group))
                .response
                .on_hover_text(tip(group))
        });
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

/// The tooltip of a menu.
const fn tip(group: MenuGroup) -> &'static str {
    match group {
        MenuGroup::File => "Open, save, export.",
        MenuGroup::Edit => "Undo, and editing points.",
        MenuGroup::Frame => "Navigate, accept and reject frames.",
        MenuGroup::Camera => "The camera's base: estimate it, load it, enter it.",
        MenuGroup::View => "What is shown, and zoom.",
        MenuGroup::Help => "Commands, keys, about.",
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

/// The submenus of a menu, with their titles.
fn submenus(group: MenuGroup) -> impl Iterator<Item = (&'static str, &'static [Command])> {
    SUBMENUS
        .into_iter()
        .filter(move |(_, commands)| commands[0].group() == group)
}

/// The commands of a menu that are in no submenu.
fn rows(group: MenuGroup) -> impl Iterator<Item = Command> {
    Command::all().filter(move |command| command.group() == group && !is_in_submenu(*command))
}

fn is_in_submenu(command: Command) -> bool {
    SUBMENUS
        .iter()
        .any(|(_, commands)| commands.contains(&command))
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
        let after = ui.spacing().button_padding.x + name + theme::SPACE;
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
        panel.actions.push(Action::Command(command));
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
                if ui
                    .button(document_name(&document.file))
                    .on_hover_text(document.file.display().to_string())
                    .clicked()
                {
                    panel.actions.push(Action::Open(document.file.clone()));
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
fn place(app: &App, ui: &mut Ui) {
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
            ui.label(RichText::new(shot).color(ui.palette().weak))
                .on_hover_text(format!("The frame's shot, {clip}"));
        }
        ui.add(
            egui::Label::new(RichText::new(file_name(&frame.name())).color(ui.palette().weak))
                .truncate(),
        )
        .on_hover_text(frame.name());
    }
    if let Some((number, of)) = app.queue_position() {
        let text = format!("{} of {} in the queue", thousands(number), thousands(of));
        ui.label(RichText::new(text).color(ui.palette().text))
            .on_hover_text("The next frame to do is the next of the season's queue.");
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

/// Maximum length of a name in the row, characters; the tooltip has the whole name.
const LONGEST_NAME: usize = 48;

/// A text of at most `most` characters: longer ones lose their middle.
fn shorten_text(text: &str, most: usize) -> String {
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

/// Shows whether every edit is on disk, and what to do if not.
fn saving(panel: &mut Panel<'_>, ui: &mut Ui) {
    // A change by another program stops saving until the user has chosen, so it is shown beside
    // whatever the state of saving is.
    if panel.app.session.disk.changed_outside.is_some() {
        let choose = Button::new(RichText::new("Changed outside").color(ui.palette().on_accent))
            .fill(ui.palette().caution)
            .small();
        let tip = "Another program changed the document. It is not written until you choose which version to keep.";
        if ui.add(choose).on_hover_text(tip).clicked() {
            panel.actions.push(Action::AskOutside);
        }
    }
    match &panel.app.session.disk.saving {
        Saving::Untouched => {}
        Saving::Pending => {
            ui.label(RichText::new("saving…").color(ui.palette().weak))
                .on_hover_text("The last edit is being written to disk.");
        }
        Saving::Saved { at } => {
            ui.label(RichText::new(format!("saved {at}")).color(ui.palette().weak))
                .on_hover_text("Every edit is on disk. You do not have to save.");
        }
        Saving::Failed { message, since } => {
            let edits = since.as_ref().map_or_else(
                || "Edits are only in memory.".to_owned(),
                |at| format!("Edits since {at} are only in memory."),
            );
            let elsewhere =
                Button::new(RichText::new("Save elsewhere").color(ui.palette().on_accent))
                    .fill(ui.palette().bad)
                    .small();
            panel.run_on_click(ui.add(elsewhere), Command::SaveAs);
            let text = RichText::new(format!("NOT SAVED: {message}. {edits}"))
                .color(ui.palette().bad)
                .strong();
            ui.add(egui::Label::new(text).truncate())
                .on_hover_text(format!("{message}. {edits}"));
        }
    }
}

/// Shows the background work that is going on.
fn jobs(panel: &mut Panel<'_>, ui: &mut Ui) {
    if let Some(opening) = &panel.app.session.disk.opening {
        ui.add(egui::Spinner::new().size(12.0));
        ui.label(RichText::new(shorten_text(opening, LONGEST_NAME)).color(ui.palette().accent))
            .on_hover_text(format!("{opening} The window stays usable meanwhile."));
        let key = key_in_brackets(&panel.app.settings.keys, Command::Cancel);
        let palette = ui.palette();
        let give_up = symbol::button(ui, symbol::Symbol::Cross, "Stop opening", palette.weak);
        if give_up
            .on_hover_text(format!("Stop opening.{key}"))
            .clicked()
        {
            panel.actions.push(Action::Command(Command::Cancel));
        }
    }
    trainer(panel, ui);
    shot_search(panel, ui);
    writing(panel, ui);
    // The counts are those of the previous frame of the window: this one has not laid out its
    // lists yet.
    let thumbnails = panel.pictures.thumbnails_in_view();
    if thumbnails.done < thumbnails.wanted {
        let text = format!("thumbnails {}/{}", thumbnails.done, thumbnails.wanted);
        ui.label(RichText::new(text).small().color(ui.palette().weak))
            .on_hover_text("Thumbnails of the frames in view.");
    }
}

/// Shows how far the search for cuts is; a click stops it.
fn shot_search(panel: &mut Panel<'_>, ui: &mut Ui) {
    let state = &panel.app.operations.shot_search;
    let Some(search) = state.running() else {
        return;
    };
    let text = format!("cuts {} %", state.progress().percent());
    let weak = ui.palette().weak;
    let says = work_button(ui, text, weak);
    let tip = format!(
        "Looking for cuts in {}. Click to stop.",
        file_name(&search.video)
    );
    if says.on_hover_text(tip).clicked() {
        panel.actions.push(Action::Command(Command::StopShotSearch));
    }
}

/// Shows how far an export is; a click shows its dialog, in which it can be stopped.
fn writing(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(running) = panel.app.operations.transfer.writing() else {
        return;
    };
    // Rounded down, so that 100 % is never shown while something is still to be written.
    let far = running
        .progress()
        .map(|far| format!(" {:.0} %", (100.0 * far.fraction()).floor()))
        .unwrap_or_default();
    let weak = ui.palette().weak;
    let says = work_button(ui, format!("export{far}"), weak);
    if says
        .on_hover_text("An export is being written. Click to show it.")
        .clicked()
    {
        panel.actions.push(Action::Command(Command::Export));
    }
}

/// Shows background work as a text that can be clicked.
fn work_button(ui: &mut Ui, text: String, colour: Color32) -> Response {
    ui.add(Button::new(RichText::new(text).small().color(colour)).frame(false))
}

/// Shows what the trainer is doing; a click shows its panel.
fn trainer(panel: &mut Panel<'_>, ui: &mut Ui) {
    let status = &panel.app.session.trainer.status;
    let (text, colour) = match (&status.trouble, status.doing.in_brief()) {
        (Some(_), _) => ("trainer: problem".to_owned(), ui.palette().caution),
        (None, Some(brief)) => (brief, ui.palette().weak),
        (None, None) => return,
    };
    let tip = status
        .trouble
        .clone()
        .unwrap_or_else(|| format!("{}.", status.doing.describe()));
    let says = work_button(ui, text, colour);
    let keys = &panel.app.settings.keys;
    let key = keys.with_key(Command::TrainerPanel, |key| {
        format!(" Trainer panel: {key}.")
    });
    if says.on_hover_text(format!("{tip}{key}")).clicked() {
        panel.actions.push(Action::Command(Command::TrainerPanel));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_menu_is_longer_than_twelve_rows_and_lines_are_above_its_own_commands() {
        for group in MenuGroup::ALL {
            // The menu of files lists recent documents, too.
            let recent = rows(group).filter(|row| *row == RECENT_BELOW).count();
            assert_eq!(recent, usize::from(group == MenuGroup::File));
            let length = submenus(group).count() + rows(group).count() + recent;
            assert!(length <= 12, "{}: {length} rows", group.title());
        }
        for (title, commands) in SUBMENUS {
            assert!(commands.len() <= 12, "{title}: {} rows", commands.len());
            let group = commands[0].group();
            assert!(
                commands.iter().all(|command| command.group() == group),
                "{title}"
            );
        }
        let of_menus: Vec<Command> = MenuGroup::ALL.into_iter().flat_map(rows).collect();
        assert!(SECTIONS.iter().all(|command| of_menus.contains(command)));
    }

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
